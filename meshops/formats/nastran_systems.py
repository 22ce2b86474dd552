"""The coordinate systems that a Nastran deck defines, and the places of its grid points."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from meshops.errors import InputError
from meshops.formats.coordinates import BASIC, Frame, Kind, frame_through
from meshops.formats.fortran import real
from meshops.formats.nastran_cards import Card
from meshops.formats.sources import Sources
from meshops.mesh import Floats

_KINDS: dict[str, Kind] = {"R": "R", "C": "C", "S": "S"}


def integer_at(card: Card, i: int, sources: Sources, default: int | None = None) -> int:
    """Integer field ``i``, ``default`` where it is blank; raises InputError where it is neither."""
    text = card.field(i)
    if not text and default is not None:
        return default
    try:
        if "_" in text or len(text) > 18:
            raise ValueError(text)
        return int(text)
    except ValueError:
        found = f"'{text}'" if text else "blank"
        raise InputError(
            f"{sources.where(card.lines[0])}: field {i + 2} of {card.name} is {found}; "
            "it has to be an integer."
        ) from None


def reals_at(card: Card, start: int, count: int, sources: Sources) -> list[float]:
    """Real fields from ``start`` on, 0 where blank; raises InputError where one is no number."""
    try:
        return [real(card.field(i)) for i in range(start, start + count)]
    except ValueError:
        pass
    for i in range(start, start + count):
        try:
            real(card.field(i))
        except ValueError:
            break
    raise InputError(
        f"{sources.where(card.lines[0])}: field {i + 2} of {card.name} is '{card.field(i)}'; "
        "it has to be a number."
    )


class Systems:
    """Coordinate systems by id, resolved when first asked for.

    Parameters
    ----------
    cards
        The CORD1x and CORD2x cards of the deck.
    grids
        All GRID cards by id; a CORD1x system is defined by three of them.
    default
        What GRDSET says for a GRID whose CP is blank.
    """

    def __init__(
        self, cards: Iterable[Card], grids: Mapping[int, Card], sources: Sources, default: int
    ) -> None:
        self.default = default
        self._grids = grids
        self._sources = sources
        self._frames: dict[int, Frame] = {0: BASIC}
        self._resolving: set[int] = set()
        self._cards: dict[int, tuple[Card, int]] = {}
        for card in cards:
            starts = (0, 4) if card.name.startswith("CORD1") and card.field(4) else (0,)
            for start in starts:
                self._cards[integer_at(card, start, sources)] = (card, start)

    def system_of(self, grid: Card) -> int:
        """Id of the system in which a GRID gives its coordinates."""
        return integer_at(grid, 1, self._sources, self.default)

    def frame(self, system: int, asked_by: Card) -> Frame:
        """Return the system of an id.

        Raises
        ------
        InputError
            Where ``asked_by`` names a system that is not defined, that is defined by itself or
            whose points lie on a line.
        """
        if system in self._frames:
            return self._frames[system]
        place = self._sources.where(asked_by.lines[0])
        if system not in self._cards:
            raise InputError(
                f"{place}: {asked_by.name} {asked_by.field(0)} uses coordinate system {system}, "
                "which is not defined; add its CORD card."
            )
        if system in self._resolving:
            raise InputError(
                f"{place}: coordinate system {system} is defined by itself; correct it."
            )
        self._resolving.add(system)
        card, start = self._cards[system]
        try:
            frame = frame_through(_KINDS[card.name[5:6]], self._points(card, start))
        except ValueError:
            raise InputError(
                f"{self._sources.where(card.lines[0])}: the three points of coordinate system "
                f"{system} lie on a line; correct them."
            ) from None
        self._resolving.discard(system)
        self._frames[system] = frame
        return frame

    def basic_points(self, grids: Sequence[Card]) -> Floats:
        """(N, 3) basic coordinates of GRID cards."""
        local = np.array([reals_at(grid, 2, 3, self._sources) for grid in grids]).reshape(-1, 3)
        systems = np.array([self.system_of(grid) for grid in grids], int)
        points = local.copy()
        for system in np.unique(systems[systems != 0]):
            rows = np.flatnonzero(systems == system)
            frame = self.frame(int(system), grids[rows[0]])
            points[rows] = frame.to_basic(local[rows])
        return points

    def _points(self, card: Card, start: int) -> Floats:
        """(3, 3) basic coordinates of the points that define a system."""
        if card.name.startswith("CORD2"):
            frame = self.frame(integer_at(card, 1, self._sources, 0), card)
            return frame.to_basic(np.reshape(reals_at(card, 2, 9, self._sources), (3, 3)))
        ids = [integer_at(card, start + k, self._sources) for k in (1, 2, 3)]
        for node in ids:
            if node not in self._grids:
                raise InputError(
                    f"{self._sources.where(card.lines[0])}: {card.name} names node {node}, "
                    "which is not defined; add the node or correct the card."
                )
        return self.basic_points([self._grids[node] for node in ids])
