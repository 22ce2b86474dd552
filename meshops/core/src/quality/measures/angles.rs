//! The largest and the smallest angle of an element; over 180 degrees in a concave corner.

use super::corners::{QuadSides, TriaSides};
use crate::math::{acos, degrees, greatest, greatest_of, least, least_of};
use crate::vectors::dot;

/// Extreme angles of an element, in degrees.
pub struct Angles {
    pub smallest: f64,
    pub largest: f64,
}

/// Angles of a tria.
#[inline]
pub fn of_tria(sides: &TriaSides) -> Angles {
    let TriaSides { ab, bc, ca, .. } = *sides;
    let [lab, lbc, lca] = sides.lengths;
    let cosines =
        [-dot(ca, ab) / (lca * lab), -dot(ab, bc) / (lab * lbc), -dot(bc, ca) / (lbc * lca)];
    Angles {
        smallest: degrees(acos(clamp(greatest_of(cosines)))),
        largest: degrees(acos(clamp(least_of(cosines)))),
    }
}

/// Angles of a quad; its Jacobians say which corners are concave.
#[inline]
pub fn of_quad(sides: &QuadSides, jacobians: [f64; 4]) -> Angles {
    let QuadSides { ab, bc, cd, da, .. } = *sides;
    let [lab, lbc, lcd, lda] = sides.lengths;
    let turns = [
        turn(-dot(da, ab) / (lda * lab), jacobians[0]),
        turn(-dot(ab, bc) / (lab * lbc), jacobians[1]),
        turn(-dot(bc, cd) / (lbc * lcd), jacobians[2]),
        turn(-dot(cd, da) / (lcd * lda), jacobians[3]),
    ];
    Angles { smallest: turned(greatest_of(turns)), largest: turned(least_of(turns)) }
}

#[inline]
fn clamp(cosine: f64) -> f64 {
    least(1.0, greatest(-1.0, cosine))
}

/// Fold a corner's cosine and side into one number that falls as the angle grows to 360.
#[inline]
fn turn(cosine: f64, jacobian: f64) -> f64 {
    if jacobian >= 0.0 { cosine } else { -2.0 - cosine }
}

/// Degrees of a corner from its turn.
#[inline]
fn turned(turn: f64) -> f64 {
    if turn >= -1.0 {
        degrees(acos(clamp(turn)))
    } else {
        360.0 - degrees(acos(clamp(-2.0 - turn)))
    }
}
