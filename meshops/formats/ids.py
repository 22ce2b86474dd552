"""Sets of ids that decks name one by one and in ranges, and ids that are still free."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np

from meshops.errors import InputError
from meshops.mesh import NEW, Bools, Ids


def is_id(text: str) -> bool:
    """Tell whether a text is a positive integer that an array of ids can hold."""
    return text.isdecimal() and len(text) < 19


@dataclass
class IdSet:
    """Ids as a deck names them; ranges are kept as ranges, however wide.

    Attributes
    ----------
    singles : set of int
    ranges : set of (first, last, step)
        ``last`` belongs to the range.
    everything : bool
        Whether every id is meant.
    """

    singles: set[int] = field(default_factory=set)
    ranges: set[tuple[int, int, int]] = field(default_factory=set)
    everything: bool = False

    def update(self, other: IdSet) -> None:
        """Add the ids of another set."""
        self.singles |= other.singles
        self.ranges |= other.ranges
        self.everything |= other.everything

    def mask(self, ids: Ids) -> Bools:
        """Which of ``ids`` (N,) are in the set: (N,) bool."""
        if self.everything:
            return np.ones(len(ids), bool)
        found: Bools = np.isin(ids, np.fromiter(self.singles, np.int64, len(self.singles)))
        for first, last, step in self.ranges:
            found |= (ids >= first) & (ids <= last) & ((ids - first) % step == 0)
        return found

    @property
    def highest(self) -> int:
        """The highest id that is named, 0 in an empty set."""
        return max([0, *self.singles, *(last for _, last, _ in self.ranges)])

    def read(self, tokens: Iterable[str]) -> None:
        """Add a list as decks write it: ids, ``a THRU b``, ``a THRU b BY n``.

        Other words and numbers are passed over; EXCEPT is too, so the set is rather too large.
        """
        words = [token for token in tokens if token]
        for i, word in enumerate(words):
            if is_id(word):
                self.singles.add(int(word))
            elif word.upper() == "THRU":
                self._read_range(words, i)

    def _read_range(self, words: Sequence[str], i: int) -> None:
        if i == 0 or i + 1 >= len(words) or not (is_id(words[i - 1]) and is_id(words[i + 1])):
            return
        has_step = i + 3 < len(words) and words[i + 2].upper() == "BY" and is_id(words[i + 3])
        step = int(words[i + 3]) if has_step else 1
        self.ranges.add((int(words[i - 1]), int(words[i + 1]), max(step, 1)))


def with_new_ids(ids: Ids, taken: IdSet, limit: int) -> Ids:
    """Replace every NEW in ``ids`` (N,) by an id of its own.

    New ids count up from above the highest id that is taken; where that passes ``limit`` they are
    the lowest ids that are neither taken nor inside a taken range.

    Raises
    ------
    InputError
        Where there are not enough ids below the limit.
    """
    new = ids == NEW
    count = int(new.sum())
    floor = max(taken.highest, int(ids.max(initial=0)))
    fits = floor + count <= limit
    fresh = range(floor + 1, floor + 1 + count) if fits else _lowest_free(ids, taken, count, limit)
    numbered = ids.copy()
    numbered[new] = fresh
    return numbered


def free_ids(ids: Ids, taken: IdSet, limit: int) -> int:
    """How many ids ``with_new_ids`` has to give."""
    above = limit - max(taken.highest, int(ids.max(initial=0)))
    if above > 0:
        return above
    ranges = _merged((first, last) for first, last, _ in taken.ranges)
    in_ranges = sum(max(min(last, limit) - first + 1, 0) for first, last in ranges)
    singles = [i for i in {*taken.singles, *ids.tolist()} if 0 < i <= limit]
    starts = np.array([first for first, _ in ranges], np.int64)
    place = np.searchsorted(starts, singles, side="right") - 1
    ends = np.array([last for _, last in ranges] or [0], np.int64)
    outside = (place < 0) | (np.array(singles) > ends[place]) if len(ranges) else place < 0
    return max(limit - in_ranges - int(outside.sum()), 0)


def check_room(ids: Ids, taken: IdSet, limit: int, what: str) -> None:
    """Check before a search that there are as many free ids as ids in use.

    Raises
    ------
    InputError
        Where there are fewer; ``what`` says what they are ids of, as 'nodes'.
    """
    free = free_ids(ids, taken, limit)
    if free < len(ids):
        raise InputError(
            f"The deck leaves {free:,} ids of {what} free up to {limit:,}, too few to repair "
            f"{len(ids):,} {what}: renumber it first."
        )


def _merged(ranges: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    found: list[tuple[int, int]] = []
    for first, last in sorted(ranges):
        if found and first <= found[-1][1] + 1:
            found[-1] = (found[-1][0], max(found[-1][1], last))
        else:
            found.append((first, last))
    return found


def _lowest_free(ids: Ids, taken: IdSet, count: int, limit: int) -> list[int]:
    singles = taken.singles | set(ids.tolist())
    ranges = sorted((first, last) for first, last, _ in taken.ranges)
    free: list[int] = []
    candidate = 1
    while len(free) < count:
        last = max((b for a, b in ranges if a <= candidate <= b), default=0)
        if last:
            candidate = last + 1
            continue
        if candidate > limit:
            raise InputError(f"The deck leaves no ids free up to {limit}: renumber it first.")
        if candidate not in singles:
            free.append(candidate)
        candidate += 1
    return free
