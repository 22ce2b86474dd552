"""Conditions under which a check fails."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from meshops.criteria import NAMES, PAPER
from meshops.errors import InputError
from meshops.gate import FIGURES, Condition
from meshops.quality_index import quality_index
from tests.decks import bad_plate

REPORT = quality_index(bad_plate(), PAPER.at(5.0))


@pytest.mark.parametrize(
    ("text", "is_met"),
    [
        ("failed>0", True),
        (f"failed>{REPORT.failed}", False),
        (f"failed>={REPORT.failed}", True),
        (f"failed=={REPORT.failed}", True),
        (f"failed<={REPORT.failed - 1}", False),
        (" shape > 0 ", REPORT.failed_by_shape > 0),
        ("size>1e9", False),
        ("trias<13", True),
        ("percent-trias>99", False),
        ("compound-qi>0", True),
        ("MEAN-QI<=0", False),
        ("elements<1", False),
        ("quads<1", False),
        ("min angle quad<90", True),
        ("Jacobian<0.0001", False),
        ("max angle quad>90", True),
        ("% of trias>0", True),
    ],
)
def test_conditions(text, is_met):
    assert Condition.parse(text).is_met(REPORT) == is_met


@given(
    st.sampled_from([*FIGURES, "min size", "skew", "warpage"]),
    st.sampled_from(["<", "<=", ">", ">=", "=="]),
    st.floats(-1e6, 1e6),
)
def test_a_condition_is_met_as_its_sign_says(name, sign, limit):
    condition = Condition.parse(f"{name}{sign}{limit!r}")
    value = condition.value(REPORT)
    assert value is not None
    # Python's own comparison of the figure in the report
    assert condition.is_met(REPORT) == eval(f"{value!r}{sign}{limit!r}")
    assert f"{name}{sign}" in condition.sentence(REPORT)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("failed", "no condition"),
        ("failed=0", "no condition"),
        ("failed>", "no condition"),
        ("failures>0", "percent-trias"),
        ("failed>many", "many"),
        ("failed>nan", "nan"),
        ("", "no condition"),
    ],
)
def test_what_is_no_condition_is_said(text, word):
    with pytest.raises(InputError, match=word):
        Condition.parse(text)


def test_a_gate_does_not_stay_open_because_a_criterion_is_off():
    off = PAPER.having(replace(PAPER["skew"], active=False), name="off").at(5.0)
    with pytest.raises(InputError, match="skew"):
        Condition.parse("skew>0").is_met(quality_index(bad_plate(), off))


def test_what_no_element_has_meets_no_condition():
    quads = bad_plate()
    quads = replace(
        quads,
        elements=quads.elements[~quads.is_tria],
        region=quads.region[~quads.is_tria],
        locked_elements=quads.locked_elements[~quads.is_tria],
        element_ids=quads.element_ids[~quads.is_tria],
    )
    report = quality_index(quads, PAPER.at(5.0))
    assert not Condition.parse("min angle tria<90").is_met(report)
    assert set(NAMES) >= {row.name for row in report.rows}
