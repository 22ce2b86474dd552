//! Conflicts: small edits done at once, and which of them get into each other's way.
//!
//! Candidates of which none needs what another has may be done together, and what they change adds
//! up. For they share no element that goes or is deformed: so each element changes by one of them
//! only, and a node that moves or vanishes in one, with all elements around it, is not in the other.
//! And they share no node of an element that goes or comes: so they cannot make the same edge or the
//! same element, which is all that is left of what the evaluation of each alone looks at.
//!
//! A choice costs the same on any mesh: it grows with what its candidates need.

use super::candidates::Candidates;
use crate::mesh::Element;
use crate::mesh::csr::{Csr, CsrView};
use crate::quality::sums::SUMS;

/// What each candidate needs for itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Claims {
    /// Numbers that stand for nodes and elements, each once a candidate.
    pub claimed: Csr,
    /// How many numbers there are.
    pub count: usize,
}

/// Candidates of one genome, or of several, that are done together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Combined {
    /// What the candidates of each genome add to the sums of the mesh.
    pub sums: Vec<[f64; SUMS]>,
    /// For each gene whether its candidate is done.
    pub taken: Vec<bool>,
}

impl Claims {
    /// List what candidates need: the nodes of the elements that go or come, and the elements that
    /// go or have a node that moves.
    pub fn of(candidates: Candidates<'_>, elements: &[Element], around: CsrView<'_>) -> Self {
        let nodes = around.len();
        let mut listing = Listing {
            claims: Self::default(),
            number: vec![0; nodes + elements.len()],
            claimed_by: vec![0; nodes + elements.len()],
            candidate: 0,
        };
        listing.claims.claimed.start.push(0);
        for candidate in candidates.iter() {
            listing.candidate += 1;
            for row in candidate.removed {
                listing.claim(nodes + *row as usize);
                for node in elements[*row as usize].iter().filter(|node| **node >= 0) {
                    listing.claim(*node as usize);
                }
            }
            for node in candidate.added.iter().flatten() {
                if *node >= 0 && (*node as usize) < nodes {
                    listing.claim(*node as usize);
                }
            }
            for node in candidate.moved {
                for row in around.list(*node as usize) {
                    listing.claim(nodes + *row as usize);
                }
            }
            let claimed = &mut listing.claims.claimed;
            claimed.start.push(claimed.items.len() as i32);
        }
        listing.claims
    }

    /// Take the candidates of each genome in order, but none that needs what an earlier one has.
    ///
    /// A gene is the row of a candidate; one beyond them is nothing. `changes` is what each candidate
    /// adds to the sums.
    pub fn combine<'g>(
        &self,
        genomes: impl Iterator<Item = &'g [i64]>,
        changes: &[[f64; SUMS]],
    ) -> Combined {
        let mut combined = Combined::default();
        let mut owner = vec![0u32; self.count];
        for (genome, own) in genomes.zip(1..) {
            let mut sums = [0.0; SUMS];
            for gene in genome {
                let candidate = usize::try_from(*gene).unwrap_or(usize::MAX);
                let is_taken = candidate < changes.len() && {
                    let claimed = self.claimed.list(candidate);
                    let is_clear = claimed.iter().all(|number| owner[*number as usize] != own);
                    if is_clear {
                        for number in claimed {
                            owner[*number as usize] = own;
                        }
                        for (sum, change) in sums.iter_mut().zip(&changes[candidate]) {
                            *sum += change;
                        }
                    }
                    is_clear
                };
                combined.taken.push(is_taken);
            }
            combined.sums.push(sums);
        }
        combined
    }
}

/// Claims that are being listed, in numbers as they come.
struct Listing {
    claims: Claims,
    /// The number of each node and element, from 1; 0 for none yet.
    number: Vec<u32>,
    /// The candidate that last claimed it, from 1.
    claimed_by: Vec<u32>,
    candidate: u32,
}

impl Listing {
    /// Note that the candidate at hand needs a node or an element.
    #[inline]
    fn claim(&mut self, what: usize) {
        if self.claimed_by[what] == self.candidate {
            return;
        }
        self.claimed_by[what] = self.candidate;
        if self.number[what] == 0 {
            self.claims.count += 1;
            self.number[what] = self.claims.count as u32;
        }
        self.claims.claimed.items.push(self.number[what] as i32 - 1);
    }
}
