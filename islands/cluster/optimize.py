"""What `ray submit cluster.yaml optimize.py DECK --out FOLDER` runs on the head of the cluster."""

import os
import sys
from pathlib import Path

if __name__ == "__main__":
    command = str(Path.home() / "meshipelago" / "bin" / "meshipelago")
    os.execv(
        command,
        [command, "optimize", *sys.argv[1:], "--backend", "ray", "--address", "auto", "--resume"],
    )
