"""Which suffix means which format."""

from __future__ import annotations

import os
from pathlib import Path

from meshops.errors import InputError

NASTRAN = (".bdf", ".dat", ".nas", ".blk", ".fem")
ABAQUS = (".inp",)
INTERCHANGE = (".vtu", ".msh", ".stl", ".obj", ".off")
KNOWN = (*(suffix for suffix in NASTRAN + ABAQUS + INTERCHANGE if suffix != ".fem"), ".fem")


def check_suffix(path: Path) -> None:
    """Raise InputError where the suffix of ``path``, in capitals or not, is of no known format."""
    if path.suffix.lower() not in KNOWN:
        suffix = f"the suffix '{path.suffix}'" if path.suffix else "no suffix"
        raise InputError(f"{path} has {suffix}: use one of {' '.join(KNOWN)}.")


def check_writable_suffix(path: Path) -> None:
    """Raise InputError where a mesh cannot be written to ``path``, to be called early.

    That is where the suffix is of no known format, the path is a folder, its folder is a file or
    may not be written to.
    """
    check_suffix(path)
    if path.is_dir():
        raise InputError(f"{path} is a folder: name a file to write to.")
    if path.parent.exists() and not path.parent.is_dir():
        raise InputError(f"{path.parent} is not a folder: choose another place to write to.")
    there = next(folder for folder in path.absolute().parents if folder.exists())
    if not os.access(there, os.W_OK):
        raise InputError(f"{there} may not be written to: choose another place.")
