//! Numbers in messages.

use std::fmt;

/// A number with so many digits: plain where that is short, else with a power of ten; 0 is "0".
pub(crate) struct Digits(pub f64, pub usize);

/// Numbers from here to there are plain.
const PLAIN_NUMBERS: [f64; 2] = [1e-4, 1e6];

/// A number as somebody gave it: plain where that is short, else with a power of ten.
pub(crate) struct Given(pub f64);

impl fmt::Display for Given {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        let is_plain = value == 0.0 || (PLAIN_NUMBERS[0]..PLAIN_NUMBERS[1]).contains(&value.abs());
        if is_plain { write!(formatter, "{value}") } else { write!(formatter, "{value:e}") }
    }
}

impl fmt::Display for Digits {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, digits) = *self;
        let size = value.abs();
        if size == 0.0 {
            return formatter.write_str("0");
        }
        if !(PLAIN_NUMBERS[0]..PLAIN_NUMBERS[1]).contains(&size) {
            return write!(formatter, "{value:.*e}", digits - 1);
        }
        let decimals = digits as i32 - 1 - size.log10().floor() as i32;
        write!(formatter, "{value:.*}", decimals.max(0) as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_given_is_told_as_short_as_it_is() {
        let written =
            [5.0, 0.25, -0.001, 0.0, 1e300, 1e-300, f64::INFINITY].map(|value| Given(value).to_string());
        assert_eq!(written, ["5", "0.25", "-0.001", "0", "1e300", "1e-300", "inf"]);
    }

    #[test]
    fn numbers_are_plain_where_that_is_short() {
        let written = [1.547484, 12345.678, 0.00062, -3.0, 4.2e-5, 7.5e9, 0.0]
            .map(|value| Digits(value, 4).to_string());
        assert_eq!(written, ["1.547", "12346", "0.0006200", "-3.000", "4.200e-5", "7.500e9", "0"]);
    }
}
