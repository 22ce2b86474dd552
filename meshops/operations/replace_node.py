"""ReplaceNode: merge adjacent nodes (the paper's section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops._core import compound_indices, evaluate_merges, rewire
from meshops.edit import Edit
from meshops.mesh import Bools, Floats, Ids, Ints
from meshops.quality_sums import ELEMENTS
from meshops.topology import FAR, Topology, element_normals
from meshops.workpiece import Workpiece

CANDIDATES = 4
"""Pairs drawn for each pair that is kept."""

STRAIGHT = 1e-6
"""Sine of the angle up to which two border edges count as one line."""


@dataclass(frozen=True)
class ReplaceNodePairs:
    """Merge pairs of adjacent nodes at the second one or half-way between them, as in the paper.

    A node moves or vanishes only where that changes neither border nor region nor feature: inside
    a zone, or along a straight border. Every gene is a pair; parameters are node numbers.

    Attributes
    ----------
    pairs : int
        How many pairs a genome merges.
    pool : int
        How many pairs are drawn before the first individual.
    """

    pairs: int = 10
    pool: int = 100
    name: str = "replace-node-pairs"
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
        kept = drawn[least_harmful(workpiece, candidates[drawn], on_border[drawn], self.pool)]
        if len(kept) < self.pairs:
            return None
        return ReplaceNodeSpace(workpiece, self.pairs, candidates[kept], on_border[kept])

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Merge pairs (K, 3): numbers of the nodes from 1, and whether they meet half-way."""
        count = len(workpiece.mesh.points)
        if not len(parameters):
            return Edit()
        if parameters[:, :2].min() < 1 or parameters[:, :2].max() > count:
            raise ValueError(f"node numbers must be from 1 to {count}")
        wanted = parameters - np.array([1, 1, 0], np.int32)
        candidates, borders = mergeable_pairs(workpiece.topology)
        matches = (candidates[None] == wanted[:, None]).all(axis=2)
        if not matches.any(axis=1).all():
            raise ValueError("a pair of nodes cannot be merged on this mesh")
        return merge_if_valid(workpiece, wanted, borders[matches.argmax(axis=1)])

    def format(self, parameters: Ints) -> str:
        """Pairs as in Figure 10, ``242,243``; ``242~243`` where they meet half-way."""
        return " ".join(f"{a}{'~' if half_way else ','}{b}" for a, b, half_way in parameters)


@dataclass(frozen=True)
class ReplaceNode:
    """Merge pairs of adjacent nodes near the worst places.

    A pair is named by its rank among all that may be merged, those nearest to a bad element first,
    and a gene may also stand for no pair.

    Attributes
    ----------
    pairs : int
        How many pairs a genome merges at the most.
    pool : int
        How many pairs there are to choose from.
    """

    pairs: int = 4
    pool: int = 100
    name: str = "replace-node"
    code: int = 23

    def search_space(
        self, workpiece: Workpiece, rng: np.random.Generator
    ) -> RankedReplaceNodeSpace | None:
        """Take the pairs that do the least harm of those nearest to the bad elements."""
        candidates, on_border = ranked_pairs(workpiece)
        nearest = slice(0, CANDIDATES * self.pool)
        kept = least_harmful(workpiece, candidates[nearest], on_border[nearest], self.pool)
        if not len(kept):
            return None
        return RankedReplaceNodeSpace(
            workpiece, self.pairs, candidates[kept], on_border[kept], kept.astype(np.int32)
        )

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Merge pairs by their ranks from 1, (K, 2); a rank that is not there is left out."""
        candidates, on_border = ranked_pairs(workpiece)
        rows = parameters[:, 0] - 1
        rows = rows[(rows >= 0) & (rows < len(candidates))]
        return merge_if_valid(workpiece, candidates[rows], on_border[rows])

    def format(self, parameters: Ints) -> str:
        """Ranks: ``3 17``."""
        return " ".join(str(rank) for rank, _ in parameters)


class ReplaceNodeSpace:
    """Choices out of a pool of pairs on one mesh."""

    def __init__(self, workpiece: Workpiece, pairs: int, pool: Ints, on_border: Bools) -> None:
        self.workpiece = workpiece
        self.pool = pool
        self.on_border = on_border
        self.bounds: Ids = np.full(pairs, len(pool), np.int64)
        self._normals = element_normals(workpiece.mesh)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Pairs of the pool, without repetition in an individual."""
        ranks = rng.random((count, len(self.pool))).argsort(axis=1)
        return ranks[:, : len(self.bounds)].astype(np.int64)

    def parameters(self, genome: Ids) -> Ints:
        """(K, 3): node numbers from 1, and whether they meet half-way."""
        return self.pool[genome] + np.array([1, 1, 0], np.int32)

    def evaluate(self, genomes: Ids) -> Floats:
        """Merge the pairs of each genome at once; pairs that overlap make no mesh (section 3.1)."""
        return self.tallies(genomes, measured=self.workpiece.setting.fitness.kind != "trias")

    def tally(self, genome: Ids) -> Floats:
        """Merge the pairs of one genome."""
        tally: Floats = self.tallies(genome[None])[0]
        return tally

    def tallies(self, genomes: Ids, *, measured: bool = True) -> Floats:
        """(P, TALLY_SIZE) tallies of genomes of any length, elements measured or just counted."""
        return evaluate_merges(
            genomes,
            self.pool,
            self.on_border,
            self._normals,
            self.workpiece,
            self.workpiece.setting.scoring.core if measured else None,
        )


class RankedReplaceNodeSpace(ReplaceNodeSpace):
    """The same with pairs that have ranks, and genes that may stand for no pair."""

    def __init__(
        self, workpiece: Workpiece, pairs: int, pool: Ints, on_border: Bools, ranks: Ints
    ) -> None:
        super().__init__(workpiece, pairs, pool, on_border)
        self.ranks = ranks
        self.bounds = np.full(pairs, 2 * len(pool), np.int64)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Half of the genes, on the average, are pairs."""
        return rng.integers(0, self.bounds, (count, len(self.bounds)))

    def parameters(self, genome: Ids) -> Ints:
        """(K, 2): ranks from 1, and 0."""
        chosen = self.ranks[genome[genome < len(self.pool)]] + np.int32(1)
        return np.column_stack([chosen, np.zeros(len(chosen), np.int32)])


def least_harmful(workpiece: Workpiece, pairs: Ints, on_border: Bools, most: int) -> Ids:
    """Rows of the pairs whose merging alone leaves the lowest compound Q.I., at most so many."""
    if not len(pairs):
        return np.zeros(0, np.int64)
    space = ReplaceNodeSpace(workpiece, 1, pairs, on_border)
    alone = space.tallies(np.arange(len(pairs), dtype=np.int64)[:, None])
    index = compound_indices(alone, workpiece.setting.scoring.core)
    valid = np.isfinite(alone[:, ELEMENTS])
    order = np.argsort(np.where(valid, index, np.inf), kind="stable")
    return order[: min(most, np.count_nonzero(valid))]


def ranked_pairs(workpiece: Workpiece) -> tuple[Ints, Bools]:
    """All pairs that may be merged, those nearest to a bad element first, and their borders."""
    pairs, on_border = mergeable_pairs(workpiece.topology)
    if workpiece.setting.slides:  # then border nodes are not locked that may move, but must stay
        pairs, on_border = pairs[~on_border], on_border[~on_border]
    mesh = workpiece.mesh
    distance = np.full(len(mesh.points) + 1, FAR, np.int32)
    np.minimum.at(distance, mesh.elements, workpiece.rings[:, None])
    order = np.argsort(distance[pairs[:, 0]], kind="stable")
    return pairs[order], on_border[order]


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
    """(N,) bool: unlocked nodes between two border edges in one line, on no other barrier."""
    mesh, neighbours = topology.mesh, topology.border_neighbours
    nodes = np.nonzero(neighbours[:, 0] >= 0)[0]
    one = mesh.points[neighbours[nodes, 0]] - mesh.points[nodes]
    two = mesh.points[neighbours[nodes, 1]] - mesh.points[nodes]
    size = np.linalg.norm(one, axis=1) * np.linalg.norm(two, axis=1)
    in_line = (np.linalg.norm(np.cross(one, two), axis=1) <= STRAIGHT * size) & (
        np.einsum("ij,ij->i", one, two) < 0
    )
    straight = np.zeros(len(mesh.points), bool)
    straight[nodes[in_line]] = True
    return straight


def merge_if_valid(workpiece: Workpiece, pool: Ints, on_border: Bools) -> Edit:
    """Merge pairs (K, 3) of node rows all at once; empty where that leaves no valid mesh."""
    if not len(pool):
        return Edit()
    space = ReplaceNodeSpace(workpiece, len(pool), pool, on_border)
    if not np.isfinite(space.tallies(np.arange(len(pool), dtype=np.int64)[None, :])).all():
        return Edit()
    return merge(workpiece, pool)


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
