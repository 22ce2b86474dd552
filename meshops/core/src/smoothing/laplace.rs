//! Smart Laplacian smoothing: nodes move towards the mean of their neighbours.
//!
//! Freitag, On combining Laplacian and optimization-based mesh smoothing techniques (1997), 2: a
//! node moves only where the worst corner around it does not get worse by that, here all the way,
//! half or a quarter of it, and within the tangent plane of its elements. Free nodes come last. The
//! cost grows with the sweeps times the elements around free nodes.

use crate::mesh::csr::Csr;
use crate::mesh::node_elements::elements_of_nodes;
use crate::mesh::{Element, following, is_tria, preceding, size_of};
use crate::vectors::{
    Vector, add, area_vector_of, corner_jacobian_min_of, corners_of, dot, scale, subtract, unit,
};

/// Trials of a node in a sweep: each goes half as far as the one before.
const TRIALS: usize = 3;

/// What counts of an element.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    /// Its area times its mean unit normal.
    area: Vector,
    /// Its worst corner along that normal.
    corner: f64,
}

impl Shape {
    #[inline(always)]
    fn of(points: &[Vector], element: Element) -> Self {
        let corners = corners_of(points, element);
        let area = area_vector_of(&corners);
        Self { area, corner: corner_jacobian_min_of(&corners, is_tria(element), unit(area)) }
    }
}

/// Move nodes from row `first_free` on towards the mean of their neighbours.
pub fn smooth(points: &mut [Vector], elements: &[Element], first_free: usize, sweeps: usize) {
    if first_free >= points.len() {
        return;
    }
    let around = elements_of_nodes(elements, points.len());
    let neighbours = neighbours_by_element(elements, &around, first_free);
    let mut shapes: Vec<Shape> =
        elements.iter().map(|element| Shape::of(points, *element)).collect();
    let mut moved = Vec::new();
    for _ in 0..sweeps {
        for node in first_free..points.len() {
            let rows = around.list(node);
            let Some(worst) = worst_of(&shapes, rows) else { continue };
            let places = around.start[node] as usize..around.start[node + 1] as usize;
            let old = points[node];
            let mut step = tangent_step(points, &shapes, rows, &neighbours[places], node);
            for _ in 0..TRIALS {
                points[node] = add(old, step);
                if keeps(points, elements, rows, &worst, &mut moved) {
                    for (row, shape) in rows.iter().zip(&moved) {
                        shapes[*row as usize] = *shape;
                    }
                    break;
                }
                points[node] = old;
                step = scale(step, 0.5);
            }
        }
    }
}

/// The worst corner of some elements, and the place of the element among them.
struct Worst {
    corner: f64,
    place: usize,
}

#[inline]
fn worst_of(shapes: &[Shape], rows: &[i32]) -> Option<Worst> {
    if rows.is_empty() {
        return None;
    }
    let mut worst = Worst { corner: 1.0, place: 0 };
    for (place, row) in rows.iter().enumerate() {
        let corner = shapes[*row as usize].corner;
        if corner < worst.corner {
            worst = Worst { corner, place };
        }
    }
    Some(worst)
}

/// The nodes after and before each free node, in each element around it.
fn neighbours_by_element(elements: &[Element], around: &Csr, first_free: usize) -> Vec<[i32; 2]> {
    let mut neighbours = vec![[0; 2]; around.items.len()];
    for node in first_free..around.len() {
        for i in around.start[node] as usize..around.start[node + 1] as usize {
            let element = elements[around.items[i] as usize];
            for k in 0..size_of(element) {
                if element[k] == node as i32 {
                    neighbours[i] =
                        [following(element, k), preceding(element, k)].map(|k| element[k]);
                }
            }
        }
    }
    neighbours
}

/// From a node to the mean of its neighbours, within the tangent plane of its elements.
#[inline]
fn tangent_step(
    points: &[Vector],
    shapes: &[Shape],
    rows: &[i32],
    neighbours: &[[i32; 2]],
    node: usize,
) -> Vector {
    let (mut normal, mut total) = ([0.0; 3], [0.0; 3]);
    for (row, [after, before]) in rows.iter().zip(neighbours) {
        normal = add(normal, shapes[*row as usize].area);
        total = add(total, points[*after as usize]);
        total = add(total, points[*before as usize]);
    }
    let step = subtract(scale(total, 1.0 / (2 * rows.len()) as f64), points[node]);
    let normal = unit(normal);
    subtract(step, scale(normal, dot(step, normal)))
}

/// Whether no corner of some elements is worse than `worst`; what they are like goes to `shapes`.
#[inline]
fn keeps(
    points: &[Vector],
    elements: &[Element],
    rows: &[i32],
    worst: &Worst,
    shapes: &mut Vec<Shape>,
) -> bool {
    // most places that are no good are so for the element that is the worst now
    let first = Shape::of(points, elements[rows[worst.place] as usize]);
    if first.corner < worst.corner {
        return false;
    }
    shapes.clear();
    for (place, row) in rows.iter().enumerate() {
        if place == worst.place {
            shapes.push(first);
            continue;
        }
        let shape = Shape::of(points, elements[*row as usize]);
        if shape.corner < worst.corner {
            return false;
        }
        shapes.push(shape);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::validity::own_corner;
    use proptest::prelude::*;

    /// Four squares around a node, which comes last.
    fn cross(middle: Vector) -> (Vec<Vector>, Vec<Element>) {
        let border = [(0, 0), (1, 0), (2, 0), (2, 1), (2, 2), (1, 2), (0, 2), (0, 1)];
        let mut points: Vec<Vector> =
            border.iter().map(|(x, y)| [f64::from(*x), f64::from(*y), 0.0]).collect();
        points.push(middle);
        (points, vec![[0, 1, 8, 7], [1, 2, 3, 8], [8, 3, 4, 5], [7, 8, 5, 6]])
    }

    proptest! {
        #[test]
        fn no_corner_gets_worse(x in 0.2..1.8, y in 0.2..1.8, z in -0.2..0.2) {
            let (mut points, elements) = cross([x, y, z]);
            let worst = |points: &[Vector]| {
                elements.iter().map(|element| own_corner(points, *element)).fold(1.0, f64::min)
            };
            let before = worst(&points);
            smooth(&mut points, &elements, 8, 3);
            prop_assert!(worst(&points) >= before);
        }
    }

    #[test]
    fn a_node_goes_to_the_middle() {
        let (mut points, elements) = cross([1.25, 0.75, 0.0]);
        smooth(&mut points, &elements, 8, 1);
        assert_eq!(points[8], [1.0, 1.0, 0.0]);
    }
}
