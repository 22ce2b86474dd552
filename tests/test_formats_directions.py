"""Material directions of a Nastran deck stay where they are when shells become others."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.mesh import NO_NODE
from tests.meshes import area_vectors, centre
from tests.strips import GRIDS, SHELLS, changed_lines, deck_maker, halved, strip, written


@pytest.fixture
def deck(tmp_path):
    return deck_maker(tmp_path)


def directions(deck):
    """Material direction of each shell, by its id, one element and one step at a time."""
    mesh = deck.mesh
    typed = dict(zip(deck.directions.element_ids, deck.directions.angles, strict=True))
    found = {}
    for row, vector in enumerate(area_vectors(mesh)):
        theta = np.radians(typed[mesh.element_ids[row]])
        normal = vector / np.linalg.norm(vector)
        a, b = mesh.points[mesh.elements[row, :2]]
        along = (b - a) - (b - a) @ normal * normal
        along /= np.linalg.norm(along)
        found[int(mesh.element_ids[row])] = np.cos(theta) * along + np.sin(theta) * np.cross(
            normal, along
        )
    return found


def test_directions_that_agree_are_of_one_region(deck):
    # the third shell begins at its upper right corner: its direction is that of the others
    text = strip("30.", "3.2+1", "-148.", "51.", "72.").replace(
        "CQUAD4,3,1,13,14,24,23", "CQUAD4,3,1,24,23,13,14"
    )
    mesh = deck(text).mesh
    # 32, 32, then 19 and 21 degrees more
    assert mesh.region.tolist() == [0, 0, 0, 0, 1]


def test_what_the_field_means_parts_regions(deck):
    mesh = deck(strip("30.", "30", "", "0.", "1.")).mesh
    # an angle, a coordinate system, nothing; zero is an angle where others have one
    assert mesh.region.tolist() == [0, 1, 2, 3, 3]


def test_zero_and_blank_are_the_same_where_there_is_no_other_angle(deck):
    text = strip("", "0.", "0.0", "", "").replace(
        "CQUAD4,2,1,12,13,23,22", "CQUAD4,2,1,23,22,12,13"
    )
    source = deck(text)
    assert source.mesh.region.tolist() == [0] * 5
    assert not source.directions.angles.size


@pytest.mark.parametrize(
    "cards",
    ["PCOMP,1,,,,,,,,+\n+,5,.1,45.\n", "PSHELL,1,4,.1,5\nMAT8,5,1.,1.,.3,1.\nMAT1,4,1.,,.3\n"],
)
def test_a_blank_angle_matters_where_the_stiffness_has_a_direction(deck, cards):
    turned = SHELLS.replace("3,1,13,14,24,23", "3,1,24,23,13,14")
    plain = deck(GRIDS + turned + "PSHELL,1,4,.1,4\nMAT1,4,1.,,.3\n", "plain.bdf")
    assert plain.mesh.region.tolist() == [0] * 5
    source = deck(GRIDS + turned + cards)
    assert source.mesh.region.tolist() == [0, 0, 1, 2, 2]
    # the second tria runs the other way along the quad's first edge
    text = written(source, halved(source.mesh, 1))
    assert "CTRIA3,27,1,11,12,22,0.\nCTRIA3,28,1,22,21,11,180.\n" in text


def test_only_a_shell_that_turned_gets_another_angle(deck):
    text = strip("30.", "30.", "30.", "30.", "30.")
    source = deck(text)
    mesh = source.mesh

    def moved(node, place):
        row = np.flatnonzero(mesh.node_ids == node)
        return written(source, apply(mesh, Edit(moved=row, moved_to=np.array([place]))))

    # node 26 is on no first edge; node 16 is on that of shell 5
    other = moved(26, [6.5, 2.5, 0.0])
    assert other == text.replace("GRID,26,,6.,2.,0.", "GRID,26,,6.5,2.5,0.")
    turned = moved(16, [6.0, 1.5, 0.0])
    assert changed_lines(text, turned) == (
        ["GRID,16,,6.,1.,0.", "CQUAD4,5,1,15,16,26,25,30."],
        ["GRID,16,,6.,1.5,0.", "CQUAD4,5,1,15,16,26,25,3.434949"],
    )


@pytest.mark.parametrize(
    ("nodes", "card"),
    [
        ((12, 22, 21), "CTRIA3,1,1,12,22,21,-60."),
        ((11, 12, 21), "CTRIA3,1,1,11,12,21,3.+1"),
        ((22, 21, 11, 12), "CQUAD4,1,1,22,21,11,12,-150."),
    ],
)
def test_a_rewired_shell_keeps_its_direction(deck, nodes, card):
    source = deck(strip("3.+1", "30.", "30.", "30.", "30."))
    rows = [int(np.flatnonzero(source.mesh.node_ids == node)[0]) for node in nodes]
    to = np.array([[*rows, NO_NODE][:4]])
    mesh = apply(source.mesh, Edit(rewired=np.array([0]), rewired_to=to))
    assert card in written(source, mesh).splitlines()


def test_a_direction_comes_from_the_region(deck):
    source = deck(strip("30.", "30.", "72.", "72.", "72."))
    edit = Edit(
        removed=np.array([2]),
        added_elements=source.mesh.elements[[2]],
        added_region=source.mesh.region[[0]],
    )
    assert "CQUAD4,27,1,13,14,24,23,30.\n" in written(source, apply(source.mesh, edit))


def test_a_fold_has_no_direction_across_it(deck):
    wall = "GRID,31,,1.,1.,1.\nGRID,32,,2.,1.,1.\nCQUAD4,6,1,31,32,12,11,30.\n"
    mesh = deck(strip(*["30."] * 5) + wall).mesh
    assert mesh.region.tolist() == [0, 0, 0, 0, 0, 1]


def test_a_coordinate_system_and_a_blank_stay_what_they_are(deck):
    source = deck(strip("12", "12", "", "", ""))
    text = written(source, halved(source.mesh, 1, 4))
    trias = [line for line in text.splitlines() if line.startswith("CTRIA3")]
    assert trias == [
        "CTRIA3,27,1,11,12,22,12",
        "CTRIA3,28,1,22,21,11,12",
        "CTRIA3,29,1,14,15,25",
        "CTRIA3,30,1,25,24,14",
    ]


FORMS = {
    "small": lambda name, fields: name.ljust(8) + "".join(field.rjust(8) for field in fields),
    "free": lambda name, fields: ",".join([name, *fields]),
}


@st.composite
def oriented_sheets(draw):
    """A bent sheet whose quads begin at any corner, its directions all near a drawn one."""
    rng = np.random.default_rng(draw(st.integers(0, 10**6)))
    columns, rows = draw(st.integers(2, 5)), draw(st.integers(2, 4))
    bend, heading = draw(st.sampled_from([0.0, 0.08])), draw(st.floats(-180, 180))
    spread = draw(st.sampled_from([0.0, 8.0]))
    x, y = (a.ravel() for a in np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0)))
    inner = (x > 0) & (x < columns) & (y > 0) & (y < rows)
    x, y = x + inner * rng.uniform(-0.2, 0.2, len(x)), y + inner * rng.uniform(-0.2, 0.2, len(x))
    points = np.stack([x, y, bend * (x**2 - y**2) / 2], axis=1).round(5)
    form = FORMS[draw(st.sampled_from(sorted(FORMS)))]
    lines = [
        form("GRID", [str(i + 1), "", *(f"{value:.5f}" for value in point)])
        for i, point in enumerate(points)
    ]
    at = np.arange(len(x)).reshape(rows + 1, columns + 1)
    for i, corner in enumerate(np.ndindex(rows, columns)):
        r, c = corner
        quad = np.roll([at[r, c], at[r, c + 1], at[r + 1, c + 1], at[r + 1, c]], rng.integers(4))
        a, b = points[quad[:2]]
        edge = np.degrees(np.arctan2(b[1] - a[1], b[0] - a[0]))
        theta = (heading + rng.uniform(-spread, spread) - edge + 180.0) % 360.0 - 180.0
        fields = [str(100 + i), "1", *(str(n + 1) for n in quad), f"{theta:.2f}"]
        lines.append(form("CQUAD4", fields))
    return "\n".join([*lines, ""]), rng


@settings(
    max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(oriented_sheets())
def test_every_new_shell_has_the_direction_of_the_nearest_old_one(deck, tmp_path, drawn):
    text, rng = drawn
    source = deck(text)
    mesh = source.mesh
    assert len(source.regions) == 1
    ids = rng.choice(mesh.element_ids, min(3, len(mesh.element_ids) - 1), replace=False)
    edited = halved(mesh, *ids)
    written(source, edited)
    again = read_deck(tmp_path / "out.bdf")
    assert not again.mesh.locked_elements.any()
    before, after = directions(source), directions(again)
    centres = np.array([centre(mesh, row) for row in range(len(mesh.elements))])
    for row, element in enumerate(again.mesh.element_ids.tolist()):
        if element in before:
            np.testing.assert_array_equal(after[element], before[element])
            continue
        away = np.linalg.norm(centres - centre(again.mesh, row), axis=1)
        nearest = np.sort(away)
        if nearest[1] - nearest[0] < 1e-6:
            continue
        normal = area_vectors(again.mesh)[row]
        normal = normal / np.linalg.norm(normal)
        inherited = before[int(mesh.element_ids[np.argmin(away)])]
        projected = inherited - inherited @ normal * normal
        turn = np.cross(projected, after[element]) @ normal, projected @ after[element]
        assert abs(np.degrees(np.arctan2(*turn))) < 2e-3
