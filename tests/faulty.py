"""Operations that do harm, to see what a run makes of it."""

from __future__ import annotations

import os
import signal
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from meshops.operations import Operation, SearchSpace
from meshops.workpiece import Workpiece

Harm = Literal["crash", "hang", "memory", "none"]

FOREVER = 600.0
"""Seconds, beside what a test allows."""


@dataclass(frozen=True)
class Faulty:
    """An operation that does harm on some meshes, as the sound one would not.

    Attributes
    ----------
    sound : Operation
    harm : str
    share : int
        It does harm on one mesh of so many.
    times : int
        How often on each of them.
    folder : str
        Where it counts, over all processes.
    spared : int
        The process that it does no harm to: that of the test.
    """

    sound: Operation
    harm: Harm
    share: int
    times: int
    folder: str
    spared: int

    @property
    def name(self) -> str:
        return self.sound.name

    @property
    def code(self) -> int:
        return self.sound.code

    def search_space(self, workpiece: Workpiece, rng: np.random.Generator) -> SearchSpace | None:
        is_one = int(workpiece.mesh.digest, 16) % self.share == 0
        if is_one and os.getpid() != self.spared:
            self._harm(workpiece.mesh.digest)
        return self.sound.search_space(workpiece, rng)

    def apply(self, workpiece: Workpiece, parameters: Any) -> Any:
        return self.sound.apply(workpiece, parameters)

    def format(self, parameters: Any) -> str:
        return self.sound.format(parameters)

    def _harm(self, digest: str) -> None:
        folder = Path(self.folder)
        if len(list(folder.glob(f"{digest}-*"))) >= self.times:
            return
        (folder / f"{digest}-{time.time_ns()}").touch()
        if self.harm == "crash":
            os.kill(os.getpid(), signal.SIGSEGV)
        elif self.harm == "hang":
            time.sleep(FOREVER)
        elif self.harm == "memory":
            raise MemoryError
