"""Splicing an edited mesh into the lines of its Nastran deck."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from meshops.formats.difference import Difference
from meshops.formats.fortran import real_field
from meshops.formats.nastran_cards import Card, Form, card_lines
from meshops.formats.nastran_contents import Contents
from meshops.formats.nastran_shells import Attributes, attributes
from meshops.formats.splice import Splice
from meshops.mesh import NEW, Floats, Ids, ShellMesh


@dataclass(frozen=True, eq=False)
class Update:
    """An edited mesh and what it changes.

    Attributes
    ----------
    mesh : ShellMesh
    change : Difference
    regions : sequence of Attributes
        What new elements of each region take over.
    angles : mapping of int to float
        Another THETA for some rows of the mesh, in degrees.
    """

    mesh: ShellMesh
    change: Difference
    regions: Sequence[Attributes]
    angles: Mapping[int, float]

    def splice(self, splice: Splice, contents: Contents) -> None:
        """Change the lines of the deck that have to differ."""
        self._splice_nodes(splice, contents)
        self._splice_shells(splice, contents)
        self._splice_pressures(splice, contents)

    def _splice_nodes(self, splice: Splice, contents: Contents) -> None:
        change = self.change
        gone = set(change.gone_nodes.tolist())
        moved = dict(zip(change.node_ids[change.moved].tolist(), change.moved, strict=True))
        for grid in contents.grids if gone or moved else ():
            node = int(grid.field(0))
            if node in gone:
                splice.drop(grid.lines)
            elif node in moved:
                text = _moved_grid(contents, grid, self.mesh.points[moved[node]])
                splice.replace(grid.lines, text)
        splice.insert_after(contents.grids[-1].lines[-1], self._new_grids(contents))

    def _new_grids(self, contents: Contents) -> list[str]:
        change, systems = self.change, contents.systems
        # in the system of GRDSET, since a blank CP would be read as that one
        frame = systems.frame(systems.default, contents.grids[0])
        system = str(systems.default) if systems.default else ""
        local = frame.from_basic(self.mesh.points[change.new_nodes])
        rows: list[str] = []
        ids = change.node_ids[change.new_nodes]
        for node, point in zip(ids.tolist(), local.tolist(), strict=True):
            fields = [str(node), system, *map(real_field, point)]
            rows += card_lines("GRID", fields, Form(wide=True))
        return rows

    def _splice_shells(self, splice: Splice, contents: Contents) -> None:
        ids = self.change.element_ids
        gone = set(self.change.gone_elements.tolist())
        turned = [row for row in self.angles if self.mesh.element_ids[row] != NEW]
        changed = {int(ids[row]): int(row) for row in (*self.change.rewired, *turned)}
        for card in contents.shells if gone or changed else ():
            element = int(card.field(0))
            if element in gone:
                splice.drop(card.lines)
            elif element in changed:
                splice.replace(card.lines, self._shell(attributes(card), changed[element]))
        rows: list[str] = []
        for row in self.change.new_elements.tolist():
            rows += self._shell(self.regions[self.mesh.region[row]], row)
        splice.insert_after(contents.shells[-1].lines[-1], rows)

    def _shell(self, item: Attributes, row: int) -> list[str]:
        nodes = _nodes(self.change.corners[row])
        return item.turned(self.angles.get(row)).lines(int(self.change.element_ids[row]), nodes)

    def _splice_pressures(self, splice: Splice, contents: Contents) -> None:
        gone = set(self.change.gone_elements.tolist())
        last: dict[tuple[str, ...], int] = {}
        for load in contents.pressures:
            last[load.pressure.key] = load.lines[-1]
            left = [element for element in load.elements if element not in gone]
            if len(left) < len(load.elements):
                splice.replace(load.lines, load.pressure.lines(left))
        rows: defaultdict[tuple[str, ...], list[str]] = defaultdict(list)
        for row in self.change.new_elements.tolist():
            for pressure in self.regions[self.mesh.region[row]].pressures:
                rows[pressure.key] += pressure.lines([int(self.change.element_ids[row])])
        for key, text in rows.items():
            splice.insert_after(last[key], text)


def _moved_grid(contents: Contents, grid: Card, point: Floats) -> list[str]:
    systems = contents.systems
    local = systems.frame(systems.system_of(grid), grid).from_basic(point[None])[0]
    tail = [grid.field(i) for i in range(5, len(grid.fields))]
    fields = [grid.field(0), grid.field(1), *map(real_field, local.tolist()), *tail]
    return card_lines("GRID", fields, grid.form)


def _nodes(corners: Ids) -> list[int]:
    return [int(node) for node in corners if node]
