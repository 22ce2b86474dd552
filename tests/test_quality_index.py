"""The QualityIndex report."""

import json
from dataclasses import replace

import numpy as np
import pytest

from meshops.criteria import NAMES, PAPER, STANDARD, Criterion
from meshops.errors import InputError
from meshops.mesh import ShellMesh
from meshops.quality import (
    element_index,
    element_penalties,
    element_values,
    failed_elements,
    median_edge,
)
from meshops.quality_index import quality_index

SCORING = PAPER.at(5.0)


def strip(widths, *, trias=0, element_ids=None, height=5.0):
    """Rectangles side by side, the last of which are split into two trias each."""
    x = np.concatenate([[0.0], np.cumsum(widths)])
    n = len(x)
    points = np.concatenate([np.c_[x, 0 * x, 0 * x], np.c_[x, 0 * x + height, 0 * x]])
    quads = np.array([[i, i + 1, n + i + 1, n + i] for i in range(n - 1)]).reshape(-1, 4)
    kept, split = quads[: len(quads) - trias], quads[len(quads) - trias :]
    halves = np.stack([split[:, [0, 1, 2, 2]], split[:, [0, 2, 3, 3]]], 1).reshape(-1, 4)
    halves[:, 3] = -1
    return ShellMesh.build(points, np.concatenate([kept, halves]), element_ids=element_ids)


def lines(report):
    return report.table().splitlines()


def test_figure_5():
    # two elements of 8.00 among good ones: the figure's row of max length
    mesh = strip([5.0] * 40 + [8.0, 8.0], element_ids=np.arange(120, 162))
    report = quality_index(mesh, SCORING)
    row = report.rows[1]
    assert (row.number, row.name, row.failure, row.worst) == (2, "max length", 7.5, 8.0)
    assert row.percent_failed == pytest.approx(100 * 2 / 42)
    assert row.index == pytest.approx(8.0)
    assert row.worst_elements == ("160", "161")
    assert (report.failed, report.quads, report.trias) == (2, 42, 0)


def test_table_is_laid_out_as_figure_5():
    mesh = strip([5.0, 5.0, 8.0, 9.5, 5.0], trias=1, element_ids=[7, 8, 1234567, 0, 9, 10])
    table = lines(quality_index(mesh, SCORING))
    assert table[0] == "#   Criterion       Fails at  % failed  Worst   Q.I.  Worst elements"
    assert [line[4:18].strip() for line in table[1:14]] == list(NAMES)
    assert table[2] == ("2   max length          7.50     33.33   9.50  14.41  4*  1234567")
    assert table[4].split() == ["4", "warpage", "15.00", "0.00", "0.00", "0.00"]
    assert table[11].split() == ["11", "chordal", "dev", "1.00"]
    labels = [line.split("=")[0].strip() for line in table[14:]]
    assert labels == [
        "compound Q.I.",
        "# of quads",
        "# of trias",
        "% trias",
        "# of failed",
        "by shape",
        "by size alone",
        "mean element Q.I.",
    ]
    values = [line.split("=")[1].strip() for line in table[15:21]]
    assert values == ["4", "2", "33.33", "2", "0", "2"]


def test_table_fits_a_terminal_however_long_its_figures_are():
    wide = strip([5e9, 5.0, 8e9, 9.5, 5.0], trias=1, element_ids=[7, 8, 99999999, 99999998, 9, 10])
    table = lines(quality_index(wide, SCORING))
    assert max(map(len, table)) <= 80
    assert table[2].split()[-3:] == ["99999999", "7", "99999998"]


def test_an_element_that_fails_by_shape_and_by_size_is_counted_by_shape():
    # of size 8: too long; a rhombus of 30 degrees: its angles; both of them at once
    slim = np.array([[0, 0, 0], [5, 0, 0], [5 + 4.33, 2.5, 0], [4.33, 2.5, 0]])
    oblong, aside = strip([8.0]).points, np.array([30.0, 0.0, 0.0])
    points = np.concatenate([slim, slim * 2 + aside, oblong + 2 * aside])
    mesh = ShellMesh.build(points, [[0, 1, 2, 3], [4, 5, 6, 7], [8, 9, 11, 10]])
    report = quality_index(mesh, SCORING)
    assert (report.failed, report.failed_by_shape, report.failed_by_size) == (3, 2, 1)
    document = report.to_json()
    assert (document["failed_by_shape"], document["failed_by_size"]) == (2, 1)


def test_worst_elements_are_the_worst_three_in_order():
    mesh = strip([8.0, 12.0, 5.0, 10.0, 12.0, 11.0])
    row = quality_index(mesh, SCORING).rows[1]
    assert row.worst_elements == ("2", "5", "6")
    assert row.worst == 12.0


def test_worst_of_a_falling_criterion_is_the_smallest():
    row = quality_index(strip([5.0, 1.0, 2.0, 4.0]), SCORING).rows[0]
    assert row.worst == 1.0
    assert row.worst_elements == ("2", "3")
    assert row.percent_failed == 50.0


def test_percent_failed_is_of_the_elements_that_the_criterion_applies_to():
    mesh = strip([5.0, 5.0, 5.0, 40.0], trias=1)
    row = quality_index(mesh, SCORING).rows[NAMES.index("min angle tria")]
    assert row.percent_failed == 100.0


def test_percent_of_trias():
    report = quality_index(strip([5.0] * 4, trias=1), SCORING)
    row = report.rows[12]
    assert report.percent_trias == row.worst == 40.0
    assert (row.percent_failed, row.index, row.worst_elements) == (100.0, 10.0, ())
    assert report.failed == 0
    assert report.compound_qi > 10
    few = quality_index(strip([5.0] * 25, trias=1), SCORING)
    assert few.rows[12].percent_failed == 0.0
    assert few.rows[12].index == pytest.approx(0.8 * (few.percent_trias - 6) / 4)


def test_inactive_criteria_say_only_where_they_would_fail():
    off = PAPER.having(replace(PAPER["max length"], active=False), name="off")
    report = quality_index(strip([5.0, 50.0]), off.at(5.0))
    row = report.rows[1]
    assert (row.active, row.failure) == (False, 7.5)
    assert (row.percent_failed, row.worst, row.index, row.worst_elements) == (None, None, None, ())
    assert lines(report)[2].split() == ["2", "max", "length", "7.50"]


def test_rows_agree_with_the_element_functions():
    mesh = strip([5.0, 3.0, 8.0, 1.0, 9.0], trias=2)
    report = quality_index(mesh, SCORING)
    assert report.failed == failed_elements(mesh, SCORING).sum()
    assert report.mean_element_qi == pytest.approx(element_index(mesh, SCORING).mean())
    penalties = element_penalties(mesh, SCORING)
    for row, p in zip(report.rows, penalties.T, strict=False):
        if row.active:
            failing = p > 1
            good = p[~failing & ~np.isnan(p)]
            mean = good.mean() if len(good) else 0
            assert row.index == pytest.approx(mean + p[failing].sum())


def test_json():
    report = quality_index(strip([5.0, 8.0, 5.0], trias=1), SCORING)
    document = json.loads(json.dumps(report.to_json(), allow_nan=False))
    assert document["criteria"] == "paper"
    assert document["size"] == 5.0
    assert (document["elements"], document["quads"], document["trias"]) == (4, 2, 2)
    assert document["failed"] == 1
    assert document["compound_qi"] == report.compound_qi
    assert document["mean_element_qi"] == report.mean_element_qi
    assert document["percent_trias"] == 50.0
    assert [row["name"] for row in document["rows"]] == list(NAMES)
    assert document["rows"][1]["worst_elements"] == ["2"]


def test_an_element_without_a_length_is_reported_and_can_be_written():
    mesh = ShellMesh.build([[0, 0, 0], [5, 0, 0], [5, 0, 0], [0, 5, 0]], [[0, 1, 2, 3]])
    report = quality_index(mesh, SCORING)
    assert report.rows[2].worst == np.inf
    assert report.rows[2].index == 10.0
    document = json.loads(json.dumps(report.to_json(), allow_nan=False))
    assert document["rows"][2]["worst"] is None
    assert "inf" in lines(report)[3]


def test_small_units_keep_their_digits():
    mesh = strip([0.005, 0.008], height=0.005)
    row = lines(quality_index(mesh, PAPER.at(0.005)))[2].split()
    assert row[3:6] == ["0.00750", "50.00", "0.00800"]


def test_a_mesh_without_elements():
    report = quality_index(ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4))), SCORING)
    assert (report.elements, report.compound_qi, report.mean_element_qi) == (0, 0.0, 0.0)
    assert len(lines(report)) == 22


def bump(height):
    """Two squares over a ridge, and the same ridge raised by a height."""
    points = np.array([[x, y, 0.0] for x in (0, 1, 2) for y in (0, 1)])
    raised = points + np.array([0, 0, height])
    elements = [[0, 2, 3, 1], [2, 4, 5, 3]]
    return ShellMesh.build(points, elements), ShellMesh.build(raised, elements)


def test_chordal_deviation_is_the_distance_to_the_reference():
    scoring = STANDARD.at(1.0)
    mesh, raised = bump(0.05)
    values = element_values(mesh, scoring, raised)[:, NAMES.index("chordal dev")]
    assert values == pytest.approx([0.05, 0.05])
    row = quality_index(mesh, scoring, raised).rows[10]
    assert row.active
    assert row.worst == pytest.approx(0.05)
    assert row.index == pytest.approx(0.8 * 0.02 / 0.05)
    assert quality_index(mesh, scoring, mesh).rows[10].worst == pytest.approx(0, abs=1e-12)
    assert quality_index(mesh, scoring, bump(0.15)[1]).failed == 2


def test_chordal_deviation_needs_a_reference_and_the_criterion_to_be_active():
    scoring = STANDARD.at(1.0)
    mesh, raised = bump(9.0)
    assert np.isnan(element_values(mesh, scoring)[:, 10]).all()
    assert not quality_index(mesh, scoring).rows[10].active
    off = STANDARD.having(replace(STANDARD["chordal dev"], active=False), name="off").at(1.0)
    assert not quality_index(mesh, off, raised).rows[10].active
    assert quality_index(mesh, off, raised).failed == 0


def test_chordal_deviation_of_a_chord_is_its_sagitta():
    # a cylinder of radius 10 in fine strips, and a coarse one in it
    def cylinder(steps):
        turn = np.linspace(0, np.pi / 2, steps + 1)
        ring = np.c_[10 * np.cos(turn), 10 * np.sin(turn)]
        points = np.concatenate([np.c_[ring, 0 * turn], np.c_[ring, 0 * turn + 3]])
        n = steps + 1
        return ShellMesh.build(points, [[i, i + 1, n + i + 1, n + i] for i in range(steps)])

    values = element_values(cylinder(4), STANDARD.at(4.0), cylinder(400))[:, 10]
    assert values == pytest.approx(10 * (1 - np.cos(np.pi / 16)), rel=1e-3)


def test_a_reference_may_have_elements_without_area_but_not_none():
    mesh, raised = bump(0.05)
    poor = ShellMesh.build(raised.points, [*raised.elements, [0, 0, 1, 3], [2, 2, 2, 2]])
    assert element_values(mesh, STANDARD.at(1.0), poor)[:, 10] == pytest.approx([0.05, 0.05])
    empty = ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4)))
    with pytest.raises(InputError, match="reference surface"):
        element_values(mesh, STANDARD.at(1.0), empty)


def test_median_edge_counts_each_edge_once():
    # 7 edges: three of 5 across, two of 2 and two of 8 along; counted by element 5 would be less
    assert median_edge(strip([2.0, 8.0])) == 5.0
    one_tria = ShellMesh.build([[0, 0, 0], [3, 0, 0], [0, 4, 0]], [[0, 1, 2, -1]])
    assert median_edge(one_tria) == 4.0
    with pytest.raises(InputError, match="element size"):
        median_edge(ShellMesh.build(np.zeros((0, 3)), np.zeros((0, 4))))


def test_weights_move_the_compound_index():
    heavy = Criterion("max length", PAPER["max length"].levels, weight=3.0, scaled=True)
    mesh = strip([5.0, 8.0])
    light = quality_index(mesh, SCORING).compound_qi
    assert quality_index(mesh, PAPER.having(heavy, name="heavy").at(5.0)).compound_qi == (
        pytest.approx(light + 2 * 4.0, rel=1e-9)
    )
