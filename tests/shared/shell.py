"""The command as a process of its own, in a line of shell."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.shared.folders import ROOT

ENVIRONMENT = {**os.environ, "PYTHONPATH": str(ROOT)}


def shell(line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """A line of shell in which `heun` is the command."""
    line = line.replace("heun", f"{sys.executable} -m heuncli", 1)
    return subprocess.run(
        ["bash", "-c", line], capture_output=True, text=True, cwd=folder, timeout=60, env=ENVIRONMENT, check=False
    )
