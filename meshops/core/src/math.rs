//! Functions that IEEE 754 does not pin down, the same on every machine, and Python's arithmetic.
//!
//! The system's mathematical library differs from one machine to the next in the last bit, so none
//! of it is called: use these instead of the methods of `f64`. Square roots, absolute values and
//! `floor` are exact everywhere and may be taken from `f64`.

/// Sine of an angle in radians.
#[inline]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Cosine of an angle in radians.
#[inline]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Tangent of an angle in radians.
#[inline]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Angle of a sine, in radians; NaN outside [-1, 1].
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Angle of a cosine, in radians; NaN outside [-1, 1].
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Angle of a tangent, in radians.
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the vector (x, y) from the first axis, in radians.
#[inline]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// e to the power of x.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// Natural logarithm.
#[inline]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// x to the power of y.
#[inline]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Cube root.
#[inline]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// Length of the vector (x, y), without overflow on the way.
#[inline]
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

/// Degrees of an angle in radians, rounded as Python rounds it.
#[inline(always)]
pub fn degrees(radians: f64) -> f64 {
    radians * (180.0 / std::f64::consts::PI)
}

/// Radians of an angle in degrees, rounded as Python rounds it.
#[inline]
pub fn radians(degrees: f64) -> f64 {
    degrees * (std::f64::consts::PI / 180.0)
}

/// Python's `min(a, b)`: the first unless the second is less, so also where one is NaN.
#[inline(always)]
pub fn least<T: PartialOrd>(a: T, b: T) -> T {
    if b < a { b } else { a }
}

/// Python's `max(a, b)`: the first unless the second is greater, so also where one is NaN.
#[inline(always)]
pub fn greatest<T: PartialOrd>(a: T, b: T) -> T {
    if b > a { b } else { a }
}

/// Python's `min` of some numbers, in their order.
#[inline(always)]
pub fn least_of<const N: usize>(numbers: [f64; N]) -> f64 {
    let mut found = numbers[0];
    for number in &numbers[1..] {
        found = least(found, *number);
    }
    found
}

/// Python's `max` of some numbers, in their order.
#[inline(always)]
pub fn greatest_of<const N: usize>(numbers: [f64; N]) -> f64 {
    let mut found = numbers[0];
    for number in &numbers[1..] {
        found = greatest(found, *number);
    }
    found
}

/// Python's `a // b`: rounded down. `b` is not 0.
#[inline]
pub fn floor_div(a: i64, b: i64) -> i64 {
    let quotient = a.wrapping_div(b);
    let inexact = a.wrapping_rem(b) != 0;
    quotient - i64::from(inexact && ((a < 0) != (b < 0)))
}

/// Python's `a % b`: of the sign of `b`. `b` is not 0.
#[inline]
pub fn floor_mod(a: i64, b: i64) -> i64 {
    let rest = a.wrapping_rem(b);
    if rest != 0 && ((rest < 0) != (b < 0)) { rest + b } else { rest }
}

/// Python's `a % b` of floats: of the sign of `b`, which is above 0.
#[inline]
pub fn modulo(a: f64, b: f64) -> f64 {
    let rest = a % b;
    if rest < 0.0 { rest + b } else { rest.abs() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn nan_is_kept_where_it_comes_first() {
        assert!(least(f64::NAN, 1.0).is_nan());
        assert_eq!(least(1.0, f64::NAN), 1.0);
        assert!(greatest(f64::NAN, 1.0).is_nan());
        assert_eq!(greatest_of([1.0, f64::NAN, 2.0]), 2.0);
    }

    #[test]
    fn remainders_have_the_sign_of_the_divisor() {
        assert_eq!(modulo(-1.0, 4.0), 3.0);
        assert_eq!(modulo(9.0, 4.0), 1.0);
        assert!(modulo(-8.0, 4.0).is_sign_positive());
    }

    proptest! {
        #[test]
        fn division_rounds_down(a in -1000i64..1000, b in -50i64..50) {
            prop_assume!(b != 0);
            prop_assert_eq!(floor_div(a, b), (a as f64 / b as f64).floor() as i64);
            prop_assert_eq!(floor_div(a, b) * b + floor_mod(a, b), a);
        }
    }
}
