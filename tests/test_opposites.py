"""Sides of narrow faces are divided alike, and every face evenly."""

from __future__ import annotations

from collections import Counter

from hypothesis import given
from hypothesis import strategies as st

from meshops.opposites import ALIKE, Face, Line, matched_divisions

SIDES = st.floats(0.3, 12.0)


def lines(lengths: dict[int, float]) -> dict[int, Line]:
    return {curve: Line(length) for curve, length in lengths.items()}


def test_the_two_circles_of_a_narrow_ring_are_divided_alike() -> None:
    ring = Face(3.0, ((1, 2), (3, 4)))
    lengths = {1: 5.5, 2: 5.5, 3: 3.3, 4: 3.3}
    round_ = {curve: Line(length, 180.0) for curve, length in lengths.items()}
    assert matched_divisions([ring], lines(lengths), 1.0) == dict.fromkeys(lengths, 4)
    assert matched_divisions([ring], round_, 1.0) == dict.fromkeys(lengths, 6)


def test_opposite_sides_of_a_strip_are_divided_alike_and_short_ones_once() -> None:
    strip = Face(4.0, ((1, 2, 3, 4),))
    found = matched_divisions([strip], lines({1: 4.2, 2: 1.0, 3: 3.8, 4: 1.0}), 1.0)
    assert found == {1: 4, 3: 4, 2: 1, 4: 1}


def test_sides_of_a_wide_face_are_left_alone() -> None:
    wide = Face(20.0, ((1, 2, 3, 4),))
    assert matched_divisions([wide], lines(dict.fromkeys((1, 2, 3, 4), 4.5)), 1.0) == {}


def test_sides_of_other_lengths_and_without_length_are_left_alone() -> None:
    wedge = Face(1.0, ((1, 2, 3, 4),))
    assert matched_divisions([wedge], lines({1: 4.0, 2: 1.0, 3: 1.0, 4: 0.0}), 1.0) == {}


def test_what_is_opposite_by_way_of_others_is_divided_alike() -> None:
    tube = [Face(3.0, ((1,), (2,))), Face(6.0, ((2,), (3,)))]
    found = matched_divisions(tube, lines({1: 4.0, 2: 6.0, 3: 6.0}), 1.0)
    assert len(set(found.values())) == 1
    assert set(found) == {1, 2, 3}


@given(st.lists(st.tuples(SIDES, SIDES, st.floats(0.5, 2.0)), min_size=1, max_size=6))
def test_a_row_of_strips_has_an_even_border_everywhere(
    strips: list[tuple[float, float, float]],
) -> None:
    """Strips side by side share their long sides; a triangle on the last has one odd use of it."""
    lengths = {0: strips[0][0]}
    faces = []
    for number, (along, across, area) in enumerate(strips):
        a, b, c = 3 * number, 3 * number + 1, 3 * number + 2
        lengths |= {b: across, c: across, a + 3: along}
        faces.append(Face(area * along, ((a, b, a + 3, c),)))
    last = 3 * len(strips)
    lengths |= {last + 1: 2.0, last + 2: 2.0}
    faces.append(Face(50.0, ((last, last + 1, last + 2),)))
    found = matched_divisions(faces, lines(lengths), 1.0)
    for face in faces:
        uses = Counter(curve for loop in face.loops for curve in loop)
        assert sum(found.get(curve, 0) * times for curve, times in uses.items()) % 2 == 0
    for face in faces[:-1]:
        for one, other in zip(face.loops[0][:2], face.loops[0][2:], strict=True):
            both = sorted((lengths[one], lengths[other]))
            if one in found and other in found and len(strips) == 1 and both[1] <= ALIKE * both[0]:
                assert found[one] == found[other]
