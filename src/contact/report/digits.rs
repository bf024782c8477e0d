//! Numbers in messages.

use std::fmt;

/// A number with so many digits: plain where that is short, else with a power of ten.
pub(crate) struct Digits(pub f64, pub usize);

/// Numbers from here to there are plain.
const PLAIN: [f64; 2] = [1e-4, 1e6];

impl fmt::Display for Digits {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value, digits) = *self;
        let size = value.abs();
        if !(PLAIN[0]..PLAIN[1]).contains(&size) {
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
    fn numbers_are_plain_where_that_is_short() {
        let written =
            [1.547484, 12345.678, 0.00062, -3.0, 4.2e-5, 7.5e9].map(|value| Digits(value, 4).to_string());
        assert_eq!(written, ["1.547", "12346", "0.0006200", "-3.000", "4.200e-5", "7.500e9"]);
    }
}
