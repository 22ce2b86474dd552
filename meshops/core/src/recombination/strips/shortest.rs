//! Open strips: the shortest ways from trias through quads, turning as they may.
//!
//! A breadth-first search from each tria; the graph of elements is whole. The cost grows with the
//! trias and the square of the reach, and with the mesh for the arrays.

use super::{NO_RUNG, StripGround, Strips};
use crate::mesh::is_tria;

/// How far ways go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Quads between two trias, at the most.
    pub reach: usize,
    /// Edges that a way to a quad crosses, at the most.
    pub steps: usize,
    /// How many of the nearest other trias there are ways to.
    pub partners: usize,
}

/// The shortest ways from each of some trias.
///
/// Those to the nearest other trias behind 1 to `reach` quads, each pair found once, and those to
/// each quad across at most `steps` edges.
pub fn shortest_strips(ground: StripGround<'_>, trias: &[i32], limits: Limits) -> Strips {
    let mut strips = Strips::default();
    if trias.is_empty() {
        return strips;
    }
    let mut search = Search {
        ground,
        visits: vec![Visit { number: u32::MAX, depth: 0, entry: 0 }; ground.elements.len()],
        queue: Vec::new(),
    };
    let mut done = vec![false; ground.elements.len()];
    for (number, tria) in trias.iter().enumerate() {
        let tria = *tria as usize;
        done[tria] = true;
        search.begin(tria, number as u32);
        let (mut head, mut met) = (0, 0);
        while head < search.queue.len() && met < limits.partners {
            let cell = search.queue[head];
            head += 1;
            let depth = search.visits[cell].depth as usize;
            let is_goal = is_tria(ground.elements[cell]) && cell != tria;
            met += usize::from(is_goal);
            let is_end =
                if is_goal { depth > 1 && !done[cell] } else { 0 < depth && depth <= limits.steps };
            if is_end {
                search.write_way(cell, &mut strips);
            }
            if !is_goal && depth <= limits.reach {
                search.step(cell, if cell == tria { 3 } else { 4 });
            }
        }
    }
    strips
}

/// How an element was reached.
#[derive(Clone, Copy, Debug)]
struct Visit {
    /// From which tria it was last.
    number: u32,
    /// Across how many edges.
    depth: u32,
    /// By which of its sides.
    entry: u8,
}

/// A breadth-first search through editable elements.
struct Search<'a> {
    ground: StripGround<'a>,
    visits: Vec<Visit>,
    queue: Vec<usize>,
}

impl Search<'_> {
    /// Begin anew at an element.
    fn begin(&mut self, element: usize, number: u32) {
        self.visits[element] = Visit { number, depth: 0, entry: 0 };
        self.queue.clear();
        self.queue.push(element);
    }

    /// Visit what is across the first sides of an element.
    fn step(&mut self, element: usize, sides: usize) {
        let Visit { number, depth, .. } = self.visits[element];
        for side in 0..sides {
            let Some((behind, entry)) = self.ground.graph.enter(element, side) else { continue };
            if self.ground.editable[behind] && self.visits[behind].number != number {
                self.visits[behind] = Visit { number, depth: depth + 1, entry: entry as u8 };
                self.queue.push(behind);
            }
        }
    }

    /// Follow the sides by which elements were entered from the goal back to the beginning.
    fn write_way(&self, goal: usize, strips: &mut Strips) {
        let first = strips.cells.len();
        let last = first + self.visits[goal].depth as usize;
        strips.cells.resize(last + 1, -1);
        strips.rungs.resize(last + 1, NO_RUNG);
        let mut cell = goal;
        strips.cells[last] = cell as i32;
        for at in (first..last).rev() {
            let entry = usize::from(self.visits[cell].entry);
            let [a, b] = self.ground.rung(cell, entry);
            strips.rungs[at] = [b, a];
            let Some(before) = self.ground.graph.across(cell, entry) else { break };
            cell = before;
            strips.cells[at] = cell as i32;
        }
        strips.close();
    }
}
