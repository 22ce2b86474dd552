"""Splicing an edited mesh into the lines of its section of a Nastran deck."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from meshops.formats import nastran_nodes as nodes
from meshops.formats.difference import Difference
from meshops.formats.fortran import real_field
from meshops.formats.nastran_cards import Card, card_lines
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_loads import Layer, Pressure
from meshops.formats.nastran_shells import Attributes, attributes
from meshops.formats.node_attributes import Memberships, memberships_of_new_nodes
from meshops.formats.splice import Splice
from meshops.mesh import NEW, Floats, Ids


@dataclass(frozen=True, eq=False)
class Update:
    """An edited mesh and what it changes.

    Attributes
    ----------
    contents : Contents
    change : Difference
    regions : sequence of Attributes
        What new elements of each region take over.
    shared : sequence of frozenset of Membership
        What new nodes of each region get.
    systems : sequence of int
        The system of new nodes of each region.
    angles : mapping of int to float
        Another THETA for some rows of the mesh, in degrees.
    pressures : mapping of int to sequence of Pressure
        Other loads, by the layers of fields, for some rows of the mesh.
    """

    contents: Contents
    change: Difference
    regions: Sequence[Attributes]
    shared: Sequence[Memberships]
    systems: Sequence[int]
    angles: Mapping[int, float]
    pressures: Mapping[int, Sequence[Pressure]]

    def splice(self, splice: Splice) -> None:
        """Change the lines of the section that have to differ."""
        self._splice_nodes(splice)
        gone = set(self.change.gone_nodes.tolist())
        ids = self.change.node_ids
        got = {int(ids[row]): items for row, items in self._memberships.items()}
        nodes.splice_node_cards(splice, self.contents, gone, got)
        self._splice_shells(splice)
        self._splice_pressures(splice)

    def new_in_sets(self) -> tuple[dict[int, list[int]], dict[int, list[int]]]:
        """Ids of new nodes, and of new shells, by the numbers of the output sets they are in."""
        of_nodes: defaultdict[int, list[int]] = defaultdict(list)
        of_shells: defaultdict[int, list[int]] = defaultdict(list)
        for row, items in self._memberships.items():
            for item in items:
                if isinstance(item.kind, tuple) and item.kind[0] == "SET":
                    of_nodes[item.kind[1]].append(int(self.change.node_ids[row]))
        for row in self.change.new_elements.tolist():
            for number in self.regions[self.change.mesh.region[row]].sets:
                of_shells[number].append(int(self.change.element_ids[row]))
        return of_nodes, of_shells

    @cached_property
    def _memberships(self) -> dict[int, Memberships]:
        return memberships_of_new_nodes(self.change.mesh, self.shared)

    def _splice_nodes(self, splice: Splice) -> None:
        change, contents = self.change, self.contents
        gone = set(change.gone_nodes.tolist())
        moved = dict(zip(change.node_ids[change.moved].tolist(), change.moved, strict=True))
        for grid in contents.grids if gone or moved else ():
            node = int(grid.field(0))
            if node in gone:
                splice.drop(grid.lines)
            elif node in moved:
                text = _moved_grid(contents, grid, change.mesh.points[moved[node]])
                splice.replace(grid.lines, text)
        splice.insert_after(contents.grids[-1].lines[-1], self._new_grids())

    def _new_grids(self) -> list[str]:
        change, systems = self.change, self.contents.systems
        region_at = np.zeros(len(change.mesh.points), np.int64)
        rows, sides = np.nonzero(change.mesh.elements >= 0)
        region_at[change.mesh.elements[rows, sides]] = change.mesh.region[rows]
        text: list[str] = []
        for row in change.new_nodes.tolist():
            system = self.systems[region_at[row]]
            frame = systems.frame(system, self.contents.grids[0])
            place = frame.from_basic(change.mesh.points[[row]])[0]
            # a blank would be read as the system of GRDSET
            named = str(system) if system or systems.default else ""
            text += nodes.new_grid(
                int(change.node_ids[row]),
                [named, *map(real_field, place.tolist())],
                self._memberships.get(row, frozenset()),
                self.contents.grdset,
            )
        return text

    def _splice_shells(self, splice: Splice) -> None:
        change, shells = self.change, self.contents.shells
        ids = change.element_ids
        gone = set(change.gone_elements.tolist())
        turned = [row for row in self.angles if change.mesh.element_ids[row] != NEW]
        changed = {int(ids[row]): int(row) for row in (*change.rewired, *turned)}
        for card in shells if gone or changed else ():
            element = int(card.field(0))
            if element in gone:
                splice.drop(card.lines)
            elif element in changed:
                splice.replace(card.lines, self._shell(attributes(card), changed[element]))
        rows: list[str] = []
        for row in change.new_elements.tolist():
            rows += self._shell(self.regions[change.mesh.region[row]], row)
        splice.insert_after(shells[-1].lines[-1], rows)

    def _shell(self, item: Attributes, row: int) -> list[str]:
        corners = _nodes(self.change.corners[row])
        return item.turned(self.angles.get(row)).lines(int(self.change.element_ids[row]), corners)

    def _splice_pressures(self, splice: Splice) -> None:
        change, cards = self.change, self.contents.pressures
        gone = set(change.gone_elements.tolist())
        # shells whose part of a field is another one are taken out of their cards and named anew
        out: defaultdict[Layer, set[int]] = defaultdict(lambda: set(gone))
        joining: defaultdict[Pressure, list[int]] = defaultdict(list)
        for row, loads in self.pressures.items():
            for load in loads:
                out[load.layer].add(int(change.element_ids[row]))
                joining[load].append(int(change.element_ids[row]))
        ranges = [card for card in cards if isinstance(card.elements, range)]
        for row in change.new_elements.tolist():
            element = int(change.element_ids[row])
            for load in self.regions[change.mesh.region[row]].pressures:
                if not any(element in c.elements and c.pressure.key == load.key for c in ranges):
                    joining[load].append(element)
        last: dict[tuple[str, ...], int] = {}
        of_many: set[Layer] = set()
        for card in cards:
            layer = card.pressure.layer
            last[layer] = last[card.pressure.key] = card.lines[-1]
            left_out = _common(card.elements, out[layer])
            if len(card.elements) > 1:
                of_many.add(layer)
            if left_out:
                splice.replace(card.lines, card.left(left_out))
        for load, elements in joining.items():
            groups = [sorted(elements)] if load.layer in of_many else [[e] for e in elements]
            rows = [line for group in groups for line in load.lines(group)]
            splice.insert_after(last.get(load.key, last[load.layer]), rows)


def _common(elements: Sequence[int], others: set[int]) -> list[int]:
    """Ids that are in both; a range may be much longer than a set."""
    if len(elements) > len(others):
        return [element for element in others if element in elements]
    return [element for element in elements if element in others]


def _moved_grid(contents: Contents, grid: Card, point: Floats) -> list[str]:
    systems = contents.systems
    local = systems.frame(systems.system_of(grid), grid).from_basic(point[None])[0]
    tail = [grid.field(i) for i in range(5, len(grid.fields))]
    fields = [grid.field(0), grid.field(1), *map(real_field, local.tolist()), *tail]
    return card_lines("GRID", fields, grid.form)


def _nodes(corners: Ids) -> list[int]:
    return [int(node) for node in corners if node]
