"""Linear shell cards of Nastran: CQUAD4, CTRIA3, CQUADR, CTRIAR and their attributes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from meshops.formats.fortran import canonical, real, real_field
from meshops.formats.nastran_cards import Card, Form, card_lines
from meshops.formats.nastran_loads import Layer, Pressure

CORNERS = {"CQUAD4": 4, "CTRIA3": 3, "CQUADR": 4, "CTRIAR": 3}
"""The cards that are elements here, and their numbers of nodes."""

_QUADS = {"CQUAD4": "CQUAD4", "CTRIA3": "CQUAD4", "CQUADR": "CQUADR", "CTRIAR": "CQUADR"}
_TRIAS = {"CQUAD4": "CTRIA3", "CQUADR": "CTRIAR"}


class Attributes(NamedTuple):
    """What a deck says of a shell besides its id and nodes, as typed.

    ``pressures`` are even loads, ``graded`` fields of load and the areas of them, ``sets`` numbers
    of output sets. A tria has no T4; where it has thicknesses, T4 repeats T3, so that a tria and a
    quad of uniform thickness can be of one region.
    """

    quad: str
    pid: str
    theta: str
    zoffs: str
    tflag: str
    thickness: tuple[str, str, str, str]
    form: Form
    pressures: tuple[Pressure, ...] = ()
    graded: tuple[tuple[Layer, int], ...] = ()
    sets: frozenset[int] = frozenset()

    @property
    def key_but_theta(self) -> tuple[object, ...]:
        """Equal for elements that differ in nothing but id, nodes and THETA."""
        return (
            self.quad,
            self.pid,
            canonical(self.zoffs, zero=""),
            "" if self.tflag == "0" else self.tflag,
            *map(canonical, self.thickness),
            tuple(sorted(pressure.key for pressure in self.pressures)),
            tuple(sorted(self.graded)),
            self.sets,
        )

    @property
    def theta_key(self) -> str:
        """Equal for equal THETA; MCID 0 is not THETA 0."""
        return canonical(self.theta, zero="")

    @property
    def angle(self) -> float | None:
        """THETA in degrees, None where it is the number of a coordinate system or no number."""
        try:
            return None if self.theta.isdecimal() else real(self.theta)
        except ValueError:
            return None

    @property
    def is_uniform(self) -> bool:
        """Whether the thickness is the same at all nodes: else it belongs to these nodes alone."""
        return len(set(map(canonical, self.thickness))) == 1

    def turned(self, angle: float | None) -> Attributes:
        """Attributes with another THETA in degrees, as exactly as its field allows; or the same."""
        if angle is None:
            return self
        return self._replace(theta=real_field(round(angle, 9), 16 if self.form.wide else 8))

    def lines(self, element: int, nodes: Sequence[int]) -> list[str]:
        """Write the card of an element with these attributes on three or four nodes."""
        corners = [str(node) for node in nodes]
        # a quad has its nodes in fields 2 to 5, a tria in 2 to 4 and two blanks after ZOFFS
        gap = [""] if len(nodes) == 4 else ["", ""]
        name = self.quad if len(nodes) == 4 else _TRIAS[self.quad]
        head = [str(element), self.pid, *corners, self.theta, self.zoffs, *gap, self.tflag]
        return card_lines(name, [*head, *self.thickness[: len(nodes)]], self.form)


def attributes(card: Card, pressures: Sequence[Pressure] = ()) -> Attributes:
    """Attributes of a linear shell card and the loads on the shell."""
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
        pressures=tuple(pressures),
    )
