"""Reading and writing meshes: one file a format.

A deck (Nastran, Abaqus) is spliced: every line that an edit does not touch stays byte for byte. An
interchange file (.vtu .msh .stl .obj .off) is written anew.
"""

from __future__ import annotations

from pathlib import Path
from typing import Protocol

from meshops.errors import InputError
from meshops.formats.fresh import write_mesh
from meshops.formats.locks import Lock
from meshops.formats.suffixes import ABAQUS, KNOWN, NASTRAN, check_suffix, check_writable_suffix
from meshops.mesh import ShellMesh

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

    def check_room(self) -> None:
        """Raise InputError, before a search, where ids for what is new would run out."""

    def write(self, mesh: ShellMesh, path: Path) -> None:
        """Write the file with ``mesh``, which descends from ``self.mesh``, in their place.

        A suffix of another format makes a whole new file by ``write_mesh``.
        """


def read_deck(path: Path) -> Deck:
    """Read a file in the format that its suffix tells, in capitals or not.

    Raises
    ------
    InputError
        Where the file is missing, a folder, unreadable or of no known format, or its mesh cannot be
        used.
    """
    if path.is_dir():
        raise InputError(f"{path} is a folder: name the mesh file in it.")
    check_suffix(path)
    suffix = path.suffix.lower()
    if suffix in NASTRAN:
        from meshops.formats.nastran import read_nastran

        return read_nastran(path)
    if suffix in ABAQUS:
        from meshops.formats.abaqus import read_abaqus

        return read_abaqus(path)
    from meshops.formats.interchange import read_interchange

    return read_interchange(path)
