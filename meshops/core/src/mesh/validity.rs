//! Whether elements are valid: neither inverted, concave nor degenerate, and none twice.

use super::node_elements::elements_of_nodes;
use super::{Element, is_tria, size_of};
use crate::math::least;
use crate::vectors::{
    Vector, area_vector, area_vector_of, corner_jacobian_min_of, corners_of, dot, unit,
};

/// Cosine of the angle up to which an element may be turned against the surface under it.
pub const FACING: f64 = 0.5;

/// Unit normal of an element; 0 where it has no area.
#[inline(always)]
pub fn unit_normal(points: &[Vector], element: Element) -> Vector {
    unit(area_vector(points, element))
}

/// Unit normals of elements.
pub fn unit_normals(points: &[Vector], elements: &[Element]) -> Vec<Vector> {
    elements.iter().map(|element| unit_normal(points, *element)).collect()
}

/// Worst corner of an element along its own mean normal, see
/// [`corner_jacobian_min`](crate::vectors::corner_jacobian_min).
#[inline(always)]
pub fn own_corner(points: &[Vector], element: Element) -> f64 {
    let corners = corners_of(points, element);
    corner_jacobian_min_of(&corners, is_tria(element), unit(area_vector_of(&corners)))
}

/// Worst corner of an element along its own normal; below -1 where it faces another way.
///
/// `normal` is that of the surface under it.
#[inline(always)]
pub fn corner_on_surface(points: &[Vector], element: Element, normal: Vector) -> f64 {
    let corners = corners_of(points, element);
    let own = unit(area_vector_of(&corners));
    let facing = dot(own, normal);
    if facing < FACING {
        return facing - 2.0;
    }
    corner_jacobian_min_of(&corners, is_tria(element), own)
}

/// Which elements have no corner along their own normal that is worse than `least`.
pub fn valid_elements(points: &[Vector], elements: &[Element], least: f64) -> Vec<bool> {
    elements.iter().map(|element| own_corner(points, *element) >= least).collect()
}

/// Whether every element looks the way of its surface normal, up to 60 degrees.
pub fn all_facing(points: &[Vector], elements: &[Element], normals: &[Vector]) -> bool {
    elements.iter().zip(normals).all(|(element, normal)| {
        // not `>=`: an element whose normal is NaN passes
        let turned = dot(unit_normal(points, *element), *normal) < FACING;
        !turned
    })
}

/// Whether two elements have the same nodes, or one all nodes of another.
///
/// Elements name none but the first `nodes` nodes.
pub fn has_doubles(elements: &[Element], nodes: usize) -> bool {
    let around = elements_of_nodes(elements, nodes);
    elements.iter().enumerate().any(|(row, element)| {
        let neighbours = around.list(element[0] as usize).iter().map(|other| *other as usize);
        neighbours.filter(|other| *other != row).any(|other| {
            let other = elements[other];
            shared_nodes(*element, other) == least(size_of(*element), size_of(other))
        })
    })
}

/// How many pairs of equal nodes two elements have.
#[inline(always)]
fn shared_nodes(element: Element, other: Element) -> usize {
    let mut shared = 0;
    for node in element {
        for same in other {
            shared += usize::from(node == same && node >= 0);
        }
    }
    shared
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tria_within_a_quad_is_a_double() {
        assert!(has_doubles(&[[0, 1, 2, 3], [2, 3, 0, -1]], 4));
        assert!(!has_doubles(&[[0, 1, 2, 3], [2, 3, 4, -1]], 5));
    }
}
