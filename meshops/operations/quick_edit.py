"""QuickEdit: rings of quads around a hole (the paper's section 4.1 makes its test piece so)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from meshops._core import all_facing, has_doubles, nearest_edges, unit_normals, valid_elements
from meshops.edit import Edit
from meshops.holes import Hole, border_loops, border_sides, holes
from meshops.mesh import Floats, Ids, Ints
from meshops.methods import METHODS, Method
from meshops.patch import Patch, components, extract, join, stitch
from meshops.quality_sums import TALLY_SIZE
from meshops.remeshing import (
    LEAST_CORNER,
    SURFACE_TOLERANCE,
    remesh_patch,
    replacement_change,
)
from meshops.surface import PatchSurface
from meshops.workpiece import Workpiece

MOST_RINGS = 3

THICKNESSES = (50, 75, 100, 125, 150)
"""What the search chooses from, in percent of the element size."""

SHARPEST_MITRE = 2.0
"""A corner of a ring is at most this many thicknesses away from that of the hole."""

TRANSITION = 2.0
"""Width around the rings that is meshed anew, in elements."""

_TINY = float(np.finfo(np.float64).tiny)
"""Instead of 0 below a fraction: an edge without length sets nothing off."""


@dataclass(frozen=True)
class QuickEdit:
    """Put rings of quads around a hole and mesh anew between them and the elements farther out.

    A ring has as many quads as the hole's border has edges. The border stays node for node. A
    parameter row is (rank of the hole from 1, rings, thickness of a ring in percent of the element
    size, method of meshing outside the rings); holes near a bad element come first.
    """

    name: str = "quick-edit"
    code: int = 20

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> QuickEditSpace | None:
        """One hole a genome; the random generator is not needed."""
        found = holes(workpiece)
        return QuickEditSpace(workpiece, found) if found else None

    def apply(self, workpiece: Workpiece, parameters: Ints) -> Edit:
        """Surround holes (K, 4); one that is in the way of an earlier one is left out."""
        found = holes(workpiece)
        taken = np.zeros(len(workpiece.mesh.elements), bool)
        edits = []
        for rank, rings, thickness, method in parameters.tolist():
            if rings < 1 or thickness < 1 or not 0 <= method < len(METHODS):
                raise ValueError(
                    f"a hole has no {rings} rings of {thickness} percent by method {method}"
                )
            if not 1 <= rank <= len(found):
                continue
            edit, _ = surround(
                workpiece, found[rank - 1], rings, thickness / 100.0, METHODS[method]
            )
            if not taken[edit.removed].any():
                taken[edit.removed] = True
                edits.append(edit)
        return join(workpiece.mesh, edits)

    def format(self, parameters: Ints) -> str:
        """Write holes as ``2:3x75% front``: the rank, how many rings, how thick, and the method."""
        return " ".join(
            f"{rank}:{rings}x{thickness}% {METHODS[method].name}"
            for rank, rings, thickness, method in parameters
        )


class QuickEditSpace:
    """A hole, how many rings, how thick, and the method. What was tried once is remembered."""

    def __init__(self, workpiece: Workpiece, found: list[Hole]) -> None:
        self.workpiece = workpiece
        self.holes = found
        self.bounds: Ids = np.array(
            [len(found), MOST_RINGS, len(THICKNESSES), len(METHODS)], np.int64
        )
        self._tallies: dict[bytes, Floats] = {}

    def draw(self, rng: np.random.Generator, count: int) -> Ids:
        """Numbers drawn evenly."""
        return rng.integers(0, self.bounds, (count, len(self.bounds)))

    def parameters(self, genome: Ids) -> Ints:
        """(1, 4): hole from 1, rings, thickness in percent, method; no row where it fails."""
        if not np.isfinite(self.tally(genome)).all():
            return np.zeros((0, 4), np.int32)
        hole, rings, thickness, method = genome
        return np.array([[hole + 1, rings + 1, THICKNESSES[thickness], method]], np.int32)

    def evaluate(self, genomes: Ids) -> Floats:
        """Surround the hole of each genome."""
        return np.stack([self.tally(genome) for genome in genomes])

    def tally(self, genome: Ids) -> Floats:
        """Tally of the mesh with one hole surrounded; NaN where the rings do not fit."""
        key = genome.tobytes()
        if key not in self._tallies:
            hole, rings, thickness, method = genome.tolist()
            edit, change = surround(
                self.workpiece,
                self.holes[hole],
                rings + 1,
                THICKNESSES[thickness] / 100.0,
                METHODS[method],
            )
            self._tallies[key] = self.workpiece.tally + (np.nan if edit.is_empty else change)
        return self._tallies[key]


def surround(
    workpiece: Workpiece, hole: Hole, rings: int, thickness: float, method: Method
) -> tuple[Edit, Floats]:
    """Put rings around one hole; the edit, empty where they do not fit, and its tally change.

    `thickness` is that of one ring, over the element size: that of the run, or else the mean edge
    of the hole's border.
    """
    patch, loop = _cut_out(workpiece, hole, rings * thickness)
    made = None if loop is None else _ringed(workpiece, patch, loop, rings, thickness, method)
    if made is None:
        return Edit(), np.zeros(TALLY_SIZE)
    points, elements = made
    edit = stitch(workpiece.mesh, patch, points[patch.border_nodes :], elements)
    return edit, replacement_change(workpiece, patch, points, elements, edit)


def _cut_out(workpiece: Workpiece, hole: Hole, width: float) -> tuple[Patch, Ints | None]:
    """Cut out what is nearer to a hole than its rings, of a width over the element size, reach.

    Also returns the border edges of the patch that go around the hole, in order; None where the
    patch does not close around it.
    """
    mesh, topology = workpiece.mesh, workpiece.topology
    border = mesh.points[hole.nodes]
    reach = (width + TRANSITION) * _size(workpiece, border)
    low, high = border.min(axis=0) - reach, border.max(axis=0) + reach
    near = ((mesh.points >= low) & (mesh.points <= high)).all(axis=1)
    distance, *_ = nearest_edges(mesh.points[near], border, np.roll(border, -1, axis=0))
    near[near] = distance <= reach
    zone = topology.zones == topology.zones[hole.elements[0]]
    selected = zone & (near[mesh.elements] & (mesh.elements >= 0)).any(axis=1)
    rows = next(r for r in components(topology, selected) if hole.elements[0] in r)
    patch = extract(topology, rows)
    for loop in border_loops(patch):
        ends = patch.nodes[patch.border[loop]]
        if len(loop) == len(hole.nodes) and (ends == hole.nodes[:2]).all(axis=1).any():
            return patch, loop
    return patch, None


def _ringed(
    workpiece: Workpiece, patch: Patch, loop: Ints, rings: int, thickness: float, method: Method
) -> tuple[Floats, Ints] | None:
    """Mesh a patch anew with rings around the hole that a loop of its border edges encloses.

    The patch is pressed away from the hole until the rings have room, and then remeshed: so every
    step has a mesh of the surface to work on. Returns points and elements, border nodes first;
    None where no valid mesh came out.
    """
    surface = PatchSurface.of(patch.points, patch.elements)
    reference = workpiece.reference or surface
    edge = workpiece.setting.element_size or surface.mean_edge(patch)
    inmost = patch.points[patch.border[loop, 0]]
    step = thickness * _size(workpiece, inmost) * _outward(patch, loop)
    ring_points = np.concatenate([inmost + ring * step for ring in range(1, rings + 1)])
    reference.project(ring_points, 0)
    pressed = _pressed(patch, loop, ring_points[-len(inmost) :] - inmost)
    reference.project(pressed, patch.border_nodes)
    outside = remesh_patch(
        replace(patch, points=pressed),
        PatchSurface.of(pressed, patch.elements),
        reference,
        edge,
        method.remesh,
    )
    if outside is None:
        return None
    points, elements = _assembled(patch, loop, ring_points, *outside)
    tolerance = SURFACE_TOLERANCE * edge
    normals = reference.normals_at(points, elements, tolerance)
    fits = (
        normals is not None
        and valid_elements(points, elements, LEAST_CORNER).all()
        and all_facing(points, elements, normals)
        and not has_doubles(elements, len(points))
        and surface.is_covered(patch, points, elements, tolerance)
    )
    return (points, elements) if fits else None


def _assembled(
    patch: Patch, loop: Ints, ring_points: Floats, points: Floats, elements: Ints
) -> tuple[Floats, Ints]:
    """Put quads between a hole and the mesh outside its rings, which begins at the last of them.

    `ring_points` (rings * h, 3) are ring after ring, from the hole on.
    """
    border = patch.border_nodes
    ring_rows = np.arange(border, border + len(ring_points), dtype=np.int32)
    layers = np.concatenate([patch.border[loop, 0], ring_rows]).reshape(-1, len(loop))
    ahead = np.roll(layers, -1, axis=1)
    quads = np.stack([layers[:-1], ahead[:-1], ahead[1:], layers[1:]], axis=-1).reshape(-1, 4)
    rows = np.arange(len(points), dtype=np.int32)
    rows[border:] += len(ring_points)
    rows[layers[0]] = layers[-1]
    return (
        np.concatenate([patch.points[:border], ring_points, points[border:]]),
        np.concatenate([quads, np.where(elements < 0, elements, rows[elements])]),
    )


def _pressed(patch: Patch, loop: Ints, shifts: Floats) -> Floats:
    """(n, 3) points of a patch after its nodes on a hole's border were shifted by (h, 3).

    Inner nodes go along with the nearest point of that border, the less the nearer they are to
    another border; those do not move.
    """
    points, first = patch.points.copy(), patch.border_nodes
    inner = patch.points[first:]
    starts, ends = patch.points[patch.border].transpose(1, 0, 2)
    others = np.setdiff1d(np.arange(len(patch.border)), loop)
    to_hole, edge, along = nearest_edges(inner, starts[loop], ends[loop])
    share = np.ones(len(inner))
    if len(others):
        to_others, *_ = nearest_edges(inner, starts[others], ends[others])
        share = to_others / (to_hole + to_others)
    along = along[:, None]
    shift = (1.0 - along) * shifts[edge] + along * np.roll(shifts, -1, axis=0)[edge]
    points[patch.border[loop, 0]] += shifts
    points[first:] += share[:, None] * shift
    return points


def _size(workpiece: Workpiece, border: Floats) -> float:
    """Element size at a hole: that of the run, or else the mean edge of the border (h, 3)."""
    edges = np.linalg.norm(np.roll(border, -1, axis=0) - border, axis=1)
    return workpiece.setting.element_size or float(edges.mean())


def _outward(patch: Patch, loop: Ints) -> Floats:
    """(h, 3) steps from a hole's nodes into the surface that set both edges off by 1."""
    ends = patch.border[loop]
    along = patch.points[ends[:, 1]] - patch.points[ends[:, 0]]
    owner, _ = border_sides(patch)
    off = np.cross(unit_normals(patch.points, patch.elements[owner[loop]]), along)
    off /= np.maximum(np.linalg.norm(off, axis=1, keepdims=True), _TINY)
    mean = 0.5 * (off + np.roll(off, 1, axis=0))
    square = np.einsum("ij,ij->i", mean, mean)[:, None]
    mitred: Floats = mean / np.maximum(np.maximum(square, np.sqrt(square) / SHARPEST_MITRE), _TINY)
    return mitred
