"""The help of all of heun as typer makes it of the registry, and the file that has it ready."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from heuncli.app.cli import terminal

HELP = Path(terminal.HELP)
CODE = "import sys; from heuncli.app.cli import typer_reader; sys.exit(typer_reader.read(['--help']))"


def help_of_typer(columns: int = terminal.MIN_HELP_WIDTH) -> str:
    """What typer answers to `heun --help` on a terminal of that width."""
    environment = {**os.environ, "COLUMNS": str(columns)}
    return subprocess.run(
        [sys.executable, "-c", CODE], capture_output=True, text=True, check=True, env=environment
    ).stdout
