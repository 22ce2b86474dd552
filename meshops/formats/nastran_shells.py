"""Linear shell cards of Nastran: CQUAD4, CTRIA3, CQUADR, CTRIAR and their attributes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from meshops.formats.fortran import real
from meshops.formats.nastran_cards import Card, Form

CORNERS = {"CQUAD4": 4, "CTRIA3": 3, "CQUADR": 4, "CTRIAR": 3}
"""The cards that are elements here, and their numbers of nodes."""

_QUADS = {"CQUAD4": "CQUAD4", "CTRIA3": "CQUAD4", "CQUADR": "CQUADR", "CTRIAR": "CQUADR"}
_TRIAS = {"CQUAD4": "CTRIA3", "CQUADR": "CTRIAR"}


class Attributes(NamedTuple):
    """What a shell card says besides its id and nodes, as typed.

    A tria has no T4; where it has thicknesses, T4 repeats T3, so that a tria and a quad of uniform
    thickness can be of one region.
    """

    quad: str
    pid: str
    theta: str
    zoffs: str
    tflag: str
    thickness: tuple[str, str, str, str]
    form: Form

    @property
    def region_key(self) -> tuple[str, ...]:
        """Equal for elements that differ in nothing but id and nodes."""
        angle_and_offset = (_value(self.theta, zero=""), _value(self.zoffs, zero=""))
        tflag = "" if self.tflag == "0" else self.tflag
        return (self.quad, self.pid, *angle_and_offset, tflag, *map(_value, self.thickness))

    @property
    def is_uniform(self) -> bool:
        """Whether the thickness is the same at all nodes: else it belongs to these nodes alone."""
        return len(set(map(_value, self.thickness))) == 1

    def card(self, element: int, nodes: Sequence[int]) -> tuple[str, list[str]]:
        """Name and fields of a card with these attributes on three or four nodes."""
        corners = [str(node) for node in nodes]
        # a quad has its nodes in fields 2 to 5, a tria in 2 to 4 and two blanks after ZOFFS
        gap = [""] if len(nodes) == 4 else ["", ""]
        name = self.quad if len(nodes) == 4 else _TRIAS[self.quad]
        head = [str(element), self.pid, *corners, self.theta, self.zoffs, *gap, self.tflag]
        return name, [*head, *self.thickness[: len(nodes)]]


def attributes(card: Card) -> Attributes:
    """Attributes of a linear shell card."""
    corners = CORNERS[card.name]
    thickness = [card.field(i) for i in range(10, 10 + corners)]
    if corners == 3:
        thickness.append(thickness[-1])
    return Attributes(
        quad=_QUADS[card.name],
        # the guide: a blank PID is the element's own id
        pid=card.field(1) or card.field(0),
        theta=card.field(2 + corners),
        zoffs=card.field(3 + corners),
        tflag=card.field(9),
        thickness=(thickness[0], thickness[1], thickness[2], thickness[3]),
        form=card.form,
    )


def _value(text: str, zero: str = "0.0") -> str:
    """Texts of one value made equal; an integer stays one, since MCID 0 is not THETA 0."""
    if not text or text.isdecimal():
        return text
    try:
        value = real(text)
    except ValueError:
        return text.upper()
    return repr(value) if value else zero
