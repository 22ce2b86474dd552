"""Planar parts of sheet metal: holes, fillets, thin ligaments and slivers, as plain data.

A loop is a polygon whose corners are rounded: ``(x, y, radius)`` each, the radius 0 for a sharp
one. A circle is a square that is rounded by half of its side. All corners are wide enough for a
quad (a corner of 12 degrees fails whatever is meshed into it): the sliver of the gusset narrows by
12 degrees and ends blunt, one element wide.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, pi, radians, sin, sqrt, tan

Place = tuple[float, float]
Corner = tuple[float, float, float]
Loop = tuple[Corner, ...]

_SHORTEST = 1e-9
"""Lines up to this length, relative to the radii beside them, are left out between two arcs."""


@dataclass(frozen=True)
class Segment:
    """A line, or an arc of less than half a turn.

    Attributes
    ----------
    start, end : (x, y)
    centre : (x, y) or None
        Of an arc; None for a line.
    """

    start: Place
    end: Place
    centre: Place | None = None


@dataclass(frozen=True)
class Part:
    """A plane part in the plane z = 0.

    Attributes
    ----------
    name : str
    size : float
        Element size.
    outline : Loop
        Counter-clockwise.
    holes : tuple of Loop
    """

    name: str
    size: float
    outline: Loop
    holes: tuple[Loop, ...] = ()


def segments(loop: Loop) -> list[Segment]:
    """Lines and arcs of a closed loop, in order."""
    arcs = [
        _rounded(loop[k - 1], corner, loop[(k + 1) % len(loop)]) for k, corner in enumerate(loop)
    ]
    found = []
    for arc, following in zip(arcs, [*arcs[1:], arcs[0]], strict=True):
        if arc.start != arc.end:
            found.append(arc)
        line = Segment(arc.end, following.start)
        if _distance(line.start, line.end) > _SHORTEST * (1.0 + max(c[2] for c in loop)):
            found.append(line)
    return _closed(found)


def circle(x: float, y: float, radius: float) -> Loop:
    """Return a circle around a place."""
    return slot(x, y, 2.0 * radius, 2.0 * radius)


def slot(x: float, y: float, length: float, width: float) -> Loop:
    """Return a slot with round ends around a place, its longer side along x or along y."""
    a, b, radius = 0.5 * length, 0.5 * width, 0.5 * min(length, width)
    return (
        (x - a, y - b, radius),
        (x + a, y - b, radius),
        (x + a, y + b, radius),
        (x - a, y + b, radius),
    )


def _rounded(before: Corner, corner: Corner, after: Corner) -> Segment:
    """Arc that rounds a corner; from the corner to itself where it is sharp."""
    x, y, radius = corner
    if radius == 0.0:
        return Segment((x, y), (x, y))
    back, ahead = _direction(corner, before), _direction(corner, after)
    cosine = back[0] * ahead[0] + back[1] * ahead[1]
    reach = radius * sqrt((1.0 + cosine) / (1.0 - cosine))  # radius over the tangent of half of it
    to_centre = hypot(radius, reach)
    middle = _direction((0.0, 0.0, 0.0), (back[0] + ahead[0], back[1] + ahead[1], 0.0))
    return Segment(
        (x + reach * back[0], y + reach * back[1]),
        (x + reach * ahead[0], y + reach * ahead[1]),
        (x + to_centre * middle[0], y + to_centre * middle[1]),
    )


def _closed(found: list[Segment]) -> list[Segment]:
    """Let each segment end exactly where the next one starts."""
    return [
        Segment(one.start, following.start, one.centre)
        for one, following in zip(found, [*found[1:], found[0]], strict=True)
    ]


def _direction(start: Corner, end: Corner) -> Place:
    length = _distance(start[:2], end[:2])
    return (end[0] - start[0]) / length, (end[1] - start[1]) / length


def _distance(one: Place, other: Place) -> float:
    return hypot(other[0] - one[0], other[1] - one[1])


def _bracket() -> Part:
    outline = (
        (0.0, 0.0, 8.0),
        (120.0, 0.0, 8.0),
        (120.0, 40.0, 8.0),
        (45.0, 40.0, 12.0),
        (45.0, 110.0, 8.0),
        (0.0, 110.0, 8.0),
    )
    return Part("bracket", 5.0, outline, (slot(80.0, 20.0, 40.0, 14.0), slot(22.5, 75.0, 14, 40)))


def _plate_of_five_holes() -> Part:
    outline = ((0.0, 0.0, 0.0), (120.0, 0.0, 0.0), (120.0, 90.0, 0.0), (0.0, 90.0, 0.0))
    holes = (
        circle(60.0, 45.0, 18.0),
        circle(20.0, 20.0, 8.0),
        circle(100.0, 20.0, 8.0),
        circle(100.0, 70.0, 10.0),
        circle(20.0, 70.0, 6.0),
    )
    return Part("five holes", 5.0, outline, holes)


def _gusset() -> Part:
    narrow, wide, length = 4.5, 45.0, 190.0
    start = length - (wide - narrow) / tan(radians(12.0))
    outline = (
        (-50.0, 0.0, 6.0),
        (length, 0.0, 0.0),
        (length, narrow, 0.0),
        (start, wide, 0.0),
        (start - 10.0, wide + 30.0, 6.0),
        (-50.0, wide + 30.0, 6.0),
    )
    return Part("gusset", 4.5, outline, (circle(-22.0, 48.0, 12.0), circle(12.0, 20.0, 9.0)))


def _perforated_strip() -> Part:
    outline = ((0.0, 0.0, 5.0), (150.0, 0.0, 5.0), (150.0, 30.0, 5.0), (0.0, 30.0, 5.0))
    return Part("strip", 4.0, outline, tuple(circle(17.0 + 23.2 * k, 15.0, 9.5) for k in range(6)))


def _gear() -> Part:
    teeth, inner, outer, root = 8, 42.0, 58.0, 5.0
    step = 2.0 * pi / teeth
    outline = []
    for tooth in range(teeth):
        for radius, share in ((inner, -0.26), (outer, -0.19), (outer, 0.19), (inner, 0.26)):
            angle = (tooth + share) * step
            outline.append((radius * cos(angle), radius * sin(angle), root))
    return Part("gear", 4.5, tuple(outline), (circle(0.0, 0.0, 16.0),))


def _washer_off_centre() -> Part:
    return Part("washer", 5.0, circle(0.0, 0.0, 50.0), (circle(19.0, 0.0, 25.5),))


PARTS: tuple[Part, ...] = (
    _bracket(),
    _plate_of_five_holes(),
    _gusset(),
    _perforated_strip(),
    _gear(),
    _washer_off_centre(),
)
"""The parts of ``benchmarks.quality planar``."""
