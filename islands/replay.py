"""Replay: perform a saved procedure, on its own mesh bit for bit or on another one."""

from __future__ import annotations

from pathlib import Path

from islands.procedure import Procedure, perform
from islands.transfer import transfer
from meshops.errors import InputError
from meshops.formats import Deck, read_deck
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from meshops.quality import median_edge
from meshops.quality_index import quality_index
from meshops.workpiece import Setting


def replay_file(procedure_file: Path, source: Path, out: Path) -> str:
    """Perform the procedure of a file on the mesh of another and write the result.

    On the mesh that it was found on the very same mesh comes out as then; on another one it does
    what it can, without any search.

    Returns a sentence for the user. Raises InputError where the procedure does not fit, or where
    another mesh came out than when it was found.
    """
    procedure = read_procedure(procedure_file)
    deck = read_deck(source)
    deck.check_room()
    if deck.mesh.digest != procedure.mesh:
        return _transfer(procedure, procedure_file, deck, source, out)
    setting = procedure.setting(deck.mesh)
    mesh = perform(deck.mesh, procedure.rounds, ALL_OPERATIONS, setting)
    if mesh.digest != procedure.result:
        raise InputError(
            f"The replay made another mesh than the run that found {procedure_file} "
            f"(digest {mesh.digest}, not {procedure.result}); use the versions of meshipelago and "
            "pymeshlab that the run used."
        )
    deck.write(mesh, out)
    return f"{out}: the mesh of the run, bit for bit (digest {mesh.digest})."


def read_procedure(file: Path) -> Procedure:
    """Read a procedure; InputError where the file has none."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file} cannot be read: {error}.") from None
    return Procedure.from_json(text, ALL_OPERATIONS, str(file))


def _transfer(
    procedure: Procedure, procedure_file: Path, deck: Deck, source: Path, out: Path
) -> str:
    setting = procedure.setting(deck.mesh, procedure.element_size or median_edge(deck.mesh))
    try:
        mesh, _ = transfer(procedure, deck.mesh, ALL_OPERATIONS, setting)
    except InputError as error:
        raise InputError(
            f"{procedure_file} was found on another mesh than {source}: {error}"
        ) from None
    deck.write(mesh, out)
    return (
        f"{out}: {procedure_file} was found on another mesh; on this one it brought, without any "
        f"search, {_faults(deck.mesh, setting)} -> {_faults(mesh, setting)}."
    )


def _faults(mesh: ShellMesh, setting: Setting) -> str:
    report = quality_index(setting.at_even_size(mesh), setting.scoring)
    return f"{report.failed} failed elements and {report.trias} trias"
