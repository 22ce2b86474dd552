//! What to score with: criteria at one target element size.

use super::{CRITERIA, SLACK};

/// Values at which a criterion is ideal, good, warn, fail and worst, and the worst that a changed
/// element may have: infinite where just the fail level counts. They rise or fall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// -1 where the levels fall.
    sign: f64,
    /// Ideal to worst times the sign, so that they rise.
    rising: [f64; 5],
    /// The bound times the sign, and a little beyond.
    bound: f64,
}

impl Levels {
    /// A value times the sign: the larger, the worse.
    #[inline(always)]
    pub fn badness(&self, value: f64) -> f64 {
        self.sign * value
    }

    /// Ideal to worst as badness.
    #[inline(always)]
    pub fn rising(&self) -> &[f64; 5] {
        &self.rising
    }

    /// Whether a badness is beyond the bound.
    #[inline(always)]
    pub fn is_beyond_bound(&self, badness: f64) -> bool {
        badness > self.bound
    }
}

impl From<[f64; 6]> for Levels {
    fn from(levels: [f64; 6]) -> Self {
        let [ideal, good, warn, fail, worst, bound] = levels;
        let sign = if worst < ideal { -1.0 } else { 1.0 };
        Self {
            sign,
            rising: [ideal, good, warn, fail, worst].map(|level| sign * level),
            bound: sign * bound * (1.0 + sign * SLACK),
        }
    }
}

/// How lengths are measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sizing {
    /// The minimal normalised height instead of the shortest edge.
    pub normalised: bool,
    /// Gradient of the logarithm of the target size: lengths are over the target size where they
    /// are, so that an element is measured as if it lay in `origin`.
    pub gradient: [f64; 3],
    /// Where the target size is that of the levels.
    pub origin: [f64; 3],
}

impl From<[f64; 7]> for Sizing {
    fn from(sizing: [f64; 7]) -> Self {
        let [normalised, gx, gy, gz, x, y, z] = sizing;
        Self { normalised: normalised != 0.0, gradient: [gx, gy, gz], origin: [x, y, z] }
    }
}

/// Criteria at one target element size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scoring {
    /// Levels of each criterion.
    pub levels: [Levels; CRITERIA + 1],
    /// Share of each criterion in the Q.I.
    pub weights: [f64; CRITERIA + 1],
    /// Which criteria count at all.
    pub active: [bool; CRITERIA + 1],
    /// Penalty at ideal, good, warn, fail and worst.
    pub penalties: [f64; 5],
    /// How lengths are measured.
    pub sizing: Sizing,
}

impl Scoring {
    /// The penalty beyond which an element fails.
    #[inline]
    pub fn limit(&self) -> f64 {
        self.penalties[3] + SLACK
    }
}
