"""Rows of Abaqus input, as CalculiX reads them too."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

_WIDTH = 20  # the most characters of a number that CalculiX reads
_PER_LINE = 16  # the most ids that Abaqus reads from a line of a set


def number(value: float) -> str:
    """Write a number as exactly as 20 characters allow."""
    exact = _short_exponent(repr(value))
    if len(exact) <= _WIDTH:
        return exact
    candidates = (
        _short_exponent(f"{value:.{digits}{how}}") for digits in range(11, 18) for how in "ge"
    )
    fitting = [text for text in candidates if len(text) <= _WIDTH and "." in text]
    return min(fitting, key=lambda text: (abs(float(text) - value), len(text)))


def node_row(node: int, point: Sequence[float], tail: Sequence[str] = ()) -> str:
    """Write a node with two or three coordinates and what stood behind them."""
    return ", ".join([str(node), *map(number, point), *tail])


def element_row(element: int, corners: Iterable[int]) -> str:
    """Write an element; a corner of 0 is none."""
    return ", ".join([str(element), *(str(node) for node in corners if node)])


def set_rows(tokens: Sequence[str]) -> list[str]:
    """Write the members of a set, 16 a line."""
    return [", ".join(tokens[i : i + _PER_LINE]) for i in range(0, len(tokens), _PER_LINE)]


def generated_rows(members: Iterable[int], prefix: str = "") -> list[str]:
    """Write rows for GENERATE: first and last id of each run, step 1."""
    values = np.array(sorted(members), np.int64)
    breaks = np.flatnonzero(np.diff(values) != 1) + 1
    runs = np.split(values, breaks) if len(values) else []
    return [f"{prefix}{run[0]}, {prefix}{run[-1]}, 1" for run in runs]


def _short_exponent(text: str) -> str:
    """'1.5E-5' of '1.5e-05'."""
    mantissa, e, exponent = text.partition("e")
    return f"{mantissa}E{int(exponent)}" if e else text
