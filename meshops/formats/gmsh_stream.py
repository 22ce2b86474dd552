"""Numbers of a .msh file, as text or bytes, read one after the other and written again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from meshops.errors import InputError
from meshops.mesh import Floats, Ids


@dataclass(frozen=True)
class Layout:
    """How a file writes numbers.

    Attributes
    ----------
    version : '2.2', '4.0' or '4.1'
    is_binary : bool
    order : '<' or '>'
        Of the bytes.
    size : 4 or 8
        Bytes of a size.
    """

    version: str
    is_binary: bool = False
    order: str = "<"
    size: int = 8


class Numbers(Protocol):
    """Takes numbers off a section; raises InputError where none are left or they are none."""

    at: int

    def integers(self, count: int) -> Ids:
        """Take 32-bit integers."""

    def sizes(self, count: int) -> Ids:
        """Take counts or, in version 4.1, tags of nodes and elements."""

    def floats(self, count: int) -> Floats:
        """Take floating-point numbers."""

    def tagged(self, count: int, width: int) -> tuple[Ids, Floats]:
        """Take rows of an integer and as many floating-point numbers: (count,), (count, width)."""

    @property
    def is_over(self) -> bool:
        """Whether nothing is left."""


class TextNumbers:
    """Numbers of an ASCII section; the words of floating-point ones are kept."""

    def __init__(self, name: str, body: bytes) -> None:
        self.name = name
        self.words = body.split()
        self.at = 0

    @property
    def is_over(self) -> bool:
        """Whether nothing is left."""
        return self.at >= len(self.words)

    def take(self, count: int) -> list[bytes]:
        """Take words as they are."""
        if count < 0 or self.at + count > len(self.words):
            raise InputError(f"{self.name} is cut short: check the file.")
        self.at += count
        return self.words[self.at - count : self.at]

    def integers(self, count: int) -> Ids:
        """Take integers."""
        words = self.take(count)
        try:
            return np.array(words, dtype="S").astype(np.int64) if words else np.zeros(0, np.int64)
        except (ValueError, OverflowError):
            raise self._none(words, "integer") from None

    sizes = integers

    def floats(self, count: int) -> Floats:
        """Take floating-point numbers."""
        words = self.take(count)
        try:
            return np.array(words, dtype="S").astype(np.float64) if words else np.zeros(0)
        except ValueError:
            raise self._none(words, "number") from None

    def tagged(self, count: int, width: int) -> tuple[Ids, Floats]:
        """Take rows of an integer and floating-point numbers."""
        words = self.take(count * (1 + width))
        rows = [words[i : i + 1 + width] for i in range(0, len(words), 1 + width)]
        tags = TextNumbers(self.name, b" ".join(row[0] for row in rows)).integers(count)
        values = TextNumbers(self.name, b" ".join(word for row in rows for word in row[1:]))
        return tags, values.floats(count * width).reshape(count, width)

    def peek(self) -> bytes:
        """Look at the next word; empty where none is left."""
        return b"" if self.is_over else self.words[self.at]

    def _none(self, words: list[bytes], what: str) -> InputError:
        kind = int if what == "integer" else float
        for word in words:
            try:
                if kind(word) < 2**63:
                    continue
            except ValueError:
                pass
            text = word.decode("latin-1")
            break
        return InputError(f"{self.name}: '{text}' is no {what}; correct it.")


class ByteNumbers:
    """Numbers of a binary section."""

    def __init__(self, name: str, body: bytes, layout: Layout) -> None:
        self.name, self._body, self._layout = name, body, layout
        self.at = 0

    @property
    def is_over(self) -> bool:
        """Whether nothing is left but a line end."""
        return self.at + 4 > len(self._body)

    def records(self, dtype: np.dtype[Any], count: int) -> NDArray[Any]:
        """Take values of a type."""
        if count < 0 or self.at + count * dtype.itemsize > len(self._body):
            raise InputError(f"{self.name} is cut short: check the file.")
        found = np.frombuffer(self._body, dtype, count, self.at)
        self.at += count * dtype.itemsize
        return found

    def _array(self, kind: str, count: int) -> NDArray[Any]:
        return self.records(np.dtype(self._layout.order + kind), count)

    def integers(self, count: int) -> Ids:
        """Take 32-bit integers."""
        return self._array("i4", count).astype(np.int64)

    def sizes(self, count: int) -> Ids:
        """Take sizes."""
        return self._array(f"i{self._layout.size}", count).astype(np.int64)

    def floats(self, count: int) -> Floats:
        """Take floating-point numbers."""
        return self._array("f8", count).astype(np.float64)

    def tagged(self, count: int, width: int) -> tuple[Ids, Floats]:
        """Take rows of an integer and floating-point numbers."""
        order = self._layout.order
        kind = np.dtype([("tag", f"{order}i4"), ("at", f"{order}f8", (width,))])
        rows = self.records(kind, count)
        values = rows["at"].astype(np.float64).reshape(count, width)
        return rows["tag"].astype(np.int64), values


def packed(layout: Layout, kind: str, values: ArrayLike) -> bytes:
    """Bytes of numbers of a type, such as 'i4'."""
    return np.asarray(values).astype(layout.order + kind).tobytes()


def numbers_of(name: str, body: bytes, layout: Layout) -> Numbers:
    """Read the numbers of a section, whose name is for messages."""
    return ByteNumbers(name, body, layout) if layout.is_binary else TextNumbers(name, body)
