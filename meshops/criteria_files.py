"""Reading and writing criteria: TOML of our own and HyperMesh's text.

TOML::

    name = "crash"                # optional, else the file's name
    base = "standard"             # optional: what is not said below is as in this built-in set
    normalised_size = false       # optional
    penalties = { ideal = 0, good = 0, warn = 0.8, fail = 1, worst = 10 }    # optional

    [criteria."min size"]
    ideal = 5.0
    good = 4.5
    warn = 2.0
    fail = 1.0
    worst = 0.5
    weight = 1.0                  # optional
    active = true                 # optional
    scaled = false                # optional: levels are multiples of the target element size

Without a base, criteria that are not named are off.

HyperMesh's text has a line a criterion: an optional line number, the tag, 0 or 1 for off or on, the
weight, the five levels, and perhaps numbers of methods, which are left aside. Lengths are absolute.
"""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from meshops.criteria import (
    BUILT_IN,
    LEVELS,
    NAMES,
    PENALTIES,
    STANDARD,
    Criteria,
    Criterion,
    Levels,
)
from meshops.errors import InputError

Table = Mapping[str, Any]

OFF = replace(STANDARD, criteria=tuple(replace(c, active=False) for c in STANDARD.criteria))
"""What a file starts from that names no base."""

KINDS = {str: "a text", bool: "true or false", dict: "a table"}

TAGS = {name.lower(): name for name in NAMES} | {"min length": "min size"}

PENALTY_TAG = "penalty value"

# the number of a line may be missing, and a switch may stand glued to its tag ("10 jacobian1 1")
TAGGED_LINE = re.compile(
    r"(?:\d+\s+)?(?P<tag>{})(?P<values>.*)".format(
        "|".join(tag.replace(" ", r"\s+") for tag in (*TAGS, PENALTY_TAG))
    ),
    re.IGNORECASE,
)

# what HyperMesh also writes and what has no say in the Q.I. of shells
OTHER_LINE = re.compile(
    r"(\d+\s+)?(QI color legend|time_step|area_skew|cell_squish|equi_skew|Global_solver)\b",
    re.IGNORECASE,
)


def load_criteria(file: str) -> Criteria:
    """Return the criteria set that ``file`` names: "standard", "paper" or a file.

    Files are TOML (``.toml``) or HyperMesh's text (``.criteria``, ``.txt``). Raises InputError
    where there is no such set or file, or where the file cannot be understood.
    """
    if file in BUILT_IN:
        return BUILT_IN[file]
    path = Path(file)
    readers = {".toml": parse_toml, ".criteria": parse_hypermesh, ".txt": parse_hypermesh}
    if not path.is_file():
        raise InputError(
            f'criteria "{file}" are neither {" nor ".join(BUILT_IN)} nor a file that is there'
        )
    if path.suffix.lower() not in readers:
        raise InputError(f"{file}: a criteria file ends in {', '.join(readers)}")
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: cannot be read as UTF-8 text ({error})") from None
    try:
        return readers[path.suffix.lower()](text, path.stem)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None


def dump_criteria(criteria: Criteria) -> str:
    """Write a set as TOML that loads back equal."""
    name = json.dumps(criteria.name, ensure_ascii=False).replace("\x7f", "\\u007f")
    penalties = ", ".join(
        f"{level} = {value!r}" for level, value in zip(LEVELS, criteria.penalties, strict=True)
    )
    lines = [
        f"name = {name}",
        f"normalised_size = {_toml(criteria.normalised_size)}",
        f"penalties = {{ {penalties} }}",
    ]
    for criterion in criteria.criteria:
        values = dict(zip(LEVELS, criterion.levels, strict=True))
        values |= {key: getattr(criterion, key) for key in ("weight", "active", "scaled")}
        lines += ["", f'[criteria."{criterion.name}"]']
        lines += [f"{key} = {_toml(value)}" for key, value in values.items()]
    return "\n".join(lines) + "\n"


def _toml(value: float) -> str:
    return repr(value).lower()


def parse_toml(text: str, name: str) -> Criteria:
    """Parse the TOML form; ``name`` is for a set that gives none."""
    try:
        document = tomllib.loads(text)
    except ValueError as error:
        raise InputError(f"is not TOML: {error}") from None
    _refuse_unknown(document, ("name", "base", "normalised_size", "penalties", "criteria"), "key")
    base = _base(document)
    tables = _typed(document, "criteria", dict, {})
    _refuse_unknown(tables, NAMES, "criterion")
    return replace(
        base,
        name=_typed(document, "name", str, name),
        criteria=tuple(
            _criterion(_typed(tables, known.name, dict, None), known, has_base="base" in document)
            for known in base.criteria
        ),
        penalties=_penalties(_typed(document, "penalties", dict, {}), base.penalties),
        normalised_size=_typed(document, "normalised_size", bool, base.normalised_size),
    )


def _base(document: Table) -> Criteria:
    name = _typed(document, "base", str, None)
    if name is None:
        return OFF
    if name not in BUILT_IN:
        raise InputError(f'base "{name}" is none of {", ".join(BUILT_IN)}')
    return BUILT_IN[name]


def _criterion(table: Table | None, known: Criterion, *, has_base: bool) -> Criterion:
    if table is None:
        return known
    where = f' in criterion "{known.name}"'
    _refuse_unknown(table, (*LEVELS, "weight", "active", "scaled"), "key", where)
    default = known if has_base else Criterion(known.name, known.levels)
    for level in LEVELS:
        if level not in table and not has_base:
            raise InputError(f'level "{level}" is missing{where}')
    return Criterion(
        known.name,
        levels=_levels(table, default.levels, where),
        weight=_number(table, "weight", default.weight, where),
        active=_typed(table, "active", bool, default.active, where),
        scaled=_typed(table, "scaled", bool, default.scaled, where),
    )


def _penalties(table: Table, default: Levels) -> Levels:
    _refuse_unknown(table, LEVELS, "key", " in penalties")
    return _levels(table, default, " in penalties")


def _levels(table: Table, default: Levels, where: str) -> Levels:
    ideal, good, warn, fail, worst = (
        _number(table, level, value, where) for level, value in zip(LEVELS, default, strict=True)
    )
    return ideal, good, warn, fail, worst


def _number(table: Table, key: str, default: float, where: str) -> float:
    value = table.get(key, default)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(f'"{key}"{where} must be a number, not {value!r}')
    try:
        return float(value)
    except OverflowError:
        raise InputError(f'"{key}"{where} is larger than a number can be') from None


def _typed(table: Table, key: str, kind: type, default: Any, where: str = "") -> Any:
    value = table.get(key, default)
    if key in table and not isinstance(value, kind):
        raise InputError(f'"{key}"{where} must be {KINDS[kind]}, not {value!r}')
    return value


def _refuse_unknown(table: Table, known: tuple[str, ...], noun: str, where: str = "") -> None:
    for key in table:
        if key not in known:
            raise InputError(f'there is no {noun} "{key}"{where}; choose of {", ".join(known)}')


def parse_hypermesh(text: str, name: str) -> Criteria:
    """Parse HyperMesh's text; criteria that it does not name are off."""
    given: dict[str, Criterion] = {}
    penalties = PENALTIES
    for number, line in enumerate(text.splitlines(), 1):
        content = line.split("#")[0].strip()
        if not content or OTHER_LINE.match(content):
            continue
        try:
            tag, values = _tag_and_values(content)
            if tag == PENALTY_TAG:
                penalties = _five(values)
                continue
            criterion = _criterion_of_line(TAGS[tag], values)
            if criterion.name in given:
                raise InputError(f'"{criterion.name}" is given a second time')
        except InputError as error:
            raise InputError(f"line {number}: {error}") from None
        given[criterion.name] = criterion
    if not given:
        raise InputError("names no criterion; each has a line: tag, switch, weight, five levels")
    return OFF.having(*given.values(), name=name, penalties=penalties)


def _tag_and_values(content: str) -> tuple[str, list[float]]:
    found = TAGGED_LINE.fullmatch(content)
    if found is None:
        raise InputError(f'"{content}" names none of the criteria {", ".join(NAMES)}')
    try:
        values = [float(word) for word in found["values"].split()]
    except ValueError:
        raise InputError(f'there is something else than numbers after "{found["tag"]}"') from None
    return " ".join(found["tag"].lower().split()), values


def _criterion_of_line(name: str, values: list[float]) -> Criterion:
    if len(values) < 7 or values[0] not in (0.0, 1.0):
        raise InputError(f'"{name}" needs 0 or 1, a weight and five levels')
    return Criterion(name, _five(values[2:7]), weight=values[1], active=bool(values[0]))


def _five(values: list[float]) -> Levels:
    if len(values) != len(LEVELS):
        raise InputError(f"five values are needed ({', '.join(LEVELS)}), not {len(values)}")
    ideal, good, warn, fail, worst = values
    return ideal, good, warn, fail, worst
