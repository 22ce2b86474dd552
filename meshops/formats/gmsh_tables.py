"""The nodes, elements and entities of .msh files of the versions 2.2, 4.0 and 4.1.

See "MSH file format" in gmsh's reference manual.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import chain

import numpy as np

from meshops.errors import InputError
from meshops.formats.gmsh_stream import (
    Layout,
    Numbers,
    TextNumbers,
    numbers_of,
    packed,
)
from meshops.mesh import Floats, Ids

TRIA, QUAD = 2, 3
"""Kinds of the elements that are linear shells."""

NODES = {
    1: 2, 2: 3, 3: 4, 4: 4, 5: 8, 6: 6, 7: 5, 8: 3, 9: 6, 10: 9, 11: 10, 12: 27, 13: 18, 14: 14,
    15: 1, 16: 8, 17: 20, 18: 15, 19: 13, 20: 9, 21: 10, 22: 12, 23: 15, 24: 15, 25: 21, 26: 4,
    27: 5, 28: 6, 29: 20, 30: 35, 31: 56, 36: 16, 37: 25, 38: 36, 62: 7, 63: 8, 64: 9, 65: 10,
    66: 11, 92: 64, 93: 125, 94: 216, 95: 343, 96: 512, 97: 729, 98: 1000,
}  # fmt: skip
"""Nodes of an element by gmsh's number of its kind."""

LINES = (1, 8, 26, 27, 28, 62, 63, 64, 65, 66)
POINTS = (15,)
SURFACES = (2, 3, 9, 10, 16, 20, 21, 22, 23, 24, 25, 36, 37, 38)

Block = tuple[int, int, int]
"""Dimension and number of an entity, and how many parameters its nodes have."""


def dimension_of(kind: int) -> int:
    """Dimension of an element by its kind."""
    if kind in POINTS:
        return 0
    return 1 if kind in LINES else 2 if kind in SURFACES else 3


@dataclass(frozen=True, eq=False)
class NodeTable:
    """Nodes of a file.

    Attributes
    ----------
    tags : (N,) int64
    points : (N, 3) float64
    words : list of bytes
        'x y z' as an ASCII file writes it; of a binary one empty.
    parameters : (N, 3) float64
        On their curve or surface, as far as the block has them.
    block : (N,) int64
        Which of the blocks a node is in.
    blocks : list of Block
        Version 2.2 has just one.
    """

    tags: Ids
    points: Floats
    words: list[bytes]
    parameters: Floats
    block: Ids
    blocks: list[Block]


@dataclass(frozen=True, eq=False)
class ElementTable:
    """Elements of a file.

    Attributes
    ----------
    tags : (M,) int64
    kinds : (M,) int64
    start : (M + 1,) int64
        Where the nodes of an element begin.
    nodes : (K,) int64
        Tags of nodes.
    owner : (M,) int64
        Row in ``owners``.
    owners : list of tuple of int
        Dimension and number of an entity; in version 2.2 all tags of an element.
    """

    tags: Ids
    kinds: Ids
    start: Ids
    nodes: Ids
    owner: Ids
    owners: list[tuple[int, ...]]

    def corners(self, rows: Ids, count: int) -> Ids:
        """(k, count) node tags of elements that have that many nodes."""
        found: Ids = self.nodes[self.start[rows][:, None] + np.arange(count)]
        return found


def read_nodes(name: str, body: bytes, layout: Layout) -> NodeTable:
    """Read $Nodes; raises InputError where it is cut short or holds what is no number."""
    stream, head = _opened(name, body, layout)
    if layout.version == "2.2":
        count = head[0]
        tags, values, words = _node_rows(stream, count, 3, layout)
        parts = [(tags, values, words)]
        blocks: list[Block] = [(2, 0, 0)]
    else:
        parts, blocks = [], []
        for _ in range(head[0]):
            first, second, parametric = stream.integers(3).tolist()
            dimension, entity = (first, second) if layout.version == "4.1" else (second, first)
            if dimension not in (0, 1, 2, 3):
                raise InputError(f"{name}: an entity has the dimension {dimension}; correct it.")
            blocks.append((dimension, entity, dimension if parametric else 0))
            count = int(stream.sizes(1)[0])
            width = 3 + blocks[-1][2]
            parts.append(_node_rows(stream, count, width, layout))
    tags = np.concatenate([np.zeros(0, np.int64), *(part[0] for part in parts)])
    values = np.concatenate([np.zeros((0, 6)), *(_six(part[1]) for part in parts)])
    return NodeTable(
        tags=tags,
        points=values[:, :3],
        words=list(chain.from_iterable(part[2] for part in parts)),
        parameters=values[:, 3:],
        block=np.repeat(np.arange(len(parts)), [len(part[0]) for part in parts]),
        blocks=blocks,
    )


def read_elements(name: str, body: bytes, layout: Layout) -> ElementTable:
    """Read $Elements; raises InputError where it is cut short, wrong or of an unknown kind."""
    stream, head = _opened(name, body, layout)
    if layout.version == "2.2":
        rows = _elements_2(stream, head[0], name, layout)
    else:
        rows = _elements_4(stream, head[0], name, layout)
    tags, kinds, nodes, lengths, owners = rows
    known = list(dict.fromkeys(owners))
    number = {owner: row for row, owner in enumerate(known)}
    return ElementTable(
        tags=np.concatenate([np.zeros(0, np.int64), *tags]),
        kinds=np.repeat(np.array(kinds, np.int64), lengths),
        start=np.cumsum([0, *np.repeat([NODES[kind] for kind in kinds], lengths).tolist()]),
        nodes=np.concatenate([np.zeros(0, np.int64), *nodes]),
        owner=np.repeat(np.array([number[owner] for owner in owners], np.int64), lengths),
        owners=known,
    )


def read_physicals(
    name: str, body: bytes, layout: Layout
) -> dict[tuple[int, int], tuple[int, ...]]:
    """Read the physical groups of each (dimension, entity) in $Entities; raises InputError."""
    stream = numbers_of(name, body, layout)
    counts = stream.sizes(4).tolist()
    found = {}
    for dimension, count in enumerate(counts):
        for _ in range(count):
            entity = int(stream.integers(1)[0])
            stream.floats(3 if dimension == 0 and layout.version == "4.1" else 6)
            groups = stream.integers(int(stream.sizes(1)[0])).tolist()
            found[dimension, entity] = tuple(groups)
            if dimension:
                stream.integers(int(stream.sizes(1)[0]))
    return found


def node_section(table: NodeTable, layout: Layout) -> bytes:
    """Write what stands between $Nodes and $EndNodes."""
    if layout.version == "2.2":
        return _line(len(table.tags)) + _node_lines(table, np.arange(len(table.tags)), 3, layout)
    order = np.argsort(table.block, kind="stable")
    bound = np.searchsorted(table.block[order], np.arange(len(table.blocks) + 1))
    pieces = [_sizes([len(table.blocks), len(order), *_least_and_most(table.tags, layout)], layout)]
    for number, (dimension, entity, parameters) in enumerate(table.blocks):
        rows = order[bound[number] : bound[number + 1]]
        pieces.append(_head(dimension, entity, int(parameters > 0), len(rows), layout))
        pieces.append(_node_lines(table, rows, 3 + parameters, layout))
    return b"".join(pieces) + (b"\n" if layout.is_binary else b"")


def element_section(table: ElementTable, layout: Layout) -> bytes:
    """Write what stands between $Elements and $EndElements."""
    count = len(table.tags)
    change = (np.diff(table.kinds) != 0) | (np.diff(table.owner) != 0)
    starts = np.flatnonzero(np.r_[np.ones(min(count, 1), bool), change])
    runs = [np.arange(a, b) for a, b in zip(starts, np.r_[starts[1:], count], strict=True)]
    if layout.version == "2.2":
        pieces = [_line(count)]
    else:
        head = [len(runs), count, *_least_and_most(table.tags, layout)]
        pieces = [_sizes(head, layout)]
    for rows in runs:
        kind = int(table.kinds[rows[0]])
        owner = table.owners[int(table.owner[rows[0]])]
        nodes = table.corners(rows, NODES[kind])
        if layout.version != "2.2":
            pieces.append(_head(owner[0], owner[1], kind, len(rows), layout))
            values = np.column_stack([table.tags[rows], nodes])
        else:
            tags = np.tile(np.array(owner, np.int64), (len(rows), 1))
            values = np.column_stack([table.tags[rows], tags, nodes])
            if layout.is_binary:
                pieces.append(packed(layout, "i4", [kind, len(rows), len(owner)]))
            else:
                middle = np.tile([kind, len(owner)], (len(rows), 1))
                values = np.column_stack([values[:, :1], middle, values[:, 1:]])
        if layout.is_binary:
            wide = f"u{layout.size}" if layout.version == "4.1" else "i4"
            pieces.append(packed(layout, wide, values))
        else:
            pieces += [_line(*row) for row in values.tolist()]
    return b"".join(pieces) + (b"\n" if layout.is_binary else b"")


def _opened(name: str, body: bytes, layout: Layout) -> tuple[Numbers, list[int]]:
    """Open a stream behind the counts at the beginning; these stand beside it."""
    if layout.version == "2.2":
        head, _, rest = body.partition(b"\n")
        if not head.strip().isdigit() or len(head) > 18:
            raise InputError(f"{name} does not begin with a count; check the file.")
        return numbers_of(name, rest, layout), [int(head)]
    stream = numbers_of(name, body, layout)
    return stream, stream.sizes(4 if layout.version == "4.1" else 2).tolist()


def _node_rows(
    stream: Numbers, count: int, width: int, layout: Layout
) -> tuple[Ids, Floats, list[bytes]]:
    """Tags, (count, width) numbers and words of nodes of one block."""
    if layout.version == "4.1":
        tags = stream.sizes(count)
        before = stream.at
        values = stream.floats(count * width).reshape(count, width)
        return tags, values, _words(stream, before, count, width, skip=0)
    before = stream.at
    tags, values = stream.tagged(count, width)
    return tags, values, _words(stream, before, count, width, skip=1)


def _words(stream: Numbers, at: int, count: int, width: int, skip: int) -> list[bytes]:
    """'x y z' of the rows of a block, as an ASCII file writes them."""
    if not isinstance(stream, TextNumbers):
        return []
    starts = range(at + skip, at + count * (skip + width), skip + width)
    return [b" ".join(stream.words[i : i + 3]) for i in starts]


Rows = tuple[list[Ids], list[int], list[Ids], list[int], list[tuple[int, ...]]]
"""Of each run of elements: tags, kind, nodes, how many they are, owner."""


def _elements_2(stream: Numbers, count: int, name: str, layout: Layout) -> Rows:
    tags, kinds, nodes, lengths, owners = _no_rows()
    done = 0
    while done < count:
        if layout.is_binary:
            kind, together, width = stream.integers(3).tolist()
        else:
            number, kind, width = stream.integers(3).tolist()
            together = 1
        size = _size(kind, name)
        if together < 1 or width < 0:
            raise InputError(f"{name}: a block of {together} elements; check the file.")
        if layout.is_binary:
            each = 1 + width + size
            values = stream.integers(together * each).reshape(together, each)
        else:
            values = np.r_[number, stream.integers(width + size)][None]
        for row in values:
            tags.append(row[:1])
            kinds.append(kind)
            nodes.append(row[1 + width :])
            lengths.append(1)
            owners.append(tuple(row[1 : 1 + width].tolist()))
        done += together
    return tags, kinds, nodes, lengths, owners


def _elements_4(stream: Numbers, blocks: int, name: str, layout: Layout) -> Rows:
    tags, kinds, nodes, lengths, owners = _no_rows()
    for _ in range(blocks):
        first, second, kind = stream.integers(3).tolist()
        count = int(stream.sizes(1)[0])
        size = _size(kind, name)
        take = stream.sizes if layout.version == "4.1" else stream.integers
        values = take(count * (1 + size)).reshape(count, 1 + size)
        if not count:
            continue
        tags.append(values[:, 0])
        kinds.append(kind)
        nodes.append(values[:, 1:].ravel())
        lengths.append(count)
        owners.append((first, second) if layout.version == "4.1" else (second, first))
    return tags, kinds, nodes, lengths, owners


def _no_rows() -> Rows:
    return [], [], [], [], []


def _size(kind: int, name: str) -> int:
    if kind not in NODES:
        raise InputError(f"{name}: elements of gmsh's type {kind} are not read; remove them.")
    return NODES[kind]


def _six(values: Floats) -> Floats:
    six = np.zeros((len(values), 6))
    six[:, : values.shape[1]] = values
    return six


def _node_lines(table: NodeTable, rows: Ids, width: int, layout: Layout) -> bytes:
    values = np.column_stack([table.points[rows], table.parameters[rows]])[:, :width]
    if layout.is_binary:
        if layout.version == "4.1":
            return packed(layout, f"u{layout.size}", table.tags[rows]) + packed(
                layout, "f8", values
            )
        kind = [("tag", f"{layout.order}i4"), ("at", f"{layout.order}f8", (width,))]
        records = np.empty(len(rows), kind)
        records["tag"], records["at"] = table.tags[rows], values
        return records.tobytes()
    places = []
    for row, numbers in zip(rows.tolist(), values.tolist(), strict=True):
        more = [repr(number).encode() for number in numbers[3:]]
        places.append(b" ".join([table.words[row], *more]))
    tags = [str(tag).encode() for tag in table.tags[rows].tolist()]
    if layout.version == "4.1":
        return b"".join(line + b"\n" for line in [*tags, *places])
    return b"".join(t + b" " + p + b"\n" for t, p in zip(tags, places, strict=True))


def _head(first: int, second: int, third: int, count: int, layout: Layout) -> bytes:
    """Head of a block: an entity's dimension and number, in the order of the version."""
    three = [first, second, third] if layout.version == "4.1" else [second, first, third]
    if layout.is_binary:
        return packed(layout, "i4", three) + _sizes([count], layout)
    return _line(*three, count)


def _least_and_most(tags: Ids, layout: Layout) -> list[int]:
    if layout.version != "4.1":
        return []
    return [int(tags.min()), int(tags.max())] if len(tags) else [0, 0]


def _sizes(values: list[int], layout: Layout) -> bytes:
    return packed(layout, f"u{layout.size}", values) if layout.is_binary else _line(*values)


def _line(*values: int) -> bytes:
    return " ".join(map(str, values)).encode() + b"\n"
