//! Smart Laplacian smoothing: nodes move towards the mean of their neighbours.
//!
//! Freitag, On combining Laplacian and optimization-based mesh smoothing techniques (1997), 2: a
//! node moves only where the worst corner around it does not get worse by that, here all the way,
//! half or a quarter of it, and within the tangent plane of its elements. Free nodes come last. The
//! cost grows with the sweeps times the elements around free nodes.

use crate::mesh::{Element, following, is_tria, preceding};
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

/// A free node in one of the elements around it.
#[derive(Clone, Copy, Debug)]
struct Spoke {
    /// Row of the element.
    row: usize,
    /// The nodes after and before it.
    neighbours: [i32; 2],
}

/// Smoothing of one mesh after another, for which memory is taken once.
#[derive(Clone, Debug, Default)]
pub struct Laplace {
    /// Where the spokes of each free node start, and last where those of the last one end.
    start: Vec<usize>,
    spokes: Vec<Spoke>,
    /// Of all elements as they are.
    shapes: Vec<Shape>,
    /// Of the elements around a node in the trial at hand.
    moved: Vec<Shape>,
}

impl Laplace {
    /// Move nodes from row `first_free` on towards the mean of their neighbours.
    pub fn smooth(
        &mut self,
        points: &mut [Vector],
        elements: &[Element],
        first_free: usize,
        sweeps: usize,
    ) {
        if first_free >= points.len() {
            return;
        }
        self.find_spokes(elements, first_free, points.len());
        self.shapes.clear();
        self.shapes.extend(elements.iter().map(|element| Shape::of(points, *element)));
        for _ in 0..sweeps {
            for node in first_free..points.len() {
                self.visit(points, elements, node, node - first_free);
            }
        }
    }

    /// Find the elements around the free nodes.
    fn find_spokes(&mut self, elements: &[Element], first_free: usize, nodes: usize) {
        let Self { start, spokes, .. } = self;
        let is_free = |node: i32| node >= 0 && node as usize >= first_free;
        start.clear();
        start.resize(nodes - first_free + 1, 0);
        for node in elements.as_flattened().iter().filter(|node| is_free(**node)) {
            start[*node as usize - first_free] += 1;
        }
        // each list is filled from its end, so that its start is known then
        let mut end = 0;
        for count in start.iter_mut() {
            end += *count;
            *count = end;
        }
        spokes.clear();
        spokes.resize(end, Spoke { row: 0, neighbours: [0; 2] });
        for (row, element) in elements.iter().enumerate().rev() {
            for node in element.iter().filter(|node| is_free(**node)) {
                let place = &mut start[*node as usize - first_free];
                *place -= 1;
                // a node that comes twice is taken where it comes last
                let own = element.iter().rposition(|same| same == node).unwrap_or_default();
                let neighbours = [following(*element, own), preceding(*element, own)];
                spokes[*place] = Spoke { row, neighbours: neighbours.map(|k| element[k]) };
            }
        }
    }

    /// Move one free node, the number of which is given too.
    #[inline]
    fn visit(&mut self, points: &mut [Vector], elements: &[Element], node: usize, number: usize) {
        let spokes = &self.spokes[self.start[number]..self.start[number + 1]];
        let Some(worst) = worst_of(&self.shapes, spokes) else { return };
        let old = points[node];
        let mut step = tangent_step(points, &self.shapes, spokes, node);
        for _ in 0..TRIALS {
            points[node] = add(old, step);
            if keeps(points, elements, spokes, &worst, &mut self.moved) {
                for (spoke, shape) in spokes.iter().zip(&self.moved) {
                    self.shapes[spoke.row] = *shape;
                }
                return;
            }
            points[node] = old;
            step = scale(step, 0.5);
        }
    }
}

/// The worst corner of some elements, and the place of the element among them.
struct Worst {
    corner: f64,
    place: usize,
}

#[inline]
fn worst_of(shapes: &[Shape], spokes: &[Spoke]) -> Option<Worst> {
    if spokes.is_empty() {
        return None;
    }
    let mut worst = Worst { corner: 1.0, place: 0 };
    for (place, spoke) in spokes.iter().enumerate() {
        let corner = shapes[spoke.row].corner;
        if corner < worst.corner {
            worst = Worst { corner, place };
        }
    }
    Some(worst)
}

/// From a node to the mean of its neighbours, within the tangent plane of its elements.
#[inline]
fn tangent_step(points: &[Vector], shapes: &[Shape], spokes: &[Spoke], node: usize) -> Vector {
    let (mut normal, mut total) = ([0.0; 3], [0.0; 3]);
    for Spoke { row, neighbours: [after, before] } in spokes {
        normal = add(normal, shapes[*row].area);
        total = add(total, points[*after as usize]);
        total = add(total, points[*before as usize]);
    }
    let step = subtract(scale(total, 1.0 / (2 * spokes.len()) as f64), points[node]);
    let normal = unit(normal);
    subtract(step, scale(normal, dot(step, normal)))
}

/// Whether no corner of some elements is worse than `worst`; what they are like goes to `shapes`.
#[inline]
fn keeps(
    points: &[Vector],
    elements: &[Element],
    spokes: &[Spoke],
    worst: &Worst,
    shapes: &mut Vec<Shape>,
) -> bool {
    // most places that are no good are so for the element that is the worst now
    let first = Shape::of(points, elements[spokes[worst.place].row]);
    if first.corner < worst.corner {
        return false;
    }
    shapes.clear();
    for (place, spoke) in spokes.iter().enumerate() {
        if place == worst.place {
            shapes.push(first);
            continue;
        }
        let shape = Shape::of(points, elements[spoke.row]);
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
            Laplace::default().smooth(&mut points, &elements, 8, 3);
            prop_assert!(worst(&points) >= before);
        }
    }

    #[test]
    fn a_node_goes_to_the_middle() {
        let (mut points, elements) = cross([1.25, 0.75, 0.0]);
        Laplace::default().smooth(&mut points, &elements, 8, 1);
        assert_eq!(points[8], [1.0, 1.0, 0.0]);
    }
}
