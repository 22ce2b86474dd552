"""What one operation costs: ``python -m benchmarks.operations``.

ReplaceNode is measured on the plate with the paper's settings, in individuals of 10 merges a second
on one core. Remesh is measured on patches of tiled plates against the bare pymeshlab call: the same
trias with the same collar, put into a fresh MeshSet, remeshed and read back, and nothing else. The
pairing, the smoothing, the guards and the quality are on our side alone.

Every other operation is measured on the plate by the time to build its search space, which judges
each of its sites as an edit of its own, and to score individuals in it, over the number of sites
and individuals. What all operations share is not in it: the topology and the tally of the mesh.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Iterator

import numpy as np
import pymeshlab

from benchmarks.report import Row, parser, publish
from benchmarks.tiling import tiled
from meshops._core import collar_apexes
from meshops.criteria import PAPER
from meshops.examples import plate
from meshops.fitness import Fitness
from meshops.mesh import Floats, Ints, ShellMesh
from meshops.operations import (
    ALL_OPERATIONS,
    Operation,
    Remesh,
    RemeshRanges,
    ReplaceNodePairs,
)
from meshops.operations.sites import SiteOperation
from meshops.patch import Patch, components, extract
from meshops.remesher import isotropic_options
from meshops.remeshing import TRIA_OF_QUAD, replace_patch
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece

INDIVIDUALS = 20_000
REPEATS = 15

SCORED = 200
"""Individuals of each other operation."""

MEASURED = 50_000
"""Individuals of ReplaceNodeGA a second that must be reached with full compound Q.I."""

REMESH_RATIO = 1.5
"""Remesh over the bare pymeshlab call that must not be exceeded."""

REMESHED = (20, 60, 160, 400)
"""Elements of the patches."""

MICROSECONDS = 20.0
"""Of a site or an individual of each other operation."""


def individuals_a_second(workpiece: Workpiece, *, measured: bool) -> float:
    """Score individuals of the paper's ReplaceNodeGA on the workpiece; the best of the repeats."""
    rng = np.random.default_rng(1)
    space = ReplaceNodePairs().search_space(workpiece, rng)
    if space is None:
        raise ValueError("the mesh has no pairs to merge")
    genomes = space.draw(rng, INDIVIDUALS)
    space.tallies(genomes[:1], measured=measured)
    seconds = min(_time(lambda: space.tallies(genomes, measured=measured)) for _ in range(5))
    return INDIVIDUALS / seconds


def remesh_ratio(workpiece: Workpiece, elements: int) -> tuple[float, float, float]:
    """Time Remesh and the bare call in turn on a patch of about so many elements.

    Returns milliseconds of Remesh, of the bare call, and the median ratio of pairs.
    """
    rows = _patch_rows(workpiece, elements)
    patch = extract(workpiece.topology, rows)
    bare = _bare_call(patch)
    for _ in range(3):
        replace_patch(workpiece, rows)
        bare()
    pairs = [(_time(lambda: replace_patch(workpiece, rows)), _time(bare)) for _ in range(REPEATS)]
    ours, theirs = (statistics.median(column) for column in zip(*pairs, strict=True))
    return ours * 1e3, theirs * 1e3, statistics.median(a / b for a, b in pairs)


def microseconds(operation: Operation, workpiece: Workpiece) -> tuple[float, int]:
    """Build the search space of an operation and score individuals in it.

    Returns the time for each site and individual, the best of the repeats, and how many there are.
    """
    judged = 0
    if isinstance(operation, SiteOperation):
        judged = len(operation.candidates(workpiece))

    def score() -> None:
        rng = np.random.default_rng(1)
        space = operation.search_space(workpiece, rng)
        if space is not None:
            space.evaluate(space.draw(rng, SCORED))

    score()
    seconds = min(_time(score) for _ in range(REPEATS))
    return 1e6 * seconds / (judged + SCORED), judged + SCORED


def _patch_rows(workpiece: Workpiece, elements: int) -> Ints:
    """Rows of the elements nearest to a corner of the mesh that make one patch."""
    mesh = workpiece.mesh
    centres = mesh.points[mesh.elements[:, :3]].mean(axis=1)
    distance = np.abs(centres - mesh.points.min(axis=0)).max(axis=1)
    chosen = np.zeros(len(mesh.elements), bool)
    chosen[np.argsort(distance, kind="stable")[:elements]] = True
    return max(components(workpiece.topology, chosen), key=len)


def _bare_call(patch: Patch) -> Callable[[], tuple[Floats, Ints]]:
    surface = PatchSurface.of(patch.points, patch.elements)
    size = TRIA_OF_QUAD * surface.mean_edge(patch)
    apexes = collar_apexes(patch.points, surface.trias, patch.border)
    outer = np.arange(len(patch.points), len(patch.points) + len(apexes), dtype=np.int32)
    collar = np.column_stack([patch.border[:, ::-1], outer]).astype(np.int32)
    points, trias = np.concatenate([patch.points, apexes]), np.concatenate([surface.trias, collar])
    selected = (np.arange(len(trias)) < len(surface.trias)).astype(np.float64)

    def call() -> tuple[Floats, Ints]:
        meshes = pymeshlab.MeshSet(verbose=False)
        meshes.add_mesh(pymeshlab.Mesh(points, trias, f_scalar_array=selected))
        meshes.compute_selection_by_scalar_per_face(minq=0.5, maxq=2.0)
        meshes.meshing_isotropic_explicit_remeshing(**isotropic_options(size))
        mesh = meshes.current_mesh()
        return mesh.vertex_matrix(), mesh.face_matrix()

    return call


def _time(call: Callable[[], object]) -> float:
    started = time.perf_counter()
    call()
    return time.perf_counter() - started


def _workpiece(mesh: ShellMesh) -> Workpiece:
    return Workpiece(mesh, Setting(PAPER.at(5.0), Fitness("trias", len(mesh.elements))))


def main() -> None:
    """Measure all operations."""
    options = parser(__doc__).parse_args()
    workpiece = _workpiece(plate())
    rows = [*_replace_node_rows(workpiece), *_remesh_rows(), *_other_rows(workpiece)]
    publish("Cost of one operation, one core", rows, {}, options)


def _replace_node_rows(workpiece: Workpiece) -> Iterator[Row]:
    for measured in (False, True):
        speed = individuals_a_second(workpiece, measured=measured)
        case = f"ReplaceNode, 10 merges, {'full compound Q.I.' if measured else 'trias counted'}"
        yield Row(case, f"{speed:,.0f} a second", f">= {MEASURED:,}", speed >= MEASURED)


def _remesh_rows() -> Iterator[Row]:
    workpiece = _workpiece(tiled(4 * max(REMESHED)))
    for elements in REMESHED:
        ours, bare, ratio = remesh_ratio(workpiece, elements)
        yield Row(
            f"Remesh of {elements} elements",
            f"{ours:.2f} ms, bare pymeshlab {bare:.2f} ms, ratio {ratio:.2f}",
            f"<= {REMESH_RATIO}",
            ratio <= REMESH_RATIO,
        )


def _other_rows(workpiece: Workpiece) -> Iterator[Row]:
    for operation in ALL_OPERATIONS:
        if isinstance(operation, Remesh | RemeshRanges | ReplaceNodePairs):
            continue
        cost, count = microseconds(operation, workpiece)
        measured = f"{cost:.1f} µs, {count} sites and individuals"
        yield Row(operation.name, measured, f"<= {MICROSECONDS:g} µs", cost <= MICROSECONDS)


if __name__ == "__main__":
    main()
