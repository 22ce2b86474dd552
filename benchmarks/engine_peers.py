"""What DEAP, pymoo and pygmo spend on an evaluation whose fitness costs nothing.

Each gets the same: individuals of ten genes, the sum of the genes as fitness, and a problem that
carries some bytes. A figure is milliseconds an evaluation, everything included but the start.
"""

from __future__ import annotations

import random
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from multiprocessing import get_context
from types import MappingProxyType
from typing import Any

import numpy as np

GENES = 10
INDIVIDUALS = 100
SECONDS = 2.0
"""That a peer may go on with more generations."""


def _measured(generation: Callable[[], Any]) -> float:
    """Milliseconds an evaluation, over generations for some seconds; the first one is its start."""
    generation()
    started, count = time.perf_counter(), 0
    while time.perf_counter() - started < SECONDS:
        generation()
        count += 1
    return 1e3 * (time.perf_counter() - started) / (count * INDIVIDUALS)


class _Sum:
    """Fitness of DEAP's individuals."""

    def __init__(self, payload: int) -> None:
        self.payload = np.zeros(payload, np.uint8)

    def __call__(self, individual: list[int]) -> tuple[float]:
        """Sum up the genes."""
        return (float(sum(individual)),)


def deap(payload: int, processes: int) -> float:
    """Run DEAP's eaSimple, with a pool where there are processes."""
    from deap import algorithms, base, creator, tools

    creator.create("Fitness", base.Fitness, weights=(1.0,))
    creator.create("Individual", list, fitness=creator.Fitness)
    toolbox = base.Toolbox()
    toolbox.register("gene", random.randint, 0, 2)
    toolbox.register("individual", tools.initRepeat, creator.Individual, toolbox.gene, GENES)
    toolbox.register("evaluate", _Sum(payload))
    toolbox.register("mate", tools.cxOnePoint)
    toolbox.register("mutate", tools.mutUniformInt, low=0, up=2, indpb=0.05)
    toolbox.register("select", tools.selTournament, tournsize=2)
    population = tools.initRepeat(list, toolbox.individual, INDIVIDUALS)

    def generation() -> None:
        for one in population:
            del one.fitness.values  # as after breeding: all are to be evaluated
        population[:], _ = algorithms.eaSimple(population, toolbox, 0.95, 0.2, 1, verbose=False)

    with _pool(processes) as pool:  # it knows the classes from before
        toolbox.register("map", pool.map if pool else map)
        # one generation is evaluated before the loop of eaSimple and most of another in it
        return _measured(generation) / 2.0


def pymoo(payload: int, processes: int, *, on_ray: bool = False) -> float:
    """Run pymoo's GA, with a pool where there are processes, or on Ray."""
    from pymoo.algorithms.soo.nonconvex.ga import GA
    from pymoo.core.problem import ElementwiseProblem
    from pymoo.parallelization import RayParallelization, StarmapParallelization

    class Sum(ElementwiseProblem):  # type: ignore[misc]
        def __init__(self, **given: Any) -> None:
            self.carried = np.zeros(payload, np.uint8)
            super().__init__(n_var=GENES, n_obj=1, xl=0.0, xu=2.0, **given)

        def _evaluate(self, x: Any, out: dict[str, Any], *_: Any, **__: Any) -> None:
            out["F"] = -x.sum()

    Sum.__qualname__ = "Sum"
    globals()["Sum"] = Sum  # a pool finds it by its name
    with _pool(processes) as pool:
        runner = RayParallelization() if on_ray else pool and StarmapParallelization(pool.starmap)
        problem = Sum(elementwise_runner=runner) if runner else Sum()
        algorithm = GA(pop_size=INDIVIDUALS, eliminate_duplicates=False)
        algorithm.setup(problem, termination=("n_gen", 10**9), seed=1, verbose=False)
        return _measured(algorithm.next)


def pymoo_on_ray(payload: int, processes: int) -> float:
    """Run pymoo's GA with Ray's tasks."""
    import ray

    ray.init(num_cpus=processes, include_dashboard=False, log_to_driver=False, logging_level=40)
    try:
        return pymoo(payload, 0, on_ray=True)
    finally:
        ray.shutdown()


@contextmanager
def _pool(processes: int) -> Iterator[Any]:
    if not processes:
        yield None
        return
    with get_context("fork").Pool(processes) as pool:
        yield pool


class _Udp:
    """The problem as pygmo has it."""

    def __init__(self, payload: int) -> None:
        self.payload = np.zeros(payload, np.uint8)

    def fitness(self, x: Any) -> list[float]:
        """Sum up the genes."""
        return [-float(x.sum())]

    def get_bounds(self) -> tuple[list[float], list[float]]:
        """From 0 to 2."""
        return [0.0] * GENES, [2.0] * GENES


def pygmo(payload: int, processes: int) -> float:
    """Run pygmo's sga, or, with processes, evaluate generations by mp_bfe without any breeding."""
    import pygmo

    problem = pygmo.problem(_Udp(payload))
    if processes:
        genes = np.random.default_rng(1).uniform(0.0, 2.0, GENES * INDIVIDUALS)
        pygmo.mp_bfe.init_pool(processes)
        batch = pygmo.bfe(pygmo.mp_bfe())
        try:
            return _measured(lambda: batch(problem, genes))
        finally:
            pygmo.mp_bfe.shutdown_pool()
    algorithm = pygmo.algorithm(pygmo.sga(gen=1, seed=1))
    population = pygmo.population(problem, INDIVIDUALS, seed=1)

    def generation() -> None:
        nonlocal population
        population = algorithm.evolve(population)

    return _measured(generation)


PEERS: Mapping[str, tuple[Callable[[int, int], float], int]] = MappingProxyType(
    {
        "DEAP, one process": (deap, 0),
        "DEAP, pool of 2": (deap, 2),
        "pymoo, one process": (pymoo, 0),
        "pymoo, pool of 2": (pymoo, 2),
        "pymoo, Ray": (pymoo_on_ray, 2),
        "pygmo sga, one process": (pygmo, 0),
        "pygmo mp_bfe, pool of 2": (pygmo, 2),
    }
)
"""By name: what takes bytes and processes, and how many of these."""


def measured(name: str, payload: int, timeout: float) -> float:
    """Return what a peer spends, in a process that may have some of its own; NaN where it fails."""
    command = [sys.executable, "-m", "benchmarks.engine_peers", name, str(payload)]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=timeout, check=True)
        return float(done.stdout.split()[-1])
    except (subprocess.SubprocessError, ValueError, IndexError) as error:
        print(f"{name}, {payload} bytes: {error}")
        return float("nan")


if __name__ == "__main__":
    call, number = PEERS[sys.argv[1]]
    print(call(int(sys.argv[2]), number))
