"""Anneal: many small random edits of a place, which settle where the mesh lacks least."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from meshops._core import (
    AnnealingPrices,
    AnnealingSite,
    Cooling,
    Ground,
    NodeSearch,
    WantedSizes,
    all_facing,
    anneal,
    has_doubles,
    valid_elements,
)
from meshops.edit import Edit
from meshops.fitness import IRREGULARITY
from meshops.mesh import NO_NODE, Floats, Ids, Ints, following
from meshops.patch import Patch, components, extract, join, stitch
from meshops.quality_sums import TALLY_SIZE
from meshops.remeshing import LEAST_CORNER, SURFACE_TOLERANCE
from meshops.surface import PatchSurface
from meshops.topology import valences
from meshops.workpiece import Workpiece

RINGS = (2, 3, 4, 6, 9, 40)
"""Rings around the bad element that a gene chooses of; parameters may have more."""

HEATS = ((0.4, 300), (0.2, 600), (0.1, 300), (0.3, 1000))
"""Temperature at the start, and trials an element that is bad or has an irregular node."""

COLD = 0.02
"""Temperature at the end."""

SEEDS = 1000

PRICES = AnnealingPrices(shape=10.0, tria=6.0, irregular=IRREGULARITY, invalid=10.0, size=6.0)

LEAST_TRIALS, MOST_TRIALS = 2_000, 400_000

CELLS = 4096
"""Of the grid of wanted sizes, at the most."""


@dataclass(frozen=True)
class Anneal:
    """Anneal a disc: edges swap, quads collapse and open, trias travel and meet, nodes move.

    No other operation sees so many steps ahead: one that makes the mesh worse may stay for a while,
    the less likely the worse it is and the later it comes (Kirkpatrick and others 1983). A genome
    is one number for a place (the rank of a bad element and the rings around it), a temperature and
    a seed.
    """

    name: str = "anneal"
    code: int = 25

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> AnnealSpace | None:
        """Genomes are places; the random generator is not needed."""
        if not workpiece.topology.free_nodes.any():
            return None
        return AnnealSpace(workpiece)

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Anneal places (K, 4) one after the other; none where the mesh does not have their ranks.

        Raises ValueError for a temperature or a number of rings that there is none of.
        """
        if not len(parameters):
            return Edit()
        if len(parameters) > 1:
            raise ValueError("Anneal takes one place at a time")
        return annealed(workpiece, parameters[0])

    def format(self, parameters: Ints) -> str:
        """Places as ``3 r4 T0.4x300 #17``: rank, rings, temperature, trials, seed."""
        return " ".join(
            f"{rank} r{rings} T{HEATS[heat][0]:g}x{HEATS[heat][1]} #{seed}"
            for rank, rings, heat, seed in parameters
        )


class AnnealSpace:
    """Places on one mesh. One that was annealed once is remembered."""

    def __init__(self, workpiece: Workpiece) -> None:
        self.workpiece = workpiece
        self._shape = (len(workpiece.bad_elements), len(RINGS), len(HEATS), SEEDS)
        self.bounds: Ids = np.array([np.prod(self._shape)], np.int64)
        self._edits: dict[int, Edit] = {}
        self._tallies: dict[int, Floats] = {}

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """One place again and again, rather near the worst elements: each is a search of its own.

        Many procedures that anneal once do more in the same time than one that chooses.
        """
        bad, rings, heats, seeds = self._shape
        genes = (
            int(bad * rng.random() ** 2),
            rng.integers(0, rings),
            rng.integers(0, heats),
            rng.integers(0, seeds),
        )
        return np.full((count, 1), np.ravel_multi_index(genes, self._shape))

    def evaluate(self, genomes: Ids) -> Floats:
        """Anneal the place of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally after annealing one place; NaN where that is not a valid mesh."""
        key = int(genome[0])
        if key not in self._tallies:
            edit = self.edit_of(genome)
            change = self.workpiece.tally_change(edit)
            nothing = np.full(TALLY_SIZE, np.nan)
            self._tallies[key] = nothing if edit.is_empty else self.workpiece.tally + change
        return self._tallies[key]

    def edit_of(self, genome: Ids) -> Edit:
        """Anneal one place, once."""
        key = int(genome[0])
        if key not in self._edits:
            self._edits[key] = annealed(self.workpiece, self._place(key))
        return self._edits[key]

    def parameters(self, genome: Ids) -> Ints:
        """(1, 4) int32: rank from 1, rings, temperature, seed; no row where nothing comes of it."""
        place = self._place(int(genome[0]))[None]
        return place if np.isfinite(self.tally(genome)).all() else place[:0]

    def _place(self, key: int) -> Ints:
        rank, rings, heat, seed = np.unravel_index(key, self._shape)
        return np.array([rank + 1, RINGS[rings], heat, seed], np.int32)


def annealed(workpiece: Workpiece, place: Ints) -> Edit:
    """Anneal all patches of one place (4,)."""
    rank, rings, heat, seed = place.tolist()
    if not 0 <= heat < len(HEATS) or rings < 0:
        raise ValueError(f"there is no temperature {heat} or ring {rings} to anneal at")
    topology, bad = workpiece.topology, workpiece.bad_elements
    if not 1 <= rank <= len(bad):
        return Edit()
    chosen = topology.graph.disc(topology.editable, bad[rank - 1], rings)
    edits = [_anneal_patch(workpiece, rows, heat, seed) for rows in components(topology, chosen)]
    return join(workpiece.mesh, [edit for edit in edits if not edit.is_empty])


def _anneal_patch(workpiece: Workpiece, rows: Ints, heat: int, seed: int) -> Edit:
    """Anneal one patch; the edit, empty where there is nothing to gain or no valid mesh comes."""
    patch = extract(workpiece.topology, rows)
    fixed = patch.border_nodes
    outside = _outside(workpiece, patch)
    bad = workpiece.irregular_elements | workpiece.failing | workpiece.mesh.is_tria
    wanting = int(np.count_nonzero(bad[rows]))
    if not wanting or fixed == len(patch.points):
        return Edit()
    hot, effort = HEATS[heat]
    surface, scoring = workpiece.surface, workpiece.setting.scoring
    edge = PatchSurface.of(patch.points, patch.elements).mean_edge(patch)
    near, tolerance = surface.near(patch.points, edge), SURFACE_TOLERANCE * edge
    site = AnnealingSite(
        outside=outside,
        fixed=fixed,
        plane=surface.plane,
        ground=Ground(surface.points, *near, tolerance, LEAST_CORNER),
        wanted=_wanted(workpiece, patch, edge),
    )
    trials = min(max(wanting * effort, LEAST_TRIALS), MOST_TRIALS)
    cooling = Cooling(hot=hot, cold=COLD, trials=trials)
    found = anneal(patch.points, patch.elements, site, PRICES, scoring.core, cooling, seed)
    if found is None:
        return Edit()
    points, elements = found[:2]
    inner = np.arange(fixed, len(points), dtype=np.int32)
    search = NodeSearch("even", surface, tolerance, LEAST_CORNER, scoring.core)
    points = search.optimise(points, elements, inner)
    if not _is_valid(workpiece, patch, points, elements, edge):
        return Edit()
    return stitch(workpiece.mesh, patch, points[fixed:], elements)


def _outside(workpiece: Workpiece, patch: Patch) -> Ints:
    """(n,) int32: elements around each node that are not of the patch; -1 where any number is."""
    nodes = patch.nodes
    own = valences(patch.elements, len(nodes))
    around = workpiece.topology.valence[nodes] + workpiece.outside[nodes]
    outside: Ints = np.where(workpiece.outside[nodes] < 0, -1, around - own).astype(np.int32)
    return outside


def _wanted(workpiece: Workpiece, patch: Patch, edge: float) -> WantedSizes:
    """Edge lengths that are wanted, by the cubes of a grid: the run's, or those that are there."""
    low, high = patch.points.min(axis=0), patch.points.max(axis=0)
    size = workpiece.setting.element_size
    if size is not None:
        return WantedSizes(np.full((1, 1, 1), size), low, 1.0)
    cell = max(edge, float(np.ptp(patch.points, axis=0).max()) * 1e-3)
    shape = np.ceil((high - low) / cell).astype(np.int64) + 1
    while np.prod(shape) > CELLS:
        cell *= 1.25
        shape = np.ceil((high - low) / cell).astype(np.int64) + 1
    places = low + cell * (np.indices(shape).reshape(3, -1).T + 0.5)
    near = cKDTree(patch.points).query(places)[1]
    return WantedSizes(_sizes_at_nodes(patch)[near].reshape(shape), low, cell)


def _sizes_at_nodes(patch: Patch) -> Floats:
    """(n,) edge of a square of the mean area of the elements around each node."""
    corners = patch.points[patch.elements]
    tria = patch.elements[:, 3] == NO_NODE
    corners[tria, 3] = corners[tria, 2]
    vectors = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    areas = 0.5 * np.linalg.norm(vectors, axis=1) * np.where(tria, 2.0, 1.0)
    is_node = patch.elements != NO_NODE
    nodes = patch.elements[is_node]
    weights = np.broadcast_to(areas[:, None], is_node.shape)[is_node]
    count = len(patch.points)
    sizes: Floats = np.sqrt(
        np.bincount(nodes, weights, count) / np.bincount(nodes, minlength=count)
    )
    return sizes


def _is_valid(
    workpiece: Workpiece, patch: Patch, points: Floats, elements: Ints, edge: float
) -> bool:
    """Whether new elements within the border of a patch leave the mesh whole and on its surface."""
    reference, surface = workpiece.surface, PatchSurface.of(patch.points, patch.elements)
    tolerance = SURFACE_TOLERANCE * edge
    if not valid_elements(points, elements, LEAST_CORNER).all():
        return False
    normals = reference.normals_at(points, elements, tolerance)
    if normals is None or not all_facing(points, elements, normals):
        return False
    if has_doubles(elements, len(points)) or _doubles_an_edge(workpiece, patch, elements):
        return False
    return surface.is_covered(patch, points, elements, tolerance)


def _doubles_an_edge(workpiece: Workpiece, patch: Patch, elements: Ints) -> bool:
    """Whether an edge through a patch joins two border nodes that an edge outside joins already."""
    topology, nodes = workpiece.topology, patch.nodes
    count = len(workpiece.mesh.points)
    on_border = np.zeros(count, bool)
    on_border[nodes[: patch.border_nodes]] = True
    own = np.zeros(len(topology.edges), bool)
    used = topology.element_edges[patch.rows]
    own[used[used >= 0]] = True
    outer = topology.edges[~own & on_border[topology.edges].all(axis=1)].astype(np.int64)
    if not len(outer):
        return False
    sides = np.stack([elements, following(elements)], axis=2).reshape(-1, 2)
    across = ((sides >= 0) & (sides < patch.border_nodes)).all(axis=1)
    ends = np.sort(nodes[sides[across]], axis=1).astype(np.int64)
    return bool(np.isin(ends[:, 0] * count + ends[:, 1], outer[:, 0] * count + outer[:, 1]).any())
