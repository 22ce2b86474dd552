"""Which values of the cells of a file tell the parts of a model apart."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from meshops.errors import InputError
from meshops.mesh import Ids

NAMES = re.compile(
    r"(region|part|pid|property|prop|material|mat|group|component|comp|block|elementblock|zone|"
    r"subdomain|section|physical|gmshphysical|cellentity|celltag)(id)?s?"
)
"""Names of arrays that number parts, in small letters and without signs between."""

FEW = 10
"""Cells up to which each may be a part of its own; beyond, such an array numbers the cells."""


def named_like_a_part(name: str) -> bool:
    """Tell whether an array is named like a part id: 'PartId', 'material_ids', 'gmsh:physical'."""
    return NAMES.fullmatch(re.sub(r"[^a-z0-9]", "", name.lower())) is not None


def parts_of(
    arrays: Mapping[str, NDArray[Any]], wanted: str | None, source: str
) -> tuple[Ids, tuple[str, ...]]:
    """Divide cells by the arrays that number parts, or by the one that is wanted.

    Parameters
    ----------
    arrays : mapping of str to (M, ...) arrays
        Values of the cells.
    wanted : str or None
        Name of the array to divide by.
    source : str
        Name of the file, for messages.

    Returns
    -------
    parts : (M,) int64
        The values of the array; where several divide the cells, combinations counted from 1.
    names : tuple of str
        Of the arrays that were taken.

    Raises
    ------
    InputError
        Where there is no array of the wanted name, or its values are no integers.
    """
    if wanted is not None:
        if wanted not in arrays:
            there = ", ".join(f"'{name}'" for name in arrays) or "none"
            raise InputError(
                f"{source} has no cell array '{wanted}' to tell regions by; it has {there}."
            )
        values = _integers(arrays[wanted])
        if values is None:
            raise InputError(
                f"{source}: the cell array '{wanted}' cannot tell regions, since it does not hold "
                "one integer for each cell; name another."
            )
        return values, (wanted,)
    found = {}
    for name, array in arrays.items():
        values = _integers(array) if named_like_a_part(name) else None
        if values is not None and not _numbers_cells(values):
            found[name] = values
    count = len(next(iter(arrays.values()), np.zeros(0)))
    return _combined(list(found.values()), count), tuple(found)


def _integers(values: NDArray[Any]) -> Ids | None:
    """(M,) int64 where the values are integers, also ones that are written as floats."""
    if values.size != len(values):
        return None
    flat = values.ravel()
    if np.issubdtype(flat.dtype, np.floating):
        if not np.isfinite(flat).all() or (flat != np.rint(flat)).any():
            return None
        if (np.abs(flat) >= 2.0**62).any():
            return None
    return flat.astype(np.int64)


def _numbers_cells(values: Ids) -> bool:
    return len(values) > FEW and len(np.unique(values)) == len(values)


def _combined(several: Sequence[Ids], count: int) -> Ids:
    if not several:
        return np.zeros(count, np.int64)
    together = np.column_stack(several)
    _, inverse = np.unique(together, axis=0, return_inverse=True)
    kinds: Ids = inverse.ravel().astype(np.int64)
    for alone in several:
        if len(np.unique(alone)) == int(kinds.max(initial=-1)) + 1:
            return alone
    return kinds + 1
