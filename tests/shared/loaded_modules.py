"""Modules that other packages load by themselves, by version: what is left of sys.modules is what heun loaded."""

from __future__ import annotations

import subprocess
import sys
from functools import cache


@cache
def loaded_by(package: str) -> frozenset[str]:
    """Names of the modules that importing a package loads, in a fresh process."""
    code = f"import {package}, sys; print(*sys.modules)"
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return frozenset(run.stdout.split())
