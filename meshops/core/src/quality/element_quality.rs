//! How good one element is: how severe its faults are, and its Q.I.

use super::measures::{Corners, Measures};
use super::penalty::{penalty, severity};
use super::scoring::Scoring;
use super::{ASPECT_RATIO, CRITERIA};
use crate::mesh::Element;
use crate::vectors::Vector;

/// What a fault of size counts over one of shape: all around a node together less than one.
pub const SIZE_SHARE: f64 = 1.0 / 1024.0;

/// Faults and Q.I. of an element.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementFaults {
    /// Severity of its faults of shape.
    pub shape: f64,
    /// Severity of its faults of size.
    pub size: f64,
    /// Its Q.I. as it is reported.
    pub index: f64,
}

/// Quality of an element as one that moves nodes sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementQuality {
    /// Severity of its faults, shape before size.
    pub severity: f64,
    /// Its Q.I.
    pub index: f64,
}

impl ElementFaults {
    /// Look at an element.
    #[inline]
    pub fn of(points: &[Vector], element: Element, scoring: &Scoring) -> Self {
        let values = Measures::of(&Corners::of(points, element), &scoring.sizing).to_array();
        let limit = scoring.limit();
        let (mut shape, mut size) = (0.0, 0.0);
        let (mut failing, mut passing, mut weight) = (0.0, 0.0, 0.0);
        for c in 0..CRITERIA {
            if !scoring.active[c] {
                continue;
            }
            let levels = &scoring.levels[c];
            let p = penalty(values[c], levels, &scoring.penalties);
            if p.is_nan() {
                continue;
            }
            let fault = severity(values[c], p, levels, limit);
            if c > ASPECT_RATIO {
                shape += fault;
            } else {
                size += fault;
            }
            if p > limit {
                failing += scoring.weights[c] * p;
            } else {
                passing += scoring.weights[c] * p;
                weight += scoring.weights[c];
            }
        }
        let mean = if weight > 0.0 { passing / weight } else { 0.0 };
        Self { shape, size, index: failing + mean }
    }
}

impl ElementQuality {
    /// Look at an element.
    #[inline]
    pub fn of(points: &[Vector], element: Element, scoring: &Scoring) -> Self {
        let faults = ElementFaults::of(points, element, scoring);
        Self { severity: faults.shape + SIZE_SHARE * faults.size, index: faults.index }
    }
}
