//! Penalties: how far a measure is from ideal, linear between the levels of its criterion.

use super::CRITERIA;
use super::scoring::{Levels, Scoring};

/// Severities are whole multiples of 1 / GRAIN, so that sums of them are exact in any order.
const GRAIN: f64 = (1u64 << 20) as f64;

/// Penalty of a value: linear between the levels, constant outside them, NaN for NaN.
#[inline(always)]
pub fn penalty(value: f64, levels: &Levels, penalties: &[f64; 5]) -> f64 {
    let badness = levels.badness(value);
    let rising = levels.rising();
    // counted and not looked for: there is nothing to guess for the processor
    let passed = usize::from(badness > rising[0])
        + usize::from(badness > rising[1])
        + usize::from(badness > rising[2])
        + usize::from(badness > rising[3])
        + usize::from(badness > rising[4]);
    if passed == 0 {
        return if badness.is_nan() { f64::NAN } else { penalties[0] };
    }
    if passed >= 5 {
        return penalties[4];
    }
    let (low, high) = (rising[passed - 1], rising[passed]);
    let (at_low, at_high) = (penalties[passed - 1], penalties[passed]);
    at_low + (badness - low) / (high - low) * (at_high - at_low)
}

/// Penalties of an element's measures; NaN where a criterion is inactive or not measured.
pub fn penalise(values: &[f64; CRITERIA], scoring: &Scoring) -> [f64; CRITERIA] {
    std::array::from_fn(|c| {
        if scoring.active[c] {
            penalty(values[c], &scoring.levels[c], &scoring.penalties)
        } else {
            f64::NAN
        }
    })
}

/// Severity of a value that fails with a penalty.
#[inline(always)]
pub fn severity_of(penalty: f64) -> f64 {
    let grains = penalty * GRAIN + 0.5;
    // cut off, which is rounding down of a positive number; a larger one is whole
    let whole = if grains < 4e15 { grains as i64 as f64 } else { grains };
    whole / GRAIN
}

/// Severity of a value with penalty `p`: that where it is beyond the limit, 1 where just its bound
/// is broken, or 0.
#[inline(always)]
pub fn severity(value: f64, p: f64, levels: &Levels, limit: f64) -> f64 {
    if p > limit {
        severity_of(p)
    } else if levels.is_beyond_bound(levels.badness(value)) {
        1.0
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn worse_values_cost_no_less(value in 0.0..200.0, more in 0.0..50.0, falls in any::<bool>()) {
            let sign = if falls { -1.0 } else { 1.0 };
            let levels = [10.0, 40.0, 80.0, 100.0, 150.0, f64::INFINITY].map(|x: f64| sign * x);
            let penalties = [0.0, 0.0, 0.8, 1.0, 10.0];
            let at = |x: f64| penalty(sign * x, &Levels::from(levels), &penalties);
            prop_assert!(at(value) <= at(value + more) + 1e-12);
        }
    }
}
