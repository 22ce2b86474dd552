"""Procedure: operations in order, each with the parameters that its GA found."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from islands.assessing import assessment_of
from meshops.assessment import EVEN
from meshops.criteria import Criteria
from meshops.criteria_files import dump_criteria, parse_toml
from meshops.edit import apply
from meshops.errors import InputError
from meshops.fitness import Fitness
from meshops.guard import guarded, guarded_edits
from meshops.mesh import Floats, Ints, ShellMesh
from meshops.operations import NOTHING, Operation
from meshops.reference import Reference
from meshops.sizing import local_growth
from meshops.subdomain import Aim, Extent, Subdomain, subdomains
from meshops.surface import PatchSurface
from meshops.workpiece import Setting, Workpiece

FORMAT = "meshipelago procedure 4"


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

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Own the array: a step is kept for long, and not all of the message that it came with."""
        self.__dict__.update(state, parameters=state["parameters"].copy())


@dataclass(frozen=True, eq=False)
class Place:
    """What was done in one place.

    Attributes
    ----------
    centre : three floats
        Of the subdomain, or of the whole mesh.
    steps : tuple of Step
    """

    centre: tuple[float, float, float]
    steps: tuple[Step, ...]


@dataclass(frozen=True, eq=False)
class Round:
    """Places that are worked on at the same time, each a subdomain of its own.

    Attributes
    ----------
    extent : Extent or None
        Of the subdomains; None: the one place is the whole mesh.
    turn : int
        Which round of its run it was.
    places : tuple of Place
        In the order of the subdomains.
    aim : "faults", "flow" or "tidy"
        What the subdomains were cut out for.
    keeps_neutral : bool
        Whether changes that gain nothing were kept too.
    """

    extent: Extent | None
    turn: int
    places: tuple[Place, ...]
    aim: Aim = "faults"
    keeps_neutral: bool = False


@dataclass(frozen=True, eq=False)
class Procedure:
    """What the paper's Figure 10 shows, with all that it takes to do it again.

    Attributes
    ----------
    rounds : tuple of Round
    mesh : str
        Digest of the mesh that the procedure was found on.
    result : str
        Digest of the mesh that it made of it.
    box : (2, 3) float64
        The lowest and the highest corner of the box around the mesh.
    criteria : Criteria
    size : float
        Under which elements failed, which says where places are.
    element_size : float or None
    size_field : str or None
        ``local``, or a file of sizes; None: lengths were judged by one size.
    feature_angle : float
    slides : bool
        The setting under which its operations ran.
    seed : int
        Seed of the run that found it.
    only : str or None
        What of the deck was to be repaired, in the user's words; None: all of it.
    """

    rounds: tuple[Round, ...]
    mesh: str
    result: str
    box: Floats
    criteria: Criteria
    size: float
    element_size: float | None
    size_field: str | None
    feature_angle: float
    slides: bool
    seed: int
    only: str | None = None

    def setting(self, mesh: ShellMesh, size: float | None = None) -> Setting:
        """Return the setting under which it is performed on a mesh.

        `size` is what lengths are judged by on another mesh than its own.
        """
        sizes = self.element_size or self.size_field or EVEN
        return Setting.of(
            mesh,
            assessment_of(mesh, self.criteria, sizes, judged_size=size or self.size),
            Fitness("quality", len(mesh.elements)),
            element_size=self.element_size,
            feature_angle=self.feature_angle,
            slides=self.slides,
        )

    @property
    def is_whole(self) -> bool:
        """Whether it is of a whole mesh, as the paper's."""
        return is_whole(self.rounds)

    def text(self, operations: tuple[Operation, ...]) -> str:
        """Figure 10: a line a gene, the code and the parameters; a dash where nothing is done.

        Where there is more than one place, a line before each says which round and where.
        """
        parts = []
        for number, done in enumerate(self.rounds, 1):
            for place in done.places:
                if done.extent is not None:
                    if not place.steps:
                        continue
                    where = ", ".join(f"{x:.6g}" for x in place.centre)
                    parts.append(f"# round {number}, {done.extent.rings} rings around {where}")
                parts.append(steps_text(place.steps, operations))
        return "\n".join(parts)

    def to_json(self, operations: tuple[Operation, ...]) -> str:
        """Write as JSON."""
        document = {
            "format": FORMAT,
            "mesh": self.mesh,
            "result": self.result,
            "box": self.box.tolist(),
            "criteria": dump_criteria(self.criteria),
            "size": self.size,
            "element_size": self.element_size,
            "size_field": self.size_field,
            "feature_angle": self.feature_angle,
            "slides": self.slides,
            "seed": self.seed,
            "only": self.only,
            "rounds": [round_document(done, operations) for done in self.rounds],
        }
        return json.dumps(document) + "\n"

    @classmethod
    def from_json(cls, text: str, operations: tuple[Operation, ...], source: str) -> Procedure:
        """Read what `to_json` wrote; `source` names the file in messages.

        Raises InputError where the text is no such document.
        """
        try:
            document = json.loads(text)
            if document["format"] != FORMAT:
                raise InputError(
                    f"{source} is of the format {document['format']!r}, not {FORMAT!r}."
                )
            size = document["element_size"]
            box = np.array(document["box"], np.float64)
            if box.shape != (2, 3):
                raise ValueError("box must be two corners")
            return cls(
                rounds=tuple(read_round(item, operations) for item in document["rounds"]),
                mesh=str(document["mesh"]),
                result=str(document["result"]),
                box=box,
                criteria=_read_criteria(document["criteria"], source),
                size=float(document["size"]),
                element_size=None if size is None else float(size),
                size_field=document["size_field"],
                feature_angle=float(document["feature_angle"]),
                slides=bool(document["slides"]),
                seed=int(document["seed"]),
                only=document.get("only"),
            )
        except (ValueError, KeyError, TypeError, OverflowError) as error:
            raise InputError(
                f"{source} is not a procedure ({type(error).__name__}: {error}); "
                "give the procedure.json that an optimize run wrote."
            ) from None


def _read_criteria(text: str, source: str) -> Criteria:
    try:
        return parse_toml(text, source)
    except InputError as error:
        raise InputError(f"{source}: {error}.") from None


def round_document(done: Round, operations: tuple[Operation, ...]) -> dict[str, Any]:
    """Make what JSON holds of a round; operations go by their names."""
    names = {operation.code: operation.name for operation in operations} | {NOTHING: "nothing"}
    return {
        "extent": None if done.extent is None else [done.extent.rings, done.extent.elements],
        "turn": done.turn,
        "aim": done.aim,
        "keeps_neutral": done.keeps_neutral,
        "places": [
            {
                "centre": place.centre,
                "steps": [
                    {"operation": names[step.code], "parameters": step.parameters.tolist()}
                    for step in place.steps
                ],
            }
            for place in done.places
        ],
    }


def read_round(item: dict[str, Any], operations: tuple[Operation, ...]) -> Round:
    """Read what `round_document` made.

    Raises ValueError, KeyError, TypeError or OverflowError where it is something else.
    """
    codes = {operation.name: operation.code for operation in operations} | {"nothing": NOTHING}
    extent = None
    if item["extent"] is not None:
        rings, elements = item["extent"]
        extent = Extent(int(rings), int(elements))
        if extent.rings < 0 or extent.elements < 1:
            raise ValueError("an extent must be rings and elements")
    if item["aim"] not in get_args(Aim):
        raise ValueError(f"a round has no aim {item['aim']!r}")
    places = tuple(_read_place(place, codes) for place in item["places"])
    return Round(extent, int(item["turn"]), places, item["aim"], bool(item["keeps_neutral"]))


def _read_place(place: dict[str, Any], codes: dict[str, int]) -> Place:
    x, y, z = place["centre"]
    return Place(
        (float(x), float(y), float(z)),
        tuple(_read_step(step, codes) for step in place["steps"]),
    )


def _read_step(step: dict[str, Any], codes: dict[str, int]) -> Step:
    rows = np.array(step["parameters"], np.int32)
    if rows.size and rows.ndim != 2:
        raise ValueError("parameters must be rows of numbers")
    return Step(codes[step["operation"]], rows if rows.size else np.zeros((0, 2), np.int32))


def steps_text(steps: tuple[Step, ...], operations: tuple[Operation, ...]) -> str:
    """Write steps in the notation of Figure 10; those that the paper has no code for by name."""
    by_code = {operation.code: operation for operation in operations}
    lines = []
    for step in steps:
        name = str(step.code) if step.code <= NOTHING else by_code[step.code].name
        done = by_code[step.code].format(step.parameters) if len(step.parameters) else "-"
        lines.append(f"{name} {done}")
    return "\n".join(lines)


def perform(
    mesh: ShellMesh,
    rounds: tuple[Round, ...],
    operations: tuple[Operation, ...],
    setting: Setting,
    reference: Reference | None = None,
) -> ShellMesh:
    """Perform rounds on the mesh that they were found on, and guard what they make of it.

    `reference` is what nodes must stay on where that is another mesh. Raises InputError where a
    step names what the mesh does not have.
    """
    after = perform_rounds(mesh, rounds, operations, setting, reference)
    if is_whole(rounds):
        return after
    return guarded(Workpiece(mesh, setting), after, all_aims(rounds))


def is_whole(rounds: tuple[Round, ...]) -> bool:
    """Whether rounds are of a whole mesh, as the paper's, whose GA knows no guard."""
    return any(done.extent is None for done in rounds)


def all_aims(rounds: tuple[Round, ...]) -> Aim:
    """Return what all rounds together aim at.

    What tidies removes irregular nodes that other rounds have brought, which is no gain over all.
    """
    return "flow" if any(done.aim == "flow" for done in rounds) else "faults"


def perform_rounds(
    mesh: ShellMesh,
    rounds: tuple[Round, ...],
    operations: tuple[Operation, ...],
    setting: Setting,
    reference: Reference | None = None,
) -> ShellMesh:
    """Perform rounds; each of their places is guarded by itself. See `perform`."""
    reference = reference or Reference(mesh, setting.feature_angle)
    origin = Workpiece(mesh, setting)
    for done in rounds:
        if done.extent is None:
            mesh = perform_steps(mesh, done.places[0].steps, operations, setting)
            continue
        start = Workpiece(mesh, setting)
        found = subdomains(start, done.extent, done.turn, done.aim)
        edits = []
        for subdomain, place in zip(found, done.places, strict=False):
            if place.steps:
                own = subdomain_setting(setting, subdomain)
                surface = reference.around(subdomain.patch)
                after = perform_steps(subdomain.mesh, place.steps, operations, own, surface)
                root = Workpiece(subdomain.mesh, own, surface)
                after = guarded(root, after, done.aim, neutral=done.keeps_neutral)
                edits.append(subdomain.edit(mesh, after))
        mesh = guarded_edits(start, edits, done.aim, origin=origin, neutral=done.keeps_neutral)
    return mesh


def subdomain_setting(setting: Setting, subdomain: Subdomain) -> Setting:
    """Return the setting of a run for one subdomain.

    Its fitness counts its own elements, and its lengths are judged by a size that grows evenly, as
    near to the size field as can be.
    """
    elements = len(subdomain.mesh.elements)
    fitness = replace(setting.fitness, elements=elements)
    own = replace(setting, fitness=fitness, outside=subdomain.outside, rows=None, areas=None)
    if setting.sizes is None:
        return own
    size, growth = local_growth(setting.sizes, subdomain.mesh.points)
    scoring = replace(setting.scoring, size=size, growth=growth)
    wanted = None if setting.keeps_sizes else size
    return replace(own, scoring=scoring, element_size=wanted, sizes=None)


def perform_steps(
    mesh: ShellMesh,
    steps: tuple[Step, ...],
    operations: tuple[Operation, ...],
    setting: Setting,
    reference: PatchSurface | None = None,
) -> ShellMesh:
    """Perform steps on a mesh or a subdomain.

    Raises InputError where a step names what the mesh does not have.
    """
    by_code = {operation.code: operation for operation in operations}
    for number, step in enumerate(steps, 1):
        if not len(step.parameters):
            continue
        operation = by_code[step.code]
        workpiece = Workpiece(mesh, setting, reference)
        try:
            mesh = apply(mesh, operation.apply(workpiece, step.parameters))
        except ValueError as error:
            raise InputError(
                f"Step {number} ({operation.name}) does not fit this mesh: {error}; "
                "replay a procedure on the mesh that it was found on."
            ) from None
    return mesh
