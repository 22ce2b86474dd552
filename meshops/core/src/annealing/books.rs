//! The books of an annealing: the energy as it is, and what the trial at hand would make of it.

use super::energy::Energy;
use super::undoable_patch::UndoablePatch;

/// Elements or nodes that a trial may touch.
const MOST_TOUCHED: usize = 128;

/// Rows that a trial touches, each once.
#[derive(Clone, Debug)]
struct Touched {
    /// The last trial that touched each row, from 1.
    stamps: Vec<u64>,
    rows: Vec<i32>,
}

impl Touched {
    fn new(count: usize) -> Self {
        Self { stamps: vec![0; count], rows: Vec::with_capacity(MOST_TOUCHED) }
    }

    /// Note a row; false where there is no room for it.
    #[inline]
    fn note(&mut self, row: i32, trial: u64) -> bool {
        let stamp = &mut self.stamps[row as usize];
        if *stamp == trial {
            return true;
        }
        if self.rows.len() == MOST_TOUCHED {
            return false;
        }
        *stamp = trial;
        self.rows.push(row);
        true
    }
}

/// Energy of each element and node, and what a trial touches.
#[derive(Clone, Debug)]
pub struct Books {
    of_elements: Vec<f64>,
    of_nodes: Vec<f64>,
    elements: Touched,
    nodes: Touched,
    /// Energy of the touched elements, as the trial would have it.
    fresh: Vec<f64>,
    trial: u64,
}

impl Books {
    /// Count the energy of each element and node of a patch.
    pub fn new(patch: &UndoablePatch, energy: &Energy<'_>) -> Self {
        let (rows, nodes) = (patch.elements().len(), patch.points().len());
        Self {
            of_elements: (0..rows).map(|row| energy.of_element(patch, row)).collect(),
            of_nodes: (0..nodes).map(|node| energy.of_node(patch, node as i32)).collect(),
            elements: Touched::new(rows),
            nodes: Touched::new(nodes),
            fresh: Vec::with_capacity(MOST_TOUCHED),
            trial: 0,
        }
    }

    /// Energy of the patch.
    pub fn total(&self) -> f64 {
        let sum = |energies: &[f64]| energies.iter().fold(0.0, |sum, energy| sum + energy);
        sum(&self.of_elements) + sum(&self.of_nodes)
    }

    /// Energy of an element and its nodes.
    #[inline]
    pub fn around(&self, patch: &UndoablePatch, row: usize) -> f64 {
        let nodes = &patch.elements()[row][..patch.size(row)];
        let costs = nodes.iter().map(|node| self.of_nodes[*node as usize]);
        costs.fold(self.of_elements[row], |sum, cost| sum + cost)
    }

    /// Begin another trial: it touches nothing yet.
    pub fn begin(&mut self) {
        self.trial += 1;
        self.elements.rows.clear();
        self.nodes.rows.clear();
    }

    /// Note the nodes of the elements that changed, before and after, and return them.
    pub fn note_nodes(&mut self, patch: &UndoablePatch) -> &[i32] {
        for change in patch.element_changes() {
            let after = patch.elements()[change.row];
            for node in change.before.into_iter().chain(after).filter(|node| *node >= 0) {
                self.nodes.note(node, self.trial);
            }
        }
        &self.nodes.rows
    }

    /// Note the elements that changed, or whose nodes moved; false if there are too many.
    pub fn note_elements(&mut self, patch: &UndoablePatch) -> bool {
        let changed = patch.element_changes().iter().map(|change| change.row as i32);
        let moved = patch.node_moves().iter().flat_map(|change| patch.around(change.node));
        changed.chain(moved.copied()).all(|row| self.elements.note(row, self.trial))
    }

    /// Whether the trial touches no element.
    pub fn is_empty(&self) -> bool {
        self.elements.rows.is_empty()
    }

    /// Find what the trial adds to the energy; anything above the limit where it is more.
    pub fn gain(&mut self, patch: &UndoablePatch, energy: &Energy<'_>, limit: f64) -> f64 {
        let mut gain = 0.0;
        for row in &self.elements.rows {
            gain -= self.of_elements[*row as usize];
        }
        for node in &self.nodes.rows {
            gain += energy.of_node(patch, *node) - self.of_nodes[*node as usize];
        }
        self.fresh.clear();
        for row in &self.elements.rows {
            let fresh = energy.of_element(patch, *row as usize);
            self.fresh.push(fresh);
            gain += fresh;
            if gain > limit {
                break;
            }
        }
        gain
    }

    /// Keep the trial, whose gain has been found below the limit.
    pub fn keep(&mut self, patch: &UndoablePatch, energy: &Energy<'_>) {
        for (row, fresh) in self.elements.rows.iter().zip(&self.fresh) {
            self.of_elements[*row as usize] = *fresh;
        }
        for node in &self.nodes.rows {
            self.of_nodes[*node as usize] = energy.of_node(patch, *node);
        }
    }
}
