"""What files have in common whose nodes and cells go by their places, or by tags of their own."""

from __future__ import annotations

from pathlib import Path

from meshops.formats.grid import Shells
from meshops.formats.selection import by_label, select
from meshops.mesh import Bools, ShellMesh


class OneFile:
    """A file of its own: nothing else belongs to it, and its regions have numbers."""

    source: Path
    shells: Shells

    @property
    def files(self) -> tuple[Path, ...]:
        """The one file."""
        return (self.source,)

    def region_name(self, region: int) -> str:
        """Return the name of a region of the mesh: `REGION n`."""
        return f"REGION {region}"

    def select(self, text: str) -> Bools:
        """Return which elements a user names, (M,) bool: `REGION n` or ids.

        Raises InputError where that is nothing of the mesh.
        """
        mesh = self.shells.mesh
        return select(mesh, text, by_label([self.region_name(r) for r in mesh.region.tolist()]))

    def numbered(self, mesh: ShellMesh) -> None:
        """Return nothing: a place in the file is an id, and known once the file is written."""
