"""The sections of a .msh file as they stand in it, and the pairs of nodes that are periodic."""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats.gmsh_stream import Layout, TextNumbers, numbers_of
from meshops.mesh import Ids

_HEAD = re.compile(rb"\$([A-Za-z]+)[ \t\r]*\n")

AFFINE = 16
"""Numbers of a transformation."""


class Section(NamedTuple):
    """A section: its name, and where what it holds begins and stops in the file."""

    name: str
    start: int
    stop: int


def sections_of(data: bytes, source: str) -> list[Section]:
    """Find the sections of a file, in order; raises InputError where one does not end."""
    found = []
    at = 0
    while head := _HEAD.search(data, at):
        name = head.group(1).decode()
        stop = data.find(b"$End" + head.group(1), head.end())
        if stop < 0:
            raise InputError(f"{source}: ${name} does not end; the file is cut short.")
        found.append(Section(name, head.end(), stop))
        at = stop + len(name) + 4
    return found


def layout_of(data: bytes, sections: list[Section], source: str) -> Layout:
    """Read $MeshFormat; raises InputError where the version is none that is read."""
    if not sections or "MeshFormat" not in {section.name for section in sections}:
        raise InputError(f"{source} has no $MeshFormat: it cannot be read as gmsh's .msh.")
    section = next(section for section in sections if section.name == "MeshFormat")
    line, _, rest = data[section.start : section.stop].partition(b"\n")
    words = line.split()
    versions = {b"2": "2.2", b"2.0": "2.2", b"2.1": "2.2", b"4": "4.0"}
    versions |= {name.encode(): name for name in ("2.2", "4.0", "4.1")}
    if len(words) < 3 or words[0] not in versions or words[1] not in (b"0", b"1"):
        raise InputError(
            f"{source}: the format '{line.decode('latin-1').strip()}' is not read; "
            "save it in version 2.2, 4.0 or 4.1."
        )
    version, is_binary = versions[words[0]], words[1] == b"1"
    if words[0] == b"4" and not is_binary and _counts_like_4_1(data, sections):
        version = "4.1"
    size = 4 if words[2] == b"4" and version == "4.1" else 8
    if not is_binary:
        return Layout(version, size=size)
    for order in "<>":
        if np.frombuffer(rest[:4].ljust(4, b"\0"), f"{order}i4")[0] == 1:
            return Layout(version, is_binary=True, order=order, size=size)
    raise InputError(f"{source}: the order of its bytes is unclear; check the file.")


def _counts_like_4_1(data: bytes, sections: list[Section]) -> bool:
    """Whether $Nodes begins with four counts: gmsh writes '4' for 4.0, and others for 4.1."""
    for section in sections:
        if section.name == "Nodes":
            return len(data[section.start : section.stop].partition(b"\n")[0].split()) == 4
    return False


def periodic_nodes(name: str, body: bytes, layout: Layout) -> Ids:
    """Tags of all nodes that $Periodic names; raises InputError."""
    if layout.version == "2.2":
        layout = Layout("2.2")
    stream = numbers_of(name, body, layout)
    modern = layout.version == "4.1"
    (links,) = (stream.sizes(1) if modern else stream.integers(1)).tolist()
    found = [np.zeros(0, np.int64)]
    for _ in range(links):
        stream.integers(3)
        if modern:
            stream.floats(int(stream.sizes(1)[0]))
            count = int(stream.sizes(1)[0])
        elif isinstance(stream, TextNumbers):
            if stream.peek() == b"Affine":
                stream.take(1 + AFFINE)
            count = int(stream.integers(1)[0])
        else:
            count = int(stream.sizes(1)[0])
            if count < 0:
                stream.floats(AFFINE)
                count = int(stream.sizes(1)[0])
        found.append((stream.sizes if modern else stream.integers)(2 * count))
    return np.concatenate(found)
