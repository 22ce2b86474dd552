//! Penalties: how far a measure is from ideal, linear between the levels of its criterion.

use super::scoring::{Levels, Scoring};
use super::{CRITERIA, SLACK};

/// Severities are whole multiples of 1 / GRAIN, so that sums of them are exact in any order.
const GRAIN: f64 = (1u64 << 20) as f64;

/// Penalty of a value: linear between the levels, constant outside them, NaN for NaN.
#[inline]
pub fn penalty(value: f64, levels: &Levels, penalties: &[f64; 5]) -> f64 {
    let Levels { mut ideal, mut good, mut warn, mut fail, mut worst, .. } = *levels;
    let mut value = value;
    if worst < ideal {
        (value, ideal, good) = (-value, -ideal, -good);
        (warn, fail, worst) = (-warn, -fail, -worst);
    }
    if value <= ideal {
        penalties[0]
    } else if value <= good {
        between(value, [ideal, good], [penalties[0], penalties[1]])
    } else if value <= warn {
        between(value, [good, warn], [penalties[1], penalties[2]])
    } else if value <= fail {
        between(value, [warn, fail], [penalties[2], penalties[3]])
    } else if value <= worst {
        between(value, [fail, worst], [penalties[3], penalties[4]])
    } else if value.is_nan() {
        f64::NAN
    } else {
        penalties[4]
    }
}

#[inline]
fn between(value: f64, [low, high]: [f64; 2], [at_low, at_high]: [f64; 2]) -> f64 {
    at_low + (value - low) / (high - low) * (at_high - at_low)
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

/// Severity of a value with penalty `p`: that where it is beyond the limit, 1 where just its bound
/// is broken, or 0.
#[inline]
pub fn severity(value: f64, p: f64, levels: &Levels, limit: f64) -> f64 {
    if p > limit {
        return (p * GRAIN + 0.5).floor() / GRAIN;
    }
    let broken = if levels.worst < levels.ideal {
        value < levels.bound * (1.0 - SLACK)
    } else {
        value > levels.bound * (1.0 + SLACK)
    };
    if broken { 1.0 } else { 0.0 }
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
