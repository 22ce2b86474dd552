"""Replay: perform a saved procedure, on its own mesh bit for bit or on another one."""

from __future__ import annotations

from pathlib import Path

from islands.assessing import verifier
from islands.procedure import Procedure, all_aims, perform
from islands.transfer import transfer
from meshops.assessment import Assessment
from meshops.errors import InputError
from meshops.formats import Deck, read_deck
from meshops.formats.selection import locked_but
from meshops.formats.verified import nothing_else, write_verified
from meshops.guard import guarded
from meshops.mesh import ShellMesh
from meshops.operations import ALL_OPERATIONS
from meshops.quality import median_edge
from meshops.workpiece import Setting, Workpiece


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
    start = deck.mesh
    if procedure.only is not None:
        start = locked_but(start, deck.select(procedure.only))
    if start.digest != procedure.mesh:
        return _transfer(procedure, procedure_file, deck, start, source, out)
    setting = procedure.setting(start)
    mesh = perform(start, procedure.rounds, ALL_OPERATIONS, setting)
    if mesh.digest != procedure.result:
        raise InputError(
            f"The replay made another mesh than the run that found {procedure_file} "
            f"(digest {mesh.digest}, not {procedure.result}); use the versions of meshipelago and "
            "pymeshlab that the run used."
        )
    check = verifier(Assessment(setting.scoring, setting.sizes))
    write_verified(deck, mesh, out, nothing_else if procedure.is_whole else check)
    return f"{out}: the mesh of the run, bit for bit (digest {mesh.digest})."


def read_procedure(file: Path) -> Procedure:
    """Read a procedure; InputError where the file has none."""
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file} cannot be read: {error}.") from None
    return Procedure.from_json(text, ALL_OPERATIONS, str(file))


def _transfer(
    procedure: Procedure,
    procedure_file: Path,
    deck: Deck,
    start: ShellMesh,
    source: Path,
    out: Path,
) -> str:
    setting = procedure.setting(start, procedure.element_size or median_edge(start))
    try:
        mesh, rounds = transfer(procedure, start, ALL_OPERATIONS, setting)
        mesh = guarded(Workpiece(start, setting), mesh, all_aims(rounds))
    except InputError as error:
        raise InputError(
            f"{procedure_file} was found on another mesh than {source}: {error}"
        ) from None
    write_verified(deck, mesh, out, verifier(Assessment(setting.scoring, setting.sizes)))
    return (
        f"{out}: {procedure_file} was found on another mesh; on this one it brought, without any "
        f"search, {_faults(start, setting)} -> {_faults(mesh, setting)}."
    )


def _faults(mesh: ShellMesh, setting: Setting) -> str:
    report = Assessment(setting.scoring, setting.sizes).quality(mesh)
    return f"{report.failed} failed elements and {report.trias} trias"
