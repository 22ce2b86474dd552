"""Remesh: mesh the selected elements anew within their border (the paper's section 3.1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from meshops.edit import Edit
from meshops.kernels.pairing import (
    match_completely,
    match_greedily,
    merge_pairs,
    pair_shapes,
    split_quads,
    tria_neighbours,
)
from meshops.kernels.quality import TALLY_SIZE
from meshops.kernels.selection import select_ranges
from meshops.kernels.smoothing import smooth
from meshops.kernels.soundness import all_facing, has_doubles, sound_elements
from meshops.mesh import Floats, Ids, Ints
from meshops.patch import Patch, components, extract, join, stitch
from meshops.remesher import RemeshError, remesh_isotropic
from meshops.surface import PatchSurface
from meshops.workpiece import Workpiece

TRIA_OF_QUAD = 1.07
"""Edge of a regular tria of half a square's area, over the square's edge: (4 / 3) ** (1 / 4)."""

GOOD_PAIR = 0.5
"""Quads below this shape are formed only where a tria would stay alone otherwise."""

LEAST_PAIR = 0.05
"""Quads below this shape are not formed: no smoothing mends a flat corner on a fixed border."""

SMOOTHING_SWEEPS = 6

LEAST_CORNER = 0.05
"""`corner_jacobian_min` from which an element counts as sound: neither concave nor nearly flat."""

SURFACE_TOLERANCE = 0.1
"""Of the edge length: how far a new element's centre may be from the old surface, and an old node
from the new one. It is the level at which the chordal deviation of the standard criteria fails."""


@dataclass(frozen=True)
class Remesh:
    """Cut out, remesh, recombine to quads, smooth, project back, stitch in.

    Attributes
    ----------
    ranges : int
        How many ranges of element numbers a genome selects; it has twice as many genes.
    reach : int or None
        None: the two genes of a range are its ends, anywhere on the mesh, and all that they select
        is replaced, as in the paper. A number: the genes are an element that fails or is a tria,
        and how many elements, up to the reach, are selected around its number; a patch is replaced
        only where that makes the mesh fitter.
    """

    ranges: int = 20
    reach: int | None = 100
    name: str = "remesh"
    code: int = 0

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> RemeshSpace | None:
        """Genomes are ranges; the random generator is not needed."""
        if not workpiece.topology.editable.any():
            return None
        return RemeshSpace(self, workpiece)

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Remesh the union of ranges (K, 2) of element numbers from 1."""
        count = len(workpiece.mesh.elements)
        if len(parameters) and (parameters.min() < 1 or parameters.max() > count):
            raise ValueError(f"element numbers must be from 1 to {count}")
        edits = [replace_patch(workpiece, rows) for rows in select(workpiece, parameters)]
        return join(workpiece.mesh, [edit for edit, _ in edits if not edit.is_empty])

    def format(self, parameters: Ints) -> str:
        """Ranges as in Figure 10: ``33-301 317-243``."""
        return " ".join(f"{low}-{high}" for low, high in parameters)


class RemeshSpace:
    """Ranges of element numbers on one mesh. A patch that was remeshed once is remembered."""

    def __init__(self, operation: Remesh, workpiece: Workpiece) -> None:
        self.operation = operation
        self.workpiece = workpiece
        self._changes: dict[bytes, Floats | None] = {}
        count = len(workpiece.mesh.elements)
        if operation.reach is None:
            self._sites: Ints = np.arange(count, dtype=np.int32)
            bounds = [count, count]
        else:
            self._sites = workpiece.bad_elements
            bounds = [len(self._sites), min(operation.reach, count)]
        self.bounds: Ids = np.tile(np.array(bounds, np.int64), operation.ranges)

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Numbers drawn evenly (section 4.1)."""
        return rng.integers(0, self.bounds, (count, len(self.bounds)))

    def parameters(self, genome: Ids) -> Ints:
        """(K, 2) ranges, numbered from 1; with a reach, of just the elements that are replaced."""
        ranges = self._ranges(genome)
        if self.operation.reach is None:
            return ranges
        replaced = [
            rows for rows in select(self.workpiece, ranges) if self._change(rows) is not None
        ]
        return runs(np.concatenate(replaced)) if replaced else ranges[:0]

    def evaluate(self, genomes: Ids) -> Floats:
        """Remesh the patches of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Add up what the patches of one genome change."""
        tally = self.workpiece.tally
        for rows in select(self.workpiece, self._ranges(genome)):
            change = self._change(rows)
            if change is not None:
                tally = tally + change
        return tally

    def _ranges(self, genome: Ids) -> Ints:
        first, second = genome.reshape(-1, 2).T
        if self.operation.reach is None:
            return np.column_stack([first, second]).astype(np.int32) + np.int32(1)
        last = len(self.workpiece.mesh.elements) - 1
        centre = self._sites[first]
        low, high = centre - second // 2, centre + (second + 1) // 2
        ranges: Ints = np.column_stack([low, high]).clip(0, last).astype(np.int32) + np.int32(1)
        return ranges

    def _change(self, rows: Ints) -> Floats | None:
        """Find what remeshing a patch adds to the tally; None where the patch stays."""
        key = rows.tobytes()
        if key not in self._changes:
            edit, change = replace_patch(self.workpiece, rows)
            keep = not edit.is_empty and (
                self.operation.reach is None or self.workpiece.is_fitter_by(change)
            )
            self._changes[key] = change if keep else None
        return self._changes[key]


def select(workpiece: Workpiece, ranges: Ints) -> list[Ints]:
    """Split the union of ranges (K, 2) of numbers from 1 into patches: lists of element rows."""
    topology = workpiece.topology
    return components(topology, select_ranges(ranges, len(topology.mesh.elements)))


def runs(rows: Ints) -> Ints:
    """(K, 2) ranges of numbers from 1 that cover just these rows."""
    rows = np.sort(rows)
    breaks = np.nonzero(np.diff(rows) > 1)[0]
    first = rows[np.concatenate([[0], breaks + 1])]
    last = rows[np.concatenate([breaks, [len(rows) - 1]])]
    return np.column_stack([first, last]) + np.int32(1)


def replace_patch(workpiece: Workpiece, rows: Ints) -> tuple[Edit, Floats]:
    """Remesh one patch; the edit, empty where that fails, and its change of the tally."""
    patch = extract(workpiece.topology, rows)
    anew = remesh_patch(patch, workpiece.setting.element_size) if len(rows) > 1 else None
    if anew is None:
        return Edit(), np.zeros(TALLY_SIZE)
    points, elements = anew
    change = workpiece.tally_of(points, elements) - workpiece.tally_of(patch.points, patch.elements)
    return stitch(workpiece.mesh, patch, points[patch.border_nodes :], elements), change


def remesh_patch(patch: Patch, size: float | None) -> tuple[Floats, Ints] | None:
    """Mesh a patch anew with quads, its border kept.

    Parameters
    ----------
    patch : Patch
    size : float or None
        Edge length of the quads; None takes that of the patch as it is.

    Returns
    -------
    (points, elements), border nodes first at the rows that they have in the patch; None where no
    valid mesh came out.
    """
    surface = PatchSurface.of(patch.points, patch.elements)
    edge = surface.mean_edge(patch) if size is None else size
    try:
        points, trias = remesh_isotropic(
            patch.points, surface.trias, patch.border, TRIA_OF_QUAD * edge
        )
    except RemeshError:
        return None
    elements = recombine(points, trias)
    smooth(points, elements, patch.border_nodes, SMOOTHING_SWEEPS)
    surface.project(points, patch.border_nodes)
    sound = sound_elements(points, elements, LEAST_CORNER)
    if not sound.all():
        elements = split_quads(points, elements, ~sound)
        if not sound_elements(points, elements, LEAST_CORNER).all():
            return None
    normals = surface.normals_at(points, elements, SURFACE_TOLERANCE * edge)
    if normals is None or not all_facing(points, elements, normals):
        return None
    if has_doubles(elements, len(points)):
        return None
    if not surface.is_covered(patch, points, elements, SURFACE_TOLERANCE * edge):
        return None
    return points, elements


def recombine(points: Floats, trias: Ints) -> Ints:
    """Pair trias (T, 3) to quads, as many as can be and good ones first; (M, 4) elements."""
    neighbours = tria_neighbours(trias, len(points))
    shapes = pair_shapes(points, trias, neighbours)
    allowed = np.where(shapes < LEAST_PAIR, np.int32(-1), neighbours)
    mate = match_completely(allowed, shapes, match_greedily(allowed, shapes, GOOD_PAIR))
    elements: Ints = merge_pairs(trias, neighbours, mate)
    return elements
