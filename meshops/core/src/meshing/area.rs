//! A plane area to be meshed anew within its border, and what fills it.

use super::triangulation::plane::Place;
use crate::mesh::Facet;

/// A plane area: an older triangulation of it, whose border stays.
#[derive(Clone, Copy, Debug)]
pub struct Area<'a> {
    /// The nodes of the border come first.
    pub points: &'a [Place],
    /// Trias on the points, counter-clockwise.
    pub trias: &'a [Facet],
    /// Border edges in the direction of their tria.
    pub border: &'a [[i32; 2]],
}

impl Area<'_> {
    /// How many of the nodes are on the border.
    pub fn border_nodes(&self) -> usize {
        self.border.as_flattened().iter().max().map_or(0, |node| *node as usize + 1)
    }
}

/// An area that is meshed anew.
#[derive(Clone, Debug)]
pub struct Filled {
    /// Border nodes first, as they were.
    pub points: Vec<Place>,
    /// Trias on the points, counter-clockwise.
    pub trias: Vec<Facet>,
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::meshing::ear_clipping::clip_ears;

    /// A square of so many edges of length 1 on a side.
    pub fn square(edges: i32) -> (Vec<Place>, Vec<Facet>, Vec<[i32; 2]>) {
        let size = f64::from(edges);
        let place_at = |i: i32| {
            let along = f64::from(i % edges);
            match i / edges {
                0 => [along, 0.0],
                1 => [size, along],
                2 => [size - along, size],
                _ => [0.0, size - along],
            }
        };
        let points: Vec<Place> = (0..4 * edges).map(place_at).collect();
        let border = (0..4 * edges).map(|i| [i, (i + 1) % (4 * edges)]).collect();
        let trias = clip_ears(&points, &[0, 4 * edges]).unwrap();
        (points, trias, border)
    }

    #[test]
    fn all_nodes_of_the_square_are_on_its_border() {
        let (points, trias, border) = square(4);
        let area = Area { points: &points, trias: &trias, border: &border };
        assert_eq!(area.border_nodes(), 16);
    }
}
