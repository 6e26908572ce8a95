"""The compiled kernel and the plain one give the same bits: trees, closed chains, tables, drives."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from heuncli.kernel.form import KERNEL

SPECS = Path(__file__).parents[2] / "specs"
SCENES = {
    "double": ("analysis.duration=0.3", "analysis.samples=7"),
    "top": ("analysis.duration=0.05", "analysis.samples=4"),
    "four_bar": ("analysis.duration=0.1", "analysis.samples=4"),
    "engine": ("analysis.duration=0.002", "analysis.samples=4"),
    "cardan": ("analysis.duration=0.05", "analysis.samples=4"),
}


def found(scene: str, settings: tuple[str, ...], kernel: str) -> dict[str, Any]:
    text, *_ = (SPECS / f"{scene}.yaml").read_text(encoding="utf-8").partition("\nexpect:")  # other instants than these
    command = [sys.executable, "-m", "heuncli", "run", "-", "--format", "json"]
    command += [word for setting in settings for word in ("--set", setting)]
    environment = {**os.environ, "HEUN_KERNEL": kernel, "PYTHONPATH": str(SPECS.parent)}
    done = subprocess.run(command, input=text, capture_output=True, text=True, cwd=SPECS, env=environment, check=True)
    read: dict[str, Any] = json.loads(done.stdout)
    return read


@pytest.mark.skipif(KERNEL == "pure", reason="there is no compiled kernel to compare with")
@pytest.mark.parametrize("scene", SCENES)
def test_same_bits(scene: str) -> None:
    compiled, plain = (found(scene, SCENES[scene], kernel) for kernel in ("compiled", "pure"))
    assert (compiled["work"].pop("kernel"), plain["work"].pop("kernel")) == ("compiled", "pure")
    for results in (compiled, plain):
        del results["work"]["seconds"]
    assert compiled == plain
