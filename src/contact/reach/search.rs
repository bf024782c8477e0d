//! The argument at which a rising function takes a value: a bracketed secant in logarithms.

use crate::contact::report::digits::Digits;

/// Trials at the most.
const MAX_TRIALS: usize = 12;
/// Largest step outwards, as a factor.
const LARGEST_STEP: f64 = 4.0;
/// Least and largest power of the argument that a function is taken to rise with.
const POWERS: [f64; 2] = [0.3, 100.0];
/// Trials after which a bracket that is not half as wide is cut in the middle.
const SLOW_TRIALS: usize = 3;
/// A bracket that narrow, whose upper end has no value, ends the search.
const NARROW_BRACKET: f64 = 1.01;

/// How far a value may fall, as a logarithm, before the function is taken to fall for good: forces on rough products dip by a
/// few per cent.
const LARGEST_DIP: f64 = 0.1;

/// What is looked for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Search {
    /// The value (> 0).
    pub value: f64,
    /// First argument tried (> 0).
    pub first: f64,
    /// Power of the argument that the function rises with, as far as known.
    pub power: f64,
    /// Largest argument that is of use.
    pub limit: f64,
    /// Argument and value of one point, where known.
    pub known: Option<(f64, f64)>,
    /// Relative distance from the value at which the search ends.
    pub tolerance: f64,
}

/// What one argument gave.
pub(crate) enum Trial {
    /// A value (≥ 0).
    Value(f64),
    /// None, and why.
    Blocked(String),
}

/// How a search ended.
pub(crate) enum Found {
    /// With the value, or as near to it as jumps of no more than [`Search::UNEVENNESS`] allow; with the power of the argument
    /// that the function rises with there.
    Close { at: f64, power: f64 },
    /// Without: where the largest value below was found, if any, where the function jumps to one above, and what is in the way.
    NotReached { largest: Option<f64>, above: Option<f64>, why: String },
}

/// What is known on the way; arguments and values as logarithms, values relative to the one looked for.
struct Bracket {
    /// The largest argument known whose value is below.
    below: Option<(f64, f64)>,
    /// The largest value below.
    largest: Option<(f64, f64)>,
    /// The smallest argument known whose value is above, or beyond which none is looked for.
    above: Option<(f64, Option<f64>)>,
    /// The last two points.
    recent: [Option<(f64, f64)>; 2],
    /// The point nearest to the value.
    nearest: (f64, f64),
    /// Whether the value was 0 somewhere.
    starts_late: bool,
    /// Width at the last halving, and trials since.
    width: (f64, usize),
    why: String,
}

impl Search {
    /// Relative distance from the value asked for that is promised.
    pub const TOLERANCE: f64 = 1e-6;
    /// How near to it is good enough where no value is nearer, as contacts are solved to a gap: half of what a mesh may cost by
    /// default.
    pub const UNEVENNESS: f64 = 1e-2;

    /// Looks for the value.
    pub fn run<E>(&self, mut trial: impl FnMut(f64) -> Result<Trial, E>) -> Result<Found, E> {
        let mut bracket = Bracket {
            below: None,
            largest: None,
            above: None,
            recent: [None; 2],
            nearest: (0.0, f64::INFINITY),
            starts_late: false,
            width: (f64::INFINITY, 0),
            why: String::new(),
        };
        let mut at = self.first.min(self.limit);
        if let Some((known, value)) = self.known {
            bracket.add(known.ln(), (value / self.value).ln());
            at = bracket.next(self);
        }
        for _ in 0..MAX_TRIALS {
            match trial(at)? {
                Trial::Value(value) if (value / self.value - 1.0).abs() <= self.tolerance => {
                    return Ok(Found::Close { at, power: bracket.power(self) });
                }
                Trial::Value(value) => bracket.add(at.ln(), (value / self.value).ln()),
                Trial::Blocked(why) => {
                    bracket.above = Some((at.ln(), None));
                    bracket.why = why;
                }
            }
            if bracket.above.is_none() && at >= self.limit {
                bracket.why =
                    "no deeper one is tried, as the obstacle has come through all of the skin there".into();
                return Ok(bracket.give_up(self));
            }
            if bracket.is_narrow() {
                return Ok(bracket.give_up(self));
            }
            at = bracket.next(self);
        }
        match bracket.above {
            Some((_, Some(above))) => {
                let above = self.value * above.exp();
                bracket.why =
                    format!("it jumps to {} beyond: {MAX_TRIALS} depths were tried", Digits(above, 4));
            }
            None => bracket.why = format!("no more than {MAX_TRIALS} depths are tried"),
            Some((_, None)) => {}
        }
        Ok(bracket.give_up(self))
    }
}

impl Bracket {
    fn add(&mut self, at: f64, value: f64) {
        if value.abs() < self.nearest.1.abs() {
            self.nearest = (at, value);
        }
        let largest = self.largest.map_or(f64::NEG_INFINITY, |(_, largest)| largest);
        let is_bracketed = matches!(self.above, Some((_, Some(_))));
        if value >= 0.0 {
            self.above = Some((at, Some(value)));
        } else if is_bracketed || value >= largest - LARGEST_DIP {
            self.below = Some((at, value));
        } else {
            self.above = Some((at, None));
            self.why =
                "deeper it falls again, and what comes beyond is not searched: a press by depth tells it"
                    .into();
        }
        if value < 0.0 && value >= largest {
            self.largest = Some((at, value));
        }
        if value.is_finite() {
            self.recent = [self.recent[1], Some((at, value))];
        } else {
            self.starts_late = true;
        }
    }

    fn is_narrow(&self) -> bool {
        matches!((self.below, self.above), (Some((low, _)), Some((high, None))) if high - low < NARROW_BRACKET.ln())
    }

    /// Power of the argument between the last two points.
    fn power(&self, search: &Search) -> f64 {
        let [Some((a, at_a)), Some((b, at_b))] = self.recent else { return search.power };
        let power = (at_b - at_a) / (b - a);
        if power.is_finite() && power > 0.0 { power.clamp(POWERS[0], POWERS[1]) } else { search.power }
    }

    /// The argument to try next.
    fn next(&mut self, search: &Search) -> f64 {
        let secant = self.secant(search);
        let chord = self.chord();
        let low = self.below.map(|(at, _)| at);
        let step = LARGEST_STEP.ln();
        let next = match (low, self.above) {
            (None, None) => search.first.ln(),
            (Some(low), None) => {
                let farthest = (low + step).min(search.limit.ln());
                secant.filter(|at| *at > low).map_or(farthest, |at| at.min(farthest))
            }
            (None, Some((high, _))) => secant.filter(|at| *at < high).unwrap_or(high - step),
            (Some(low), Some((high, _))) => {
                let width = high - low;
                self.width =
                    if width <= 0.5 * self.width.0 { (width, 0) } else { (self.width.0, self.width.1 + 1) };
                let is_slow = self.width.1 >= SLOW_TRIALS;
                if is_slow {
                    self.width = (width, 0);
                }
                let inside = |at: &f64| low < *at && *at < high && !is_slow;
                // Where it starts late, any argument between may be the first with a value.
                let middle = if self.below.is_some_and(|(_, value)| value.is_finite()) {
                    0.5 * (low + high)
                } else {
                    (0.5 * (low.exp() + high.exp())).ln()
                };
                secant.filter(inside).or(chord.filter(inside)).unwrap_or(middle)
            }
        };
        next.exp().min(search.limit)
    }

    /// Where the function takes the value by its last points; where it starts late, its root of the power looked for rises in
    /// a straight line.
    fn secant(&self, search: &Search) -> Option<f64> {
        let (at, value) = self.recent[1]?;
        if !self.starts_late {
            return Some(at - value / self.power(search));
        }
        let (before, value_before) = self.recent[0]?;
        let root = |value: f64| (value / search.power).exp();
        let slope = (root(value) - root(value_before)) / (at.exp() - before.exp());
        (slope > 0.0).then(|| (at.exp() + (1.0 - root(value)) / slope).ln())
    }

    /// Where the chord between the ends of the bracket crosses.
    fn chord(&self) -> Option<f64> {
        let ((low, at_low), (high, at_high)) = (self.below?, self.above?);
        let crossing = low - at_low * (high - low) / (at_high? - at_low);
        crossing.is_finite().then_some(crossing)
    }

    fn give_up(self, search: &Search) -> Found {
        if self.nearest.1.abs() <= Search::UNEVENNESS {
            return Found::Close { at: self.nearest.0.exp(), power: self.power(search) };
        }
        let above = self.above.and_then(|(at, value)| value.map(|_| at.exp()));
        Found::NotReached { largest: self.largest.map(|(at, _)| at.exp()), above, why: self.why }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn search(value: f64) -> Search {
        Search { value, first: 1.0, power: 1.5, limit: 1e3, known: None, tolerance: Search::TOLERANCE }
    }

    /// Trials and the argument found.
    fn count(search: &Search, function: impl Fn(f64) -> f64) -> (usize, f64) {
        let mut trials = 0;
        let ended = search.run(|at| -> Result<_, ()> {
            trials += 1;
            Ok(Trial::Value(function(at)))
        });
        match ended {
            Ok(Found::Close { at, .. }) => (trials, at),
            _ => panic!("not found"),
        }
    }

    #[test]
    fn a_power_is_found_by_the_second_secant() {
        for power in [1.0_f64, 1.5, 2.0, 3.0] {
            for at in [0.01_f64, 0.3, 40.0] {
                let (trials, found) = count(&search(at.powf(power)), |x| x.powf(power));
                assert!((found / at - 1.0).abs() <= 1e-6 && trials <= 6, "{power} {at}: {trials}, {found}");
            }
        }
    }

    #[test]
    fn kinks_and_a_start_without_value_are_overcome() {
        let kinked = |x: f64| if x < 2.0 { x } else { 2.0 + 30.0 * (x - 2.0) };
        let (trials, found) = count(&search(3.0), kinked);
        // A value to 1e-6 of 3 with slope 30.
        assert!(trials <= MAX_TRIALS && (found - (2.0 + 1.0 / 30.0)).abs() <= 1e-7 + 4.0 * f64::EPSILON);
        let late = |x: f64| (x - 5.0).max(0.0).powf(1.5);
        let (trials, found) = count(&search(1.0), late);
        // To 1e-6 of 1 with slope 1.5.
        assert!(trials <= MAX_TRIALS && (found - 6.0).abs() < 1e-6);
    }

    #[test]
    fn a_start_without_value_is_found_for_values_that_are_small_there() {
        for at in [0.07_f64, 0.3, 0.7, 5.0] {
            let late = |x: f64| (x - at).max(0.0).powf(1.5);
            for value in [1e-9, 1e-6, 1e-3, 1.0] {
                let (trials, found) = count(&search(value), late);
                assert!((late(found) / value - 1.0).abs() <= 1e-6, "{value} past {at}: {trials}, {found}");
            }
        }
    }

    #[test]
    fn small_jumps_end_at_the_nearest_value() {
        // Down by 1e-4 of itself at every whole number, and up again.
        let rough = |x: f64| x * (1.0 + if (x as i64) % 2 == 0 { 1e-4 } else { 0.0 });
        for value in [7.0, 7.9999, 8.0004] {
            let at = count(&search(value), rough).1;
            assert!((rough(at) / value - 1.0).abs() <= 2e-4, "{value}: {at}");
        }
    }

    #[test]
    fn what_is_reached_beyond_a_dip_is_found() {
        // Rises, falls by 8 % from 2 to 2.3, and rises again.
        let dips = |x: f64| if x < 2.0 { x } else { (2.0 - 0.55 * (x - 2.0)).max(1.84 + 0.7 * (x - 2.3)) };
        for value in [1.9, 1.95, 1.99, 2.0, 2.1, 3.0] {
            for first in [0.5, 1.0, 1.9, 2.2] {
                let at = count(&Search { first, power: 1.0, ..search(value) }, dips).1;
                assert!((dips(at) / value - 1.0).abs() <= 1e-6, "{value} from {first}: {at}");
            }
        }
    }

    #[test]
    fn a_known_point_spares_a_trial() {
        let close = Search { known: Some((2.0, 4.0)), power: 2.0, ..search(4.1) };
        assert_eq!(count(&close, |x| x * x).0, 1);
    }

    #[test]
    fn what_cannot_be_reached_gives_the_largest_below() {
        let short = |function: fn(f64) -> Trial, reason: &str| match search(10.0)
            .run(|x| -> Result<_, ()> { Ok(function(x)) })
        {
            Ok(Found::NotReached { largest: Some(at), above: None, why }) => {
                assert!((6.5..7.0).contains(&at), "{at}");
                assert_eq!(why, reason);
            }
            _ => panic!("found"),
        };
        short(
            |x| Trial::Value(if x < 7.0 { x } else { 0.5 }),
            "deeper it falls again, and what comes beyond is not searched: a press by depth tells it",
        );
        short(|x| if x < 7.0 { Trial::Value(x) } else { Trial::Blocked("wall".into()) }, "wall");
        match search(1e9).run(|x| -> Result<_, ()> { Ok(Trial::Value(x)) }) {
            Ok(Found::NotReached { largest: Some(at), .. }) => assert!((at / 1e3 - 1.0).abs() < 1e-12),
            _ => panic!("found"),
        }
    }
}
