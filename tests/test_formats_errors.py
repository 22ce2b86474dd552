"""Every kind of bad input ends in one clear sentence."""

import pytest

from meshops.errors import InputError
from meshops.formats import check_writable_suffix, read_deck

GRIDS = "GRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nGRID,3,,1.,1.,0.\nGRID,4,,0.,1.,0.\n"
QUAD = "CQUAD4,7,3,1,2,3,4\n"
NODES = "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n"
SHELL = "*ELEMENT, TYPE=S4\n7,1,2,3,4\n"
OFF = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def sentence_of(path):
    with pytest.raises(InputError) as caught:
        read_deck(path)
    sentence = str(caught.value)
    assert "\n" not in sentence
    assert sentence.endswith(".")
    return sentence


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (GRIDS, "deck.bdf holds no linear shell element"),
        (QUAD, "line 1: element 7 names nodes, but there are none"),
        (GRIDS + "CQUAD4,7,3,1,2,3,9\n", "line 5: element 7 names node 9, which is not defined"),
        (GRIDS + "CQUAD4,7,3,1,2,2,4\n", "line 5: element 7 names node 2 twice"),
        (GRIDS + "CTRIA3,7,3,1,2,2\n", "line 5: element 7 names node 2 twice"),
        (GRIDS + "CQUAD4,7,3,1,2,1,4\n", "line 5: element 7 names node 1 twice"),
        (GRIDS + "CQUAD4,7,3,1,1,4,4\n", "line 5: element 7 names node 1 twice"),
        (
            GRIDS + QUAD + QUAD,
            "line 6: element 7 is defined a second time (first: deck.bdf, line 5",
        ),
        (GRIDS + QUAD + "CQUAD4,8,3,3,4,1,2\n", "line 6: elements 7 and 8 lie on the same nodes"),
        (GRIDS + "GRID,2,,1.,0.,.5\n" + QUAD, "line 5: node 2 is defined a second time"),
        (GRIDS + "GRID,2,,1.,0.,0.,5\n" + QUAD, "line 5: node 2 is defined a second time"),
        (GRIDS.replace("1.,1.", "1.,nan") + QUAD, "line 3: node 3 has a coordinate that is not"),
        (GRIDS.replace("1.,1.", "1.,1e999") + QUAD, "line 3: node 3 has a coordinate that is not"),
        (GRIDS.replace("1.,1.", "1.,1x") + QUAD, "line 3: field 5 of GRID is '1x'; it has to be a"),
        (GRIDS + "CQUAD4,7,3,1,2,3.,4\n", "line 5: field 6 of CQUAD4 is '3.'; it has to be an int"),
        (GRIDS + f"CQUAD4,{10**30},3,1,2,3,4\n", "line 5: field 2 of CQUAD4"),
        (GRIDS + "CQUAD4,7,3,1,2,3,\xb2\n", "line 5: field 7 of CQUAD4 is"),
        (GRIDS + "CQUAD4,7,3,1,2,3\n", "line 5: field 7 of CQUAD4 is blank"),
        ("=,*1,=\n" + GRIDS + QUAD, "line 1: '=' repeats no card of one line"),
        (GRIDS + QUAD + ",,.1\n=,*1,=\n", "line 7: '=' repeats no card of one line"),
        (GRIDS + "=,*x,=\n" + QUAD, "line 5: 'x' cannot be added to '4'"),
        (GRIDS.replace("2,,1", "2,8,1") + QUAD, "line 2: GRID 2 uses coordinate system 8, which"),
        (
            "CORD2R,8,9,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nCORD2R,9,8,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
            + GRIDS.replace("2,,1", "2,8,1")
            + QUAD,
            "coordinate system 8 is defined by itself",
        ),
        (
            "CORD2R,8,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\n" + GRIDS.replace("2,,1", "2,8,1") + QUAD,
            "line 1: the three points of coordinate system 8 lie on a line",
        ),
        (
            "CORD1R,8,1,3,77\n" + GRIDS.replace("2,,1", "2,8,1") + QUAD,
            "line 1: CORD1R names node 77, which is not defined",
        ),
        (GRIDS + "INCLUDE 'none.bdf'\n", "line 5: the included file 'none.bdf' does not exist"),
        (GRIDS + "INCLUDE 'deck.bdf'\n", "line 5: 'deck.bdf' includes itself"),
        (
            "BEGIN BULK\n" + GRIDS + "BEGIN SUPER=1\nGRID,9,,0.,0.,0.\n" + QUAD,
            "line 8: element 7 names nodes, but there are none",
        ),
        ("\0\0GRID", "is not a text file"),
    ],
)
def test_nastran(tmp_path, text, words):
    (tmp_path / "deck.bdf").write_text(text)
    assert words in sentence_of(tmp_path / "deck.bdf")


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (NODES, "holds no linear shell element"),
        (NODES + SHELL.replace("3,4", "3,9"), "line 7: element 7 names node 9, which is not"),
        (NODES + SHELL.replace("3,4", "3,x"), "line 7: value 5 is 'x'; it has to be an id"),
        (NODES + SHELL.replace(",3,4", ",3"), "line 7: value 5 is missing"),
        (NODES.replace("2,1,0", "2,1,a") + SHELL, "line 3: a coordinate of node 2 is not a number"),
        (NODES.replace("2,1,0", "2,1,inf") + SHELL, "line 3: node 2 has a coordinate that is not"),
        (NODES + "*NGEN\n1,4\n" + SHELL, "line 6: *NGEN is not read"),
        (NODES + "2,5,5,5\n" + SHELL, "line 6: node 2 is defined a second time"),
        (
            f"*PART, NAME=a\n{NODES}{SHELL}*END PART\n*PART, NAME=b\n{NODES}{SHELL}7,1,2,3,4\n",
            "line 18: element 7 is defined a second time",
        ),
        (NODES + "*INCLUDE, INPUT=none.inp\n", "line 6: the included file 'none.inp' does not"),
    ],
)
def test_abaqus(tmp_path, text, words):
    (tmp_path / "deck.inp").write_text(text)
    assert words in sentence_of(tmp_path / "deck.inp")


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("m.off", OFF + "5 0 1 2 3 0\n", "line 7: the face has 5 corners"),
        ("m.off", OFF + "4 0 1 2 9\n", "m.off, line 7: element 1 names node 10"),
        ("m.off", OFF, "0 of 1 faces"),
        ("m.off", OFF + f"4 0 1 2 {10**30}\n", "are not all integers"),
        ("m.off", "ply\n", "line 1: an OFF file begins with OFF"),
        ("m.off", OFF.replace("1 1 0", "1 y 0") + "4 0 1 2 3\n", "line 5: '1 y 0' are not all"),
        ("m.obj", OBJ + "f 1 2 3 4 1\n", "line 5: the face has 5 corners"),
        ("m.obj", OBJ + "f 1 2 3 3\n", "line 5: element 1 names node 3 twice"),
        ("m.obj", OBJ, "holds no linear shell element"),
        ("m.vtu", "no xml", "cannot be read as vtu"),
        ("m.msh", "nothing", "cannot be read as gmsh"),
        ("m.stl", "solid x\nfacet", "cannot be read as stl"),
        ("m.stl", "", "cannot be read as stl"),
    ],
)
def test_interchange(tmp_path, capfd, name, text, words):
    (tmp_path / name).write_text(text)
    assert words in sentence_of(tmp_path / name)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["none.bdf", "none.inp", "none.vtu", "none.STL", "none.obj"])
def test_missing_files_and_folders(tmp_path, name):
    assert "does not exist" in sentence_of(tmp_path / name)
    (tmp_path / name).mkdir()
    assert "is a folder" in sentence_of(tmp_path / name)


@pytest.mark.parametrize("name", ["deck.foo", "deck", "deck.step"])
def test_unknown_formats_name_the_known_ones(tmp_path, name):
    (tmp_path / name).write_text("")
    assert ".bdf .dat .nas .blk .inp .vtu .msh .stl .obj .off" in sentence_of(tmp_path / name)
    with pytest.raises(InputError, match="use one of"):
        check_writable_suffix(tmp_path / name)


def test_where_nothing_can_be_written_is_said_early(tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "out.bdf").mkdir()
    check_writable_suffix(tmp_path / "new" / "deck.BDF")
    with pytest.raises(InputError, match="not a folder"):
        check_writable_suffix(tmp_path / "file" / "deck.bdf")
    with pytest.raises(InputError, match="is a folder"):
        check_writable_suffix(tmp_path / "out.bdf")
