"""Files that appear whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from pathlib import Path

from meshops.errors import InputError


def write_whole(path: Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a temporary file in the folder of ``path``, then rename it.

    Raises
    ------
    InputError
        Where the folder cannot be made or the file cannot be written there.
    """
    temporary = _temporary(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(temporary)
        temporary.replace(path)
    except OSError as error:
        raise _cannot_write(path, error) from error
    finally:
        temporary.unlink(missing_ok=True)


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write several files that belong together: all temporaries first, then all renames.

    Raises
    ------
    InputError
        Where a folder cannot be made or a file cannot be written.
    """
    temporaries = {path: _temporary(path) for path in contents}
    path = next(iter(contents))
    try:
        for path, data in contents.items():
            path.parent.mkdir(parents=True, exist_ok=True)
            temporaries[path].write_bytes(data)
        for path, temporary in temporaries.items():
            temporary.replace(path)
    except OSError as error:
        raise _cannot_write(path, error) from error
    finally:
        for temporary in temporaries.values():
            temporary.unlink(missing_ok=True)


def refuse_to_overwrite(path: Path, sources: list[Path]) -> None:
    """Raise InputError where ``path`` is one of the files that the mesh was read from."""
    if path.resolve() in {source.resolve() for source in sources}:
        raise InputError(f"{path} is a file of the deck itself: choose another name to write to.")


def _temporary(path: Path) -> Path:
    if not path.parent.is_dir() and path.parent.exists():
        raise InputError(f"{path.parent} is not a folder: choose another place to write to.")
    return path.with_name(f".{path.name}.{os.getpid()}.tmp")


def _cannot_write(path: Path, error: OSError) -> InputError:
    return InputError(f"{path} cannot be written: {error.strerror or error}.")
