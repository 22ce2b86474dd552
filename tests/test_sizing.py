"""Size fields: what they say at places, where they come from, and which files are refused."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshops.errors import InputError
from meshops.mesh import ShellMesh
from meshops.sizing import SizeSamples, Uniform, parse_size
from tests.meshes import CURVED_KINDS, FLAT_KINDS, joined, meshes, shaped, sheet, with_

PLACES = np.array([(0.0, 0.0, 0.0), (3.0, 1.0, -2.0), (1e6, 0.0, 0.0)])


def graded(ratio):
    """A sector of rings whose quads are nearly square and get larger outwards by a ratio."""
    step = np.log(ratio)
    return shaped(
        sheet(16, 4),
        lambda x, y: (np.exp(step * x) * np.cos(step * y), np.exp(step * x) * np.sin(step * y), 0),
    )


def table(tmp_path, text):
    path = tmp_path / "sizes.csv"
    path.write_text(text)
    return str(path)


def test_a_number_is_that_size_everywhere():
    field = parse_size("2.5", sheet(2, 2))
    assert field == Uniform(2.5)
    assert field.at(PLACES).tolist() == [2.5, 2.5, 2.5]


@pytest.mark.parametrize("size", [0.5, 3.0])
def test_the_local_size_of_a_lattice_is_its_edge(size):
    mesh = sheet(5, 4)
    field = parse_size("local", with_(mesh, points=size * mesh.points))
    np.testing.assert_allclose(field.at(PLACES), size)


def test_local_sizes_follow_a_gradation():
    ratio = 1.15
    mesh = graded(ratio)
    radius = ratio ** np.arange(0.5, 16)
    places = np.stack([radius, 0.3 * radius, 0 * radius], axis=1)
    found = parse_size("local", mesh).at(places)
    wanted = np.log(ratio) * np.linalg.norm(places, axis=1)
    np.testing.assert_allclose(found[1:-1], wanted[1:-1], rtol=0.06)
    assert (np.diff(found) > 0).all()


def test_one_small_element_hardly_changes_the_local_size():
    mesh = sheet(9, 9)
    points = mesh.points.copy()
    near = np.linalg.norm(points[:, :2] - 4.5, axis=1) < 1
    points[near] = (4.5, 4.5, 0) + 0.1 * (points[near] - (4.5, 4.5, 0))
    field = parse_size("local", with_(mesh, points=points))
    assert field.at(np.array([(4.5, 4.5, 0.0)]))[0] > 0.75


def test_local_sizes_leave_out_nodes_without_elements():
    mesh = sheet(3, 3)
    lonely = ShellMesh.build(np.concatenate([mesh.points, [(9, 9, 9)]]), mesh.elements)
    assert SizeSamples.of(lonely).digest == SizeSamples.of(mesh).digest


@given(meshes(FLAT_KINDS + CURVED_KINDS))
def test_local_sizes_lie_between_the_shortest_and_the_longest_edge(mesh):
    closed = np.where(mesh.elements < 0, mesh.elements[:, [0]], mesh.elements)
    edges = np.linalg.norm(mesh.points[closed] - mesh.points[np.roll(closed, -1, axis=1)], axis=-1)
    found = SizeSamples.of(mesh).at(mesh.points)
    assert (found >= edges[edges > 0].min() - 1e-9).all()
    assert (found <= edges.max() + 1e-9).all()


def test_a_table_gives_its_sizes_at_its_places_and_means_between(tmp_path):
    text = "\ufeffX, y, z, Size\n\n0,0,0,1  # fine\n2,0,0,3\n# the end\n"
    field = parse_size(table(tmp_path, text), sheet(2, 2))
    np.testing.assert_allclose(
        field.at(np.array([(0, 0, 0), (2, 0, 0), (1, 5, 0), (0.5, 0, 0)], float)),
        [1, 3, 2, 1.2],
    )


def test_the_nearest_samples_decide():
    places = [(float(x), 0, 0) for x in range(10)]
    field = SizeSamples.build(places, [1.0] * 5 + [7.0] * 5)
    np.testing.assert_allclose(field.at(np.array([(0.4, 0, 0), (8.4, 0, 0)])), [1.0, 7.0])


def test_samples_at_one_place_count_alike():
    field = SizeSamples.build([(1, 1, 1), (1, 1, 1), (2, 2, 2)], [1.0, 3.0, 8.0])
    np.testing.assert_allclose(field.at(np.ones((1, 3))), 2.0)


@given(
    st.lists(
        st.tuples(*[st.floats(-1e200, 1e200)] * 3, st.floats(1e-3, 1e3)), min_size=1, max_size=9
    )
)
def test_sizes_stay_between_those_of_the_samples(samples):
    rows = np.array(samples)
    field = SizeSamples.build(rows[:, :3] * 1e-100, rows[:, 3])
    found = field.at(np.concatenate([PLACES, rows[:, :3] * 1e-100]))
    assert (found >= rows[:, 3].min() * (1 - 1e-12)).all()
    assert (found <= rows[:, 3].max() * (1 + 1e-12)).all()


def test_a_field_says_nothing_of_no_places():
    assert SizeSamples.of(sheet(2, 2)).at(np.zeros((0, 3))).shape == (0,)
    assert Uniform(1.0).at(np.zeros((0, 3))).shape == (0,)


def test_fields_travel_and_keep_their_digest():
    local = SizeSamples.of(sheet(4, 4, seed=1, jitter=0.2))
    for field in (Uniform(0.1), local):
        field.at(PLACES)
        copy = pickle.loads(pickle.dumps(field))
        assert copy.digest == field.digest
        assert copy.at(PLACES).tolist() == field.at(PLACES).tolist()


def test_other_fields_have_other_digests():
    mesh = sheet(4, 4)
    moved = SizeSamples.of(joined(shaped(mesh, lambda x, y: (x + 9, y, 0 * x))))
    fields = [Uniform(1.0), Uniform(1.0 + 1e-15), SizeSamples.of(mesh), moved]
    assert len({field.digest for field in fields}) == len(fields)


def test_samples_cannot_be_changed():
    field = SizeSamples.of(sheet(2, 2))
    with pytest.raises(ValueError, match="read-only"):
        field.sizes[0] = 3.0


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("0,0,0,1\n1,2,3\n", "line 2: needs x, y, z, size, not 3 values"),
        ("x,y,z,size\n1,2,3,4,5\n", "line 2: needs x, y, z, size, not 5 values"),
        ("0,0,0,1\n\n0,0,a,1\n", "line 3: has something else than numbers"),
        ("0,0,0,1\nx,y,z,size\n", "line 2: has something else than numbers"),
        ("0,nan,0,1\n", "line 1: has a number that is not finite"),
        ("0,0,0,inf\n", "line 1: has a number that is not finite"),
        ("# sizes\n0,0,0,0\n", "line 2: the size must be above 0, not 0"),
        ("0,0,0,-2\n", "line 1: the size must be above 0, not -2"),
        ("x,y,z,size\n", "has no line with x, y, z, size"),
        ("", "has no line with x, y, z, size"),
    ],
)
def test_bad_tables_are_refused_with_the_line(tmp_path, text, says):
    path = table(tmp_path, text)
    with pytest.raises(InputError) as refusal:
        parse_size(path, sheet(2, 2))
    assert path in str(refusal.value)
    assert says in str(refusal.value)


def test_a_table_that_is_no_text_is_refused(tmp_path):
    path = tmp_path / "sizes.csv"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        parse_size(str(path), sheet(2, 2))


@pytest.mark.parametrize("text", ["0", "-1", "nan", "inf"])
def test_sizes_that_are_not_positive_are_refused(text):
    with pytest.raises(InputError, match="must be positive"):
        parse_size(text, sheet(2, 2))


def test_words_that_name_nothing_are_refused():
    with pytest.raises(InputError, match='"locale" is neither a number nor "local" nor a file'):
        parse_size("locale", sheet(2, 2))


def test_there_is_no_local_size_without_elements():
    empty = ShellMesh.build(np.zeros((2, 3)), np.zeros((0, 4), np.int32))
    with pytest.raises(InputError, match="no element to take a size from"):
        parse_size("local", empty)
    point = ShellMesh.build(np.zeros((3, 3)), [(0, 1, 2, -1)])
    with pytest.raises(InputError, match="without any length"):
        parse_size("local", point)
