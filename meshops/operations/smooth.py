"""Smooth: move the free nodes of a place so that the elements around them get better."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from meshops._core import NodeSearch
from meshops.edit import Edit
from meshops.mesh import NO_NODE, Bools, Floats, Ids, Ints, following
from meshops.remeshing import LEAST_CORNER, SURFACE_TOLERANCE
from meshops.workpiece import Workpiece

Smoothing = Literal["laplace", "worst", "even"]

METHODS: tuple[Smoothing, ...] = get_args(Smoothing)
"""As parameters number them."""

RINGS = (1, 2, 3, 4)
"""Rings that a gene chooses of; parameters may have more."""


@dataclass(frozen=True)
class Smooth:
    """Move the free nodes around one or two bad elements; elements stay as they are.

    A place is the rank of a bad element, the rings around it, and the method: ``laplace`` moves
    nodes to the mean of their neighbours where nothing gets worse by that; ``worst`` searches for
    places where fewer elements fail and the worst are better; ``even`` for the best mean Q.I.
    """

    name: str = "smooth"
    code: int = 12

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> SmoothSpace | None:
        """Genomes are places; the random generator is not needed."""
        space = SmoothSpace(workpiece)
        return space if space.movable.any() and len(workpiece.bad_elements) else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Smooth places (K, 3) one after the other; ranks that the mesh does not have are skipped.

        Raises ValueError where there is no such method.
        """
        for method in parameters[:, 2]:
            if not 0 <= method < len(METHODS):
                raise ValueError(f"there is no method {method} to smooth by")
        return SmoothSpace(workpiece).edit(parameters)

    def format(self, parameters: Ints) -> str:
        """Places as ``3 r4 worst``: rank, rings, method."""
        return " ".join(f"{rank} r{rings} {METHODS[method]}" for rank, rings, method in parameters)


class SmoothSpace:
    """One or two places on one mesh. What was smoothed once is remembered.

    A genome is two places: rank, choice of ``RINGS`` and method each; rank 0 of
    the second stands for none.
    """

    def __init__(self, workpiece: Workpiece) -> None:
        self.workpiece = workpiece
        bad = len(workpiece.bad_elements)
        self.bounds: Ids = np.array(
            [bad, len(RINGS), len(METHODS), bad + 1, len(RINGS), len(METHODS)], np.int64
        )
        self._edits: dict[bytes, Edit] = {}
        self._tallies: dict[bytes, Floats] = {}

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Places near the worst elements more often than others, half of them alone."""
        genomes = rng.integers(0, self.bounds, (count, len(self.bounds)))
        genomes[:, 0] = (self.bounds[0] * rng.random(count) ** 2).astype(np.int64)
        genomes[rng.random(count) < 0.5, 3] = 0
        return genomes

    def evaluate(self, genomes: Ids) -> Floats:
        """Smooth the places of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally after smoothing; that of the mesh where nothing moves."""
        places = _places(genome)
        key = places.tobytes()
        if key not in self._tallies:
            change = self.workpiece.tally_change(self.edit(places))
            self._tallies[key] = self.workpiece.tally + change
        return self._tallies[key]

    def parameters(self, genome: Ids) -> Ints:
        """(K, 3) int32 places, ranks from 1; no row where nothing moves."""
        places = _places(genome)
        return places[:0] if self.edit(places).is_empty else places

    def edit_of(self, genome: Ids) -> Edit:
        """Smooth the places of a genome."""
        return self.edit(_places(genome))

    def edit(self, places: Ints) -> Edit:
        """Smooth places (K, 3) one after the other."""
        if not len(places):
            return Edit()
        key = places.tobytes()
        if key not in self._edits:
            self._edits[key] = self._smooth(self.edit(places[:-1]), places[-1])
        return self._edits[key]

    def _smooth(self, before: Edit, place: Ints) -> Edit:
        mesh = self.workpiece.mesh
        nodes = self._nodes(place)
        if not nodes.any():
            return before
        touched = (nodes[mesh.elements] & (mesh.elements != NO_NODE)).any(axis=1)
        elements = mesh.elements[touched]
        points = before.points_after(mesh)
        rows = np.unique(elements[elements != NO_NODE])
        local = np.searchsorted(rows, elements).astype(np.int32)
        local[elements == NO_NODE] = NO_NODE
        points[rows] = self.move(points[rows], local, rows, nodes[rows], place)
        moved = np.nonzero((points != mesh.points).any(axis=1))[0].astype(np.int32)
        return Edit(moved=moved, moved_to=points[moved])

    def _nodes(self, place: Ints) -> Bools:
        """(N,) bool: the free nodes of a place (3,)."""
        topology, bad = self.workpiece.topology, self.workpiece.bad_elements
        nodes = np.zeros(len(self.workpiece.mesh.points), bool)
        if not 1 <= place[0] <= len(bad):
            return nodes
        inside = topology.graph.disc(topology.editable, bad[place[0] - 1], place[1])
        corners = self.workpiece.mesh.elements[inside]
        nodes[corners[corners != NO_NODE]] = True
        return nodes & self.movable

    @property
    def movable(self) -> Bools:
        """(N,) bool: nodes that may move."""
        return self.workpiece.topology.free_nodes

    def move(self, points: Floats, elements: Ints, rows: Ints, moves: Bools, place: Ints) -> Floats:
        """(n, 3) places of the nodes of a place once they have moved.

        Parameters
        ----------
        points, elements
            Of the place.
        rows : (n,) int32
            The mesh row of each of its nodes.
        moves : (n,) bool
            Which of them move.
        place : (3,) int32
        """
        search = self.search(points, elements, METHODS[place[2]])
        return search.optimise(points, elements, np.nonzero(moves)[0].astype(np.int32))

    def search(self, points: Floats, elements: Ints, method: Smoothing) -> NodeSearch:
        """Prepare a search for the nodes of a place."""
        tolerance = SURFACE_TOLERANCE * _mean_edge(points, elements)
        surface, scoring = self.workpiece.surface, self.workpiece.setting.scoring
        return NodeSearch(method, surface, tolerance, LEAST_CORNER, scoring.core)


def _places(genome: Ids) -> Ints:
    """(1 or 2, 3) int32 places of a genome (6,)."""
    places = genome.reshape(2, 3) + np.array([[1, 0, 0], [0, 0, 0]])
    places[:, 1] = np.take(RINGS, places[:, 1])
    chosen: Ints = places[places[:, 0] > 0].astype(np.int32)
    return chosen


def _mean_edge(points: Floats, elements: Ints) -> float:
    is_side = elements != NO_NODE
    vectors = points[following(elements)[is_side]] - points[elements[is_side]]
    return float(np.linalg.norm(vectors, axis=1).mean())
