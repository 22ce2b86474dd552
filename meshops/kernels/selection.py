"""Selections of elements."""

from __future__ import annotations

import numpy as np

from meshops.kernels.vectors import compiled
from meshops.mesh import Bools, Ints


@compiled
def select_ranges(ranges: Ints, count: int) -> Bools:
    """(count,) bool: union of ranges (K, 2) of numbers from 1, ends included, in any order."""
    selected = np.zeros(count, np.bool_)
    for k in range(len(ranges)):
        low, high = min(ranges[k, 0], ranges[k, 1]), max(ranges[k, 0], ranges[k, 1])
        selected[low - 1 : high] = True
    return selected
