"""Criteria sets and the files that they come from."""

import pickle
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from meshops.criteria import (
    FALLING,
    LENGTHS,
    NAMES,
    PAPER,
    STANDARD,
    Criteria,
    Criterion,
)
from meshops.criteria_files import dump_criteria, load_criteria
from meshops.errors import InputError

HYPERMESH = """\
# Criterion            On Wt    Ideal    Good    Warn    Fail   Worst
 0 penalty value                 0.00    0.00    0.80    1.00   10.00
 1 min length          1  1.0   10.00    9.00    4.00    2.00    1.00    1   59    0
 2 max length\t1 1.0  10.00   12.00   15.00   20.00   30.00
 3 aspect ratio        1  2.5    1.00    2.00    4.40    5.00   10.00
   Warpage             1  1      0.00    5.00   13.00   15.00   30.00

 5 max angle quad      1  1     90.00  110.00  134.00  140.00  160.00
 6 min angle quad      1  1     90.00   70.00   46.00   40.00   20.00
 7 max angle tria      1  1     60.00   80.00  112.00  120.00  150.00
 8 min angle tria      1  1     60.00   50.00   34.00   30.00   15.00
 9 skew                0  1      0.00   10.00   34.00   40.00   70.00   # off
10 jacobian1   1    1.00 0.900 0.700 0.600 0.300
11 chordal  dev        1  1      0.00    0.30    0.80    1.00    2.00
12 taper               1  1      0.00    0.20    0.50    0.60    0.90
13 % of trias          1  1      0.00    6.00   10.00   15.00   20.00    0    0   -1
14 QI color legend            32      32       7       6       3           3   -1
15 time_step           0      10.000                   0.010            0   59   12
   Global_solver -1
"""


def file(tmp_path, text, name="mine.toml"):
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return str(path)


def test_built_in_sets():
    assert load_criteria("standard") is STANDARD
    assert load_criteria("paper") is PAPER
    fails = PAPER.at(5.0).levels[:, 3]
    # Figure 5
    figure = [2.5, 7.5, 3, 15, 140, 40, 120, 30, 40, 0.6, 1.0, 0.6, 15]
    assert fails == pytest.approx(figure)
    assert [c for c in PAPER.criteria if c == STANDARD[c.name]] == [
        c for c in STANDARD.criteria if c.name not in (*LENGTHS, "aspect ratio")
    ]


def test_lengths_follow_the_target_size_and_nothing_else_does():
    small, large = STANDARD.at(1.0).levels, STANDARD.at(8.0).levels
    for name, one, other in zip(NAMES, small, large, strict=True):
        np.testing.assert_array_equal(other, one * 8 if name in LENGTHS else one)


def test_scoring_is_a_value():
    scoring = PAPER.at(5.0)
    assert scoring == PAPER.at(5.0) != PAPER.at(4.0)
    assert {scoring: 1}[PAPER.at(5.0)] == 1
    with pytest.raises(FrozenInstanceError):
        scoring.size = 3.0
    for copy in (scoring, pickle.loads(pickle.dumps(scoring))):
        assert copy == scoring
        for array, own in zip(copy.arrays[:4], scoring.arrays[:4], strict=True):
            np.testing.assert_array_equal(array, own)
            with pytest.raises(ValueError, match="read-only"):
                array[...] = 0


def test_chordal_deviation_is_active_with_a_reference_only():
    row = NAMES.index("chordal dev")
    scoring = STANDARD.at(1.0)
    assert np.flatnonzero(~scoring.active).tolist() == [row]
    assert replace(scoring, with_reference=True).active.all()


@pytest.mark.parametrize("size", [0.0, -1.0, float("nan"), float("inf")])
def test_target_size_must_be_positive(size):
    with pytest.raises(InputError, match="size must be positive"):
        STANDARD.at(size)


def five():
    return st.lists(st.floats(-1e9, 1e9, allow_nan=False), min_size=5, max_size=5, unique=True).map(
        sorted
    )


@st.composite
def sets(draw):
    criteria = []
    for name in NAMES:
        levels = draw(five())
        criteria.append(
            Criterion(
                name,
                tuple(levels[::-1] if name in FALLING else levels),
                weight=draw(st.floats(0, 1e6)),
                active=draw(st.booleans()),
                scaled=name in LENGTHS and draw(st.booleans()),
            )
        )
    penalties = tuple(abs(p) for p in sorted(draw(five()), key=abs))
    assumed = penalties if penalties[3] < penalties[4] else (0.0, 0.0, 0.8, 1.0, 10.0)
    text = st.text(st.characters(codec="utf-8"), max_size=20)
    return Criteria(draw(text), tuple(criteria), assumed, draw(st.booleans()))


@settings(max_examples=30, deadline=None)
@given(sets())
def test_toml_loads_back_equal(tmp_path_factory, criteria):
    path = tmp_path_factory.getbasetemp() / "round-trip.toml"
    path.write_bytes(dump_criteria(criteria).encode())
    assert load_criteria(str(path)) == criteria


def test_toml_on_a_base(tmp_path):
    text = """
        name = "ours"
        base = "paper"
        normalised_size = true
        penalties = { worst = 20 }
        [criteria."max length"]
        worst = 2
        weight = 3
        [criteria.skew]
        active = false
    """
    expected = PAPER.having(
        replace(PAPER["max length"], levels=(1.0, 1.2, 1.4, 1.5, 2.0), weight=3.0),
        replace(PAPER["skew"], active=False),
        name="ours",
        penalties=(0.0, 0.0, 0.8, 1.0, 20.0),
    )
    assert load_criteria(file(tmp_path, text)) == replace(expected, normalised_size=True)


def test_toml_without_a_base_is_off_where_it_says_nothing(tmp_path):
    text = """
        [criteria."min size"]
        ideal = 5
        good = 4.5
        warn = 2.0
        fail = 1
        worst = 0.5
    """
    criteria = load_criteria(file(tmp_path, text, "our-lengths.toml"))
    assert criteria.name == "our-lengths"
    assert [c.name for c in criteria.criteria if c.active] == ["min size"]
    assert criteria.at(77.0).levels[0].tolist() == [5, 4.5, 2, 1, 0.5, -np.inf]


TOML_ERRORS = {
    "name = ": "TOML",
    "colour = 1": 'no key "colour"',
    "name = 3": '"name" must be a text',
    'base = "best"': 'base "best" is none of standard, paper',
    "normalised_size = 1": '"normalised_size" must be true or false',
    "criteria = 1": '"criteria" must be a table',
    "penalties = 1": '"penalties" must be a table',
    "penalties = { bad = 1 }": 'no key "bad" in penalties',
    "penalties = { warn = 2 }": "penalties must rise",
    "penalties = { fail = 10 }": "worst beyond fail",
    "penalties = { ideal = -1 }": "none below 0",
    "penalties = { worst = inf }": "finite",
    "[criteria.beauty]": 'no criterion "beauty"',
    "[criteria]\nskew = 1": '"skew" must be a table',
    "[criteria.skew]\nideal = 0\ngood = 1\nwarn = 2\nfail = 3": 'level "worst" is missing in '
    'criterion "skew"',
    'base = "paper"\n[criteria.skew]\nsize = 1': 'no key "size" in criterion "skew"',
    'base = "paper"\n[criteria.skew]\nfail = "3"': '"fail" in criterion "skew" must be a number',
    'base = "paper"\n[criteria.skew]\nfail = true': "must be a number",
    'base = "paper"\n[criteria.skew]\nfail = 1' + 400 * "0": "larger than a number can be",
    'base = "paper"\n[criteria.skew]\nfail = 20': 'levels of "skew" must rise',
    'base = "paper"\n[criteria.Jacobian]\nfail = 0.8': 'levels of "Jacobian" must fall',
    'base = "paper"\n[criteria.skew]\nworst = nan': "finite",
    'base = "paper"\n[criteria.skew]\nweight = -1': 'weight of "skew" must be 0 or more',
    'base = "paper"\n[criteria.skew]\nactive = 1': '"active" in criterion "skew" must be true',
    'base = "paper"\n[criteria.skew]\nscaled = true': "is no length",
}


@pytest.mark.parametrize(("text", "message"), TOML_ERRORS.items())
def test_toml_errors_are_one_sentence_with_the_file(tmp_path, text, message):
    path = file(tmp_path, text)
    with pytest.raises(InputError, match="^" + "(?s:.*)".join(map(escape, (path, message)))) as e:
        load_criteria(path)
    assert "\n" not in str(e.value)


def escape(text):
    return "".join(c if c.isalnum() or c in '/"- ,' else "." for c in text)


@pytest.mark.parametrize("name", ["mine.criteria", "mine.txt", "MINE.TXT"])
def test_hypermesh_text(tmp_path, name):
    criteria = load_criteria(file(tmp_path, HYPERMESH, name))
    scoring = criteria.at(3.0)
    np.testing.assert_allclose(scoring.levels, STANDARD.at(10.0).levels)
    assert scoring.weights.tolist() == [1, 1, 2.5, *[1] * 10]
    assert [c.name for c in criteria.criteria if not c.active] == ["skew"]
    assert not any(c.scaled for c in criteria.criteria)
    assert criteria.name == name.split(".")[0]


def test_what_hypermesh_text_leaves_out_is_off(tmp_path):
    text = "skew 1 1 0 10 35 45 90\npenalty value 0 0 0.5 1 5\n"
    criteria = load_criteria(file(tmp_path, text, "a.txt"))
    assert [c.name for c in criteria.criteria if c.active] == ["skew"]
    assert criteria["skew"].levels == (0, 10, 35, 45, 90)
    assert criteria.penalties == (0, 0, 0.5, 1, 5)


def test_files_of_windows_are_read(tmp_path):
    path = tmp_path / "windows.criteria"
    path.write_bytes(b"\xef\xbb\xbf" + HYPERMESH.replace("\n", "\r\n").encode())
    assert load_criteria(str(path)).criteria == (
        load_criteria(file(tmp_path, HYPERMESH, "unix.criteria")).criteria
    )


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("9 beauty 1 1 0 10 35 45 90", "names none of the criteria"),
        ("what is this", "names none of the criteria"),
        ("9 skew 1 1 0 10 35 45", "needs 0 or 1, a weight and five levels"),
        ("9 skew 2 1 0 10 35 45 90", "needs 0 or 1, a weight and five levels"),
        ("9 skew 1 1 0 10 x 45 90", "something else than numbers"),
        ("9 skewed 1 1 0 10 35 45 90", "something else than numbers"),
        ("9 skew 1 1 0 10 45 35 90", "must rise"),
        ("9 skew 1 -1 0 10 35 45 90", "weight"),
        ("9 skew 1 1 0 10 35 45 nan", "finite"),
        ("4 warpage 1 1 0 5 13 15 30", "second time"),
        ("0 penalty value 0 0 1 10", "five values"),
    ],
)
def test_hypermesh_errors_name_file_and_line(tmp_path, line, message):
    path = file(tmp_path, f"# mine\n 4 warpage 1 1 0 5 13 15 30\n{line}\n", "a.criteria")
    with pytest.raises(InputError, match=message) as error:
        load_criteria(path)
    assert str(error.value).startswith(f"{path}: line 3: ")


def test_other_errors_of_files(tmp_path):
    with pytest.raises(InputError, match="neither standard nor paper nor a file"):
        load_criteria("strict")
    with pytest.raises(InputError, match="a criteria file ends in"):
        load_criteria(file(tmp_path, HYPERMESH, "a.csv"))
    with pytest.raises(InputError, match="names no criterion"):
        load_criteria(file(tmp_path, "# nothing\n", "a.txt"))
    with pytest.raises(InputError, match="neither"):
        load_criteria(str(tmp_path))
    path = tmp_path / "latin.txt"
    path.write_bytes(b"skew \xe9")
    with pytest.raises(InputError, match="UTF-8"):
        load_criteria(str(path))
    bad_penalties = file(tmp_path, "skew 1 1 0 1 2 3 4\npenalty value 0 0 3 1 5", "b.txt")
    with pytest.raises(InputError, match=r"b\.txt: penalties must rise"):
        load_criteria(bad_penalties)


def test_a_set_has_all_criteria_in_order():
    with pytest.raises(ValueError, match="in this order"):
        Criteria("short", STANDARD.criteria[:12])
