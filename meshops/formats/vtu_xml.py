"""The XML of a .vtu file: its arrays are read, and written again in the coding that they had."""

from __future__ import annotations

import re
from collections.abc import Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any
from xml.etree import ElementTree as Xml

import numpy as np
from numpy.typing import NDArray

from meshops.errors import InputError
from meshops.formats.vtu_coding import COMPRESSORS, Coding

Array = NDArray[Any]


@dataclass(frozen=True, eq=False)
class Document:
    """A .vtu file.

    Attributes
    ----------
    source : str
        Its name, for messages.
    declaration : bytes
        What stands before the XML.
    root : Element
    coding : Coding
    appended : bytes
        What follows the underscore of AppendedData.
    in_base64 : bool
        Whether that is base64.
    """

    source: str
    declaration: bytes
    root: Xml.Element
    coding: Coding
    appended: bytes = b""
    in_base64: bool = True

    @classmethod
    def parse(cls, data: bytes, source: str) -> Document:
        """Parse a file; raises InputError where it is no .vtu or its coding is not read."""
        head = re.search(rb"<AppendedData([^>]*)>\s*_", data)
        appended, in_base64 = b"", True
        if head:
            stop = data.rfind(b"</AppendedData>")
            appended = data[head.end() : stop if stop > 0 else len(data)]
            in_base64 = b"raw" not in head.group(1)
            data = data[: head.end()] + data[len(data) if stop < 0 else stop :]
        try:
            builder = Xml.TreeBuilder(insert_comments=True)
            root = Xml.fromstring(data, Xml.XMLParser(target=builder))
        except (Xml.ParseError, ValueError, LookupError) as error:
            raise InputError(f"{source} cannot be read as vtu: {error}; check the file.") from error
        kind = root.get("type")
        if root.tag != "VTKFile" or kind != "UnstructuredGrid":
            raise InputError(
                f"{source} cannot be read as vtu: it holds {kind or root.tag}; save it as an "
                "unstructured grid."
            )
        compressor = root.get("compressor", "")
        if compressor not in COMPRESSORS:
            raise InputError(
                f"{source} is compressed by {compressor}, which is not read: save it with zlib."
            )
        declaration = data[: max(data.find(b"<VTKFile"), 0)]
        order = ">" if root.get("byte_order") == "BigEndian" else "<"
        width = "u8" if root.get("header_type") == "UInt64" else "u4"
        coding = Coding(order, width, compressor)
        return cls(source, declaration, root, coding, appended, in_base64)

    def values(self, array: Xml.Element) -> Array:
        """Values of a DataArray: (n,) or (n, k); raises InputError where they cannot be read."""
        name, kind = array.get("Name", "?"), array.get("type", "")
        try:
            found = self._values(array, kind)
            width = int(array.get("NumberOfComponents") or 1)
            if width < 1 or len(found) % width:
                raise ValueError(f"{len(found)} values are no rows of {width}")
        except (ValueError, OverflowError) as error:
            raise InputError(
                f"{self.source}: the array '{name}' cannot be read: {error}; check the file."
            ) from error
        return found if width == 1 else found.reshape(-1, width)

    def written(self, changed: Mapping[Xml.Element, Array], points: int, cells: int) -> bytes:
        """Write the file with other values in some arrays, all in the coding that they had.

        Parameters
        ----------
        changed : mapping of Element to array
        points, cells : int
            How many the piece has then.
        """
        root = deepcopy(self.root)
        for piece in root.iter("Piece"):
            piece.set("NumberOfPoints", str(points))
            piece.set("NumberOfCells", str(cells))
        appended: list[bytes] = []
        at = 0
        for array, copy in zip(self.root.iter("DataArray"), root.iter("DataArray"), strict=True):
            kind, form = array.get("type", ""), array.get("format", "ascii")
            if array not in changed and form != "appended":
                continue
            values = changed[array] if array in changed else self.values(array)
            if array in changed:
                _forget_ranges(copy)
            if form == "ascii":
                copy.text = _text(values)
            elif form == "binary":
                copy.text = self.coding.encoded(values, kind, in_base64=True).decode()
            else:
                stream = self.coding.encoded(values, kind, in_base64=self.in_base64)
                copy.set("offset", str(at))
                appended.append(stream)
                at += len(stream)
        for element in root.iter("AppendedData"):
            element.text = (element.text or "").rstrip()
        xml = Xml.tostring(root)
        stop = xml.rfind(b"</AppendedData>")
        if stop >= 0:
            xml = xml[:stop] + b"".join(appended) + xml[stop:]
        return self.declaration + xml

    def _values(self, array: Xml.Element, kind: str) -> Array:
        form = array.get("format", "ascii")
        dtype = self.coding.type_of(kind)
        text = (array.text or "").strip()
        if form == "ascii":
            words = text.split()
            return np.array(words, dtype="U").astype(dtype) if words else np.zeros(0, dtype)
        if form == "binary":
            return self.coding.decoded(text.encode("ascii"), kind, in_base64=True)
        if form != "appended":
            raise ValueError(f"the format '{form}' is not known")
        offset = int(array.get("offset", ""))
        if not 0 <= offset <= len(self.appended):
            raise ValueError("it lies behind the end of the file")
        stream = self.appended[offset:]
        return self.coding.decoded(stream, kind, in_base64=self.in_base64)


def _text(values: Array) -> str:
    words = values.reshape(len(values), -1).astype(str).tolist() if len(values) else []
    return "\n" + "".join(" ".join(row) + "\n" for row in words)


def _forget_ranges(array: Xml.Element) -> None:
    """Leave out what a writer has told of the values: it need not be true any more."""
    for name in ("RangeMin", "RangeMax", "NumberOfTuples"):
        array.attrib.pop(name, None)
    for child in list(array):
        if child.tag == "InformationKey" and "RANGE" in child.get("name", ""):
            array.remove(child)
