//! Simulated annealing of a patch by small changes (Kirkpatrick, Gelatt and Vecchi 1983).
//!
//! Every trial changes the topology in one place and relaxes the nodes there, or moves one node.
//! What it adds to the energy decides whether it stays: what lowers it does, what raises it does the
//! more rarely the more it raises it and the lower the temperature is.
//!
//! The patch is to be a surface: each side in at most one element, each border node before all
//! others. It stays one, with the same border, though elements may be turned over: that costs
//! energy, and is for the caller to refuse. The same seed gives the same patch. The cost is that of
//! a few elements a trial, and does not grow with the patch.

use super::books::Books;
use super::energy::{Energy, Prices, Site, mean_area};
use super::node_moves::{move_node, relax_nodes};
use super::reconnection::{
    collapse_diagonal, collapse_side, is_whole, open_node, open_trias, split_row, swap_side,
};
use super::undoable_patch::{Done, NotDone, UndoablePatch};
use crate::math::{greatest, ln, pow};
use crate::mesh::Element;
use crate::quality::Scoring;
use crate::rng::Xorshift;
use crate::vectors::Vector;

/// Elements that a trial looks at to find one where there is something to gain.
const LOOKS: usize = 5;

/// Share of the trials that move a node.
const MOVE: f64 = 0.4;

/// Up to which number between 0 and 1 a change is of each kind; beyond the last a quad is split.
const SWAP: f64 = 0.5;
const COLLAPSE: f64 = 0.65;
const OPEN: f64 = 0.8;
const COLLAPSE_SIDE: f64 = 0.88;
const OPEN_TRIAS: f64 = 0.95;

/// Elements and nodes that may come to a patch, besides half as many as it has.
const ROOM: usize = 40;

/// How it cools down: by the same share each trial.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cooling {
    /// Temperature before the first trial, on the scale of the energy.
    pub hot: f64,
    /// Temperature at the last trial.
    pub cold: f64,
    /// How many trials there are.
    pub trials: usize,
}

/// A patch after annealing.
#[derive(Clone, Debug, PartialEq)]
pub struct Annealed {
    /// Its points, those that stay first.
    pub points: Vec<Vector>,
    /// Its elements.
    pub elements: Vec<Element>,
    /// Energy before.
    pub before: f64,
    /// Energy after.
    pub after: f64,
}

/// Anneal a patch; None where more elements meet at a node than there is room for.
///
/// Elements name none but its points, at most all of which are fixed, and the site says of as many
/// nodes how many elements outside they have.
pub fn anneal(
    points: &[Vector],
    elements: &[Element],
    site: &Site<'_>,
    prices: &Prices,
    scoring: &Scoring,
    cooling: Cooling,
    seed: i64,
) -> Option<Annealed> {
    let patch = UndoablePatch::new(points, elements, elements.len() / 2 + ROOM)?;
    let energy = Energy { site, prices, scoring, mean_area: mean_area(points, elements) };
    let books = Books::new(&patch, &energy);
    let before = books.total();
    let mut annealing = Annealing { patch, energy, books, random: Xorshift::new(seed) };
    let after = annealing.run(cooling, before);
    let (points, elements) = annealing.compact();
    Some(Annealed { points, elements, before, after })
}

/// An annealing that is under way.
struct Annealing<'a> {
    patch: UndoablePatch,
    energy: Energy<'a>,
    books: Books,
    random: Xorshift,
}

impl Annealing<'_> {
    /// Do all trials; the energy after them.
    fn run(&mut self, cooling: Cooling, before: f64) -> f64 {
        let mut energy = before;
        let mut temperature = cooling.hot;
        let fall = pow(cooling.cold / cooling.hot, 1.0 / cooling.trials.max(1) as f64);
        for _ in 0..cooling.trials {
            temperature *= fall;
            self.books.begin();
            if self.attempt().is_ok() && !self.books.is_empty() {
                // drawn before the energy is known, so that what is surely too much is not finished
                let limit = -temperature * ln(greatest(self.random.draw(), 1e-300));
                let gain = self.books.gain(&self.patch, &self.energy, limit);
                if gain <= limit {
                    energy += gain;
                    self.books.keep(&self.patch, &self.energy);
                    self.patch.settle();
                    continue;
                }
            }
            self.patch.take_back();
        }
        energy
    }

    /// Change something, and note what is to be judged.
    fn attempt(&mut self) -> Done {
        let row = self.pick().ok_or(NotDone)?;
        let Self { patch, energy, books, random } = self;
        let site = energy.site;
        if random.draw() < MOVE {
            let corner = random.draw_row(patch.size(row));
            move_node(patch, site, patch.elements()[row][corner], random)?;
        } else {
            change(patch, row, site.fixed, random)?;
            if !is_whole(patch, |node| site.outside(node), site.fixed) {
                return Err(NotDone);
            }
            relax_nodes(patch, site, books.note_nodes(patch))?;
        }
        if books.note_elements(patch) { Ok(()) } else { Err(NotDone) }
    }

    /// Draw an element, rather one where there is something to gain.
    fn pick(&mut self) -> Option<usize> {
        let threshold = 0.5 * self.energy.prices.irregular;
        let mut found = None;
        for _ in 0..10 * LOOKS {
            let row = self.random.draw_row(self.patch.elements().len());
            if self.patch.size(row) == 0 {
                continue;
            }
            found = Some(row);
            let cost = self.books.around(&self.patch, row);
            if cost > threshold || self.random.draw() < 1.0 / LOOKS as f64 {
                break;
            }
        }
        found
    }

    /// Points that are used, those that stay first, and elements.
    fn compact(&self) -> (Vec<Vector>, Vec<Element>) {
        let (patch, site) = (&self.patch, self.energy.site);
        let mut points = Vec::new();
        let mut numbers = vec![-1; patch.points().len()];
        for (node, place) in patch.points().iter().enumerate() {
            if site.is_fixed(node as i32) || !patch.around(node as i32).is_empty() {
                numbers[node] = points.len() as i32;
                points.push(*place);
            }
        }
        let number = |node: i32| if node < 0 { node } else { numbers[node as usize] };
        let rows = (0..patch.elements().len()).filter(|row| patch.size(*row) > 0);
        let elements = rows.map(|row| patch.elements()[row].map(number)).collect();
        (points, elements)
    }
}

/// Make one change of the topology at an element.
fn change(patch: &mut UndoablePatch, row: usize, fixed: i32, random: &mut Xorshift) -> Done {
    let (kind, i, j) = (random.draw(), random.draw_row(1000), random.draw_row(1000));
    let side = i % patch.size(row);
    let node = patch.elements()[row][side];
    if kind < SWAP {
        swap_side(patch, row, side, j)
    } else if kind < COLLAPSE {
        collapse_diagonal(patch, row, side, fixed)
    } else if kind < OPEN {
        open_node(patch, node, i / 4, j, fixed)
    } else if kind < COLLAPSE_SIDE {
        collapse_side(patch, row, side, fixed)
    } else if kind < OPEN_TRIAS {
        open_trias(patch, node, i / 4, j, fixed)
    } else {
        split_row(patch, row, j)
    }
}
