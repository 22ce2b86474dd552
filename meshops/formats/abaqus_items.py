"""The nodes and shells of an Abaqus deck as records, and the numbers in them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshops.errors import InputError
from meshops.formats.abaqus_blocks import Block, Record, records
from meshops.formats.abaqus_types import CORNERS
from meshops.formats.coordinates import BASIC, Frame, Kind
from meshops.formats.fortran import real
from meshops.formats.ids import is_id
from meshops.formats.sources import Sources
from meshops.mesh import Floats, Ids


@dataclass(frozen=True, eq=False)
class Items:
    """Nodes or shells of a deck: their records, and the block of each."""

    records: list[Record]
    blocks: list[Block]

    @property
    def last(self) -> Block:
        """The block that comes last in the deck."""
        return max(self.distinct_blocks, key=lambda block: block.last)

    @cached_property
    def distinct_blocks(self) -> list[Block]:
        """Every block once, in the order of the deck."""
        return list({block.header[0]: block for block in self.blocks}.values())


def element_type(block: Block) -> str:
    """Read TYPE of an *ELEMENT block."""
    return block.parameters.get("TYPE", "")


def is_shell(block: Block) -> bool:
    """Tell whether a block holds elements of the mesh."""
    return block.keyword == "ELEMENT" and element_type(block) in CORNERS


def read_items(some: Sequence[Block], sources: Sources) -> Items:
    """Collect the records of *NODE blocks or of *ELEMENT blocks of shells."""
    found: list[Record] = []
    homes: list[Block] = []
    for block in some:
        count = CORNERS[element_type(block)] + 1 if block.keyword == "ELEMENT" else 1
        for record in records(block, sources.stream, count):
            found.append(record)
            homes.append(block)
    return Items(found, homes)


def id_array(items: Items, sources: Sources) -> Ids:
    """(N,) int64 ids; raises InputError where one is no integer."""
    return np.array([_integer(record, 0, sources) for record in items.records], np.int64)


def corner_array(shells: Items, sources: Sources) -> Ids:
    """(M, 4) int64 node ids, 0 last in a tria; raises InputError where one is no integer."""
    corners = np.zeros((len(shells.records), 4), np.int64)
    for row, (record, block) in enumerate(zip(shells.records, shells.blocks, strict=True)):
        count = CORNERS[element_type(block)]
        corners[row, :count] = [_integer(record, 1 + i, sources) for i in range(count)]
    return corners


def point_array(nodes: Items, sources: Sources) -> Floats:
    """(N, 3) basic coordinates; raises InputError where one is no number."""
    points = np.zeros((len(nodes.records), 3))
    for row, (record, block) in enumerate(zip(nodes.records, nodes.blocks, strict=True)):
        try:
            local = [real(text) for text in record.values[1:4]]
        except ValueError:
            raise InputError(
                f"{sources.where(record.lines[0])}: a coordinate of node {record.values[0]} "
                "is not a number; correct it."
            ) from None
        points[row, : len(local)] = local
        with np.errstate(invalid="ignore"):  # what is not finite is told by checked_mesh
            points[row] = frame_of(block).to_basic(points[row][None])[0]
    return points


def frame_of(block: Block) -> Frame:
    """Make the system in which a *NODE block gives coordinates."""
    kinds: dict[str, Kind] = {"C": "C", "S": "S"}
    kind = kinds.get(block.parameters.get("SYSTEM", "R")[:1])
    return Frame(kind, np.zeros(3), np.eye(3)) if kind else BASIC


def _integer(record: Record, i: int, sources: Sources) -> int:
    text = record.values[i] if i < len(record.values) else ""
    if is_id(text):
        return int(text)
    found = f"'{text}'" if text else "missing"
    raise InputError(
        f"{sources.where(record.lines[0])}: value {i + 1} is {found}; it has to be an id."
    )
