"""heun beside them: the integration alone, without the check run that its command takes besides."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from heuncli.motion.integration.methods.method import load_method_by_name
from heuncli.motion.integration.run.request import MotionTask
from heuncli.scene.file_format.load import load
from heuncli.study.model.setup import set_up
from heuncli.version import VERSION
from tests.bench.peers.scenes import FOLDER, duration
from tests.bench.peers.ways import Way


def version() -> str:
    """Its version."""
    return str(VERSION)


def ways(name: str) -> list[Way]:
    """DOP853, the default, with dense output at the spec's own instants."""
    setup = set_up(load(str(FOLDER / f"{name}.yaml")))
    scene, runner, method = setup.scene, setup.runner, load_method_by_name("DOP853")
    times = np.linspace(0.0, duration(name), len(setup.spec.analysis.times))

    def prepare(tolerance: float) -> tuple[Callable[[], Any], Callable[[], dict[str, Any]]]:
        last: list[Any] = []

        def integrate() -> None:
            last[:] = [runner.run(MotionTask(times, tolerance, method=method)).states[-1:]]

        def centers() -> dict[str, Any]:
            found = runner.evaluate(times[-1:], last[0]).bodies[0]
            return {
                body.name: found["r"][k] + found["R"][k] @ (body.center - scene.layout.reference[k])
                for i, body in enumerate(scene.mechanism.bodies)
                for k in [scene.layout.place[i]]
            }

        return integrate, centers

    return [Way("DOP853", [10.0**-k for k in range(2, 15)], prepare)]
