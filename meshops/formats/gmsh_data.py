"""$NodeData and $ElementData of a .msh file: values by the tags of nodes and elements."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from meshops.errors import InputError
from meshops.formats.gmsh_stream import Layout, numbers_of, packed
from meshops.mesh import Floats, Ids

COMPONENTS, ENTITIES = 1, 2
"""Which of the integers of the head say how many numbers a value has, and how many values come."""


@dataclass(frozen=True, eq=False)
class DataTable:
    """Values by tag.

    Attributes
    ----------
    head : bytes
        The lines of strings and reals.
    integers : list of int
    tags : (n,) int64
    values : (n, k) float64
    """

    head: bytes
    integers: list[int]
    tags: Ids
    values: Floats


def read_data(name: str, body: bytes, layout: Layout) -> DataTable:
    """Read a section; raises InputError where it is cut short or holds what is no number."""
    head, integers, at = _read_head(name, body)
    width, rows = integers[COMPONENTS], integers[ENTITIES]
    stream = numbers_of(name, body[at:], layout)
    tags, values = stream.tagged(rows, width)
    return DataTable(head, integers, tags, values)


def data_section(table: DataTable, layout: Layout) -> bytes:
    """Write what stands within the section."""
    integers = list(table.integers)
    integers[ENTITIES] = len(table.tags)
    lines = _integer_lines(integers)
    if layout.is_binary:
        width = table.values.shape[1]
        kind = [("tag", f"{layout.order}i4"), ("at", f"{layout.order}f8", (width,))]
        rows = np.empty(len(table.tags), kind)
        rows["tag"], rows["at"] = table.tags, table.values
        return table.head + lines + rows.tobytes() + b"\n"
    text = [
        " ".join([str(tag), *map(repr, row)]) + "\n"
        for tag, row in zip(table.tags.tolist(), table.values.tolist(), strict=True)
    ]
    return table.head + lines + "".join(text).encode()


def carried_data(
    table: DataTable, before: Ids, after: Ids, gone: Ids, carry: Callable[[Floats], Floats]
) -> DataTable:
    """Carry values over to other tags.

    Parameters
    ----------
    table : DataTable
    before, after : (n,) int64, (N,) int64
        Tags of the mesh that was read and of the edited one.
    gone : (k,) int64
        Tags that are no more.
    carry : callable
        Takes values (n, k) of the one to those (N, k) of the other.
    """
    order = np.argsort(table.tags, kind="stable")
    there = np.minimum(np.searchsorted(table.tags[order], before), max(len(order) - 1, 0))
    known = np.zeros(len(before), bool)
    values = np.full((len(before), table.values.shape[1]), np.nan)
    if len(order):
        rows = order[there]
        known = table.tags[rows] == before
        values[known] = table.values[rows[known]]
    carried = carry(values)
    had = carry(np.where(known, 1.0, np.nan)[:, None])[:, 0] == 1.0
    kept = ~np.isin(table.tags, np.concatenate([gone, after[had]]))
    tags = np.concatenate([table.tags[kept], after[had]])
    found = np.concatenate([table.values[kept], carried[had]])
    # what was there keeps its place, and what is new follows
    place = {tag: row for row, tag in enumerate(table.tags.tolist())}
    last = len(place)
    sort = np.argsort([place.get(tag, last) for tag in tags.tolist()], kind="stable")
    return replace(table, tags=tags[sort], values=found[sort])


def without_elements(name: str, body: bytes, layout: Layout, lost: Ids) -> bytes:
    """$ElementNodeData without the elements of these tags; raises InputError as ``read_data``."""
    head, integers, at = _read_head(name, body)
    width = integers[COMPONENTS]
    stream = numbers_of(name, body[at:], layout)
    gone = set(lost.tolist())
    kept = []
    for _ in range(integers[ENTITIES]):
        tag, nodes = stream.integers(2).tolist()
        values = stream.floats(nodes * width)
        if tag not in gone:
            kept.append((tag, nodes, values))
    integers[ENTITIES] = len(kept)
    lines = _integer_lines(integers)
    if layout.is_binary:
        rows = [packed(layout, "i4", [t, n]) + packed(layout, "f8", v) for t, n, v in kept]
        return head + lines + b"".join(rows) + b"\n"
    text = [" ".join([str(t), str(n), *map(repr, v.tolist())]) + "\n" for t, n, v in kept]
    return head + lines + "".join(text).encode()


def _read_head(name: str, body: bytes) -> tuple[bytes, list[int], int]:
    """Lines of strings and reals, the integers after them, and where these end."""
    at = 0

    def line() -> bytes:
        nonlocal at
        stop = body.find(b"\n", at)
        if stop < 0:
            raise InputError(f"{name} is cut short: check the file.")
        found, at = body[at:stop], stop + 1
        return found.strip()

    def count() -> int:
        words = line()
        if not words.isdigit() or len(words) > 18 or int(words) > len(body):
            raise InputError(f"{name}: '{words.decode('latin-1')}' is no count; correct it.")
        return int(words)

    for _ in range(2):
        for _ in range(count()):
            line()
    head = body[:at]
    integers = [count() for _ in range(count())]
    if len(integers) <= ENTITIES:
        raise InputError(f"{name} does not say how many values it has; correct it.")
    return head, integers, at


def _integer_lines(integers: list[int]) -> bytes:
    return "".join(f"{value}\n" for value in [len(integers), *integers]).encode()
