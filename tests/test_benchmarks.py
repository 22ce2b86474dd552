"""The benchmarks' parts and measures: what the table of the README rests on."""

import subprocess
import sys
from itertools import pairwise
from math import atan2, hypot, pi

import numpy as np
import pytest
from hypothesis import given, settings

from benchmarks.isolation import IsolatedError, isolated
from benchmarks.killing import Killer, descendants
from benchmarks.measures import (
    Shape,
    parity_bound,
    scaled_jacobians,
    singular_nodes,
    stretches,
    tapers,
)
from benchmarks.parts import PARTS, circle, segments
from benchmarks.scale import needed
from benchmarks.tiling import tiled
from benchmarks.trivial import trivial_schedule, trivial_work
from benchmarks.validity import faults
from islands.archipelago import Archipelago, Mode
from islands.executors.local import LocalExecutor
from meshops.criteria import PAPER
from meshops.examples import plate
from meshops.mesh import ShellMesh
from meshops.topology import topology
from tests.meshes import FLAT_KINDS, annulus, meshes, sheet, with_, zones

SQUARE = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])


def outline_of(loop, step=0.02):
    """Points along a loop, arcs followed the shorter way round."""
    found = []
    for part in segments(loop):
        (x0, y0), (x1, y1) = part.start, part.end
        share = np.arange(0.0, 1.0, step)[:, None]
        if part.centre is None:
            found.append(part.start + share * np.subtract(part.end, part.start))
            continue
        cx, cy = part.centre
        start = atan2(y0 - cy, x0 - cx)
        turn = (atan2(y1 - cy, x1 - cx) - start + pi) % (2 * pi) - pi
        angle = start + turn * share[:, 0]
        radius = hypot(x0 - cx, y0 - cy)
        found.append(np.column_stack([cx + radius * np.cos(angle), cy + radius * np.sin(angle)]))
    return np.concatenate(found)


def enclosed(outline):
    x, y = outline.T
    return 0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1))


def test_a_circle_is_four_arcs():
    parts = segments(circle(3.0, 4.0, 2.0))
    assert [part.centre for part in parts] == [pytest.approx((3.0, 4.0))] * 4
    assert enclosed(outline_of(circle(3.0, 4.0, 2.0))) == pytest.approx(4 * pi, rel=1e-3)


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.name)
def test_parts_are_closed_smooth_and_keep_their_holes_inside(part):
    for loop in (part.outline, *part.holes):
        parts = segments(loop)
        assert all(one.end == other.start for one, other in pairwise([*parts, parts[0]]))
        for segment in parts:
            if segment.centre is not None:
                radius = hypot(*np.subtract(segment.start, segment.centre))
                assert hypot(*np.subtract(segment.end, segment.centre)) == pytest.approx(radius)
        assert enclosed(outline_of(loop)) > 0
    outer = outline_of(part.outline)
    for k, hole in enumerate(part.holes):
        inner = outline_of(hole)
        for other in (outer, *(outline_of(h) for h in part.holes[:k])):
            gaps = np.linalg.norm(inner[:, None] - other[None], axis=2)
            assert gaps.min() > 0.6 * part.size, "no room for an element"


def test_parts_are_the_same_in_every_process():
    assert isolated(_outlines, timeout=30.0) == _outlines()


def _outlines():
    return [segments(loop) for part in PARTS for loop in (part.outline, *part.holes)]


def test_isolation_tells_what_went_wrong():
    assert isolated(max, 3, 4, timeout=30.0) == 4
    with pytest.raises(IsolatedError, match="ZeroDivisionError"):
        isolated(divmod, 1, 0, timeout=30.0)
    with pytest.raises(IsolatedError, match="exit code 3"):
        isolated(_leave, timeout=30.0)
    with pytest.raises(IsolatedError, match="no answer"):
        isolated(_hang, timeout=0.2)


def _leave():
    import os

    os._exit(3)


def _hang():
    import time

    time.sleep(60.0)


def random_quads(count, seed):
    rng = np.random.default_rng(seed)
    return SQUARE + rng.uniform(-0.3, 0.3, (count, 4, 3))


def as_mesh(corners):
    count, size = corners.shape[:2]
    elements = np.full((count, 4), -1)
    elements[:, :size] = np.arange(count * size).reshape(count, size)
    return ShellMesh.build(corners.reshape(-1, 3), elements)


def test_shapes_agree_with_verdict():
    model = pytest.importorskip("vtkmodules.vtkCommonDataModel")
    verdict = pytest.importorskip("vtkmodules.vtkFiltersVerdict").vtkMeshQuality
    quads = random_quads(300, seed=1)
    trias = quads[:, :3]
    found = (
        scaled_jacobians(as_mesh(quads)),
        stretches(quads),
        tapers(quads),
        scaled_jacobians(as_mesh(trias)),
    )
    for quad, ours in zip(quads, zip(*found, strict=True), strict=True):
        cell, tria = model.vtkQuad(), model.vtkTriangle()
        for i, point in enumerate(quad):
            cell.GetPoints().SetPoint(i, point)
        for i, point in enumerate(quad[:3]):
            tria.GetPoints().SetPoint(i, point)
        theirs = (
            verdict.QuadScaledJacobian(cell),
            verdict.QuadStretch(cell),
            verdict.QuadTaper(cell),
            verdict.TriangleScaledJacobian(tria),
        )
        assert ours == pytest.approx(theirs, abs=1e-9)


def test_a_regular_mesh_has_the_best_figures():
    shape = Shape.of(sheet(5, 4), PAPER.at(1.0))
    assert (shape.singular_nodes, shape.index) == (0, 0.0)
    assert (shape.scaled_jacobian, shape.stretch) == pytest.approx((1.0, 1.0))
    assert shape.taper == pytest.approx(0.0, abs=1e-12)
    assert singular_nodes(annulus()) == 0


def test_a_split_quad_makes_its_inner_nodes_singular():
    mesh = sheet(3, 3)
    middle = next(
        row for row, nodes in enumerate(mesh.elements) if np.all(mesh.points[nodes, :2] % 3 != 0)
    )
    a, b, c, d = mesh.elements[middle]
    elements = [*np.delete(mesh.elements, middle, axis=0), (a, b, c, -1), (a, c, d, -1)]
    assert singular_nodes(ShellMesh.build(mesh.points, elements)) == 2


@settings(deadline=None, max_examples=60)
@given(mesh=meshes(FLAT_KINDS))
def test_the_parity_bound_counts_zones_with_an_odd_border(mesh):
    if mesh.locked_elements.any() or mesh.locked_nodes.any():
        return
    bound = parity_bound(mesh)
    assert bound <= np.count_nonzero(mesh.is_tria)
    assert (np.count_nonzero(mesh.is_tria) - bound) % 2 == 0
    if bound:
        assert any(zone.sides % 2 for zone in zones(mesh))


def test_the_plate_cannot_do_without_a_tria():
    assert parity_bound(plate()) == 1


def test_tiles_are_one_mesh_with_equal_shares_of_bad_elements():
    tile, mesh = plate(), tiled(6 * len(plate().elements))
    found = topology(mesh)
    assert (len(mesh.elements), mesh.is_tria.sum()) == (6 * len(tile.elements), 6 * 11)
    assert mesh.locked_elements.sum() == 6 * tile.locked_elements.sum()
    assert found.uses.max() == 2
    # the sides of two by three plates, and six holes
    assert found.is_border.sum() == 2 * (2 + 3) * 20 + 6 * 19
    assert faults(mesh, mesh) == []


def test_faults_of_a_mesh_are_told():
    mesh = sheet(4, 4)
    inner = next(row for row, p in enumerate(mesh.points) if np.all(p[:2] % 4 != 0))
    locked = with_(mesh, locked_nodes=np.arange(len(mesh.points)) == inner)
    moved = mesh.points.copy()
    moved[inner] += (0.1, 0.1, 0.0)
    assert faults(mesh, with_(mesh, points=moved)) == []
    assert faults(locked, with_(locked, points=moved)) == ["a locked node moved"]
    moved[inner] += (2.0, 0.0, 0.0)
    assert faults(mesh, with_(mesh, points=moved)) == ["an element is not convex"]
    less = ShellMesh.build(mesh.points, np.delete(mesh.elements, 5, axis=0))
    assert faults(mesh, less) == ["the area changed", "a hole opened or closed"]
    twice = ShellMesh.build(mesh.points, [*mesh.elements, mesh.elements[5]])
    assert "more than two elements meet at an edge" in faults(mesh, twice)


# --- engine, scale, faults ----------------------------------------------------------------------


def test_a_trivial_problem_scores_individuals_and_carries_its_payload() -> None:
    work = trivial_work(1000)
    assert {len(operation.payload) for operation in work.problem.operations} == {1000}
    archipelago = Archipelago(0, work, trivial_schedule(2, 3, 4, 2))
    *_, last = LocalExecutor().evolve([archipelago])
    assert last.generation == 3
    assert all(state.performed >= 110 for state in last.islands)


@pytest.mark.parametrize(("mode", "expected"), [("synchronous", 3.0 + 3.0), ("overlapped", 4.0)])
def test_what_a_schedule_needs_is_its_longest_chain_of_steps(mode: Mode, expected: float) -> None:
    """Two islands that take 1 and 3 seconds in turn: whoever need not wait is done earlier."""
    schedule = trivial_schedule(2, 2, 1, 1, mode)
    assert needed(schedule, np.array([[1.0, 3.0], [3.0, 1.0]]), 2) == expected
    assert needed(schedule, np.array([[1.0, 3.0], [3.0, 1.0]]), 1) == 8.0


def test_a_killer_takes_its_own_descendants_by_name() -> None:
    above = (
        "import subprocess, sys; subprocess.run(['sleep', '60']); subprocess.run(['sleep', '0'])"
    )
    with subprocess.Popen([sys.executable, "-c", above]) as process:
        with Killer(process.pid, 60.0, ("sleep",)) as killer:
            process.wait(30)
        assert killer.killed == 1
    assert descendants(process.pid) == []
