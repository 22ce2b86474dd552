"""ReplaceNode: merge adjacent nodes (the paper's section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.kernels.merging import evaluate_merges, rewire
from meshops.kernels.quality import CRITERIA, ELEMENTS, compound_indices, measure_elements
from meshops.kernels.smoothing import elements_of_nodes
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints
from meshops.topology import Topology, element_normals
from meshops.workpiece import Workpiece

CANDIDATES = 4
"""Pairs drawn for each pair that is kept."""

STRAIGHT = 1e-6
"""Sine of the angle up to which two border edges count as one line."""


@dataclass(frozen=True)
class ReplaceNode:
    """Merge pairs of adjacent nodes at the second one or half-way between them.

    A node moves or vanishes only where that changes neither border nor region nor feature: inside
    a zone, or along a straight border.

    Attributes
    ----------
    pairs : int
        How many pairs a genome merges at the most.
    pool : int
        How many pairs are drawn before the first individual.
    optional : bool
        Whether a gene may also stand for no pair. In the paper every gene is a pair.
    """

    pairs: int = 10
    pool: int = 100
    optional: bool = True
    name: str = "replace-node"
    code: int = 1

    def search_space(
        self, workpiece: Workpiece, rng: np.random.Generator
    ) -> ReplaceNodeSpace | None:
        """Draw the pool of pairs.

        Of ``CANDIDATES`` times as many pairs the ones are kept that change the compound Q.I. for
        the better or do it the least harm (section 3.1).
        """
        candidates, on_border = mergeable_pairs(workpiece.topology)
        if not len(candidates):
            return None
        drawn = rng.permutation(len(candidates))[: CANDIDATES * self.pool]
        space = ReplaceNodeSpace(self, workpiece, candidates[drawn], on_border[drawn])
        alone = space.tallies(np.arange(len(drawn), dtype=np.int64)[:, None])
        index = compound_indices(alone, *workpiece.setting.scoring.arrays)
        valid = np.isfinite(alone[:, ELEMENTS])
        order = np.argsort(np.where(valid, index, np.inf), kind="stable")
        kept = order[: min(self.pool, np.count_nonzero(valid))]
        if len(kept) < (1 if self.optional else self.pairs):
            return None
        return ReplaceNodeSpace(self, workpiece, candidates[drawn[kept]], on_border[drawn[kept]])

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Merge pairs (K, 3): numbers of the nodes from 1, and whether they meet half-way."""
        count = len(workpiece.mesh.points)
        if not len(parameters):
            return Edit()
        if parameters[:, :2].min() < 1 or parameters[:, :2].max() > count:
            raise ValueError(f"node numbers must be from 1 to {count}")
        pool = parameters - np.array([1, 1, 0], np.int32)
        candidates, borders = mergeable_pairs(workpiece.topology)
        known = {tuple(pair): bool(b) for pair, b in zip(candidates.tolist(), borders, strict=True)}
        if not all(tuple(pair) in known for pair in pool.tolist()):
            raise ValueError("a pair of nodes cannot be merged on this mesh")
        on_border = np.array([known[tuple(pair)] for pair in pool.tolist()])
        space = ReplaceNodeSpace(self, workpiece, pool, on_border)
        if not np.isfinite(space.tallies(np.arange(len(pool), dtype=np.int64)[None, :])).all():
            return Edit()
        return merge(workpiece, pool)

    def format(self, parameters: Ints) -> str:
        """Pairs as in Figure 10, ``242,243``; ``242~243`` where they meet half-way."""
        return " ".join(f"{a}{'~' if half_way else ','}{b}" for a, b, half_way in parameters)


class ReplaceNodeSpace:
    """Choices out of a pool of pairs on one mesh."""

    def __init__(
        self, operation: ReplaceNode, workpiece: Workpiece, pool: Ints, on_border: Bools
    ) -> None:
        self.operation = operation
        self.workpiece = workpiece
        self.pool = pool
        self.on_border = on_border
        size = len(pool)
        bound = 2 * size if operation.optional else size
        self.bounds: Ids = np.full(operation.pairs, bound, np.int64)
        mesh = workpiece.mesh
        values = np.empty((len(mesh.elements), CRITERIA))
        scoring = workpiece.setting.scoring.arrays
        measure_elements(mesh.points, mesh.elements, scoring[-1], values)
        self._around = elements_of_nodes(mesh.elements, len(mesh.points))
        self._of_elements = (element_normals(mesh), values)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Pairs of the pool; without repetition in an individual where each gene is a pair."""
        if self.operation.optional:
            return rng.integers(0, self.bounds, (count, len(self.bounds)))
        ranks = rng.random((count, len(self.pool))).argsort(axis=1)
        return ranks[:, : len(self.bounds)].astype(np.int64)

    def parameters(self, genome: Ids) -> Ints:
        """(K, 3): node numbers from 1, and whether they meet half-way."""
        chosen = genome[genome < len(self.pool)]
        return self.pool[chosen] + np.array([1, 1, 0], np.int32)

    def evaluate(self, genomes: Ids) -> Floats:
        """Merge the pairs of each genome at once; pairs that overlap make no mesh (section 3.1)."""
        return self.tallies(genomes, measured=self.workpiece.setting.fitness.kind != "trias")

    def tally(self, genome: Ids) -> Floats:
        """Merge the pairs of one genome."""
        tally: Floats = self.tallies(genome[None])[0]
        return tally

    def tallies(self, genomes: Ids, *, measured: bool = True) -> Floats:
        """(P, TALLY_SIZE) tallies of genomes of any length, elements measured or just counted."""
        mesh = self.workpiece.mesh
        levels, weights, active, penalties, normalised = self.workpiece.setting.scoring.arrays
        return evaluate_merges(
            genomes,
            self.pool,
            self.on_border,
            mesh.points,
            mesh.elements,
            *self._around,
            *self._of_elements,
            self.workpiece.tally,
            levels,
            weights,
            active if measured else np.zeros_like(active),
            penalties,
            normalised,
        )


def mergeable_pairs(topology: Topology) -> tuple[Ints, Bools]:
    """All pairs of adjacent nodes that may be merged.

    Returns
    -------
    pairs : (K, 3) int32
        Rows of the node that vanishes and of the one that stays, and whether they meet half-way.
    on_border : (K,) bool
    """
    free = topology.free_nodes
    straight = straight_border_nodes(topology)
    edges, border = topology.edges, topology.is_border
    ways = np.concatenate([edges, edges[:, ::-1]])
    on_border = np.concatenate([border, border])
    goes = free[ways[:, 0]] | (straight[ways[:, 0]] & on_border)
    both = (
        goes
        & (free[ways[:, 1]] | (straight[ways[:, 1]] & on_border))
        & (free[ways[:, 0]] == free[ways[:, 1]])
    )
    pairs = np.concatenate(
        [
            np.column_stack([ways[goes], np.zeros(np.count_nonzero(goes), np.int32)]),
            np.column_stack([ways[both], np.ones(np.count_nonzero(both), np.int32)]),
        ]
    )
    return pairs, np.concatenate([on_border[goes], on_border[both]])


def straight_border_nodes(topology: Topology) -> Bools:
    """(N,) bool: unlocked nodes between two border edges in one line, on no other barrier.

    Both ends of a fan are barriers, so a node with one fan and two border edges has no others.
    """
    mesh = topology.mesh
    locked = mesh.locked_nodes.copy()
    corners = mesh.elements[mesh.locked_elements]
    locked[corners[corners != NO_NODE]] = True
    edges = topology.edges[topology.is_border]
    ends = np.concatenate([edges[:, 0], edges[:, 1]])
    others = np.concatenate([edges[:, 1], edges[:, 0]])
    borders = np.bincount(ends, minlength=len(mesh.points))
    fans = np.bincount(topology.fans[1], minlength=len(mesh.points))
    nodes = np.nonzero((borders == 2) & (fans == 1) & ~locked)[0]
    order = np.argsort(ends, kind="stable")
    first = np.searchsorted(ends[order], nodes)
    one = mesh.points[others[order[first]]] - mesh.points[nodes]
    two = mesh.points[others[order[first + 1]]] - mesh.points[nodes]
    size = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    in_line = (np.linalg.norm(np.cross(one, two), axis=1) <= STRAIGHT * size) & (
        np.einsum("ij,ij->i", one, two) < 0
    )
    straight = np.zeros(len(mesh.points), bool)
    straight[nodes[in_line]] = True
    return straight


def merge(workpiece: Workpiece, pool: Ints) -> Edit:
    """Merge pairs (K, 3) of node rows that do not overlap."""
    mesh = workpiece.mesh
    target = np.arange(len(mesh.points), dtype=np.int32)
    target[pool[:, 0]] = pool[:, 1]
    removed, rewired, rewired_to = rewire(mesh.elements, target)
    half_way = pool[pool[:, 2] == 1]
    return Edit(
        removed=removed,
        rewired=rewired,
        rewired_to=rewired_to,
        moved=half_way[:, 1],
        moved_to=0.5 * (mesh.points[half_way[:, 0]] + mesh.points[half_way[:, 1]]),
    )
