"""Holes of CAD parts stay holes, however coarse the size; nothing comes out on the same nodes."""

from math import pi
from pathlib import Path

import numpy as np
import pytest

from meshops.geometry import mesh_geometry, same_nodes
from meshops.mesh import ShellMesh
from meshops.opposites import Face, Line, matched_divisions
from meshops.topology import topology
from tests.meshes import unsound

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "other"


@pytest.fixture
def cad(tmp_path):
    """Write what a function draws with gmsh's OpenCASCADE as a STEP file."""
    gmsh = pytest.importorskip("gmsh")

    def write(draw):
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            gmsh.option.setNumber("General.Terminal", 0)
            draw(gmsh.model.occ)
            gmsh.model.occ.synchronize()
            gmsh.write(str(tmp_path / "part.step"))
        finally:
            gmsh.finalize()
        return tmp_path / "part.step"

    return write


def arcs(occ, count, radius, *, stretch=0.0):
    """Arcs of a circle about (50, 30); with a stretch, half circles drawn apart to a slot."""
    x, y = 50.0, 30.0
    if stretch:
        return _slot(occ, x, y, radius, stretch)
    angles = 2 * pi * np.arange(count) / count
    points = [occ.addPoint(x + radius * np.cos(a), y + radius * np.sin(a), 0) for a in angles]
    between = angles + pi / count
    tops = [occ.addPoint(x + radius * np.cos(a), y + radius * np.sin(a), 0) for a in between]
    ends = [*points[1:], points[0]]
    return [
        occ.addCircleArc(a, top, b, center=False)
        for a, top, b in zip(points, tops, ends, strict=True)
    ]


def _slot(occ, x, y, radius, stretch):
    right, left = x + stretch, x - stretch
    corners = [(right, y - radius), (right, y + radius), (left, y + radius), (left, y - radius)]
    a, b, c, d = (occ.addPoint(u, v, 0) for u, v in corners)
    one, other = occ.addPoint(right + radius, y, 0), occ.addPoint(left - radius, y, 0)
    return [
        occ.addCircleArc(a, one, b, center=False),
        occ.addLine(b, c),
        occ.addCircleArc(c, other, d, center=False),
        occ.addLine(d, a),
    ]


def plate(occ, hole, *, thickness):
    corners = [(0, 0), (100, 0), (100, 60), (0, 60)]
    points = [occ.addPoint(x, y, 0) for x, y in corners]
    rim = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(rim), occ.addCurveLoop(hole)])
    if thickness:
        occ.extrude([(2, face)], 0, 0, thickness)


def rims(mesh: ShellMesh):
    """Number of edges of the holes of a sheet, or of those between plane faces and other walls."""
    found = topology(mesh, feature_angle=50.0)
    edges = found.edges[~found.crossable]
    x, y, _ = mesh.points[edges].mean(axis=1).T
    inside = (x > 5) & (x < 95) & (y > 5) & (y < 55)
    z = mesh.points[edges][:, :, 2]
    return {float(level): int((inside & (z == level).all(axis=1)).sum()) for level in np.unique(z)}


@pytest.mark.parametrize("thickness", [0.0, 5.0])
@pytest.mark.parametrize("count", [2, 3, 4, 5])
@pytest.mark.parametrize(("radius", "size"), [(3.3, 15.0), (0.4, 12.0), (12.0, 30.0)])
def test_a_hole_keeps_elements_around_it(cad, thickness, count, radius, size):
    part = cad(lambda occ: plate(occ, arcs(occ, count, radius), thickness=thickness))
    mesh = mesh_geometry(part, size)
    assert len(same_nodes(mesh)) == 0
    assert unsound(mesh) == []
    for edges in rims(mesh).values():
        assert edges >= 4
    if thickness:
        assert (topology(mesh).uses == 2).all()


@pytest.mark.parametrize("thickness", [0.0, 5.0])
def test_a_slot_keeps_its_round_ends(cad, thickness):
    part = cad(lambda occ: plate(occ, arcs(occ, 4, 2.0, stretch=9.0), thickness=thickness))
    mesh = mesh_geometry(part, 15.0)
    assert len(same_nodes(mesh)) == 0
    assert all(edges >= 8 for edges in rims(mesh).values())


def test_faces_that_would_fall_onto_each_other_are_divided_more_finely(cad):
    """A pillow: a plane and a bulge on the same four edges, of one division each."""

    def pillow(occ):
        points = [occ.addPoint(x, y, 0) for x, y in [(0, 0), (10, 0), (10, 10), (0, 10)]]
        rim = [occ.addLine(a, b) for a, b in zip(points, [*points[1:], points[0]], strict=True)]
        loop = occ.addCurveLoop(rim)
        occ.addPlaneSurface([loop])
        occ.addSurfaceFilling(loop, pointTags=[occ.addPoint(5, 5, 3)])

    mesh = mesh_geometry(cad(pillow), 10.0)
    assert len(same_nodes(mesh)) == 0
    assert (topology(mesh).uses == 2).all()
    assert len(mesh.elements) > 2


def test_a_bar_with_two_sides_is_no_crash(cad):
    """Its ends have two edges, of one division each at this size."""

    def bar(occ):
        both = [occ.addCylinder(0, y, 0, 0, 0, 30.0, 10.0) for y in (-9.0, 9.0)]
        occ.intersect([(3, both[0])], [(3, both[1])])

    mesh = mesh_geometry(cad(bar), 40.0)
    assert len(same_nodes(mesh)) == 0
    assert (topology(mesh).uses == 2).all()


def test_a_rounded_rim_may_still_become_one_row():
    stadium = Face(30.0, ((1, 2, 3, 4),))
    lines = {1: Line(20.0), 2: Line(2.4, 180.0), 3: Line(20.0), 4: Line(2.4, 180.0)}
    found = matched_divisions([stadium], lines, 15.0)
    assert found[2] == found[4] == 1
    disc = Face(1.8, ((2, 4),))
    assert matched_divisions([disc], lines, 15.0) == {2: 3, 4: 3}


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
@pytest.mark.parametrize("name", ["f09_plate_hole_two_halves", "f09b_plate_hole_one_face"])
def test_the_plates_with_a_hole(name):
    pytest.importorskip("gmsh")
    mesh = mesh_geometry(FAULTS / f"{name}.step", 15.0)
    assert len(same_nodes(mesh)) == 0
    assert all(4 <= edges <= 8 for edges in rims(mesh).values())
