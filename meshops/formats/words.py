"""Words of text files of numbers, and what is said where they are none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from decimal import Decimal, InvalidOperation
from pathlib import Path

import numpy as np

from meshops.errors import InputError
from meshops.formats.sources import read_lines
from meshops.mesh import NO_NODE


def lines_of(path: Path) -> Iterator[tuple[int, list[str]]]:
    """Words of each line that has any, without comments, and its number from 1."""
    for number, line in enumerate(read_lines(path), start=1):
        words = line.split("#")[0].split()
        if words:
            yield number, words


def numbers(words: Sequence[str], path: Path, line: int) -> list[float]:
    """Read numbers; raises InputError where a word is none."""
    try:
        return [float(word) for word in words]
    except ValueError:
        raise InputError(
            f"{path.name}, line {line}: '{' '.join(words)}' are not all numbers; correct the line."
        ) from None


def integers(words: Sequence[str], path: Path, line: int) -> list[int]:
    """Read integers; raises InputError where a word is none or too large."""
    try:
        return np.array(words, np.int64).tolist() if words else []
    except (ValueError, OverflowError):
        raise InputError(
            f"{path.name}, line {line}: '{' '.join(words)}' are not all integers; correct the line."
        ) from None


def corners(nodes: Sequence[int], path: Path, line: int) -> list[int]:
    """Four corners of a face, ``NO_NODE`` last in a tria; raises InputError where it has others."""
    if len(nodes) in (3, 4):
        return [*nodes, NO_NODE][:4]
    raise InputError(
        f"{path.name}, line {line}: the face has {len(nodes)} corners; split it into quads and "
        "trias."
    )


def resolution(words: Sequence[str]) -> float:
    """Up to which numbers tell two places apart as they are written: '12.50' up to .01.

    The finest of them counts, as a writer may leave zeros out.
    """
    exponents = []
    for word in words:
        try:
            exponent = Decimal(word).as_tuple().exponent
        except InvalidOperation:
            continue
        if isinstance(exponent, int):
            exponents.append(exponent)
    if not exponents:
        return 0.0
    # a little more, since the difference of two such numbers is rounded
    return 1.001 * 10.0 ** min(max(min(exponents), -300), 300)
