//! An element by the places of its corners, and what all measures need of it.

use crate::math::{greatest_of, least_of};
use crate::mesh::{Element, is_tria};
use crate::vectors::{Vector, add, corners_of, cross, length, subtract};

/// Places of an element's corners, in order around it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Corners {
    /// Three.
    Tria([Vector; 3]),
    /// Four.
    Quad([Vector; 4]),
}

impl Corners {
    /// The corners of an element on points.
    #[inline(always)]
    pub fn of(points: &[Vector], element: Element) -> Self {
        let [a, b, c, d] = corners_of(points, element);
        if is_tria(element) { Self::Tria([a, b, c]) } else { Self::Quad([a, b, c, d]) }
    }

    /// Mean of the corners.
    #[inline(always)]
    pub fn centre(&self) -> Vector {
        match self {
            Self::Tria([a, b, c]) => add(add(*a, *b), *c).map(|x| x / 3.0),
            Self::Quad([a, b, c, d]) => add(add(add(*a, *b), *c), *d).map(|x| x / 4.0),
        }
    }
}

/// Sides of a tria abc.
pub struct TriaSides {
    pub ab: Vector,
    pub bc: Vector,
    pub ca: Vector,
    pub lengths: [f64; 3],
    pub longest: f64,
    pub shortest: f64,
    pub twice_area: f64,
}

impl TriaSides {
    #[inline(always)]
    pub fn of([a, b, c]: &[Vector; 3]) -> Self {
        let (ab, bc, ca) = (subtract(*b, *a), subtract(*c, *b), subtract(*a, *c));
        let lengths = [length(ab), length(bc), length(ca)];
        Self {
            ab,
            bc,
            ca,
            lengths,
            longest: greatest_of(lengths),
            shortest: least_of(lengths),
            twice_area: length(cross(ab, bc)),
        }
    }
}

/// Sides of a quad abcd, and its normals.
pub struct QuadSides {
    pub ab: Vector,
    pub bc: Vector,
    pub cd: Vector,
    pub da: Vector,
    pub lengths: [f64; 4],
    pub longest: f64,
    pub shortest: f64,
    /// Of the corners a, b, c and d.
    pub normals: [Vector; 4],
    /// Sum of two opposite ones: the cross product of the diagonals.
    pub normal: Vector,
    pub twice_area: f64,
}

impl QuadSides {
    #[inline(always)]
    pub fn of([a, b, c, d]: &[Vector; 4]) -> Self {
        let (ab, bc) = (subtract(*b, *a), subtract(*c, *b));
        let (cd, da) = (subtract(*d, *c), subtract(*a, *d));
        let lengths = [length(ab), length(bc), length(cd), length(da)];
        let normals = [cross(da, ab), cross(ab, bc), cross(bc, cd), cross(cd, da)];
        let normal = add(normals[1], normals[3]);
        Self {
            ab,
            bc,
            cd,
            da,
            lengths,
            longest: greatest_of(lengths),
            shortest: least_of(lengths),
            normals,
            normal,
            twice_area: length(normal),
        }
    }
}
