"""Replay: perform a saved procedure and see that the very same mesh comes out."""

from __future__ import annotations

from pathlib import Path

from islands.procedure import Procedure, perform
from meshops.criteria import STANDARD
from meshops.errors import InputError
from meshops.fitness import Fitness
from meshops.formats import read_deck
from meshops.operations import OPERATIONS
from meshops.quality import median_edge
from meshops.workpiece import Setting


def replay_file(procedure_file: Path, source: Path, out: Path) -> str:
    """Perform the procedure of a file on the mesh of another and write the result.

    Returns a sentence for the user. Raises InputError where the procedure was found on another
    mesh, or where another mesh came out than when it was found.
    """
    try:
        text = procedure_file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{procedure_file} cannot be read: {error}.") from None
    procedure = Procedure.from_json(text, OPERATIONS, str(procedure_file))
    deck = read_deck(source)
    if deck.mesh.digest != procedure.mesh:
        raise InputError(
            f"{procedure_file} was found on another mesh than {source}; its element and node "
            "numbers mean nothing there. Give the deck that the run was started with."
        )
    setting = Setting(
        scoring=STANDARD.at(median_edge(deck.mesh)),  # says which edits are valid, not which good
        fitness=Fitness("quality", len(deck.mesh.elements)),
        element_size=procedure.element_size,
        feature_angle=procedure.feature_angle,
    )
    mesh = perform(deck.mesh, procedure.steps, OPERATIONS, setting)
    if mesh.digest != procedure.result:
        raise InputError(
            f"The replay made another mesh than the run that found {procedure_file} "
            f"(digest {mesh.digest}, not {procedure.result}); use the versions of meshipelago and "
            "pymeshlab that the run used."
        )
    deck.write(mesh, out)
    return f"{out}: the mesh of the run, bit for bit (digest {mesh.digest})."
