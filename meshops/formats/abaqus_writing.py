"""Nodes and elements of an edited mesh, written into the blocks of an Abaqus deck."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence

import numpy as np

from meshops.formats.abaqus_blocks import Block
from meshops.formats.abaqus_items import Items, element_type, frame_of
from meshops.formats.abaqus_output import element_row, node_row, set_rows
from meshops.formats.abaqus_regions import Region
from meshops.formats.abaqus_sets import NamedSets, header_of, identity_of
from meshops.formats.abaqus_types import CORNERS
from meshops.formats.coordinates import BASIC
from meshops.formats.difference import Difference
from meshops.formats.splice import Splice


def write_nodes(
    splice: Splice,
    nodes: Items,
    change: Difference,
    joining: Mapping[str, Sequence[int]],
) -> dict[str, list[int]]:
    """Write moved nodes in their places, and new ones into the blocks of the sets that they join.

    Returns
    -------
    dict of str to list of int
        Who still has to join a set, as ``joining`` by its identity.
    """
    _write_old_nodes(splice, nodes, change)
    homes = {
        identity_of("NSET", block): block
        for block in nodes.distinct_blocks
        if block.parameters.get("NSET")
    }
    home_of = {node: name for name in homes for node in joining.get(name, ())}
    plain = [b for b in nodes.distinct_blocks if not {"NSET", "SYSTEM"} & b.parameters.keys()]
    rows_of_block: dict[int, list[int]] = defaultdict(list)
    for row in change.new_nodes.tolist():
        name = home_of.get(int(change.node_ids[row]))
        home = homes[name] if name else plain[-1] if plain else None
        rows_of_block[home.header[0] if home else -1].append(row)
    blocks = {block.header[0]: block for block in nodes.distinct_blocks}
    is_plane = all(len(record.values) == 3 for record in nodes.records)
    # a keyword of its own comes after what is added to the block before it
    for start, rows in sorted(rows_of_block.items(), reverse=True):
        block = blocks.get(start)
        points = (frame_of(block) if block else BASIC).from_basic(change.mesh.points[rows])
        count = 2 if is_plane and not points[:, 2].any() else 3
        texts = [
            node_row(int(change.node_ids[row]), point[:count])
            for row, point in zip(rows, points.tolist(), strict=True)
        ]
        if block:
            splice.insert_after(block.last, texts)
        else:
            splice.insert_after(nodes.last.end, ["*NODE", *texts])
    return {
        name: [node for node in ids if home_of.get(node) != name] for name, ids in joining.items()
    }


def write_first_lists(
    splice: Splice, nodes: Items, nsets: NamedSets, joining: Mapping[str, Sequence[int]]
) -> None:
    """List the new members of sets that only *NODE blocks name so far."""
    for item in nsets:
        ids = joining.get(item.identity, ())
        if ids and not item.lists:
            rows = set_rows([str(node) for node in ids])
            splice.insert_after(nodes.last.end, [header_of("NSET", item.headers[-1]), *rows])


def write_elements(
    splice: Splice,
    shells: Items,
    change: Difference,
    regions: Sequence[Region],
) -> None:
    """Write elements with other nodes in their places, and those of another kind and new ones last.

    Parameters
    ----------
    regions
        By the numbers of ``change.mesh.region``.
    """
    gone = set(change.gone_elements.tolist())
    ids, corners = change.element_ids.tolist(), change.corners
    rewired = {ids[row]: row for row in change.rewired}
    added: dict[tuple[str, str], list[str]] = {}

    def add(row: int) -> None:
        region = regions[change.mesh.region[row]]
        kind = region.quad if corners[row, 3] else region.tria
        added.setdefault((kind, region.elset), []).append(element_row(ids[row], corners[row]))

    left = {block.header[0]: 0 for block in shells.distinct_blocks}
    for record, block in zip(shells.records, shells.blocks, strict=True):
        element = int(record.values[0])
        row = rewired.get(element)
        stays_a_kind = row is None or CORNERS[element_type(block)] == np.count_nonzero(corners[row])
        if element in gone or not stays_a_kind:
            splice.drop(record.lines)
            if row is not None:
                add(row)
            continue
        left[block.header[0]] += 1
        if row is not None:
            splice.replace(record.lines, [element_row(element, corners[row])])
    for row in change.new_elements:
        add(row)
    for block in shells.distinct_blocks:
        # the files that it names stay, without elements
        if not left[block.header[0]] and "INPUT" not in block.parameters:
            splice.drop(block.header)
    in_set = _written_sets(shells.distinct_blocks)
    rows = [
        text
        for (kind, elset), texts in added.items()
        for text in (f"*ELEMENT, TYPE={kind}{in_set[elset]}", *texts)
    ]
    splice.insert_after(shells.last.end, rows)


def _write_old_nodes(splice: Splice, nodes: Items, change: Difference) -> None:
    gone = set(change.gone_nodes.tolist())
    moved = dict(zip(change.node_ids[change.moved].tolist(), change.moved, strict=True))
    for record, block in zip(nodes.records, nodes.blocks, strict=True):
        node = int(record.values[0])
        if node in gone:
            splice.drop(record.lines)
        elif node in moved:
            local = frame_of(block).from_basic(change.mesh.points[moved[node]][None])[0].tolist()
            count = 2 if len(record.values) == 3 and not local[2] else 3
            splice.replace(record.lines, [node_row(node, local[:count], record.values[4:])])


def _written_sets(blocks: Sequence[Block]) -> dict[str, str]:
    """', ELSET=name' as the first *ELEMENT of a set writes it, by the key of the name."""
    found = {"": ""}
    for block in blocks:
        if block.parameters.get("ELSET"):
            found.setdefault(block.parameters["ELSET"], f", ELSET={block.written['ELSET']}")
    return found
