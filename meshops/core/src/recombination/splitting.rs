//! Splitting quads along their better diagonal.
//!
//! That is the one whose worse tria is better: the larger area over the squared sides.

use crate::math::least;
use crate::mesh::{Element, Facet, as_element, is_tria};
use crate::vectors::{Vector, cross, dot, subtract};

/// The facets of elements: trias as they are, quads split, in their order.
pub fn as_trias(points: &[Vector], elements: &[Element]) -> Vec<Facet> {
    let mut trias = Vec::with_capacity(2 * elements.len());
    for element in elements {
        if is_tria(*element) {
            trias.push([element[0], element[1], element[2]]);
        } else {
            let [one, other] = halves(points, *element);
            trias.push(one);
            trias.push(other);
        }
    }
    trias
}

/// Split the chosen quads, all else as it is; the two trias of a quad take its place.
///
/// `chosen` says it of each element.
pub fn split_quads(points: &[Vector], elements: &[Element], chosen: &[bool]) -> Vec<Element> {
    let splits = chosen.iter().filter(|chosen| **chosen).count();
    let mut result = Vec::with_capacity(elements.len() + splits);
    for (element, chosen) in elements.iter().zip(chosen) {
        if is_tria(*element) || !chosen {
            result.push(*element);
        } else {
            let [one, other] = halves(points, *element);
            result.push(as_element(one));
            result.push(as_element(other));
        }
    }
    result
}

/// The two trias of a quad.
#[inline]
pub fn halves(points: &[Vector], [a, b, c, d]: Element) -> [Facet; 2] {
    let [p, q, r, s] = [a, b, c, d].map(|node| points[node as usize]);
    let [abc, acd, abd, bcd] = tria_shapes([[p, q, r], [p, r, s], [p, q, s], [q, r, s]]);
    if least(abc, acd) >= least(abd, bcd) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] }
}

/// Area over the sum of squared sides of four trias: greatest for the regular tria.
///
/// Four at once, step by step, as the processor does them fastest.
#[inline]
fn tria_shapes(trias: [[Vector; 3]; 4]) -> [f64; 4] {
    let ahead = trias.map(|[a, b, _]| subtract(b, a));
    let behind = trias.map(|[a, _, c]| subtract(c, a));
    let mut sides = [0.0; 4];
    let mut areas = [0.0; 4];
    for t in 0..4 {
        let (u, v) = (ahead[t], behind[t]);
        let w = subtract(v, u);
        sides[t] = u[0] * u[0]
            + u[1] * u[1]
            + u[2] * u[2]
            + v[0] * v[0]
            + v[1] * v[1]
            + v[2] * v[2]
            + w[0] * w[0]
            + w[1] * w[1]
            + w[2] * w[2];
        areas[t] = dot(cross(u, v), cross(u, v));
    }
    let lengths = areas.map(f64::sqrt);
    let mut shapes = [0.0; 4];
    for t in 0..4 {
        let shape = lengths[t] / sides[t];
        shapes[t] = if sides[t] <= 0.0 { 0.0 } else { shape };
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_short_diagonal_of_a_slanted_quad_is_taken() {
        let points = [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [4.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
        assert_eq!(as_trias(&points, &[[0, 1, 2, 3]]), [[0, 1, 3], [1, 2, 3]]);
        let elements = [[0, 1, 2, -1], [0, 1, 2, 3], [3, 0, 1, 2]];
        let split = split_quads(&points, &elements, &[true, true, false]);
        assert_eq!(split, [[0, 1, 2, -1], [0, 1, 3, -1], [1, 2, 3, -1], [3, 0, 1, 2]]);
    }
}
