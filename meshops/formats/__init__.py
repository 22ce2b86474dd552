"""Reading and writing meshes: one file a format.

A deck (Nastran, Abaqus) is spliced: every line that an edit does not touch stays byte for byte. In
an interchange file (.vtu .msh .stl .obj .off) only points and cells that an edit touches change,
and all else that it holds is carried over.
"""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from meshops.errors import InputError
from meshops.formats.fresh import write_mesh
from meshops.formats.locks import Lock
from meshops.formats.suffixes import ABAQUS, KNOWN, NASTRAN, check_suffix, check_writable_suffix
from meshops.mesh import Bools, ShellMesh

__all__ = ["KNOWN", "Deck", "Lock", "check_writable_suffix", "read_deck", "write_mesh"]


class Deck(Protocol):
    """What a file holds: its shells as a mesh, and how to write them back."""

    @property
    def mesh(self) -> ShellMesh:
        """The linear shells of the file."""

    @property
    def locks(self) -> tuple[Lock, ...]:
        """What of the mesh is locked, and by which cards."""

    @property
    def notes(self) -> tuple[str, ...]:
        """What a reader of the file should know besides, a sentence each."""

    @property
    def files(self) -> tuple[Path, ...]:
        """The files that it was read from, the one that was named first."""

    def check_room(self) -> None:
        """Raise InputError where there are not enough ids left for what a run may make anew."""

    def region_name(self, region: int) -> str:
        """Return what the file calls a region of the mesh: its property or its sets."""

    def select(self, text: str) -> Bools:
        """Return which elements a user names, (M,) bool: a property, a set, a region or ids.

        Raises InputError where that is nothing of the mesh.
        """

    def numbered(self, mesh: ShellMesh) -> ShellMesh | None:
        """Give a mesh that descends from ``self.mesh`` the ids that ``write`` gives it.

        None where ids are places in the file, which are known once it is written.
        """

    def write(self, mesh: ShellMesh, path: Path) -> tuple[Path, ...]:
        """Write the file with ``mesh``, which descends from ``self.mesh``, in their place.

        A suffix of another format makes a whole new file by ``write_mesh``. Returns the files that
        were written, ``path`` first.
        """


def read_deck(path: Path, *, regions: str | None = None) -> Deck:
    """Read a file in the format that its suffix tells, in capitals or not.

    Parameters
    ----------
    path : Path
    regions : str, optional
        Name of the array of the cells of a .vtu file that tells the regions.

    Raises
    ------
    InputError
        Where the file is missing, a folder, unreadable or of no known format, its mesh cannot be
        used, or regions are named for a format without such arrays.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder: name the mesh file in it.")
    check_suffix(path)
    suffix = path.suffix.lower()
    if regions is not None and suffix != ".vtu":
        raise InputError(f"{path.name}: only cell arrays of a .vtu file are named as regions.")
    if suffix in NASTRAN:
        from meshops.formats.nastran import read_nastran

        return read_nastran(path)
    if suffix in ABAQUS:
        from meshops.formats.abaqus import read_abaqus

        return read_abaqus(path)
    if suffix == ".vtu":
        from meshops.formats.vtu import read_vtu

        return read_vtu(path, regions)
    if suffix == ".msh":
        from meshops.formats.gmsh import read_gmsh

        return read_gmsh(path)
    if suffix == ".stl":
        from meshops.formats.stl import read_stl

        return read_stl(path)
    if suffix == ".obj":
        from meshops.formats.obj import read_obj

        return read_obj(path)
    from meshops.formats.off import read_off

    return read_off(path)
