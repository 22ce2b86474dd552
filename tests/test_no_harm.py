"""Decks that must not be made worse while failures fall, and repairs that must still be made.

Each kind stands here twice: as the deck in which it was found, where that is at hand, and as a
small mesh of its own. Each is improved shortly, written, read again and measured by `meshops.harm`.
"""

from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from benchmarks.harm import measure
from benchmarks.harm_decks import Source
from benchmarks.planting import PLANTS
from benchmarks.structured import extruded, graded, patch
from meshops.criteria import PAPER
from meshops.formats import write_mesh
from meshops.harm import Harm, compare
from meshops.mesh import ShellMesh
from tests.meshes import annulus, shaped, sheet, with_

SHARED = Path("../shared")
SECONDS = 3.0


def improved(path: Path, criteria: str = "paper") -> Harm:
    """Improve a deck, and compare what is written with it."""
    outcome = measure(Source(path.name, path=path), criteria, SECONDS)
    assert (outcome.refused, outcome.failure) == ("", "")
    assert outcome.harm is not None
    return outcome.harm


def of_mesh(mesh: ShellMesh, criteria: str = "paper") -> Harm:
    """Improve a mesh as a Nastran deck."""
    with TemporaryDirectory() as folder:
        path = Path(folder) / "deck.bdf"
        write_mesh(mesh, path)
        return improved(path, criteria)


@lru_cache
def of_kind(kind: str, criteria: str = "paper") -> Harm:
    return of_mesh(OWN[kind](), criteria)


@lru_cache
def of_deck(name: str) -> Harm:
    path = SHARED / name
    if not path.is_file():
        pytest.skip(f"{name} is not here")
    return improved(path)


def steep_plate() -> ShellMesh:
    """A plate whose edges grow from 1 to 6 from one side to the other, as both ways across."""

    def place(u, v):
        return 60 * u, 30 * (v - 0.5) * (0.35 + u), 0 * u

    return patch(place, (graded(26, 1.07), graded(10, 1.0)))


def clean_rows() -> ShellMesh:
    """Square quads, and beside them rows of rectangles that fail by aspect alone."""
    tall = np.concatenate([np.arange(5) * 0.2, 0.8 + np.arange(1, 9)])
    return shaped(sheet(12, 12), lambda x, y: (x, tall[y.astype(int)], 0 * x))


def ring() -> ShellMesh:
    """A narrow ring of 24 sides whose elements fail by size."""
    mesh = annulus(24, 6)
    radius = np.hypot(*mesh.points[:, :2].T)
    return with_(mesh, points=mesh.points * ((8 + 0.25 * (radius - 2)) / radius)[:, None])


def row_between_two_trias() -> ShellMesh:
    """A row that is split lengthwise from one sound tria to another one."""
    columns, rows, split, first, last = 20, 12, 6, 5, 15
    height = np.where(np.arange(rows) == split, 1.3, 1.0)
    places = np.concatenate([[0.0], np.cumsum(height)])
    mesh = shaped(sheet(columns, rows), lambda x, y: (x, places[y.astype(int)], 0 * x))
    node = np.arange(len(mesh.points)).reshape(rows + 1, columns + 1)
    points, middle = mesh.points.tolist(), {}
    for i in range(first, last + 1):
        middle[i] = len(points)
        points.append((float(i), float(places[split] + 0.65), 0.0))
    elements = []
    for j in range(rows):
        for i in range(columns):
            a, b, c, d = node[j, i], node[j, i + 1], node[j + 1, i + 1], node[j + 1, i]
            left, right = (middle.get(k) if j == split else None for k in (i, i + 1))
            if left is None and right is None:
                elements.append((a, b, c, d))
            elif left is None:
                elements += [(a, b, right, d), (right, c, d, -1)]
            elif right is None:
                elements += [(a, b, c, left), (left, c, d, -1)]
            else:
                elements += [(a, b, right, left), (left, right, c, d)]
    return ShellMesh.build(points, elements)


def misplaced() -> ShellMesh:
    """A plate in which one node lies far from its place."""
    mesh = sheet(10, 10)
    points = mesh.points.copy()
    points[5 * 11 + 5] += (0.65, 0.6, 0.0)
    return with_(mesh, points=points)


def in_a_corner() -> ShellMesh:
    """Plates of two regions that meet at a node, with locked neighbours as a deck has them."""
    points = [
        *((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (-0.9, 0.5, 0), (0.75, 0.5, 0)),
        *((2, 0, 0), (2, 1, 0), (0, 0, 1), (0, 1, 1), (-0.9, 0.5, 1)),
        *((0, 0, -1), (0, 1, -1), (-0.9, 0.5, -1)),
    ]
    elements = [
        *((4, 5, 2, 3), (0, 1, 5, 4), (4, 3, 0, -1), (1, 6, 7, 5), (5, 7, 2, -1)),
        *((4, 0, 8, 10), (3, 4, 10, 9), (0, 4, 13, 11), (4, 3, 12, 13)),
    ]
    return ShellMesh.build(points, elements, region=[20] * 5 + [19] * 4)


def web() -> ShellMesh:
    """An I section whose web is five rows deep, of long elements."""
    legs = [((0.0, 0.0), (0.0, 20.0), 5)]
    legs += [((0.0, z), (side * 8.0, z), 2) for z in (0.0, 20.0) for side in (-1, 1)]
    return extruded(legs, graded(24, 1.0), 24 * 4.0 * 3.5)


OWN = {
    "graded": steep_plate,
    "rows": clean_rows,
    "ring": ring,
    "two trias": row_between_two_trias,
    "misplaced": misplaced,
    "corner": in_a_corner,
    "web": web,
}


@pytest.mark.parametrize("criteria", ["paper", "standard"])
@pytest.mark.parametrize("kind", OWN)
def test_nothing_is_worse_on_a_small_mesh_of_each_kind(kind, criteria):
    assert of_kind(kind, criteria).worse() == ()


@pytest.mark.parametrize(
    "name",
    [
        "faults/abaqus/f01_graded_mesh_destroyed.inp",
        "faults/nastran/needles_from_clean_rows.bdf",
        "faults/nastran/ring_border_slides_off_circle.bdf",
        "faults/nastran/two_trias_whole_plate_renumbered.bdf",
        "faults/nastran/same_elements_new_ids.bdf",
        "faults/nastran/same_nodes_written.bdf",
        "data/tacs_circ_plate.bdf",
    ],
)
def test_nothing_is_worse_on_the_decks_in_which_it_was_found(name):
    assert of_deck(name).worse() == ()


def assert_left_alone(harm: Harm) -> None:
    assert harm.changed_elements == 0
    assert harm.changed_nodes == 0


def test_rows_of_clean_rectangles_are_left_as_they_are():
    harm = of_kind("rows")
    assert harm.before.failed_by_size_alone >= 40
    assert_left_alone(harm)


def test_rows_of_clean_rectangles_of_the_deck_are_left_as_they_are():
    assert_left_alone(of_deck("faults/nastran/needles_from_clean_rows.bdf"))


def test_a_web_of_five_rows_keeps_them():
    harm = of_kind("web")
    assert harm.rows.compared > 40
    assert harm.rows.least >= 1.0


def assert_keeps_gradation(harm: Harm) -> None:
    assert harm.sizes.grown <= 1.02
    assert harm.after.greatest_size <= max(1.5, harm.before.greatest_size)


def test_a_gradation_is_meant():
    assert_keeps_gradation(of_kind("graded"))


def test_the_gradation_of_the_deck_is_meant():
    assert_keeps_gradation(of_deck("faults/abaqus/f01_graded_mesh_destroyed.inp"))


def assert_keeps_its_border(harm: Harm) -> None:
    assert harm.border_deviation <= 0.01
    assert harm.area_change <= 0.001


def test_a_ring_keeps_its_border():
    assert_keeps_its_border(of_kind("ring"))


def test_the_ring_of_the_deck_keeps_its_border():
    assert_keeps_its_border(of_deck("faults/nastran/ring_border_slides_off_circle.bdf"))


def assert_one_row_or_none(harm: Harm, row: int) -> None:
    assert harm.changed_elements <= row
    assert harm.after.greatest_angle <= harm.before.greatest_angle + 0.01
    assert harm.other_ids == 0


def test_two_sound_trias_cost_a_row_at_the_most():
    harm = of_kind("two trias")
    assert (harm.before.failed_by_shape, harm.before.trias) == (0, 2)
    assert_one_row_or_none(harm, 3 * 12)


def test_two_sound_trias_of_the_deck_cost_a_row_at_the_most():
    assert_one_row_or_none(of_deck("faults/nastran/two_trias_whole_plate_renumbered.bdf"), 3 * 22)


def test_elements_on_the_same_nodes_keep_their_ids():
    assert of_kind("misplaced").other_ids == 0


def test_elements_of_the_deck_on_the_same_nodes_keep_their_ids():
    assert of_deck("faults/nastran/same_elements_new_ids.bdf").other_ids == 0


def test_no_shell_is_written_on_the_nodes_of_another_one():
    assert of_kind("corner").after.same_nodes == 0


def test_no_shell_of_the_deck_is_written_on_the_nodes_of_another_one():
    harm = of_deck("faults/nastran/same_nodes_written.bdf")
    assert harm.after.same_nodes == 0


def test_a_hole_of_two_half_cylinders_stays_a_hole():
    """Size 15 is wider than the hole: its border gets four edges at the least all the same."""
    pytest.importorskip("gmsh")
    from meshops.cad import mesh_cad

    path = SHARED / "faults/other/f09_plate_hole_two_halves.step"
    if not path.is_file():
        pytest.skip(f"{path.name} is not here")
    mesh = mesh_cad(path, 15.0)
    found = compare(mesh, mesh, PAPER.at(15.0)).before
    assert (found.same_nodes, found.inverted) == (0, 0)


def test_an_experts_deck_changes_around_its_faults_alone():
    harm = of_deck("data/tacs_circ_plate.bdf")
    faults = harm.faults_removed
    assert harm.changed_elements <= 12 * max(faults, 0)


@pytest.mark.parametrize("plant", PLANTS, ids=lambda plant: plant.__name__)
@pytest.mark.parametrize("grid", ["even", "graded", "oblong"])
def test_a_single_fault_in_a_sound_mesh_is_mended_where_it_is(plant, grid):
    """Doing nothing is no way out."""
    growth = 1.08 if grid == "graded" else 1.0
    length = 2.2 if grid == "oblong" else 1.0
    sides = graded(12, growth), graded(12, growth)
    mesh = patch(lambda u, v: (12 * length * u, 12 * v, 0 * u), sides)
    bad = plant(mesh, 66, np.random.default_rng(2))
    harm = of_mesh(bad)
    assert harm.worse() == ()
    assert harm.after.trias == 0
    assert harm.after.failed_by_shape == 0
    assert harm.changed_elements <= 12 * max(harm.faults_removed, 1)
