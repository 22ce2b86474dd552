//! How good a node's place is: what the criteria say of the elements around it.
//!
//! That is how severe their faults are, their highest Q.I., and the sum of Q.I. or of its squares.

use super::element_quality::ElementQuality;
use super::scoring::Scoring;
use crate::math::greatest;
use crate::mesh::Element;
use crate::mesh::csr::CsrView;
use crate::mesh::validity::corner_on_surface;
use crate::surface::Surface;
use crate::vectors::Vector;

/// Share of the sum by which a node must lower it to move.
pub const GAIN: f64 = 1e-6;

/// Share by which a sum may differ with the order of its terms.
const ROUNDING: f64 = 1e-12;

/// What a node moves for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// To the mean of the neighbours.
    Laplace,
    /// For the worst elements first.
    Worst,
    /// For the mean element.
    Even,
}

/// The surface that elements must stay on; no facets where it is plane.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    /// The surface.
    pub surface: Surface<'a>,
    /// How far from it the centre of an element may be.
    pub tolerance: f64,
    /// The worst corner that an element may get.
    pub least_corner: f64,
}

impl Ground<'_> {
    /// Whether the surface is plane.
    #[inline]
    pub fn is_plane(&self) -> bool {
        self.surface.is_empty()
    }
}

/// What an element lies on and must keep.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementGround {
    /// Normal of the surface under it.
    pub normal: Vector,
    /// Its distance from there.
    pub distance: f64,
    /// The worst corner, along its own normal, that it may have.
    pub least_corner: f64,
}

/// How good a node's place is; less is better.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeScore {
    /// Severity of the faults of the elements around it.
    pub severity: f64,
    /// Their highest Q.I.
    pub highest: f64,
    /// The sum of their Q.I., or of its squares.
    pub sum: f64,
}

impl NodeScore {
    /// A place that is out of the question.
    pub const REJECTED: Self =
        Self { severity: f64::INFINITY, highest: f64::INFINITY, sum: f64::INFINITY };

    /// Whether it is better: faults are less severe, or as severe and the sum is lower.
    #[inline]
    pub fn is_better(&self, old: &Self, goal: Goal) -> bool {
        if self.severity != old.severity {
            return self.severity < old.severity;
        }
        if goal == Goal::Laplace {
            return self.sum <= old.sum;
        }
        self.sum < old.sum * (1.0 - GAIN)
    }
}

/// Scores of nodes that move. The points are not part of it: they change.
#[derive(Clone, Copy, Debug)]
pub struct NodeScores<'a> {
    /// The elements.
    pub elements: &'a [Element],
    /// Those around each node.
    pub around: CsrView<'a>,
    /// The criteria.
    pub scoring: &'a Scoring,
    /// What nodes move for.
    pub goal: Goal,
}

impl NodeScores<'_> {
    #[inline]
    fn term(&self, index: f64) -> f64 {
        if self.goal == Goal::Even { index } else { index * index }
    }

    /// Score of a node by the quality of all elements.
    #[inline]
    pub fn score(&self, node: usize, quality: &[ElementQuality]) -> NodeScore {
        let mut score = NodeScore { severity: 0.0, highest: 0.0, sum: 0.0 };
        for element in self.around.list(node) {
            let ElementQuality { severity, index } = quality[*element as usize];
            score.severity += severity;
            score.highest = greatest(score.highest, index);
            score.sum += self.term(index);
        }
        score
    }

    /// Score of a node where it stands; rejected as soon as it cannot be better than `now`.
    ///
    /// Some element is around it. `quality` is what elements were like before, `ground` what they
    /// must keep; those around the node get their quality in `trial`.
    pub fn score_trial(
        &self,
        points: &[Vector],
        node: usize,
        now: &NodeScore,
        quality: &[ElementQuality],
        ground: &[ElementGround],
        trial: &mut [ElementQuality],
    ) -> NodeScore {
        let around = self.around.list(node);
        let mut worst = around[0];
        for element in around {
            if quality[*element as usize].index > quality[worst as usize].index {
                worst = *element;
            }
        }
        // the element that is the worst now rejects most trials, and what is spared then is time gained
        let others = around.iter().copied().filter(|element| *element != worst);
        let (mut severity, mut sum) = (0.0, 0.0);
        for e in std::iter::once(worst).chain(others) {
            let e = e as usize;
            let element = self.elements[e];
            let corner = corner_on_surface(points, element, ground[e].normal);
            if corner < ground[e].least_corner {
                return NodeScore::REJECTED;
            }
            trial[e] = ElementQuality::of(points, element, self.scoring);
            severity += trial[e].severity;
            sum += self.term(trial[e].index);
            if severity > now.severity || (self.goal != Goal::Even && trial[e].index > now.highest)
            {
                return NodeScore::REJECTED;
            }
            if now.severity == 0.0 && sum > now.sum * (1.0 + ROUNDING) {
                return NodeScore::REJECTED;
            }
        }
        self.score(node, trial)
    }
}
