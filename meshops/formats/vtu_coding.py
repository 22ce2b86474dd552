"""The arrays of VTK's XML files: text, base64 or raw bytes, compressed or not.

See "VTK XML Format Details" in VTK's documentation.
"""

from __future__ import annotations

import base64
import binascii
import lzma
import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

COMPRESSORS = ("", "vtkZLibDataCompressor", "vtkLZMADataCompressor")
"""Those that are read."""

BLOCK = 32768
"""Bytes that are compressed together."""

TYPES = {
    f"{kind}{bits}": f"{letter}{bits // 8}"
    for kind, letter, sizes in (("Int", "i", (8, 16, 32, 64)), ("UInt", "u", (8, 16, 32, 64)))
    for bits in sizes
} | {"Float32": "f4", "Float64": "f8", "String": "i1", "Bit": "u1"}
"""Numpy's types by VTK's names."""


@dataclass(frozen=True)
class Coding:
    """How a file writes bytes.

    Attributes
    ----------
    order : '<' or '>'
    head : 'u4' or 'u8'
        The type of the lengths before the bytes.
    compressor : str
        One of ``COMPRESSORS``.
    """

    order: str = "<"
    head: str = "u4"
    compressor: str = ""

    def type_of(self, name: str) -> np.dtype[Any]:
        """Numpy's type of VTK's name; raises ValueError where there is none."""
        if name not in TYPES:
            raise ValueError(f"the type '{name}' is not known")
        return np.dtype(self.order + TYPES[name])

    def decoded(self, stream: bytes, name: str, *, in_base64: bool) -> NDArray[Any]:
        """Values of a type at the beginning of a stream; raises ValueError where it is wrong."""
        data = self._bytes(stream, in_base64=in_base64)
        kind = self.type_of(name)
        if len(data) % kind.itemsize:
            raise ValueError(f"{len(data)} bytes are no whole number of values")
        return np.frombuffer(data, kind)

    def encoded(self, values: NDArray[Any], name: str, *, in_base64: bool) -> bytes:
        """Write values of a type as a stream."""
        data = np.ascontiguousarray(values).astype(self.type_of(name)).tobytes()
        coded = base64.b64encode if in_base64 else bytes
        if not self.compressor:
            return coded(self._lengths([len(data)]) + data)
        blocks = [data[i : i + BLOCK] for i in range(0, len(data), BLOCK)]
        packed = [
            zlib.compress(b) if "ZLib" in self.compressor else lzma.compress(b) for b in blocks
        ]
        # the last block's own length stands there only where it is not a full one
        lengths = [len(blocks), BLOCK, len(data) % BLOCK, *map(len, packed)]
        return coded(self._lengths(lengths)) + coded(b"".join(packed))

    def _bytes(self, stream: bytes, *, in_base64: bool) -> bytes:
        size = int(self.head[1])

        def section(at: int, count: int) -> tuple[bytes, int]:
            """`count` bytes that are coded by themselves, and where they end."""
            width = -(-count // 3) * 4 if in_base64 else count
            part = stream[at : at + width]
            if len(part) < width:
                raise ValueError("it is cut short")
            return (_from_base64(part) if in_base64 else part)[:count], at + width

        if not self.compressor:
            if in_base64 and b"=" not in stream[: -(-size // 3) * 4]:
                first, _ = section(0, -(-size // 3) * 3)
                length = self._numbers(first[:size])[0]
                return section(0, size + length)[0][size:]
            head, at = section(0, size)
            return section(at, self._numbers(head)[0])[0]
        first, _ = section(0, -(-size // 3) * 3 if in_base64 else size)
        count = self._numbers(first[:size])[0]
        if not count:
            return b""
        head, at = section(0, (3 + count) * size)
        _, block, last, *lengths = self._numbers(head)
        packed, _ = section(at, sum(lengths))
        pieces, at = [], 0
        for number, length in enumerate(lengths):
            full = last if last and number == count - 1 else block
            pieces.append(self._unpacked(packed[at : at + length], full))
            at += length
        return b"".join(pieces)

    def _unpacked(self, data: bytes, size: int) -> bytes:
        try:
            unpacker: Any = (
                zlib.decompressobj() if "ZLib" in self.compressor else lzma.LZMADecompressor()
            )
            found: bytes = unpacker.decompress(data, min(size + 1, 2**31))
        except (zlib.error, lzma.LZMAError, OverflowError) as error:
            raise ValueError(f"it cannot be decompressed: {error}") from error
        if len(found) != size:
            raise ValueError("it is not as long as it says")
        return found

    def _numbers(self, data: bytes) -> list[int]:
        found: list[int] = np.frombuffer(data, self.order + self.head).tolist()
        return found

    def _lengths(self, values: list[int]) -> bytes:
        return np.array(values).astype(self.order + self.head).tobytes()


def _from_base64(text: bytes) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error as error:
        raise ValueError(f"it is no base64: {error}") from error
