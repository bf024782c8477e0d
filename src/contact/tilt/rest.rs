//! Where the gradient of a convex energy vanishes: Newton's method with a stiffness that learns, in bounded steps, each
//! cut until the energy falls along it.

use nalgebra::{DMatrix, DVector};

/// Steps at the most.
const MAX_STEPS: usize = 40;
/// Cuts of one step at the most.
const MAX_CUTS: usize = 8;
/// A step is short enough where the energy at its end rises along it by no more than this share of how it fell at first.
const MOST_RISE: f64 = 0.5;
/// Least share of a step that a cut leaves, and largest.
const CUT_SHARES: [f64; 2] = [0.1, 0.8];
/// A stiffness below this share of the largest is no hold for a step.
const SOFT_SHARE: f64 = 1e-4;
/// Steps that do not halve the distance from rest, before the stiffness is measured anew.
const STALLED_STEPS: usize = 2;
/// Least share of a step that must be left within the bounds.
const LEAST_ROOM: f64 = 1e-3;

/// What one place gave.
pub(crate) struct Place<T> {
    /// Gradient of the energy (N).
    pub gradient: DVector<f64>,
    /// Distance from rest: 1 is near enough.
    pub off: f64,
    /// Nothing holds it there, whatever the gradient.
    pub is_free: bool,
    pub found: T,
}

/// Where a search begins.
pub(crate) struct Beginning {
    pub at: DVector<f64>,
    /// Derivative of the gradient (N/m), as far as known.
    pub stiffness: Option<DMatrix<f64>>,
    /// Length of the first step at the most, and of the steps that a stiffness is measured with (m).
    pub lengths: [f64; 2],
}

/// How a search ended.
pub(crate) struct Ended<T> {
    pub at: DVector<f64>,
    pub found: T,
    /// `None` where none was needed.
    pub stiffness: Option<DMatrix<f64>>,
    /// What is in the way; `None` at rest.
    pub why: Option<&'static str>,
}

/// Looks for the place of rest.
///
/// * `first`: what the start gave
/// * `room`: share of a step from a place that stays within the bounds
/// * `trial`: `None` where a place has no answer
pub(crate) fn find<T, E>(
    start: Beginning,
    first: Place<T>,
    room: impl Fn(&DVector<f64>, &DVector<f64>) -> f64,
    mut trial: impl FnMut(&DVector<f64>) -> Result<Option<Place<T>>, E>,
) -> Result<Ended<T>, E> {
    let [mut radius, probe] = start.lengths;
    let (mut at, mut here) = (start.at, first);
    let mut known = start.stiffness;
    let mut in_vain = 0;
    let ended = |at, found, stiffness, why| Ok(Ended { at, found, stiffness, why });
    for _ in 0..MAX_STEPS {
        if here.off <= 1.0 {
            return ended(at, here.found, known, None);
        }
        let old = known.take().filter(|_| in_vain < STALLED_STEPS);
        let is_new = old.is_none();
        let mut stiffness = match old {
            Some(stiffness) => stiffness,
            None => measured(&at, &here, probe, &mut trial)?,
        };
        if is_new {
            in_vain = 0;
        }
        let mut step = newton(&stiffness, &here.gradient, radius);
        let share = room(&at, &step);
        if share < LEAST_ROOM {
            return ended(
                at,
                here.found,
                Some(stiffness),
                Some("the obstacle would turn by more than 30 degrees"),
            );
        }
        step *= share.min(1.0);
        let Some((cut, next)) = fallen_along(&step, here.gradient.dot(&step), &at, &mut trial)? else {
            if is_new {
                let why = "the obstacle swings free of the skin, or the contact changes by jumps";
                return ended(at, here.found, Some(stiffness), Some(why));
            }
            in_vain = STALLED_STEPS;
            continue;
        };
        let step = cut * step;
        let change = &next.gradient - &here.gradient - &stiffness * &step;
        stiffness += change * step.transpose() / step.norm_squared();
        let is_full = cut == 1.0 && share >= 1.0;
        radius = if is_full { radius.max(2.0 * step.norm()) } else { step.norm() };
        in_vain = if next.off > 0.5 * here.off { in_vain + 1 } else { 0 };
        at += step;
        here = next;
        known = Some(stiffness);
    }
    let why = (here.off > 1.0).then_some("it does not settle");
    ended(at, here.found, known, why)
}

/// The share of a step at whose end the energy has not begun to rise again by much, or the place is one of rest, and that
/// place; `None` where no cut leads to one.
///
/// * `slope`: along the step where it begins (N m)
fn fallen_along<T, E>(
    step: &DVector<f64>,
    slope: f64,
    at: &DVector<f64>,
    mut trial: impl FnMut(&DVector<f64>) -> Result<Option<Place<T>>, E>,
) -> Result<Option<(f64, Place<T>)>, E> {
    let mut cut = 1.0;
    for _ in 0..MAX_CUTS {
        cut *= match trial(&(at + cut * step))? {
            Some(place) if place.off <= 1.0 => return Ok(Some((cut, place))),
            Some(place) if !place.is_free => {
                let slope_there = place.gradient.dot(step);
                if slope_there <= -MOST_RISE * slope {
                    return Ok(Some((cut, place)));
                }
                (slope / (slope - slope_there)).clamp(CUT_SHARES[0], CUT_SHARES[1])
            }
            _ => 0.5,
        };
    }
    Ok(None)
}

/// Newton's step, or one down the energy where that is too long or leads up.
fn newton(stiffness: &DMatrix<f64>, gradient: &DVector<f64>, radius: f64) -> DVector<f64> {
    if let Some(step) = stiffness.clone().lu().solve(&-gradient)
        && step.norm() <= radius
        && step.dot(gradient) < 0.0
    {
        return step;
    }
    let symmetric = (0.5 * (stiffness + stiffness.transpose())).symmetric_eigen();
    // So soft that it leaves the length of the step to the radius, where nothing is stiff.
    let least = SOFT_SHARE * symmetric.eigenvalues.amax().max(gradient.norm() / radius);
    let mut along = symmetric.eigenvectors.tr_mul(gradient);
    for (part, stiffness) in along.iter_mut().zip(symmetric.eigenvalues.iter()) {
        *part /= -stiffness.abs().max(least);
    }
    let step = symmetric.eigenvectors * along;
    let length = step.norm();
    if length > radius { step * (radius / length) } else { step }
}

/// The stiffness by differences.
fn measured<T, E>(
    at: &DVector<f64>,
    here: &Place<T>,
    probe: f64,
    trial: &mut impl FnMut(&DVector<f64>) -> Result<Option<Place<T>>, E>,
) -> Result<DMatrix<f64>, E> {
    let mut stiffness = DMatrix::zeros(at.len(), at.len());
    for axis in 0..at.len() {
        // Down the energy, where the other places are.
        let down = if here.gradient[axis] > 0.0 { -probe } else { probe };
        for length in [down, -down] {
            let mut beside = at.clone();
            beside[axis] += length;
            if let Some(place) = trial(&beside)?.filter(|place| !place.is_free) {
                stiffness.set_column(axis, &((place.gradient - &here.gradient) / length));
                break;
            }
        }
    }
    Ok(stiffness)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Springs of unit stiffness at `places` under a plate of depth x0 and slope x1, pressed by a unit force.
    fn springs(places: &[(f64, f64)], at: &DVector<f64>) -> Place<()> {
        let pressed = |&(x, height): &(f64, f64)| (height + at[0] + at[1] * x).max(0.0);
        let force: f64 = places.iter().map(pressed).sum();
        let moment: f64 = places.iter().map(|place| place.0 * pressed(place)).sum();
        let gradient = DVector::from_vec(vec![force - 1.0, moment]);
        Place { off: gradient.norm() / 1e-9, gradient, is_free: false, found: () }
    }

    #[test]
    fn a_plate_settles_on_springs_that_it_does_not_touch_at_first() {
        let places = [(-1.0, 0.0), (1.0, -3.0), (0.5, -2.0)];
        let at = DVector::from_vec(vec![1.0, 0.0]);
        let first = springs(&places, &at);
        let start = Beginning { at, stiffness: None, lengths: [0.5, 1e-2] };
        let mut trials = 0;
        let ended = find(
            start,
            first,
            |_, _| 1.0,
            |at| -> Result<_, ()> {
                trials += 1;
                Ok(Some(springs(&places, at)))
            },
        );
        let ended = ended.expect("no trial fails");
        assert_eq!(ended.why, None);
        assert!(springs(&places, &ended.at).gradient.norm() <= 1e-9 && trials < 60, "{trials}");
    }

    #[test]
    fn a_place_beyond_the_bounds_is_not_found() {
        let falling = |at: &DVector<f64>| Place {
            gradient: DVector::from_vec(vec![-1.0]),
            off: 2.0,
            is_free: false,
            found: at[0],
        };
        let at = DVector::from_vec(vec![0.0]);
        let first = falling(&at);
        let start = Beginning { at, stiffness: None, lengths: [0.5, 1e-2] };
        let room = |at: &DVector<f64>, step: &DVector<f64>| (1.0 - at[0]) / step[0];
        let ended = find(start, first, room, |at| -> Result<_, ()> { Ok(Some(falling(at))) });
        let ended = ended.expect("no trial fails");
        assert!(ended.why.is_some_and(|why| why.contains("30 degrees")));
        assert!((ended.found - 1.0).abs() < 1e-2);
    }
}
