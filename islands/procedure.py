"""Procedure: operations in order, each with the parameters that its GA found."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

import numpy as np

from meshops.edit import apply
from meshops.errors import InputError
from meshops.mesh import Ints, ShellMesh
from meshops.operations import NOTHING, Operation
from meshops.workpiece import Setting, Workpiece

FORMAT = "meshipelago procedure 1"


@dataclass(frozen=True, eq=False)
class Step:
    """One gene of the integration GA with what its operation GA found.

    Attributes
    ----------
    code : int
        The operation's code, or ``NOTHING``.
    parameters : (K, C) int32
        Without rows where the mesh stayed as it was.
    """

    code: int
    parameters: Ints


@dataclass(frozen=True, eq=False)
class Procedure:
    """What the paper's Figure 10 shows, with all that it takes to do it again.

    Attributes
    ----------
    steps : tuple of Step
    mesh : str
        Digest of the mesh that the procedure was found on.
    result : str
        Digest of the mesh that it made of it.
    element_size : float or None
    feature_angle : float
        The setting under which its operations ran.
    seed : int
        Seed of the run that found it.
    """

    steps: tuple[Step, ...]
    mesh: str
    result: str
    element_size: float | None
    feature_angle: float
    seed: int

    def text(self, operations: tuple[Operation, ...]) -> str:
        """Figure 10: a line a gene, the code and the parameters; a dash where nothing is done."""
        return steps_text(self.steps, operations)

    def to_json(self, operations: tuple[Operation, ...]) -> str:
        """Write as JSON."""
        names = {operation.code: operation.name for operation in operations} | {NOTHING: "nothing"}
        steps = [
            {"operation": names[step.code], "parameters": step.parameters.tolist()}
            for step in self.steps
        ]
        document = {
            "format": FORMAT,
            "mesh": self.mesh,
            "result": self.result,
            "element_size": self.element_size,
            "feature_angle": self.feature_angle,
            "seed": self.seed,
            "steps": steps,
        }
        return json.dumps(document, indent=1) + "\n"

    @classmethod
    def from_json(cls, text: str, operations: tuple[Operation, ...], source: str) -> Procedure:
        """Read what `to_json` wrote; `source` names the file in messages.

        Raises InputError where the text is no such document.
        """
        codes = {operation.name: operation.code for operation in operations} | {"nothing": NOTHING}
        try:
            document = json.loads(text)
            if document["format"] != FORMAT:
                raise InputError(
                    f"{source} is of the format {document['format']!r}, not {FORMAT!r}."
                )
            size = document["element_size"]
            return cls(
                steps=tuple(_read_step(step, codes) for step in document["steps"]),
                mesh=str(document["mesh"]),
                result=str(document["result"]),
                element_size=None if size is None else float(size),
                feature_angle=float(document["feature_angle"]),
                seed=int(document["seed"]),
            )
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(
                f"{source} is not a procedure ({type(error).__name__}: {error}); "
                "give the procedure.json that an optimize run wrote."
            ) from None


def _read_step(step: dict[str, Any], codes: dict[str, int]) -> Step:
    rows = np.array(step["parameters"], np.int32)
    if rows.size and rows.ndim != 2:
        raise ValueError("parameters must be rows of numbers")
    return Step(codes[step["operation"]], rows if rows.size else np.zeros((0, 2), np.int32))


def steps_text(steps: tuple[Step, ...], operations: tuple[Operation, ...]) -> str:
    """Write steps in the notation of Figure 10."""
    by_code = {operation.code: operation for operation in operations}
    lines = []
    for step in steps:
        done = by_code[step.code].format(step.parameters) if len(step.parameters) else "-"
        lines.append(f"{step.code} {done}")
    return "\n".join(lines)


def perform(
    mesh: ShellMesh,
    steps: tuple[Step, ...],
    operations: tuple[Operation, ...],
    setting: Setting,
) -> ShellMesh:
    """Perform steps on a mesh.

    Raises InputError where a step names elements or nodes that the mesh does not have.
    """
    by_code = {operation.code: operation for operation in operations}
    for number, step in enumerate(steps, 1):
        if not len(step.parameters):
            continue
        operation = by_code[step.code]
        try:
            mesh = apply(mesh, operation.apply(Workpiece(mesh, setting), step.parameters))
        except ValueError as error:
            raise InputError(
                f"Step {number} ({operation.name}) does not fit this mesh: {error}; "
                "replay a procedure on the mesh that it was found on."
            ) from None
    return mesh
