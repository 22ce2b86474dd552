"""Selections: the part of a deck that a user names, to be repaired while the rest stays."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from meshops.errors import InputError
from meshops.formats.ids import IdSet
from meshops.mesh import Bools, ShellMesh

_IDS = re.compile(r"\s*\d+\s*(:\s*\d+\s*(:\s*\d+\s*)?)?")


def is_ids(text: str) -> bool:
    """Whether a text is a list of ids and ranges: ``1:100,205`` or ``1:100:2``."""
    return all(_IDS.fullmatch(part) for part in text.split(","))


def read_ids(text: str) -> IdSet:
    """Read a list that `is_ids`; raises InputError where a range runs backwards."""
    found = IdSet()
    for part in text.split(","):
        first, *rest = map(int, part.split(":"))
        if not rest:
            found.singles.add(first)
            continue
        step = rest[1] if len(rest) > 1 else 1
        if rest[0] < first or step < 1:
            raise InputError(f'--only: the range "{part.strip()}" holds no id; write first:last.')
        found.ranges.add((first, rest[0], step))
    return found


def select(mesh: ShellMesh, text: str, named: Mapping[str, Bools]) -> Bools:
    """Return which elements a user means: (M,) bool.

    `named` are the sets and properties of the deck by their names, in capitals. A lone number means
    the first of these that is so numbered, and only where there is none the element.

    Raises InputError where nothing of the mesh is meant.
    """
    key = text.strip().upper()
    if key.isdecimal():
        key = next((name for name in named if name.rpartition(" ")[2] == key), key)
    chosen: Bools
    if key in named:
        chosen = named[key]
    elif is_ids(text):
        chosen = read_ids(text).mask(mesh.element_ids)
    else:
        names = ", ".join(sorted(named)) or "none"
        raise InputError(
            f'--only "{text}" is neither a set or property of the deck nor a list of element ids '
            f"like 1:100,205; its sets and properties are: {names}."
        )
    if not chosen.any():
        raise InputError(f'--only "{text}" holds none of the shells of the deck.')
    return chosen


def locked_but(mesh: ShellMesh, chosen: Bools) -> ShellMesh:
    """Lock all elements that are not chosen (M,) bool."""
    return replace(mesh, locked_elements=_read_only(mesh.locked_elements | ~chosen))


def by_label(labels: Sequence[str]) -> dict[str, Bools]:
    """Return the elements of each label; one a label has for each element, (M,) bool each."""
    every = np.array(labels, object)
    return {label.upper(): np.array(every == label, bool) for label in dict.fromkeys(labels)}


def _read_only(array: Bools) -> Bools:
    array.flags.writeable = False
    return array
