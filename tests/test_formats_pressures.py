"""Pressures that differ by element or corner, or have a direction, are carried over."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.formats.nastran_cards import lex
from meshops.mesh import NO_NODE, ShellMesh
from meshops.patch import components, extract, stitch
from meshops.topology import topology

FAULTS = Path(__file__).parents[2] / "shared" / "faults" / "nastran"


def number(i, j):
    return 20 * j + i + 1


def plate(columns=8, rows=6, height=lambda x, y: 0.0):
    """A plate of unit quads and the mean place of each, by id."""
    grids = "".join(
        f"GRID,{number(i, j)},,{i}.,{j}.,{height(i, j):.6f}\n"
        for j in range(rows + 1)
        for i in range(columns + 1)
    )
    shells, places = "", {}
    for j in range(rows):
        for i in range(columns):
            nodes = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)]
            shells += f"CQUAD4,{number(i, j)},1,{','.join(map(str, nodes))}\n"
            places[number(i, j)] = (i + 0.5, j + 0.5)
    return grids + shells, places


@pytest.fixture
def deck(tmp_path):
    def make(text, name="deck.bdf"):
        (tmp_path / name).write_text(text)
        return read_deck(tmp_path / name)

    return make


def remeshed(mesh, box=(1.5, 5.5, 1.5, 4.5)):
    """The mesh with the elements in a box fanned out anew from a point that is not its middle."""
    x0, x1, y0, y1 = box
    centres = np.array([mesh.points[e[e >= 0]].mean(axis=0) for e in mesh.elements])
    inside = (
        (centres[:, 0] > x0) & (centres[:, 0] < x1) & (centres[:, 1] > y0) & (centres[:, 1] < y1)
    )
    topo = topology(mesh)
    for rows in components(topo, inside):
        patch = extract(topo, rows)
        middle = patch.points[: patch.border_nodes].mean(axis=0) + np.array([0.21, -0.13, 0.0])
        fan = [(a, b, patch.border_nodes, NO_NODE) for a, b in patch.border]
        mesh = apply(mesh, stitch(mesh, patch, middle[None], np.array(fan, np.int32)))
    return mesh


def cards_of(path):
    return lex(path.read_text().splitlines(), 0)


def resultants(path):
    """Force and moment of each load set, by a reader of its own: mean pressure times area."""
    points, shells, total = {}, {}, {}
    for card in cards_of(path):
        if card.name == "GRID":
            points[int(card.field(0))] = np.array([real(card.field(i)) for i in (2, 3, 4)])
        elif card.name in ("CQUAD4", "CTRIA3"):
            count = 4 if card.name == "CQUAD4" else 3
            shells[int(card.field(0))] = [int(card.field(2 + i)) for i in range(count)]
    for card in cards_of(path):
        if card.name not in ("PLOAD4", "PLOAD2"):
            continue
        if card.name == "PLOAD4":
            values = [card.field(i) or card.field(2) for i in range(2, 6)]
            last = card.field(7) if card.field(6) == "THRU" else card.field(1)
            named = range(int(card.field(1)), int(last) + 1)
        else:
            values = [card.field(1)] * 4
            words = [word for word in card.fields[2:] if word]
            is_range = "THRU" in words
            named = range(int(words[0]), int(words[2]) + 1) if is_range else map(int, words)
        way = np.array([real(card.field(i)) for i in (9, 10, 11)]) if card.field(9) else None
        for element in named:
            if element not in shells:
                continue
            corners = np.array([points[node] for node in shells[element]])
            second = corners[3] if len(corners) == 4 else corners[0]
            vector = np.cross(corners[2] - corners[0], second - corners[1]) / 2
            if way is not None:
                vector = np.linalg.norm(vector) * way / np.linalg.norm(way)
            mean = np.mean([real(value) for value in values[: len(corners)]])
            force, moment = total.setdefault(card.field(0), (np.zeros(3), np.zeros(3)))
            force += mean * vector
            moment += np.cross(corners.mean(axis=0), mean * vector)
    return total


def real(text):
    try:
        return float(text or 0)
    except ValueError:
        head, sign, tail = text[0] + text[1:].replace("+", "e+").replace("-", "e-"), "", ""
        return float(head + sign + tail)


def assert_kept(before, after, tolerance=1e-3):
    one, other = resultants(before), resultants(after)
    assert one.keys() == other.keys()
    for sid, (force, moment) in one.items():
        size = np.linalg.norm(force)
        np.testing.assert_allclose(other[sid][0], force, atol=tolerance * size)
        np.testing.assert_allclose(other[sid][1], moment, atol=tolerance * np.linalg.norm(moment))


def written(source, mesh, tmp_path):
    source.write(mesh, tmp_path / "out.bdf")
    return tmp_path / "out.bdf"


def by_element(places, value):
    return "".join(f"PLOAD4,7,{e},{value(*place):.5f}\n" for e, place in places.items())


@pytest.mark.parametrize(
    "value",
    [lambda x, y: 1 + 0.01 * x + 0.02 * y, lambda x, y: x * y, lambda x, y: np.sin(x) - 0.3 * y],
)
def test_a_field_by_element_keeps_force_and_moment(deck, tmp_path, value):
    text, places = plate()
    source = deck(text + by_element(places, value))
    assert not source.mesh.locked_elements.any()
    assert source.mesh.region.max() == 0
    mesh = remeshed(source.mesh)
    assert (mesh.element_ids == 0).sum() > 5
    out = written(source, mesh, tmp_path)
    assert_kept(tmp_path / "deck.bdf", out, tolerance=1e-6)
    # and new values are those of the field about there
    again = read_deck(out)
    ids = again.mesh.element_ids.tolist()
    for card in cards_of(out):
        if card.name == "PLOAD4" and int(card.field(1)) not in places:
            row = again.mesh.elements[ids.index(int(card.field(1)))]
            x, y, _ = again.mesh.points[row[row >= 0]].mean(axis=0)
            near = [value(x + a, y + b) for a in (-1.5, 0, 1.5) for b in (-1.5, 0, 1.5)]
            assert min(near) - 0.2 <= real(card.field(2)) <= max(near) + 0.2


def test_a_field_by_corner_is_interpolated(deck, tmp_path):
    text, places = plate()

    def at(i, j):
        return 1 + 0.5 * i + 0.25 * j

    loads = ""
    for element in places:
        i, j = (element - 1) % 20, (element - 1) // 20
        four = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]
        loads += f"PLOAD4,7,{element}," + ",".join(map(str, four)) + "\n"
    source = deck(text + loads)
    assert not source.mesh.locked_elements.any()
    out = written(source, remeshed(source.mesh), tmp_path)
    again = read_deck(out).mesh
    shells = dict(zip(again.element_ids.tolist(), again.elements.tolist(), strict=True))
    for card in cards_of(out):
        if card.name == "PLOAD4" and int(card.field(1)) not in places:
            corners = [again.points[k] for k in shells[int(card.field(1))] if k >= 0]
            values = [real(card.field(2 + k)) for k in range(len(corners))]
            # a plane field is one whatever the mesh
            expected = [at(x, y) for x, y, _ in corners]
            np.testing.assert_allclose(values, expected, atol=0.02)
    # the reader of the test takes the mean at the centre, which is not quite so for a quad
    assert_kept(tmp_path / "deck.bdf", out)


def test_a_load_with_a_direction_keeps_it(deck, tmp_path):
    text, places = plate(height=lambda x, y: 0.05 * x * y)
    tail = ",,,,,,+\n+,0,0.,1.,1.\n"
    loads = "".join(f"PLOAD4,7,{e},{1 + 0.1 * x:.3f}{tail}" for e, (x, _) in places.items())
    source = deck(text + loads + "".join(f"PLOAD4,8,{e},2.{tail}" for e in places))
    assert not source.mesh.locked_elements.any()
    assert source.mesh.region.max() == 0
    mesh = source.mesh
    rows = np.flatnonzero(mesh.element_ids == number(3, 3))
    a, b, c, d = mesh.elements[rows[0]]
    halves = np.array([(a, b, c, NO_NODE), (a, c, d, NO_NODE)], np.int32)
    edit = Edit(rows, added_elements=halves, added_region=np.zeros(2, np.int32))
    out = written(source, apply(mesh, edit), tmp_path)
    assert_kept(tmp_path / "deck.bdf", out)
    loads = [card for card in cards_of(out) if card.name == "PLOAD4"]
    new = [card for card in loads if int(card.field(1)) not in places]
    assert sorted(card.field(0) for card in new) == ["7", "7", "8", "8"]
    assert {tuple(card.fields[8:12]) for card in new} == {("0", "0.", "1.", "1.")}


def test_areas_of_even_pressure_keep_their_borders(deck):
    text, places = plate()
    source = deck(text + by_element(places, lambda x, y: 1.0 if x < 4 else 2.0))
    assert source.mesh.region.max() == 1
    loaded = {e: place for e, place in places.items() if place[0] < 4}
    source = deck(text + by_element(loaded, lambda x, y: x * y))
    assert source.mesh.region.max() == 1


def test_one_card_stays_a_few(deck, tmp_path):
    text, places = plate()
    source = deck(text + f"PLOAD2,7,2.5,1,THRU,{max(places)}\n")
    out = written(source, remeshed(source.mesh), tmp_path)
    cards = [card for card in cards_of(out) if card.name == "PLOAD2"]
    assert len(cards) <= 8
    assert_kept(tmp_path / "deck.bdf", out, tolerance=1e-9)


def test_ranges_with_gaps_are_read(deck, tmp_path):
    text, places = plate()
    source = deck(text + "PLOAD4,7,1,.5,,,,THRU,9999\n")
    assert not source.mesh.locked_elements.any()
    source.check_room()
    out = written(source, remeshed(source.mesh), tmp_path)
    assert_kept(tmp_path / "deck.bdf", out, tolerance=1e-9)
    loaded = [
        e
        for card in cards_of(out)
        if card.name == "PLOAD4"
        for e in range(int(card.field(1)), int(card.field(7) or card.field(1)) + 1)
    ]
    assert len(loaded) == len(set(loaded))
    assert set(read_deck(out).mesh.element_ids.tolist()) <= set(loaded)
    assert len(places) == 48


@settings(
    max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    seed=st.integers(0, 10**6),
    bend=st.sampled_from([0.0, 0.03]),
    corners=st.booleans(),
)
def test_any_field_keeps_force_and_moment(deck, tmp_path, seed, bend, corners):
    rng = np.random.default_rng(seed)
    text, places = plate(height=lambda x, y: bend * x * y)
    loads = ""
    for element in places:
        values = rng.uniform(0.5, 1.5, 4 if corners else 1)
        loads += f"PLOAD4,7,{element}," + ",".join(f"{value:.4f}" for value in values) + "\n"
    source = deck(text + loads)
    mesh = remeshed(source.mesh)
    assert isinstance(mesh, ShellMesh)
    assert_kept(tmp_path / "deck.bdf", written(source, mesh, tmp_path))


@pytest.mark.skipif(not FAULTS.is_dir(), reason="no shared faults")
@pytest.mark.parametrize(
    "name", ["pressure_differs_by_element", "pressure_with_direction", "pload4_thru_with_gaps"]
)
def test_faults(tmp_path, name):
    source = read_deck(FAULTS / f"{name}.bdf")
    assert not source.mesh.locked_elements.any()
    assert source.mesh.region.max() == 0
    mesh = remeshed(source.mesh, box=(2, 8, 2, 6))
    assert (mesh.element_ids == 0).sum() > 5
    out = written(source, mesh, tmp_path)
    lines = (FAULTS / f"{name}.bdf").read_text()
    (tmp_path / "before.bdf").write_text(lines[lines.index("PSHELL") :])
    text = out.read_text()
    (tmp_path / "after.bdf").write_text(text[text.index("PSHELL") :])
    assert_kept(tmp_path / "before.bdf", tmp_path / "after.bdf")
