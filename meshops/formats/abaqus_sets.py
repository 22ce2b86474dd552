"""Sets of elements that an Abaqus deck lists by number, kept in step with the mesh."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from meshops.formats.abaqus_blocks import Block, id_list
from meshops.formats.ids import IdSet, is_id
from meshops.formats.splice import Splice
from meshops.mesh import Ids

_PER_LINE = 16  # the most that Abaqus reads from a line of a set


class ElementLists:
    """The *ELSET blocks of a deck that hold element numbers."""

    def __init__(self, blocks: Iterable[Block], lines: Sequence[str]) -> None:
        self._lines = lines
        self._ids: list[tuple[Block, IdSet]] = [(block, id_list(block, lines)) for block in blocks]

    def names_of(self, element_ids: Ids) -> list[frozenset[str]]:
        """For each element, the names of the sets that list it."""
        names: list[set[str]] = [set() for _ in element_ids]
        for block, ids in self._ids:
            for row in np.flatnonzero(ids.mask(element_ids)):
                names[row].add(_name(block))
        return [frozenset(some) for some in names]

    def write(
        self, splice: Splice, *, gone: Iterable[int], joining: Mapping[str, Sequence[int]]
    ) -> None:
        """Take the vanished elements out of all lists and put new ones into the sets they join."""
        vanished = set(gone)
        last = {_name(block): block for block, _ in self._ids}
        for block, ids in self._ids:
            new = joining.get(_name(block), ()) if last[_name(block)] is block else ()
            leaving = vanished and ids.mask(np.array(sorted(vanished), np.int64)).any()
            if not new and not leaving:
                continue
            members = sorted((_members(ids) - vanished) | set(new))
            rows = _runs(members) if "GENERATE" in block.parameters else self._list(block, members)
            splice.replace(block.data, rows)
            if not rows:
                splice.drop(block.header)

    def _list(self, block: Block, members: Sequence[int]) -> list[str]:
        tokens = [
            token.strip()
            for position in block.data
            for token in self._lines[position].split(",")
            if token.strip() and not is_id(token.strip())
        ]
        tokens += map(str, members)
        return [", ".join(tokens[i : i + _PER_LINE]) for i in range(0, len(tokens), _PER_LINE)]


def _name(block: Block) -> str:
    """Scope, instance and name: sets of one name in different scopes are different sets."""
    return ":".join(
        [block.scope, *(block.parameters.get(key, "") for key in ("INSTANCE", "ELSET"))]
    )


def _members(ids: IdSet) -> set[int]:
    ranges = (range(first, last + 1, step) for first, last, step in ids.ranges)
    return ids.singles.union(*ranges)


def _runs(members: Sequence[int]) -> list[str]:
    """Rows of GENERATE: first and last id of each run, step 1."""
    values = np.array(members, np.int64)
    breaks = np.flatnonzero(np.diff(values) != 1) + 1
    runs = np.split(values, breaks) if len(values) else []
    return [f"{run[0]}, {run[-1]}, 1" for run in runs]
