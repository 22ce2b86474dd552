"""Abaqus decks (.inp): read, and spliced on writing.

The conventional shells are the mesh. Nodes that anything else names by number are locked, and so
are shells that a load, a surface or an unknown keyword names by number. Sets of elements follow
the mesh: a region is made of the shells of one kind and of the same sets, so that a new shell joins
the sets of its region and a vanished one leaves its lists.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from meshops.errors import InputError
from meshops.formats import abaqus_references as references
from meshops.formats.abaqus_blocks import (
    Block,
    blocks,
    find_includes,
    id_list,
    include_lines,
    records,
)
from meshops.formats.abaqus_items import (
    CORNERS,
    Items,
    corner_array,
    element_type,
    frame_of,
    id_array,
    is_shell,
    point_array,
    read_items,
)
from meshops.formats.abaqus_sets import ElementLists
from meshops.formats.checks import checked_mesh
from meshops.formats.coordinates import BASIC
from meshops.formats.difference import Difference, compare
from meshops.formats.fresh import write_mesh
from meshops.formats.ids import IdSet, check_room
from meshops.formats.locks import Lock
from meshops.formats.sources import Sources, read_sources
from meshops.formats.splice import Splice
from meshops.formats.suffixes import ABAQUS
from meshops.mesh import Bools, Ids, ShellMesh

LARGEST_ID = 999_999_999

_PAIRS = (("S4", "S3"), ("S4R", "S3R"), ("S4RS", "S3RS"), ("S4R5", "STRI3"))
_GENERATING = ("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM")


class _Region(NamedTuple):
    """Element types, the set that *ELEMENT names, and the sets that list the elements."""

    quad: str
    tria: str
    elset: str
    lists: frozenset[str]

    @property
    def sets(self) -> set[str]:
        """Names of all sets, without the scopes of the lists."""
        return {self.elset, *(name.rpartition(":")[2] for name in self.lists)}


@dataclass(frozen=True, eq=False)
class AbaqusDeck:
    """An Abaqus deck: its shells as a mesh, its lines, and the records of nodes and shells.

    Attributes
    ----------
    mesh : ShellMesh
    sources : Sources
    """

    mesh: ShellMesh
    sources: Sources
    _regions: list[_Region]
    _nodes: Items
    _shells: Items
    _lists: ElementLists
    _taken_nodes: IdSet
    _taken_elements: IdSet
    locks: tuple[Lock, ...] = ()
    notes: tuple[str, ...] = ()

    def check_room(self) -> None:
        """Raise InputError where there are fewer free ids than the mesh has nodes or elements."""
        check_room(self.mesh.node_ids, self._taken_nodes, LARGEST_ID, "nodes")
        check_room(self.mesh.element_ids, self._taken_elements, LARGEST_ID, "elements")

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the deck with ``mesh`` in the place of its shells; see ``NastranDeck.write``.

        Raises
        ------
        InputError
            Where the path is one of the deck's files or cannot be written, or no ids are left.
        ValueError
            Where the mesh does not descend from this deck's.
        """
        if path.suffix.lower() not in ABAQUS:
            write_mesh(mesh, path)
            return
        change = compare(
            self.mesh,
            mesh,
            taken_nodes=self._taken_nodes,
            taken_elements=self._taken_elements,
            limit=LARGEST_ID,
        )
        splice = Splice(self.sources)
        self._write_nodes(splice, mesh, change)
        self._write_shells(splice, mesh, change)
        joining = defaultdict(list)
        for row in change.new_elements:
            for name in self._regions[mesh.region[row]].lists:
                joining[name].append(int(change.element_ids[row]))
        self._lists.write(splice, gone=change.gone_elements.tolist(), joining=joining)
        splice.write(path, include_lines)

    def _write_nodes(self, splice: Splice, mesh: ShellMesh, change: Difference) -> None:
        gone = set(change.gone_nodes.tolist())
        moved = dict(zip(change.node_ids[change.moved].tolist(), change.moved, strict=True))
        for record, block in zip(self._nodes.records, self._nodes.blocks, strict=True):
            node = int(record.values[0])
            if node in gone:
                splice.drop(record.lines)
            elif node in moved:
                local = frame_of(block).from_basic(mesh.points[moved[node]][None])[0]
                tail = record.values[4:]
                splice.replace(record.lines, [_row([node, *local.tolist(), *tail])])
        last = self._nodes.last
        alone = len({block.header[0] for block in self._nodes.blocks}) == 1
        continued = alone or not ("NSET" in last.parameters or "SYSTEM" in last.parameters)
        new = mesh.points[change.new_nodes]
        points = (frame_of(last) if continued else BASIC).from_basic(new)
        ids = change.node_ids[change.new_nodes].tolist()
        rows = [_row([node, *point]) for node, point in zip(ids, points.tolist(), strict=True)]
        header = [] if continued or not rows else ["*NODE"]
        splice.insert_after(last.last, header + rows)

    def _write_shells(self, splice: Splice, mesh: ShellMesh, change: Difference) -> None:
        gone = set(change.gone_elements.tolist())
        ids, corners = change.element_ids.tolist(), change.corners
        rewired = {ids[row]: row for row in change.rewired}
        added: dict[tuple[str, str], list[str]] = {}

        def add(row: int) -> None:
            region = self._regions[mesh.region[row]]
            kind = region.quad if corners[row, 3] else region.tria
            added.setdefault((kind, region.elset), []).append(_shell_row(ids[row], corners[row]))

        left = {block.header[0]: 0 for block in self._shells.blocks}
        for record, block in zip(self._shells.records, self._shells.blocks, strict=True):
            element = int(record.values[0])
            row = rewired.get(element)
            stays_a_kind = row is None or CORNERS[element_type(block)] == np.count_nonzero(
                corners[row]
            )
            if element in gone or not stays_a_kind:
                splice.drop(record.lines)
                if row is not None:
                    add(row)
                continue
            left[block.header[0]] += 1
            if row is not None:
                splice.replace(record.lines, [_shell_row(element, corners[row])])
        for row in change.new_elements:
            add(row)
        for block in self._shells.blocks:
            if not left[block.header[0]]:
                splice.drop(block.header)
        rows = [
            text
            for (kind, elset), shells in added.items()
            for text in (f"*ELEMENT, TYPE={kind}" + f", ELSET={elset}" * bool(elset), *shells)
        ]
        splice.insert_after(self._shells.last.last, rows)


def read_abaqus(path: Path) -> AbaqusDeck:
    """Read an Abaqus deck with all that it includes.

    Raises
    ------
    InputError
        Where a file is missing or not text, nodes or elements are generated or cannot be read,
        shells stand in several parts, or the mesh fails the checks of ``checked_mesh``.
    """
    sources = read_sources(path, find_includes)
    lines = sources.stream
    every = blocks(lines)
    _refuse_generated(every, sources)
    shells = read_items([b for b in every if is_shell(b)], sources)
    scope = _scope(shells.blocks, sources)
    nodes = read_items([b for b in every if b.keyword == "NODE" and b.scope == scope], sources)
    others = [block for block in _speaking_of(scope, every) if not is_shell(block)]
    locked_nodes, locked_elements = references.collect(others, lines)
    lists = ElementLists([b for b in others if b.keyword == "ELSET"], lines)
    element_ids = id_array(shells, sources)
    node_ids = id_array(nodes, sources)
    regions, region = _regions(shells, lists, element_ids)
    edges = references.edge_sets(others, lines)
    mesh = checked_mesh(
        source=sources.name,
        points=point_array(nodes, sources),
        node_ids=node_ids,
        corners=corner_array(shells, sources),
        element_ids=element_ids,
        region=np.array(region, np.int32),
        locked_nodes=locked_nodes.mask(node_ids) | _in_used_sets(nodes, others, lines),
        locked_elements=locked_elements.mask(element_ids)
        | np.array([bool(edges & regions[r].sets) for r in region], bool),
        node_place=lambda row: sources.where(nodes.records[row].lines[0]),
        element_place=lambda row: sources.where(shells.records[row].lines[0]),
    )
    taken_nodes = IdSet(set(node_ids.tolist()))
    taken_nodes.update(locked_nodes)
    taken_elements = IdSet(set(element_ids.tolist()))
    taken_elements.update(locked_elements)
    for block in others:
        if block.keyword == "ELSET":
            taken_elements.update(id_list(block, lines))
        elif block.keyword == "ELEMENT":
            taken_elements.read(record.values[0] for record in records(block, lines))
    return AbaqusDeck(mesh, sources, regions, nodes, shells, lists, taken_nodes, taken_elements)


def _refuse_generated(every: Sequence[Block], sources: Sources) -> None:
    for block in every:
        if block.keyword in _GENERATING:
            raise InputError(
                f"{sources.where(block.header[0])}: *{block.keyword} is not read; "
                "write out the nodes and elements that it makes."
            )


def _scope(shells: Sequence[Block], sources: Sources) -> str:
    scopes = {block.scope: block for block in shells}
    if len(scopes) > 1:
        second = list(scopes.values())[1]
        raise InputError(
            f"{sources.where(second.header[0])}: there are shells in more than one part; "
            "put each part into a deck of its own."
        )
    return next(iter(scopes), "")


def _speaking_of(scope: str, every: Sequence[Block]) -> list[Block]:
    """Blocks whose ids are those of the scope: other parts count their own."""
    parts = {
        block.parameters.get("NAME", ""): block.parameters.get("PART", "")
        for block in every
        if block.keyword == "INSTANCE"
    }

    def speaks_of_it(block: Block) -> bool:
        instance = block.parameters.get("INSTANCE", "")
        if block.scope == scope:
            return True
        if block.scope.startswith("PART "):
            return False
        return instance not in parts or scope in (f"PART {parts[instance]}", f"INSTANCE {instance}")

    return [block for block in every if speaks_of_it(block)]


def _regions(
    shells: Items, lists: ElementLists, element_ids: Ids
) -> tuple[list[_Region], list[int]]:
    """Find the distinct regions, and the number of the one of each shell."""
    pairs = _type_pairs({element_type(block) for block in shells.blocks})
    named = lists.names_of(element_ids)
    numbers: dict[_Region, int] = {}
    region = []
    for block, names in zip(shells.blocks, named, strict=True):
        key = _Region(*pairs[element_type(block)], block.parameters.get("ELSET", ""), names)
        region.append(numbers.setdefault(key, len(numbers)))
    return list(numbers), region


def _type_pairs(types: set[str]) -> dict[str, tuple[str, str]]:
    """Pair the quad and tria types; S3 goes with S4R in decks that have no S4."""
    pairs = {kind: pair for pair in _PAIRS for kind in pair}
    if "S4R" in types and "S3R" not in types and "S3" in types and "S4" not in types:
        pairs["S4R"] = pairs["S3"] = ("S4R", "S3")
    return pairs


def _in_used_sets(nodes: Items, others: Sequence[Block], lines: Sequence[str]) -> Bools:
    """Nodes in an NSET of their *NODE block that is used and that new nodes would not join."""
    if len({block.header[0] for block in nodes.blocks}) <= 1:
        return np.zeros(len(nodes.blocks), bool)
    used = references.words(others, lines)
    return np.array([block.parameters.get("NSET") in used for block in nodes.blocks], bool)


def _shell_row(element: int, corners: Ids) -> str:
    return _row([element, *(int(node) for node in corners if node)])


def _row(values: Sequence[object]) -> str:
    return ", ".join(str(value) for value in values)
