"""What a mesh is judged by: one value for reports, pictures and files."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.assessment import Assessment
from meshops.criteria import PAPER, STANDARD
from meshops.failures import SIZE_ALONE, csv_text, failures
from meshops.fitness import Fitness
from meshops.formats.locks import Lock
from meshops.mesh import ShellMesh
from meshops.quality import chordal_deviation, failed_elements
from meshops.quality_index import quality_index
from meshops.sizing import SizeSamples, Uniform
from meshops.workpiece import Setting, Workpiece
from tests.decks import bad_plate
from tests.meshes import CURVED_KINDS, FLAT_KINDS, meshes


def graded(columns=9, rows=3, growth=1.3):
    """Quads that become larger from left to right, each about as long as it is high."""
    x = np.concatenate([[0.0], np.cumsum(growth ** np.arange(columns))])
    grid = [[x[i], j * growth ** (i / 2), 0.0] for i in range(columns + 1) for j in range(rows + 1)]
    n = rows + 1
    quads = [
        [i * n + j, (i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1]
        for i in range(columns)
        for j in range(rows)
    ]
    return ShellMesh.build(grid, quads)


@settings(max_examples=25, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS), st.floats(0.2, 5.0))
def test_it_judges_as_the_report_and_the_search_do(mesh, size):
    assessment = Assessment(PAPER.at(size))
    assert assessment.quality(mesh) == quality_index(mesh, PAPER.at(size))
    np.testing.assert_array_equal(assessment.failing(mesh), failed_elements(mesh, PAPER.at(size)))


def test_reports_elements_and_the_search_agree_under_a_size_field():
    mesh = graded()
    sizes = SizeSamples.of(mesh)
    assessment = Assessment(PAPER.at(2.0), sizes, "local")
    report = assessment.quality(mesh)
    setting = Setting(PAPER.at(2.0), Fitness("quality", len(mesh.elements)), sizes=sizes)
    work = Workpiece(mesh, setting)
    assert report.failed == assessment.failing(mesh).sum() == work.failing.sum()
    np.testing.assert_array_equal(assessment.failing(mesh), work.failing)
    # the same mesh at one size has others
    assert report.failed != Assessment(PAPER.at(2.0)).quality(mesh).failed


@given(st.floats(0.1, 10.0))
def test_a_field_that_is_the_same_everywhere_is_a_size(size):
    mesh = bad_plate()
    even, field = Assessment(PAPER.at(size)), Assessment(PAPER.at(1.0), Uniform(size), "file")
    assert field.quality(mesh).failed == even.quality(mesh).failed
    for one, other in zip(
        failures(mesh, field, feature_angle=30.0),
        failures(mesh, even, feature_angle=30.0),
        strict=True,
    ):
        # values and limits are those of the deck, whatever lengths are brought to
        assert one.criterion == other.criterion
        assert one.value == pytest.approx(other.value)
        assert one.limit == pytest.approx(other.limit)


def arc(steps, radius=10.0, width=3.0, angle=np.pi / 2):
    turn = np.linspace(0, angle, steps + 1)
    ring = np.c_[radius * np.cos(turn), radius * np.sin(turn)]
    points = np.concatenate([np.c_[ring, 0 * turn], np.c_[ring, 0 * turn + width]])
    n = steps + 1
    return ShellMesh.build(points, [[i, i + 1, n + i + 1, n + i] for i in range(steps)])


def test_chordal_deviation_of_a_run_is_measured_from_the_mesh_that_it_began_with():
    fine, coarse = arc(32), arc(4)
    sagitta = 10 * (1 - np.cos(np.pi / 16))
    report = Assessment(STANDARD.at(1.0), reference=fine).quality(coarse)
    assert report.rows[10].active
    assert report.rows[10].worst == pytest.approx(sagitta, rel=0.05)
    assert report.failed_by_shape == 4
    assert Assessment(STANDARD.at(1.0), reference=fine).quality(fine).rows[10].worst == 0.0


def test_what_has_not_changed_lies_on_the_reference_and_the_rest_is_measured_as_ever():
    fine = arc(32)
    moved = fine.points.copy()
    moved[5] *= (1.02, 1.02, 1.0)
    mesh = ShellMesh.build(moved, fine.elements)
    found = chordal_deviation(mesh, fine)
    assert np.flatnonzero(found).tolist() == [4, 5]
    # the same surface described by other nodes knows none of its edges: all is measured
    renumbered = ShellMesh.build(fine.points + 1e-12, fine.elements)
    assert chordal_deviation(mesh, renumbered) == pytest.approx(found, abs=1e-9)


def test_nothing_deviates_from_a_plane():
    mesh = bad_plate()
    assert Assessment(PAPER.at(5.0), reference=mesh).quality(mesh) == (
        Assessment(PAPER.at(5.0)).quality(mesh)
    )


def test_document_has_the_whole_levels():
    document = json.loads(json.dumps(Assessment(PAPER.at(4.0)).document()))
    assert (document["criteria"], document["size"], document["gradation"]) == ("paper", 4.0, "even")
    assert document["levels"]["aspect ratio"]["fail"] == 3.0
    assert document["levels"]["min size"]["scaled"] is True


def test_failures_name_place_value_limit_family_and_why():
    # two quads side by side, the second one too long; its far nodes are held by a card
    points = [[0, 0, 0], [5, 0, 0], [21, 0, 0], [0, 5, 0], [5, 5, 0], [21, 5, 0]]
    mesh = ShellMesh.build(
        points,
        [[0, 1, 4, 3], [1, 2, 5, 4]],
        locked_nodes=[0, 0, 1, 0, 0, 1],
        element_ids=[7, 9],
        node_ids=[10, 20, 30, 40, 50, 60],
    )
    lock = Lock("nodes", 2, "SPC1", "they neither move nor vanish", (30, 60))
    listed = failures(mesh, Assessment(PAPER.at(5.0)), locks=(lock,), feature_angle=30.0)
    assert [(f.element, f.criterion, f.family) for f in listed] == [
        (9, "max length", "size"),
        (9, "aspect ratio", "size"),
    ]
    assert (listed[0].x, listed[0].y, listed[0].z) == (13.0, 2.5, 0.0)
    assert (listed[0].value, listed[0].limit) == (16.0, 7.5)
    assert "locked nodes 30, 60 (SPC1)" in listed[0].why
    assert "at a border" in listed[0].why
    assert SIZE_ALONE in listed[0].why
    rows = csv_text(listed).splitlines()
    assert rows[0] == "element,x,y,z,criterion,value,limit,family,why"
    assert rows[1].startswith("9,13.0,2.5,0.0,max length,16.0,7.5,size,")


@settings(max_examples=20, deadline=None)
@given(meshes(FLAT_KINDS + CURVED_KINDS))
def test_every_failing_element_is_listed_with_what_breaks_its_limit(mesh):
    assessment = Assessment(PAPER.at(0.9))
    listed = failures(mesh, assessment, feature_angle=30.0, otherwise="tried in vain")
    failing = mesh.element_ids[assessment.failing(mesh)].tolist()
    assert sorted({f.element for f in listed}) == sorted(set(failing))
    for failure in listed:
        falls = failure.criterion in ("min size", "min angle quad", "min angle tria", "Jacobian")
        assert failure.value < failure.limit if falls else failure.value > failure.limit
        assert failure.why
    report = assessment.quality(mesh)
    shapes = {f.element for f in listed if f.family == "shape"}
    assert len(shapes) == report.failed_by_shape
    assert len(set(failing)) - len(shapes) == report.failed_by_size


def test_barriers_are_told_by_their_kind():
    # three walls at one line, a step between two properties, and an element that is locked
    points = [[x, y, 0] for x in (0, 4) for y in (0, 1, 2)] + [[4, 0, 4], [4, 1, 4], [8, 0, 0]]
    points += [[8, 1, 0], [4, 5, 0], [0, 5, 0]]
    elements = [[0, 3, 4, 1], [1, 4, 5, 2], [3, 8, 9, 4], [3, 6, 7, 4], [2, 5, 10, 11]]
    mesh = ShellMesh.build(
        points, elements, region=[0, 1, 0, 0, 1], locked_elements=[0, 0, 0, 0, 1]
    )
    why = {
        f.element: f.why
        for f in failures(mesh, Assessment(PAPER.at(1.0)), locks=(), feature_angle=30.0)
    }
    assert "at a T-junction" in why[1]
    assert "at an edge between two properties" in why[1]
    assert "beside a locked element" in why[2]
    assert "locked by other cards" in why[5]
