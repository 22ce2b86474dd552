//! A field of crosses and sizes over an area, from the edges of its border.
//!
//! Each border edge counts by its length over the cubed distance. The size that is asked for counts
//! like an endless border at some distance. A cross is the same when it is turned by a right angle,
//! so angles are taken four times before they are added up. One cross costs a sum over the border.

use super::triangulation::plane::Place;
use crate::math::{atan2, cos, sin};

/// Of the size: the distance from the border where half of its own spacing is forgotten.
const REACH: f64 = 2.0;

/// What one border edge adds to the field.
struct BorderEdge {
    middle: Place,
    length: f64,
    /// Cosine and sine of four times its angle.
    cosine: f64,
    sine: f64,
}

/// The field over an area.
pub struct CrossField {
    edges: Vec<BorderEdge>,
    size: f64,
}

/// A cross at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cross {
    /// Of one of its arms, in radians.
    pub angle: f64,
    /// Edge length of squares there.
    pub spacing: f64,
}

impl CrossField {
    /// The field of a border, far from which edges are to be of a size.
    pub fn of(points: &[Place], border: &[[i32; 2]], size: f64) -> Self {
        let edge_of = |[a, b]: &[i32; 2]| {
            let (a, b) = (points[*a as usize], points[*b as usize]);
            let (x, y) = (b[0] - a[0], b[1] - a[1]);
            let angle = 4.0 * atan2(y, x);
            BorderEdge {
                middle: [a[0] + 0.5 * x, a[1] + 0.5 * y],
                length: (x * x + y * y).sqrt(),
                cosine: cos(angle),
                sine: sin(angle),
            }
        };
        Self { edges: border.iter().map(edge_of).collect(), size }
    }

    /// The size that is asked for.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// Half of the lengths of the border edges at each of some nodes.
    pub fn sizes_on_border(&self, border: &[[i32; 2]], nodes: usize) -> Vec<f64> {
        let mut sizes = vec![0.0; nodes];
        for (ends, edge) in border.iter().zip(&self.edges) {
            for end in ends {
                sizes[*end as usize] += 0.5 * edge.length;
            }
        }
        sizes
    }

    /// The cross at a place.
    pub fn at(&self, place: Place) -> Cross {
        let (mut cosine, mut sine) = (0.0, 0.0);
        let mut mean = self.far_away();
        for edge in &self.edges {
            let weight = self.weight(edge, place);
            cosine += weight * edge.cosine;
            sine += weight * edge.sine;
            mean.add(weight, edge.length);
        }
        Cross { angle: 0.25 * atan2(sine, cosine), spacing: mean.of_all() }
    }

    /// The spacing at a place.
    pub fn spacing_at(&self, place: Place) -> f64 {
        let mut mean = self.far_away();
        for edge in &self.edges {
            mean.add(self.weight(edge, place), edge.length);
        }
        mean.of_all()
    }

    /// What an edge counts at a place.
    #[inline]
    fn weight(&self, edge: &BorderEdge, [x, y]: Place) -> f64 {
        let (dx, dy) = (edge.middle[0] - x, edge.middle[1] - y);
        let squared = dx * dx + dy * dy + 1e-6 * self.size * self.size;
        edge.length / (squared * squared.sqrt())
    }

    /// The size that is asked for, by the weight of an endless border.
    #[inline]
    fn far_away(&self) -> Mean {
        let distance = REACH * self.size;
        let weight = 2.0 / (distance * distance);
        Mean { total: weight, sum: weight * self.size }
    }
}

/// A weighted mean.
struct Mean {
    total: f64,
    sum: f64,
}

impl Mean {
    #[inline]
    fn add(&mut self, weight: f64, value: f64) {
        self.total += weight;
        self.sum += weight * value;
    }

    #[inline]
    fn of_all(&self) -> f64 {
        self.sum / self.total
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn within_a_square_crosses_follow_its_sides() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let border = [[0, 1], [1, 2], [2, 3], [3, 0]];
        let field = CrossField::of(&points, &border, 0.5);
        let cross = field.at([0.4, 0.3]);
        assert!(cross.angle.abs() < 1e-12);
        assert!(cross.spacing > 0.5 && cross.spacing < 1.0);
        assert_eq!(cross.spacing, field.spacing_at([0.4, 0.3]));
        assert_eq!(field.sizes_on_border(&border, 4), [1.0; 4]);
    }
}
