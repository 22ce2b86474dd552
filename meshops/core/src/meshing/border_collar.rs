//! A collar: one tria outside each border edge of a patch, so that a remesher leaves the border.
//!
//! The collar goes in unselected and comes back tria for tria; it names the nodes of the border,
//! all others are inside. The cost grows with the number of nodes and trias.

use super::set_apart::set_apart;
use crate::math::greatest;
use crate::mesh::Facet;
use crate::vectors::{Vector, dot, scale, subtract};

/// Height of a collar tria, as a share of its border edge.
const HEIGHT: f64 = 0.3;

/// Why a patch did not come back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A coordinate is not finite.
    NotFinite,
    /// The collar names other nodes than the border has.
    BorderChanged,
    /// A node of the border is elsewhere.
    BorderMoved,
}

/// A patch of trias.
#[derive(Clone, Debug, PartialEq)]
pub struct Trias {
    /// Places of the nodes.
    pub points: Vec<Vector>,
    /// Nodes of each tria.
    pub trias: Vec<Facet>,
}

/// A patch as it was and with its collar.
#[derive(Clone, Debug)]
pub struct Collar {
    /// The patch with its collar, whose apexes and trias come last.
    pub with_collar: Trias,
    /// 1 for the trias of the patch, 0 for those of the collar.
    pub inside: Vec<f64>,
    points: Vec<Vector>,
    border: Vec<[i32; 2]>,
    nudge: f64,
}

/// Largest coordinate without its sign, and largest distance along an axis from the first point.
///
/// Infinite where a coordinate is not finite.
pub fn extents(points: &[Vector]) -> (f64, f64) {
    let (mut largest, mut extent) = (0.0, 0.0);
    for point in points {
        for k in 0..3 {
            if !point[k].is_finite() {
                return (f64::INFINITY, f64::INFINITY);
            }
            largest = greatest(largest, point[k].abs());
            extent = greatest(extent, (point[k] - points[0][k]).abs());
        }
    }
    (largest, extent)
}

/// One point outside each border edge, in the plane of the tria inside it.
///
/// In the middle of an edge without such a tria. Trias and border name given points.
pub fn collar_apexes(points: &[Vector], trias: &[Facet], border: &[[i32; 2]]) -> Vec<Vector> {
    let place = |node: i32| points[node as usize];
    let middle = |[a, b]: &[i32; 2]| along(place(*a), 0.5, subtract(place(*b), place(*a)));
    let mut apexes: Vec<Vector> = border.iter().map(middle).collect();
    // border edges that start at the same node are chained
    let mut by_start = vec![-1; points.len()];
    let mut next = vec![-1; border.len()];
    for (j, [a, _]) in border.iter().enumerate() {
        next[j] = by_start[*a as usize];
        by_start[*a as usize] = j as i32;
    }
    for tria in trias {
        for k in 0..3 {
            let (a, b, c) = (tria[k], tria[(k + 1) % 3], tria[(k + 2) % 3]);
            let mut j = by_start[a as usize];
            while j >= 0 {
                if border[j as usize][1] == b {
                    apexes[j as usize] = apex(place(a), place(b), place(c));
                }
                j = next[j as usize];
            }
        }
    }
    apexes
}

/// The apex outside edge ab of a tria abc.
fn apex(a: Vector, b: Vector, c: Vector) -> Vector {
    let edge = subtract(b, a);
    let mut inward = subtract(c, a);
    let squared = dot(edge, edge);
    if squared > 0.0 {
        inward = subtract(inward, scale(edge, dot(inward, edge) / squared));
    }
    let height = dot(inward, inward).sqrt();
    let middle = along(a, 0.5, edge);
    if height > 0.0 {
        subtract(middle, scale(inward, HEIGHT * squared.sqrt() / height))
    } else {
        middle
    }
}

/// A place and a multiple of a direction.
fn along(place: Vector, factor: f64, direction: Vector) -> Vector {
    crate::vectors::add(place, scale(direction, factor))
}

impl Collar {
    /// Put a collar on a patch whose trias and border name given points.
    ///
    /// Nodes at the same place are set apart by `nudge`; a node of the border may come back so far
    /// from its place.
    pub fn put_on(points: &[Vector], trias: &[Facet], border: &[[i32; 2]], nudge: f64) -> Self {
        let mut places = points.to_vec();
        places.extend(collar_apexes(points, trias, border));
        set_apart(&mut places, nudge);
        let apexes = points.len() as i32..;
        let outside = border.iter().zip(apexes).map(|([a, b], apex)| [*b, *a, apex]);
        let trias: Vec<Facet> = trias.iter().copied().chain(outside).collect();
        let mut inside = vec![1.0; trias.len()];
        inside[trias.len() - border.len()..].fill(0.0);
        Self {
            with_collar: Trias { points: places, trias },
            inside,
            points: points.to_vec(),
            border: border.to_vec(),
            nudge,
        }
    }

    /// Take the collar off the remeshed patch: border nodes first, where and as they were.
    ///
    /// Trias name given points; `inside` is above 0.5 for those of the patch, one number each.
    ///
    /// # Errors
    /// Where a coordinate is not finite, or the border is not what it was.
    pub fn take_off(
        &self,
        points: &[Vector],
        trias: &[Facet],
        inside: &[f64],
    ) -> Result<Trias, Fault> {
        if points.as_flattened().iter().any(|x| !x.is_finite()) {
            return Err(Fault::NotFinite);
        }
        let is_inside = |t: &usize| inside[*t] > 0.5;
        let outside = (0..trias.len()).filter(|t| !is_inside(t)).map(|t| trias[t]);
        let (rows, count) = self.rows_of_nodes(points.len(), &outside.collect::<Vec<_>>())?;
        let border_nodes = self.border_nodes();
        let mut new_points = vec![[0.0; 3]; count];
        for (point, row) in points.iter().zip(&rows) {
            if *row < 0 {
                continue;
            }
            let row = *row as usize;
            if row >= border_nodes {
                new_points[row] = *point;
                continue;
            }
            // projecting to the surface may have moved the border by the last digits
            let moved = subtract(*point, self.with_collar.points[row]);
            if moved.iter().any(|x| x.abs() > self.nudge) {
                return Err(Fault::BorderMoved);
            }
            new_points[row] = self.points[row];
        }
        let renamed = |t: usize| trias[t].map(|node| rows[node as usize]);
        let new_trias = (0..trias.len()).filter(is_inside).map(renamed).collect();
        Ok(Trias { points: new_points, trias: new_trias })
    }

    /// How many of the nodes are on the border.
    fn border_nodes(&self) -> usize {
        self.border.as_flattened().iter().max().map_or(0, |node| *node as usize + 1)
    }

    /// The row of each node in the patch, by the collar, and how many rows there are.
    ///
    /// -1 for the apexes.
    fn rows_of_nodes(&self, nodes: usize, collar: &[Facet]) -> Result<(Vec<i32>, usize), Fault> {
        const UNKNOWN: i32 = -2;
        const APEX: i32 = -1;
        if collar.len() != self.border.len() {
            return Err(Fault::BorderChanged);
        }
        let mut rows = vec![UNKNOWN; nodes];
        for ([b, a, _], [from, to]) in collar.iter().zip(&self.border) {
            rows[*b as usize] = *to;
            rows[*a as usize] = *from;
        }
        for [_, _, apex] in collar {
            rows[*apex as usize] = APEX;
        }
        for ([b, a, _], [from, to]) in collar.iter().zip(&self.border) {
            if rows[*b as usize] != *to || rows[*a as usize] != *from {
                return Err(Fault::BorderChanged);
            }
        }
        let border_nodes = self.border_nodes();
        let (mut found, mut count) = (0, border_nodes);
        for row in &mut rows {
            if *row >= 0 {
                found += 1;
            } else if *row == UNKNOWN {
                *row = count as i32;
                count += 1;
            }
        }
        if found == border_nodes { Ok((rows, count)) } else { Err(Fault::BorderChanged) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A square of two trias.
    fn square() -> (Vec<Vector>, Vec<Facet>, Vec<[i32; 2]>) {
        let points = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]].map(|[x, y]| [x, y, 0.0]);
        let border = [[0, 1], [1, 2], [2, 3], [3, 0]];
        (points.to_vec(), vec![[0, 1, 2], [0, 2, 3]], border.to_vec())
    }

    fn take_off(collar: &Collar, remeshed: &Trias, inside: &[f64]) -> Result<Trias, Fault> {
        collar.take_off(&remeshed.points, &remeshed.trias, inside)
    }

    #[test]
    fn apexes_lie_outside() {
        let (points, trias, border) = square();
        let apexes = collar_apexes(&points, &trias, &border);
        assert_eq!(apexes[0], [1.0, -0.6, 0.0]);
        assert_eq!(apexes[2], [1.0, 2.6, 0.0]);
        assert_eq!(extents(&points), (2.0, 2.0));
    }

    #[test]
    fn what_comes_back_unchanged_is_the_patch() {
        let (points, trias, border) = square();
        let collar = Collar::put_on(&points, &trias, &border, 1e-9);
        assert_eq!(collar.with_collar.points.len(), 8);
        let patch = Trias { points, trias };
        assert_eq!(take_off(&collar, &collar.with_collar, &collar.inside), Ok(patch));
    }

    #[test]
    fn faults_are_told() {
        let (points, trias, border) = square();
        let collar = Collar::put_on(&points, &trias, &border, 1e-9);
        let mut out = collar.with_collar.clone();
        out.points[1][0] += 1e-3;
        assert_eq!(take_off(&collar, &out, &collar.inside), Err(Fault::BorderMoved));
        out.points[1][0] = f64::NAN;
        assert_eq!(take_off(&collar, &out, &collar.inside), Err(Fault::NotFinite));
        let all = vec![1.0; collar.inside.len()];
        assert_eq!(take_off(&collar, &collar.with_collar, &all), Err(Fault::BorderChanged));
    }
}
