"""New nodes of an Abaqus deck have what the nodes around them share."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from meshops.edit import Edit, apply
from meshops.formats import read_deck
from meshops.mesh import NO_NODE
from tests.abaqus_reader import fanned, free_quads, read_model, written

# nodes 11 to 16 in the lowest of three rows, elements 1 to 5 below and 6 to 10 above
NODES = {10 * j + i: f"{10 * j + i}, {i}., {j}., 0.\n" for j in (1, 2, 3) for i in range(1, 7)}
ELEMENTS = "".join(
    f"{5 * (j - 1) + i}, {10 * j + i}, {10 * j + i + 1}, {10 * j + i + 11}, {10 * j + i + 10}\n"
    for j in (1, 2)
    for i in range(1, 6)
)
PLAIN = "*NODE\n" + "".join(NODES.values()) + "*ELEMENT, TYPE=S4, ELSET=E\n" + ELEMENTS
LEFT = [10 * j + i for j in (1, 2, 3) for i in (1, 2, 3)]
RIGHT = [10 * j + i for j in (1, 2, 3) for i in (4, 5, 6)]
ALL = sorted(NODES)


def listed(ids):
    return ", ".join(map(str, ids)) + "\n"


@pytest.fixture
def deck(tmp_path):
    def make(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_deck(tmp_path / "deck.inp")

    return make


def locked(mesh):
    return mesh.node_ids[mesh.locked_nodes].tolist()


def of_column(column):
    return [column, column + 5]


@pytest.mark.parametrize(
    "definition",
    [
        "*NSET, NSET=A, GENERATE\n11, 16\n21, 26, 1\n31, 36\n",
        "*Nset, gen, nset = a\n11, 36, 1\n",
        f"*NSET, NSET=A\n{listed(ALL[:9])}{listed(ALL[9:])}",
        f"*NSET, NSET=B\n{listed(ALL[:9])}*NSET, NSET=a\nB, {listed(ALL[9:])}",
        "*NSET, NSET=A, ELSET=E\n",
    ],
)
@pytest.mark.parametrize(
    "use",
    [
        "",
        "*TEMPERATURE\nA, 120.\n",
        "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nA, 20.\n",
        "*BOUNDARY\nA, 3, 5\n",
        "*NODE PRINT, NSET=A\nU\n",
        "*NODAL THICKNESS\nA, 1.5\n",
        "*TRANSFORM, NSET=A\n0., 1., 0., -1., 0., 0.\n",
    ],
)
def test_a_set_of_all_nodes_locks_nothing_and_gets_the_new_ones(deck, definition, use):
    source = deck(PLAIN + definition + use)
    assert not source.mesh.locked_nodes.any()
    assert not source.mesh.locked_elements.any()
    text = written(source, fanned(source.mesh, 2, 9))
    model = read_model(text)
    assert len(model.nodes) == 20
    if "ELSET=E\n" not in definition:
        assert model.nodes.keys() <= model.nsets["A"]
    assert text.endswith(use)


def test_a_header_of_nodes_takes_the_new_ones_in(deck):
    first = "".join(NODES[node] for node in LEFT)
    second = "".join(NODES[node] for node in RIGHT)
    text = f"*NODE\n{second}*NODE, NSET=held\n{first}*ELEMENT, TYPE=S4\n{ELEMENTS}"
    source = deck(text + "*BOUNDARY\nHELD, 3\n")
    assert locked(source.mesh) == [13, 23, 33]
    model = read_model(written(source, fanned(source.mesh, 1, 5)))
    assert model.nsets["HELD"] - set(LEFT) == {37}
    assert model.nodes[37] == [1.5, 1.5, 0.0]
    assert model.nodes[38] == [5.5, 1.5, 0.0]


def test_a_node_of_no_set_gets_a_block_of_its_own(deck):
    source = deck(
        PLAIN.replace("*NODE", "*NODE, NSET=N").replace("36, 6., 3., 0.\n", "*NODE\n36, 6, 3, 0\n")
        + "*CLOAD\nN, 3, 1.\n"
    )
    assert len(locked(source.mesh)) == 17
    text = written(source, fanned(source.mesh, 1))
    assert "36, 6, 3, 0\n37, 1.5, 1.5, 0.0\n" in text
    assert 37 not in read_model(text).nsets["N"]
    source = deck(PLAIN.replace("*NODE", "*NODE, NSET=N") + "*CLOAD\nN, 3, 1.\n")
    text = written(source, fanned(source.mesh, 1))
    assert "*NODE\n37, 1.5, 1.5, 0.0\n*ELEMENT" in text


def test_what_counts_once_for_each_node_is_not_had_by_new_ones(deck):
    source = deck(PLAIN + f"*NSET, NSET=A\n{listed(ALL)}*CLOAD\nA, 3, 1.\n")
    assert locked(source.mesh) == ALL
    assert not source.mesh.locked_elements.any()
    assert read_model(written(source, fanned(source.mesh, 1))).nsets["A"] == set(ALL)


def test_nobody_is_born_where_it_would_be_loaded_and_held_by_one_set(deck):
    text = PLAIN + f"*NSET, NSET=A\n{listed(LEFT)}*CLOAD\nA, 3, 1.\n*RIGID BODY, TIE NSET=A\n"
    mesh = deck(text).mesh
    assert locked(mesh) == LEFT
    assert mesh.element_ids[mesh.locked_elements].tolist() == [1, 2, 6, 7]


@pytest.mark.parametrize(
    ("rows", "new_row"),
    [
        ("*TEMPERATURE\n{}, 20.\n", "37, 20."),
        ("*Initial Conditions, type=TEMPERATURE\n{}, 20.\n", "37, 20."),
        ("*NODAL THICKNESS\n  {},  1.25\n", "37, 1.25"),
        ("*BOUNDARY\n{}, 3, 3\n", "37, 3, 3"),
        ("*BOUNDARY\n{}, 2, 2, 0.5\n", "37, 2, 2, 0.5"),
    ],
)
def test_facts_by_number_are_written_for_new_nodes_and_go_with_vanished_ones(deck, rows, new_row):
    keyword, row = rows.splitlines(keepends=True)
    source = deck(PLAIN + keyword + "".join(row.format(node) for node in ALL) + "*STEP\n")
    assert not source.mesh.locked_nodes.any()
    gone = apply(source.mesh, Edit(removed=np.array([0])))
    lines = (keyword + row.format(11), new_row + "\n*STEP")
    texts = [written(source, mesh).replace(" ", "") for mesh in (gone, fanned(source.mesh, 3))]
    found = [[line.replace(" ", "") in text for line in lines] for text in texts]
    assert found == [[False, False], [True, True]]
    # the first of two new nodes takes the place of the one that goes
    model = read_model(written(source, fanned(gone, 3, 4)))
    subjects = [values[0] for name, rows in model.rows.items() if name != "STEP" for values in rows]
    assert sorted(subjects) == sorted(map(str, [*ALL, 37]))


def test_nobody_is_born_between_nodes_of_different_temperatures(deck):
    rows = "".join(f"{node}, {20 + 5 * (node > 24)}.\n" for node in ALL)
    source = deck(PLAIN + "*TEMPERATURE\n" + rows)
    mesh = source.mesh
    assert mesh.element_ids[mesh.locked_elements].tolist() == [4, 5, 6, 7, 8, 9]
    assert [lock.cards for lock in source.locks if lock.kind == "elements"] == [
        "different values of *TEMPERATURE"
    ]


def test_two_sets_of_one_temperature_part_nothing(deck):
    sets = f"*NSET, NSET=L\n{listed(LEFT)}*NSET, NSET=R\n{listed(RIGHT)}"
    source = deck(PLAIN + sets + "*TEMPERATURE\nL, 20.\nR, 20.0\n")
    assert not source.mesh.locked_nodes.any()
    model = read_model(written(source, fanned(source.mesh, 3)))
    assert len(model.nsets["L"] | model.nsets["R"]) == 19
    other = deck(PLAIN + sets + "*TEMPERATURE\nL, 20.\nR, 30.\n").mesh
    assert other.element_ids[other.locked_elements].tolist() == [3, 8]


def test_a_fact_that_no_set_brings_alone_gets_a_line(deck):
    sets = f"*NSET, NSET=L\n{listed(LEFT)}*NSET, NSET=R\n{listed(RIGHT)}"
    held = "*BOUNDARY\nL, 1\nR, 2\n"
    source = deck(PLAIN + sets + "*TEMPERATURE\nL, 20.\nR, 20.\n" + held)
    text = written(source, fanned(source.mesh, 3))
    model = read_model(text)
    assert 37 not in model.nsets["L"] | model.nsets["R"]
    assert ["37", "20."] in model.rows["TEMPERATURE"]


def test_supports_at_an_edge_stay_and_bring_nothing(deck):
    source = deck(PLAIN + "*NSET, NSET=FIX\n11, 21, 31\n*BOUNDARY\nFIX, 1, 6\n")
    assert locked(source.mesh) == [11, 21, 31]
    assert source.locks[0].sentence == (
        "3 nodes: NSET FIX in *BOUNDARY (they neither move nor vanish)"
    )
    assert read_model(written(source, fanned(source.mesh, 1))).nsets["FIX"] == {11, 21, 31}


def test_points_and_lines_that_are_printed_stay(deck):
    text = PLAIN + "*NSET, NSET=GAUGES\n22, 25\n*NSET, NSET=REST\n33\n*NODE PRINT, NSET=GAUGES\nU\n"
    assert locked(deck(text).mesh) == [22, 25]


def test_what_nothing_uses_follows_the_mesh(deck):
    source = deck(PLAIN + f"*NSET, NSET=A\n{listed(LEFT)}*NSET, NSET=B\n22\n")
    assert source.locks == ()
    gone = apply(source.mesh, Edit(removed=np.array([0])))
    model = read_model(written(source, fanned(gone, 2, 4)))
    assert model.nsets["A"] == set(LEFT) - {11} | {37}
    assert model.nsets["B"] == {22}


def test_a_line_that_nothing_uses_stays_a_line(deck):
    source = deck(PLAIN + "*NSET, NSET=A\n11, 12, 13, 14, 15, 16\n")
    mesh = fanned(source.mesh, 1, 2)
    # of the triangle at the border nothing is left but a new node and the border
    trias = np.flatnonzero((mesh.elements == 0).any(axis=1) & (mesh.elements == 1).any(axis=1))
    a, b, new = mesh.elements[trias[-1], :3]
    split = Edit(
        removed=trias[-1:],
        added_points=mesh.points[[a, b, new]].mean(axis=0)[None],
        added_elements=np.array(
            [(p, q, len(mesh.points), NO_NODE) for p, q in ((a, b), (b, new), (new, a))]
        ),
        added_region=np.zeros(3, np.int32),
    )
    text = written(source, apply(mesh, split))
    assert len(read_model(text).nodes) == 21
    assert read_model(text).nsets["A"] == {11, 12, 13, 14, 15, 16}


def test_ranges_are_cut_and_not_grown_over_others(deck):
    ranges = "*NSET, NSET=A, GENERATE\n11, 15, 2\n12, 16, 2\n21, 26\n"
    source = deck(PLAIN + ranges + "*NSET, NSET=B, GENERATE\n30, 900\n")
    gone = apply(source.mesh, Edit(removed=np.array([0])))
    text = written(source, fanned(gone, 2))
    assert "GENERATE\n13, 15, 2\n12, 16, 2\n21, 26\n901, 901, 1\n*NSET, NSET=B" in text
    assert text.endswith("B, GENERATE\n30, 900\n")


def test_results_by_node_number_lock_all(deck):
    mesh = deck(PLAIN + "*TEMPERATURE, FILE=run.frd\n").mesh
    assert mesh.locked_nodes.all()
    assert mesh.locked_elements.all()
    assert not deck(PLAIN + "*TEMPERATURE, FILE=run.odb, INTERPOLATE\n").mesh.locked_nodes.any()


def test_a_set_named_locked_is(deck):
    mesh = deck(PLAIN + "*NSET, NSET=Locked\n22\n*ELSET, ELSET=LOCKED\n4\n").mesh
    assert locked(mesh) == [22]
    assert mesh.element_ids[mesh.locked_elements].tolist() == [4]


RANDOM_SETS = st.lists(st.sets(st.sampled_from(ALL), min_size=1), min_size=4, max_size=4)
SUBJECTS = st.sampled_from(["A", "B", "C", "D", "22", "25"])


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None)
@given(
    RANDOM_SETS,
    st.lists(st.tuples(SUBJECTS, st.sampled_from(["20.", "20.0", "30."])), max_size=4),
    st.lists(SUBJECTS, max_size=2),
    st.booleans(),
)
def test_whoever_is_born_has_what_all_around_have_and_no_load(
    tmp_path, sets, warm, loaded, generated
):
    names = dict(zip("ABCD", sets, strict=True))
    text = PLAIN + "".join(
        f"*NSET, NSET={name}, GENERATE\n" + "".join(f"{i}, {i}\n" for i in sorted(members))
        if generated
        else f"*NSET, NSET={name}\n{listed(sorted(members))}"
        for name, members in names.items()
    )
    text += "*TEMPERATURE\n" + "".join(f"{subject}, {value}\n" for subject, value in warm)
    text += "*CLOAD\n" + "".join(f"{subject}, 3, 1.\n" for subject in loaded)
    (tmp_path / "deck.inp").write_text(text)
    source = read_deck(tmp_path / "deck.inp")
    free = free_quads(source.mesh)

    def temperatures(model):
        """Of each node, the last that a line gives it."""
        return {
            node: float(value)
            for subject, value in model.rows["TEMPERATURE"]
            for node in ([int(subject)] if subject.isdigit() else model.nsets[subject])
        }

    before = read_model(text)
    after = read_model(written(source, fanned(source.mesh, *free)))
    old, new = temperatures(before), temperatures(after)
    assert {node: new.get(node) for node in before.nodes} == {
        node: old.get(node) for node in before.nodes
    }
    born = sorted(after.nodes.keys() - before.nodes.keys())
    assert len(born) == len(free)
    for node, element in zip(born, free, strict=True):
        around = {old.get(corner) for corner in before.elements[element][1]}
        assert new.get(node) == (around.pop() if len(around) == 1 else None)
    for subject in loaded:
        assert after.nsets[subject] == before.nsets[subject]
