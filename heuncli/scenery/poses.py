"""Where the bodies of a run stand at some instants, and where their points come to be."""

from __future__ import annotations

import numpy as np

from heuncli.mechanism.model import Assembly, Mechanism
from heuncli.named_tuples import NamedTuple
from heuncli.results import Array
from heuncli.scenery.machine import GROUND
from heuncli.study.ask.study import Study

MOTION = frozenset({"motion"})


class Poses(NamedTuple):
    """Of each body the places of its origin (n, 3) and its attitudes (n, 3, 3), whose columns are its axes."""

    times: Array
    places: dict[str, Array]
    attitudes: dict[str, Array]

    def at(self, body: str, points: Array, k: int) -> Array:
        """Where points (..., 3) of a body stand in the world at the instant of a number."""
        if body == GROUND:
            return np.asarray(points, dtype=np.float64)
        return np.asarray(points @ self.attitudes[body][k].T + self.places[body][k])


def poses_of(study: Study, times: Array) -> Poses:
    """The poses at instants of the run, (n,) ascending."""
    found = study.results if study.of_one_instant else study.reports_at(times, MOTION)
    places = {name: body["position"] for name, body in found.bodies.items()}
    return Poses(found.time, places, {name: body["rotation"] for name, body in found.bodies.items()})


def poses_at_start(mechanism: Mechanism, start: Assembly, t: float) -> Poses:
    """The poses in which a scene is assembled."""
    own = enumerate(body.name for body in mechanism.bodies)
    places = {name: start.position[None, i] for i, name in own}
    return Poses(np.array([t]), places, {name: start.rotation[None, i] for i, name in enumerate(places)})
