"""Reading Nastran decks: card forms, coordinate systems, regions, includes."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshops.errors import InputError
from meshops.formats import read_deck
from meshops.formats.fortran import real, real_field
from meshops.formats.nastran_cards import Form, card_lines, lex

DATA = Path(__file__).parents[2] / "shared" / "data"
needs_data = pytest.mark.skipif(not DATA.is_dir(), reason="no shared data")

SQUARE = """\
GRID           1              0.      0.      0.
GRID           2              1.      0.      0.
GRID           3              1.      1.      0.
GRID           4              0.      1.      0.
"""
QUAD = "CQUAD4         7       3       1       2       3       4\n"


@pytest.fixture
def read(tmp_path):
    def read(text, name="deck.bdf"):
        path = tmp_path / name
        path.write_text(text, encoding="latin-1", newline="")
        return read_deck(path)

    return read


@needs_data
@pytest.mark.parametrize(
    ("name", "quads", "trias"),
    [
        ("pynastran_dummy_wing_metallic.bdf", 1548, 339),
        ("tacs_disk.bdf", 1232, 22),
        ("tacs_fuselage.bdf", 8157, 480),
    ],
)
def test_public_decks_have_the_published_counts(name, quads, trias):
    mesh = read_deck(DATA / name).mesh
    assert (np.sum(~mesh.is_tria), np.sum(mesh.is_tria)) == (quads, trias)


def test_small_fields_without_blanks_between_them(read):
    mesh = read(
        SQUARE.replace("      1.      0.      0.", "-2.18802-7.59-161.234567", 1) + QUAD
    ).mesh
    assert mesh.points[1].tolist() == [-2.18802, -7.59e-16, 1.234567]


@pytest.mark.parametrize(
    "text",
    [
        "GRID*                  4                              0.            1.25\n"
        "*                    0.5\n",
        "GRID*                  4                              0.            1.25*G4\n"
        "*G4                   .5\n",
        "grid*,4,,0.,1.25\n*,.5\n",
        "GRID,4,,0.,1.25,.5\n",
        "GRID, 4 , , 0. , 12.5-1 , 5.D-1 $ comment\n",
        "GRID\t4\t\t0.\t1.25\t.5\n",
        "grid           4              0.    1.25      .5\n",
        "GRID           4              0.    1.25      .5\r\n",
        "GRID,4,,0.,1.25,+5.E-1\n",
    ],
)
def test_every_way_to_type_a_grid(read, text):
    deck = SQUARE.splitlines(keepends=True)
    mesh = read("".join(deck[:3]) + text + QUAD).mesh
    assert mesh.points[3].tolist() == [0.0, 1.25, 0.5]


@pytest.mark.parametrize(
    "text",
    [
        "CQUAD4,7,3,1,2,3,4,30.,.1,+\n+,,1,.5,.5,.5,.5\n",
        "CQUAD4,7,3,1,2,3,4,30.,.1\n,,1,.5,.5,.5,.5\n",
        "CQUAD4         7       3       1       2       3       4     30.      .1+A\n"
        "$ between\n+A                     1      .5      .5      .5      .5\n",
        "CQUAD4         7       3       1       2       3       4     30.      .1\n"
        "                       1      .5      .5      .5      .5\n",
        "CQUAD4*                7               3               1               2*\n"
        "*                      3               4             30.              .1*\n"
        "*                                      1              .5              .5*\n"
        "*                     .5              .5\n",
        "CQUAD4         7       3       1       2       3       4     30.      .1\n"
        "*                                      1              .5              .5*\n"
        "*                     .5              .5\n",
    ],
)
def test_continuations_of_every_style_carry_the_attributes(read, text):
    deck = read(SQUARE + text)
    attributes = deck.regions[0]
    assert (attributes.theta, attributes.zoffs, attributes.tflag) == ("30.", ".1", "1")
    assert attributes.thickness == (".5", ".5", ".5", ".5")
    assert deck.mesh.element_ids.tolist() == [7]


@pytest.mark.parametrize("width", ["free", "small", "wide"])
def test_cards_read_as_they_were_written(width):
    form = Form(free=width == "free", wide=width == "wide")
    fields = ["12", "3", "1", "2", "3", "4", "", ".25", "", "", ".1", ".1", ".1", "1.234567"]
    (card,) = lex(card_lines("CQUAD4", fields, form), 0)
    assert [card.field(i) for i in range(14)] == fields
    assert card.form == form


def test_a_long_field_makes_small_fields_wide():
    lines = card_lines("GRID", ["1", "", "1.23456789", "2.", "3."], Form())
    assert len(lines) == 2
    assert lines[0].startswith("GRID*")
    assert lines[0][40:56].strip() == "1.23456789"


@given(st.floats(allow_nan=False, allow_infinity=False, min_value=-1e90, max_value=1e90))
def test_reals_survive_a_wide_field(value):
    text = real_field(value)
    assert len(text) <= 16
    assert "." in text
    assert real(text) == pytest.approx(value, rel=1e-9, abs=1e-95)


@given(st.integers(-9999999, 9999999), st.integers(0, 4))
def test_short_decimals_survive_exactly_and_short(digits, places):
    value = digits / 10**places
    assert real(real_field(value)) == value
    assert len(real_field(value)) <= 9


@pytest.mark.parametrize(
    ("text", "value"),
    [("1.5-3", 1.5e-3), ("1.D+2", 100.0), (".5", 0.5), ("-2.", -2.0), ("", 0.0), ("1.e2", 100.0)],
)
def test_nastran_reals(text, value):
    assert real(text) == value


@pytest.mark.parametrize("text", ["1_0", "1.2.3", "x", "1.5-", "--1."])
def test_what_is_no_real_is_refused(text):
    with pytest.raises(ValueError):  # noqa: PT011 - the reason is the type
        real(text)


def test_sections_around_the_bulk_data_are_passed_over(read):
    deck = (
        "SOL 101\nCEND\n  TITLE = GRID,1\nBEGIN BULK\n" + SQUARE + QUAD + "ENDDATA\n" + QUAD + "x\n"
    )
    assert len(read(deck).mesh.elements) == 1


def test_higher_order_shells_are_left_alone_and_lock_their_nodes(read):
    grids = SQUARE + "GRID,5,,2.,0.,0.\nGRID,6,,2.,1.,0.\n"
    mesh = read(grids + QUAD + "CTRIA6,9,3,2,5,6,3,3,3\n").mesh
    assert mesh.node_ids.tolist() == [1, 2, 3, 4]
    assert mesh.locked_nodes.tolist() == [False, True, True, False]


def test_regions_part_what_attributes_part(read):
    grids = "".join(f"GRID,{i},,{i}.,{i * i}.,0.\n" for i in range(1, 30))
    shells = [
        "CQUAD4,1,1,1,2,3,4",
        "CQUAD4,2,1,2,3,4,5,0.0",
        "CTRIA3,3,1,1,2,3",
        "CQUAD4,4,2,3,4,5,6",
        "CQUADR,5,1,4,5,6,7",
        "CQUAD4,6,1,5,6,7,8,0",
        "CQUAD4,7,1,6,7,8,9,30",
        "CTRIA3,8,1,7,8,9,30",
        "CQUAD4,9,1,8,9,10,11,,.1",
        "CQUAD4,10,1,9,10,11,12,,,+\n+,,,.1,.1,.1,.1",
        "CTRIA3,11,1,10,11,12,,,+\n+,,,.1,.1,.1",
        "CQUAD4,12,1,12,13,14,15,,,+\n+,,,.1,.2,.1,.1",
    ]
    mesh = read(grids + "\n".join(shells) + "\n").mesh
    assert mesh.region.tolist() == [0, 0, 0, 1, 2, 3, 4, 4, 5, 6, 6, 7]
    # a thickness that differs from node to node belongs to these nodes
    assert np.flatnonzero(mesh.locked_elements).tolist() == [11]


def test_coordinate_systems_chained_and_of_both_kinds(read):
    deck = (
        "CORD2R,1,,10.,0.,0.,10.,0.,1.\n,10.,1.,0.\n"  # origin (10,0,0), x along basic y
        "CORD2C,2,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
        "CORD2S,3,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\n"
        "CORD1R,4,5,6,7\n"
        "GRID,1,1,2.,3.,4.\nGRID,2,2,2.,90.,4.\nGRID,3,3,2.,90.,90.\nGRID,4,4,1.,2.,3.\n"
        "GRID,5,,0.,0.,5.\nGRID,6,,0.,0.,6.\nGRID,7,,0.,1.,5.\n"
    )
    points = read(deck + QUAD).mesh.points
    expected = [[7.0, 2.0, 4.0], [8.0, 0.0, 4.0], [8.0, 0.0, 0.0], [-2.0, 1.0, 8.0]]
    np.testing.assert_allclose(points, expected, atol=1e-12)


def test_grdset_fills_blanks_but_not_zeros(read):
    deck = "GRDSET,,1\nCORD2R,1,,10.,0.,0.,10.,0.,1.\n,11.,0.,0.\n" + SQUARE
    points = read(
        deck.replace("GRID           1        ", "GRID           1       0") + QUAD
    ).mesh.points
    assert points[:, 0].tolist() == [0.0, 11.0, 11.0, 10.0]


def test_includes_nested_quoted_and_over_several_lines(tmp_path, read):
    (tmp_path / "sub" / "deep").mkdir(parents=True)
    (tmp_path / "sub" / "nodes.bdf").write_text('INCLUDE "deep/last\n.bdf" $ x\n')
    (tmp_path / "sub" / "deep" / "last.bdf").write_text(SQUARE)
    assert len(read("include 'sub/\nnodes.bdf'\n" + QUAD).mesh.points) == 4
    assert len(read("INCLUDE sub\\nodes.bdf\n" + QUAD).mesh.points) == 4


def test_suffixes_in_capitals_and_other_bytes(read):
    assert len(read("$ gr\u00fc\u00dfe\u0085\n" + SQUARE + QUAD, "deck.BDF").mesh.elements) == 1


def test_equal_grids_twice_are_one_node(read):
    assert len(read(SQUARE + SQUARE + QUAD).mesh.points) == 4


def test_a_continuation_away_from_its_card_is_refused(read):
    with pytest.raises(InputError, match=r"line 6: the continuation '\+B' does not follow"):
        read(
            SQUARE
            + "CQUAD4         7       3       1       2       3       4                +A\n+B\n"
        )
