"""The nodes and elements of a .msh file after its shells have been edited."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from meshops.formats.carrying import Carried
from meshops.formats.gmsh_stream import Layout
from meshops.formats.gmsh_tables import NODES, QUAD, TRIA, Block, ElementTable, NodeTable
from meshops.mesh import NO_NODE, Ids


def edited_elements(
    table: ElementTable, element_of: Ids, carried: Carried, owner: Ids
) -> ElementTable:
    """Elements after the edits; new ones follow the last of their kind and owner.

    Parameters
    ----------
    table : ElementTable
    element_of : (K,) int64
        Mesh row of each element of the file, -1 where it is none of the mesh.
    carried : Carried
    owner : (M,) int64
        Of each element of the edited mesh.
    """
    d = carried.difference
    after = np.full(len(carried.before.elements), -1, np.int64)
    kept = np.flatnonzero(carried.after.element_ids != 0)
    after[carried.element_rows[kept]] = kept
    rewired = np.zeros(len(carried.after.elements), bool)
    rewired[d.rewired] = True
    copies: dict[int, list[int]] = {}
    for row in np.flatnonzero(element_of >= 0).tolist():
        copies.setdefault(int(element_of[row]), []).append(row)
    rows: list[_Row] = []
    for row in range(len(table.tags)):
        element = int(element_of[row])
        if element < 0:
            rows.append(_Row.of(table, row))
        elif after[element] >= 0:
            found = _Row.of(table, row)
            if rewired[after[element]]:
                kind, nodes = _corners(d.corners[after[element]])
                found = found._replace(kind=kind, nodes=nodes)
            rows.append(found)
    tag = max([*table.tags.tolist(), *d.element_ids.tolist(), 0])
    last = {(row.owner, row.kind): place for place, row in enumerate(rows)}
    added: dict[int, list[_Row]] = {}
    for element in d.new_elements.tolist():
        kind, nodes = _corners(d.corners[element])
        for number, copy in enumerate(copies[int(carried.element_rows[element])]):
            its_owner = int(table.owner[copy]) if number else int(owner[element])
            tag += number > 0
            its_tag = tag if number else int(d.element_ids[element])
            new = _Row(its_tag, kind, its_owner, nodes)
            place = last.get((new.owner, new.kind), len(rows) - 1)
            added.setdefault(place, []).append(new)
    ordered = list(added.get(-1, []))
    for place, found in enumerate(rows):
        ordered += [found, *added.get(place, [])]
    return _table(ordered, table.owners)


def edited_nodes(table: NodeTable, carried: Carried, entity: Ids, layout: Layout) -> NodeTable:
    """Nodes after the edits; `entity` (M,) is that of each element."""
    d, mesh = carried.difference, carried.after
    blocks = list(table.blocks)

    def block_of(block: Block) -> int:
        if block not in blocks:
            blocks.append(block)
        return blocks.index(block)

    place = {tag: row for row, tag in enumerate(table.tags.tolist())}
    points, words, block = table.points.copy(), list(table.words), table.block.copy()
    for row in d.moved.tolist():
        source = place[int(d.node_ids[row])]
        points[source] = mesh.points[row]
        if words:
            words[source] = _word(mesh.points[row].tolist())
        dimension, number, parameters = blocks[int(block[source])]
        if parameters:
            # where it is now on its surface is not known
            block[source] = block_of((dimension, number, 0))
    kept = np.flatnonzero(~np.isin(table.tags, d.gone_nodes))
    element = np.zeros(len(mesh.points), np.int64)
    corner = mesh.elements != NO_NODE
    element[mesh.elements[corner]] = np.nonzero(corner)[0]
    homes = [
        0 if layout.version == "2.2" else block_of((2, int(entity[element[row]]), 0))
        for row in d.new_nodes.tolist()
    ]
    new_points = mesh.points[d.new_nodes]
    return NodeTable(
        tags=np.concatenate([table.tags[kept], d.node_ids[d.new_nodes]]),
        points=np.concatenate([points[kept], new_points]),
        words=[words[row] for row in kept] + [_word(p) for p in new_points.tolist()]
        if words or not layout.is_binary
        else [],
        parameters=np.concatenate([table.parameters[kept], np.zeros_like(new_points)]),
        block=np.concatenate([block[kept], np.array(homes, np.int64)]),
        blocks=blocks,
    )


def _word(place: list[float]) -> bytes:
    return " ".join(map(repr, place)).encode()


class _Row(NamedTuple):
    """An element of a table."""

    tag: int
    kind: int
    owner: int
    nodes: tuple[int, ...]

    @classmethod
    def of(cls, table: ElementTable, row: int) -> _Row:
        nodes = table.nodes[table.start[row] : table.start[row + 1]].tolist()
        return cls(int(table.tags[row]), int(table.kinds[row]), int(table.owner[row]), tuple(nodes))


def _corners(ids: Ids) -> tuple[int, tuple[int, ...]]:
    """Kind and nodes of a shell; 0 stands last in a tria."""
    nodes = tuple(int(node) for node in ids if node)
    return (QUAD if len(nodes) == NODES[QUAD] else TRIA), nodes


def _table(rows: list[_Row], owners: list[tuple[int, ...]]) -> ElementTable:
    return ElementTable(
        tags=np.array([row.tag for row in rows], np.int64),
        kinds=np.array([row.kind for row in rows], np.int64),
        start=np.cumsum([0, *(len(row.nodes) for row in rows)]),
        nodes=np.array([node for row in rows for node in row.nodes], np.int64),
        owner=np.array([row.owner for row in rows], np.int64),
        owners=owners,
    )
