"""Rates: how often each operation is drawn as a gene."""

from __future__ import annotations

import numpy as np

from islands.integration_ga import Problem
from islands.procedure import Round
from meshops.mesh import Floats
from meshops.operations import NOTHING

LEAST_RATE = 0.3
"""Of an even share: what an operation that never paid off is still drawn with."""

EXPERIENCE = {
    "remesh": 5.0,
    "smooth": 4.0,
    "anneal": 2.0,
    "transport-tria": 2.0,
    "edit-element": 2.0,
    "slide": 1.0,
}
"""Credit that a run begins with: how operations shared in what paid off on a wing and on planar
parts, in the first rounds of runs that began without any; half of that for `anneal`, which takes
longest."""

LARGE = ("anneal", "remesh")
"""Operations that make a whole place anew."""

FLOW_RATES = {"anneal": 0.8, "smooth": 0.1}
"""How often operations are drawn in rounds for a better flow; the rest is nothing."""


def adapted_rates(credit: Floats) -> Floats:
    """(C,) how often each operation is drawn: more often what has paid off."""
    even = np.full(len(credit), 1.0 / len(credit))
    if not credit.any():
        return even
    rates: Floats = LEAST_RATE * even + (1.0 - LEAST_RATE) * credit / credit.sum()
    normalised: Floats = rates / rates.sum()
    return normalised


def first_credit(problem: Problem) -> Floats:
    """(C,) credit of each operation before the first round."""
    return np.array([EXPERIENCE.get(name, 0.0) for name in _names(problem)])


def small_rates(problem: Problem) -> Floats:
    """(C,) how often each operation is drawn where edits are to be small: one like the other."""
    rates = np.array([float(name not in LARGE) for name in _names(problem)])
    normalised: Floats = rates / rates.sum() if rates.any() else np.full(len(rates), 1 / len(rates))
    return normalised


def flow_rates(problem: Problem) -> Floats:
    """(C,) how often each operation is drawn where irregular nodes are to vanish."""
    rates = np.array([FLOW_RATES.get(name, 0.0) for name in _names(problem)])
    rates[problem.codes.index(NOTHING)] = max(0.0, 1.0 - rates.sum())
    normalised: Floats = rates / rates.sum()
    return normalised


def credits_of(done: Round, problem: Problem) -> Floats:
    """(C,) how many steps of the fittest procedures of a round were of each operation."""
    codes = [step.code for place in done.places for step in place.steps if len(step.parameters)]
    return np.array([codes.count(code) for code in problem.codes], np.float64)


def named_rates(problem: Problem) -> dict[str, float]:
    """Rates by the names of the operations, for reports."""
    rates = problem.weights if problem.weights is not None else np.zeros(0)
    return {name: round(float(rate), 4) for name, rate in zip(_names(problem), rates, strict=True)}


def _names(problem: Problem) -> list[str]:
    """Name what each of the problem's codes stands for."""
    names = {operation.code: operation.name for operation in problem.operations}
    return [names.get(code, "nothing") for code in problem.codes]
