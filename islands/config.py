"""Config: every setting of a run, from a profile, a TOML file and the command line."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from islands.archipelago import Mode, Schedule
from islands.genetics import Breeding, Recombination, Scaling, Selection
from islands.island import IslandPlan, OwnFitness
from islands.migration import GivingWay, Leaving, Migration
from islands.search import Plan
from islands.stopping import Stopping
from islands.topology import Link, Topology, TopologyKind
from meshops.assessment import EVEN
from meshops.criteria import BUILT_IN
from meshops.errors import InputError
from meshops.fitness import IRREGULARITY, PRICE, FitnessKind
from meshops.operations import OPERATIONS, PAPER_OPERATIONS, Operation
from meshops.sizing import LOCAL
from meshops.subdomain import Extent

PROFILES: Mapping[str, Mapping[str, Any]] = {
    "default": {},
    "thorough": {
        "islands": 4,
        "population": 8,
        "generations": 4,
        "genes": 8,
        "operation-population": 8,
        "operation-generations": 3,
        "rounds": 200,
        "patience": 20,
        "flow": 40,
    },
    "paper": {
        "fitness": "trias",
        "criteria": "paper",
        "islands": 1,
        "population": 10,
        "generations": 10,
        "genes": 10,
        "crossover": 0.95,
        "mutation": 0.05,
        "operation-population": 10,
        "operation-generations": 10,
        "elites": 0,
        "scaling": "proportional",
    },
}
"""What a profile sets other than `Config` does: ``paper`` has the settings of section 4.1."""

ALONE: Mapping[str, Any] = {"islands": 1, "population": 100, "generations": 30}
"""What running one operation GA alone sets: the settings of section 4.1 for it."""


FREE = {"backend", "address", "workers", "mode", "time_limit", "evaluation_limit", "track"}
"""Settings that another run may have that ends with the same mesh: where, how long and in how many
processes it works, who waits for whom, and who is told of it. Just an evaluation limit that some
evaluations come near could make a difference."""

FILES = {"criteria", "size", "warm_start"}
"""Settings that may name a file, which may have moved: what is in it counts."""

FILE_KEYS = ("criteria", "size", "warm-start")
"""The keys of these in a TOML file, where a path is looked for beside that file first."""

_MODEL = ConfigDict(
    frozen=True,
    extra="forbid",
    alias_generator=lambda name: name.replace("_", "-"),
    allow_inf_nan=False,
)


MOST_ISLANDS = 10_000

OWN_FITNESS = ("fitness", "irregularity", "price")


class IslandConfig(BaseModel):
    """What one island has otherwise than the rest: a table ``[[island]]`` of a TOML file."""

    model_config = _MODEL

    population: int | None = Field(default=None, ge=2)
    crossover: float | None = Field(default=None, ge=0, le=1)
    mutation: float | None = Field(default=None, ge=0, le=1)
    elites: int | None = Field(default=None, ge=0)
    scaling: Scaling | None = None
    selection: Selection | None = None
    recombination: Recombination | None = None
    operations: tuple[str, ...] | None = Field(default=None, min_length=1)
    fitness: FitnessKind | None = None
    irregularity: float | None = Field(default=None, ge=0)
    price: float | None = Field(default=None, ge=0)

    @field_validator("operations")
    @classmethod
    def _known(cls, names: tuple[str, ...] | None) -> tuple[str, ...] | None:
        known = [operation.name for operation in (*OPERATIONS, *PAPER_OPERATIONS)]
        for name in names or ():
            if name not in known:
                raise ValueError(f"there is no operation {name!r}; there are {', '.join(known)}")
        return names


class Config(BaseModel):
    """All settings of a run; keys of a TOML file are written with dashes."""

    model_config = _MODEL

    profile: Literal["default", "thorough", "paper"] = "default"
    operation: Literal["remesh", "replace-node"] | None = None
    fitness: Literal["trias", "quality"] = "quality"
    irregularity: float = Field(IRREGULARITY, ge=0)
    price: float = Field(PRICE, ge=0)
    criteria: str = "standard"
    size: Annotated[float, Field(gt=0)] | str | None = None
    judged_size: float | None = Field(None, gt=0)
    only: str | None = Field(None, min_length=1)
    regions: str | None = Field(None, min_length=1)
    feature_angle: float = Field(30.0, gt=0, le=180)
    slide: bool = True
    islands: int = Field(2, ge=1, le=MOST_ISLANDS)
    population: int = Field(2, ge=2)
    generations: int = Field(2, ge=0)
    genes: int = Field(5, ge=1)
    operation_population: int = Field(5, ge=2)
    operation_generations: int = Field(1, ge=0)
    crossover: float = Field(0.9, ge=0, le=1)
    mutation: float = Field(0.1, ge=0, le=1)
    elites: int = Field(1, ge=0)
    scaling: Scaling = "window"
    rings: tuple[int, ...] = Field((3, 4, 6, 9, 40, 400), min_length=1)
    largest: tuple[int, ...] = Field((60, 100, 160, 300, 2000, 20000), min_length=1)
    rounds: int = Field(80, ge=0)
    patience: int = Field(6, ge=1)
    flow: int = Field(0, ge=0)
    tidy: int = Field(2, ge=0)
    selection: Selection = "roulette"
    recombination: Recombination = "single-point"
    topology: TopologyKind = "ring"
    degree: int = Field(4, ge=1)
    rewiring: float = Field(0.1, ge=0, le=1)
    edges: tuple[Link, ...] = ()
    migrate_every: int = Field(1, ge=1)
    migrants: int = Field(1, ge=0)
    migrant_share: float | None = Field(None, ge=0, le=1)
    leaving: Leaving = "best"
    giving_way: GivingWay = "worst"
    migrants_move: bool = False
    refuse_duplicates: bool = False
    migration_patience: int = Field(0, ge=0)
    migration_delay: int = Field(0, ge=0)
    mode: Mode = "synchronous"
    evaluations: int | None = Field(None, ge=1)
    target_fitness: float | None = None
    stagnation: int | None = Field(None, ge=1)
    diversity: float = Field(0.0, ge=0, le=1)
    island: tuple[IslandConfig, ...] = ()
    seed: int = Field(1, ge=0)
    time_limit: float | None = Field(None, gt=0)
    evaluation_limit: float = Field(600.0, gt=0)
    backend: Literal["local", "ray"] = "local"
    address: str | None = None
    workers: int | None = Field(None, ge=1)
    track: str | None = None
    warm_start: str | None = None

    @property
    def operations(self) -> tuple[Operation, ...]:
        """The operations of the profile."""
        if self.profile == "paper":
            return PAPER_OPERATIONS
        return tuple(o for o in OPERATIONS if self.slide or o.name != "slide")

    @property
    def improving(self) -> bool:
        """Whether an operation that gains nothing leaves the mesh as it is."""
        return self.profile != "paper"

    @property
    def element_size(self) -> float | None:
        """The size of all elements, where the user gave a number."""
        return None if isinstance(self.size, str) else self.size

    @property
    def size_field(self) -> str | None:
        """The size field that the user named instead: ``local`` or a file."""
        return self.size if isinstance(self.size, str) and self.size != EVEN else None

    @property
    def judged_by(self) -> float | str | None:
        """What lengths are judged by: the user's size, or one size where the search knows no more.

        None: what is best for the criteria.
        """
        whole = self.profile == "paper" or self.operation is not None
        return EVEN if self.size is None and whole else self.size

    @property
    def plan(self) -> Plan:
        """Which subdomains are cut out in which round."""
        extents = tuple(map(Extent, self.rings, self.largest))
        return Plan(extents, self.rounds, self.patience, self.flow, self.tidy)

    @property
    def operation_code(self) -> int:
        """The code of the one operation that runs alone."""
        names = [operation.name for operation in self.operations]
        (number,) = [i for i, name in enumerate(names) if name.startswith(self.operation or "")]
        return self.operations[number].code

    @property
    def breeding(self) -> Breeding:
        """Breeding of procedures, or of the one operation GA that runs alone."""
        return self._breeding(self.population, self.generations)

    @property
    def operation_breeding(self) -> Breeding:
        """Breeding of the operation GAs within the integration GA."""
        return self._breeding(self.operation_population, self.operation_generations)

    @property
    def schedule(self) -> Schedule:
        """How long islands evolve, and when and where migrants travel.

        Raises InputError where the topology does not fit the number of islands.
        """
        topology = Topology(self.topology, self.degree, self.rewiring, self.edges, self.seed)
        return Schedule(
            plans=self.plans,
            generations=self.generations,
            links=topology.links(self.islands),
            every=self.migrate_every,
            delay=self.migration_delay,
            stopping=Stopping(
                self.evaluations, self.target_fitness, self.stagnation, self.diversity
            ),
            mode=self.mode,
        )

    @property
    def plans(self) -> tuple[IslandPlan, ...]:
        """How each island lives; tables of single islands come again where there are fewer."""
        migration = Migration(
            count=self.migrants,
            share=self.migrant_share,
            leaving=self.leaving,
            giving_way=self.giving_way,
            moves=self.migrants_move,
            refuses_duplicates=self.refuse_duplicates,
            patience=self.migration_patience,
        )
        own = self.island or (IslandConfig(),)
        return tuple(
            self._plan(own[number % len(own)], migration) for number in range(self.islands)
        )

    def _plan(self, own: IslandConfig, migration: Migration) -> IslandPlan:
        lives = own.model_dump(exclude_none=True, exclude={"operations", *OWN_FITNESS})
        return IslandPlan(
            breeding=self.model_copy(update=lives).breeding,
            genes=self.genes,
            migration=migration,
            operations=own.operations or (),
            fitness=OwnFitness(own.fitness, own.irregularity, own.price),
        )

    @property
    def decisive(self) -> dict[str, Any]:
        """What the answer depends on: all settings but `FREE`, and of files not where they are."""
        size = {"size"} if self.size_field and Path(self.size_field).is_file() else set()
        return self.model_dump(mode="json", exclude={*FREE, "criteria", "warm_start", *size})

    def to_toml(self, **instead: str) -> str:
        """All settings as a file that loads back equal, paths from the root.

        `instead` are texts that take the place of single settings.
        """
        import tomli_w

        values = self.model_dump(mode="json", by_alias=True, exclude_none=True)
        for key in FILE_KEYS:
            if _names_a_file(values.get(key)):
                values[key] = str(Path(values[key]).resolve())
        values |= instead
        return tomli_w.dumps({key: value for key, value in values.items() if value != []})

    def flat(self) -> dict[str, str | int | float | bool]:
        """All settings as the keys of a TOML file; those that are not set are left out."""
        values = self.model_dump(by_alias=True, exclude_none=True)
        return {
            key: ", ".join(map(str, value)) if isinstance(value, tuple) else value
            for key, value in values.items()
            if value != ()
        }

    def _breeding(self, individuals: int, generations: int) -> Breeding:
        return Breeding(
            individuals=individuals,
            generations=generations,
            crossover=self.crossover,
            mutation=self.mutation,
            elites=min(self.elites, individuals),
            scaling=self.scaling,
            selection=self.selection,
            recombination=self.recombination,
        )


def load_config(file: Path | None, given: Mapping[str, Any]) -> Config:
    """Put a config together: the profile's settings, over them the file's, over them the user's.

    Raises InputError with a sentence on the first mistake.
    """
    from_file = _read(file) if file else {}
    chosen = {**from_file, **given}
    profile = chosen.get("profile", "default")
    base = dict(PROFILES.get(profile, {})) if isinstance(profile, str) else {}
    if chosen.get("operation") is not None:
        base.update(ALONE)
    try:
        config = Config.model_validate({**base, **chosen})
    except ValidationError as error:
        raise InputError(_sentence(error, file, given)) from None
    _ = config.schedule  # whether the topology fits is told before the run
    if config.edges and config.topology != "edges":
        raise InputError(
            f'"edges" are given, and the topology is "{config.topology}"; write '
            'topology = "edges", or leave the edges out.'
        )
    if len(config.rings) != len(config.largest):
        raise InputError(
            f'"rings" has {len(config.rings)} values and "largest" {len(config.largest)}; '
            "give one each for every extent of a subdomain."
        )
    if config.size_field and (config.operation or config.profile == "paper"):
        raise InputError(
            f'--size "{config.size}" needs subdomains, which the paper\'s profile and --operation '
            "do not have; give a number."
        )
    if config.operation and (config.islands > 1 or config.backend == "ray"):
        raise InputError(
            "One operation GA alone runs as one population in one process; leave out --islands and "
            "--backend ray, or --operation."
        )
    return config


def _names_a_file(value: object, folder: Path = Path()) -> bool:
    """Whether a setting names a file or folder that is there, and not what is built in."""
    if not isinstance(value, str) or value in (*BUILT_IN, LOCAL):
        return False
    return (folder / value).exists()


def _read(file: Path) -> dict[str, Any]:
    try:
        found = tomllib.loads(file.read_text(encoding="utf-8"))
        for key in FILE_KEYS:
            if _names_a_file(found.get(key), file.parent):
                found[key] = str(file.parent / found[key])
        return found
    except OSError as error:
        raise InputError(f"{file} cannot be read: {error.strerror}.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{file} is not TOML: {error}.") from None


def _sentence(error: ValidationError, file: Path | None, given: Mapping[str, Any]) -> str:
    first = error.errors()[0]
    place = first["loc"]
    table = place[0] == "island" and len(place) > 1
    key = str(place[-1 if table else 0])
    if first["type"] == "extra_forbidden":
        fields = IslandConfig.model_fields if table else Config.model_fields
        known = ", ".join(name.replace("_", "-") for name in fields)
        whose = f"of island {place[1]} " if table else ""
        return f'{file}: there is no setting {whose}"{key}"; the settings are {known}.'
    where = f"--{key}" if place[0] in given or file is None else f'{file}: "{key}"'
    return f"{where} is {first['input']!r}: {first['msg'][0].lower()}{first['msg'][1:]}."
