"""The grammar of Abaqus input: names, keyword lines, comments, includes, numbers."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshops.errors import InputError
from meshops.formats import read_deck, write_mesh
from meshops.formats.abaqus_blocks import blocks, fields, name_key, without_instance
from meshops.formats.abaqus_output import number
from tests.abaqus_reader import fanned, read_model, written
from tests.decks import bad_plate
from tests.test_abaqus_nodes import ALL, ELEMENTS, NODES, PLAIN, listed, locked


@pytest.fixture
def deck(tmp_path):
    def make(text):
        (tmp_path / "deck.inp").write_text(text)
        return read_deck(tmp_path / "deck.inp")

    return make


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("Skin", "SKIN"),
        (" Skin Panel ", "SKINPANEL"),
        ('"Skin Panel-a"', '"Skin Panel-a"'),
        ('one."Set 1"', 'ONE."Set 1"'),
    ],
)
def test_names_are_equal_in_capitals_but_not_in_quotes(text, key):
    assert name_key(text) == key


def test_commas_in_quotes_part_nothing():
    assert fields('*ELEMENT, ELSET="a, b", TYPE = S4,') == [
        "*ELEMENT",
        'ELSET="a, b"',
        "TYPE = S4",
        "",
    ]
    assert fields('1, "unfinished, 2') == ["1", '"unfinished, 2"']


@pytest.mark.parametrize(
    ("token", "parted"),
    [
        ("17", ("", "17")),
        ("Part-1-1.17", ("Part-1-1.", "17")),
        ('"Part 1.a-1".17', ('"Part 1.a-1".', "17")),
        ('"Part 1-1.17"', ('"Part 1-1".', "17")),
        ("one.Set-1", ("one.", "Set-1")),
        ("1.5", ("", "1.5")),
        ("-.5", ("", "-.5")),
        ('"v1.b"', ("", '"v1.b"')),
        ("", ("", "")),
    ],
)
def test_instances_before_ids_and_names(token, parted):
    assert without_instance(token) == parted


def plain(text):
    return "".join(text.replace('"', "").split())


@given(st.text(alphabet='*,."= ab1\n\t', max_size=80))
def test_no_text_is_too_odd_for_keyword_lines(text):
    lines = text.splitlines(keepends=True)
    for block in blocks(lines):
        assert set(block.header) | set(block.data) <= set(range(len(lines)))
        assert lines[block.header[0]].lstrip().startswith("*")
    for line in lines:
        for token in fields(line):
            assert plain("".join(without_instance(token))) == plain(token)


ODD = f"""\
  *HEADING
1, 2, a text
   ** 11, 5., 5.
*Node  ,
** between
  nset = Held Nodes,
  {NODES[11].strip()},
\t{NODES[12]}   **12, 9., 9., 9.
{"".join(NODES[node] for node in ALL if node > 12)}
 *element,elset="Skin, Panel-a" , TYPE=s4
{ELEMENTS}*Nset, nset=all, unsorted, GENERATE,
 11, 36
  *Boundary
   heldnodes , 3
"""


def test_blanks_comments_and_commas_where_they_may_stand(deck):
    source = deck(ODD)
    assert len(source.mesh.elements) == 10
    assert source.mesh.points[0].tolist() == [1.0, 1.0, 0.0]
    assert not source.mesh.locked_nodes.any()
    text = written(source, fanned(source.mesh, 1))
    assert '*ELEMENT, TYPE=S3, ELSET="Skin, Panel-a"\n11, ' in text
    assert "36, 6., 3., 0.\n37, 1.5, 1.5, 0.0\n" in text
    assert written(source, source.mesh, "same.inp") == ODD


def test_a_quoted_set_is_used_by_its_own_name_alone(deck):
    named = PLAIN + f'*NSET, NSET="Fix a"\n{listed([11, 21])}*BOUNDARY\n'
    assert locked(deck(named + '"Fix a", 1, 6\n').mesh) == [11, 21]
    assert locked(deck(named + "FIXA, 1, 6\n").mesh) == []


def test_long_names(deck):
    name = "a" * 76 + "_set"
    source = deck(PLAIN.replace("ELSET=E", f"ELSET={name}") + f"*DLOAD\n{name.upper()}, P, 1.\n")
    assert f"*ELEMENT, TYPE=S3, ELSET={name}\n" in written(source, fanned(source.mesh, 1))


@pytest.mark.parametrize("parameter", ["SUBMODEL, TYPE=NODE, INPUT=big.frd", "AMPLITUDE, INPUT=t"])
def test_files_that_are_no_deck_are_not_read(deck, tmp_path, parameter):
    (tmp_path / "big.frd").write_bytes(b"\0 1C\n*NODE\n")
    source = deck(PLAIN + f"*{parameter}\n")
    assert len(source.mesh.elements) == 10
    assert [note for note in source.notes if "stays where it is" in note]


@pytest.mark.parametrize("keyword", ["*INCLUDE, INPUT=", "  *include,input = ", "*NODE, INPUT="])
def test_missing_parts_of_a_deck_are_named(deck, keyword):
    with pytest.raises(InputError, match=r"deck\.inp, line 31: the included file 'no\.inp' "):
        deck(PLAIN + keyword + "no.inp\n")


def test_a_nested_include_is_found_in_the_folder_of_the_deck(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "mesh.inc").write_text(PLAIN + "*INCLUDE, INPUT=sets.inc\n")
    (tmp_path / "sets.inc").write_text("*NSET, NSET=FIX\n11, 21\n")
    (tmp_path / "sub" / "more.inc").write_text("*BOUNDARY\nFIX, 1, 6\n")
    (tmp_path / "main.inp").write_text(
        "*INCLUDE, INPUT=sub/mesh.inc\n*INCLUDE, INPUT=sub/more.inc\n"
    )
    source = read_deck(tmp_path / "main.inp")
    assert locked(source.mesh) == [11, 21]
    source.write(fanned(source.mesh, 3), tmp_path / "out" / "new.inp")
    for path in tmp_path.rglob("*.in?"):
        if "out" not in path.parts:
            path.unlink()
    again = read_deck(tmp_path / "out" / "new.inp")
    assert len(again.mesh.elements) == 13
    assert locked(again.mesh) == [11, 21]


def test_elements_of_an_input_file_stay_without_a_keyword_in_it(deck, tmp_path):
    (tmp_path / "e.dat").write_text(ELEMENTS)
    (tmp_path / "n.dat").write_text("".join(NODES.values()))
    source = deck("*NODE, NSET=N, INPUT=n.dat\n*ELEMENT, TYPE=S4, INPUT=e.dat\n*CLOAD\nN, 3, 1.\n")
    text = written(source, fanned(source.mesh, 1))
    assert text.startswith("*NODE, NSET=N, INPUT=n.dat\n*NODE\n37, 1.5, 1.5, 0.0\n*ELEMENT")
    folder = tmp_path / "written"
    assert "*" not in (folder / "e.dat").read_text()
    assert len(read_deck(folder / "out.inp").mesh.elements) == 13


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_numbers_have_20_characters_at_most(value):
    text = number(value)
    assert len(text) <= 20
    assert float(text) == pytest.approx(value, rel=1e-12, abs=0)
    assert "." in text or "E" in text


def test_a_new_deck_is_one_for_calculix_too(tmp_path):
    mesh = bad_plate()
    write_mesh(mesh, tmp_path / "new.inp")
    text = (tmp_path / "new.inp").read_text()
    assert {kind for kind, _ in read_model(text).elements.values()} == {"S4R", "S3"}
    assert max(len(token.strip()) for line in text.splitlines() for token in line.split(",")) <= 20
