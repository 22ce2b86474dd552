"""What becomes of a run on Ray whose workers are killed, one every few seconds.

The plate, tiled to some thousand elements, as a user would start it; the killer takes the processes
of islands and operation GAs in turn, at any moment, with SIGKILL.
"""

from __future__ import annotations

import json
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.killing import Killer
from benchmarks.report import Row, parser, publish
from benchmarks.tiling import tiled
from meshops.examples import SIZE
from meshops.formats import write_mesh

SETTINGS = f"""
criteria = "paper"
size = {SIZE}
rounds = 12
track = "off"
"""

ELEMENTS = 12_000
SEEDS = (1, 2, 3, 4, 5)
LEAST_KILLS = 20
KILL_SECONDS = 3.0
WORKERS = ("ray::_Host", "ray::_run")
"""How the processes that islands and operation GAs run in are named."""


@dataclass(frozen=True)
class Run:
    """How a run ended.

    Attributes
    ----------
    digest : str
        Of the mesh.
    seconds : float
        That it took, from its start to its last file.
    killed : int
        Workers, on the way.
    """

    digest: str
    seconds: float
    killed: int = 0


@dataclass(frozen=True)
class Place:
    """Where runs have their deck, settings and folders."""

    folder: Path

    @classmethod
    def make(cls, folder: str) -> Place:
        """Write the deck and the settings."""
        place = cls(Path(folder))
        write_mesh(tiled(ELEMENTS), place.folder / "plate.bdf")
        (place.folder / "settings.toml").write_text(SETTINGS, encoding="utf-8")
        return place

    def start(self, name: str, seed: int, *options: str) -> subprocess.Popen[bytes]:
        """Start a run."""
        return _meshipelago(
            "optimize", self.folder / "plate.bdf", "--out", self.folder / name, "--quiet",
            "--config", self.folder / "settings.toml", "--seed", seed, *options,
        )  # fmt: skip

    def resume(self, name: str, *options: str) -> Run:
        """Go on with a run to its end."""
        return self.end(name, _meshipelago("resume", self.folder / name, "--quiet", *options))

    def run(self, name: str, seed: int, *options: str) -> Run:
        """Run from start to end."""
        return self.end(name, self.start(name, seed, *options))

    def run_under_fire(self, name: str, seed: int, seconds: float, *options: str) -> Run:
        """Run from start to end while a worker is killed every so many seconds."""
        process = self.start(name, seed, *options)
        with Killer(process.pid, seconds, WORKERS) as killer:
            done = self.end(name, process)
        return Run(done.digest, done.seconds, killer.killed)

    def end(self, name: str, process: subprocess.Popen[bytes]) -> Run:
        """Wait for the end of a run."""
        started = time.monotonic()
        code = process.wait()
        if code:
            sys.exit(f"{name} has ended with exit code {code}.")
        document = json.loads((self.folder / name / "result.json").read_text(encoding="utf-8"))
        return Run(document["digest"], time.monotonic() - started)


def _meshipelago(*arguments: object) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-c", "from islands.cli import main; main()"]
    return subprocess.Popen([*command, *map(str, arguments)], stdout=subprocess.DEVNULL)


def main() -> None:
    """Run all seeds, and print the table."""
    options = parser(__doc__)
    options.add_argument("--seeds", type=int, default=len(SEEDS), metavar="N")
    chosen = options.parse_args()
    on_ray = "--backend", "ray", "--workers", "2"
    pairs: list[tuple[Run, Run]] = []
    with tempfile.TemporaryDirectory() as folder:
        place = Place.make(folder)
        for seed in SEEDS[: chosen.seeds]:
            sound = place.run(f"sound-{seed}", seed, *on_ray)
            disturbed = place.run_under_fire(f"killed-{seed}", seed, KILL_SECONDS, *on_ray)
            pairs.append((sound, disturbed))
            print(f"seed {seed}: {sound} {disturbed}", file=sys.stderr)
    equal = sum(sound.digest == disturbed.digest for sound, disturbed in pairs)
    kills = [disturbed.killed for _, disturbed in pairs]
    lost = [
        (disturbed.seconds - sound.seconds) / max(disturbed.killed, 1) for sound, disturbed in pairs
    ]
    rows = [
        Row("digests equal", f"{equal} of {len(pairs)}", f"{len(pairs)}", equal == len(pairs)),
        Row(
            f"workers killed in a run, one every {KILL_SECONDS:g} s",
            f"{min(kills)} to {max(kills)}",
            f">= {LEAST_KILLS}",
            min(kills) >= LEAST_KILLS,
        ),
        Row("time lost for each", f"{statistics.median(lost):.1f} s (median)", "", met=True),
        Row(
            "a run without and with kills",
            " / ".join(f"{statistics.median(p[k].seconds for p in pairs):.0f} s" for k in (0, 1)),
            "",
            met=True,
        ),
    ]
    details = {"runs": [[asdict(run) for run in pair] for pair in pairs]}
    publish("A run on Ray whose workers are killed", rows, details, chosen)


if __name__ == "__main__":
    main()
