"""Whether a scene told otherwise says the same: every number of two runs against the errors that both state of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from heuncli.motion.integration.check.changes import find_impulse_time_differences
from heuncli.results.path_words import TREE, Node, error_kind_of_path, find_child
from heuncli.results.results import Array
from heuncli.results.results_schema import ESTIMATE_OF_ERROR_KIND, SPACE, Quantity
from heuncli.study.queries.study import Study

Powers = tuple[int, int, int]
POWERS: dict[str, Powers] = {  # of mass, length, time
    "1": (0, 0, 0), "rad": (0, 0, 0), "rad/s": (0, 0, -1), "rad/s²": (0, 0, -2), "m": (0, 1, 0), "m/s": (0, 1, -1),
    "m/s²": (0, 1, -2), "N": (1, 1, -2), "N·m": (1, 2, -2), "J": (1, 2, -2), "W": (1, 2, -3), "N·s": (1, 1, -1),
    "N·m·s": (1, 2, -1), "s": (0, 0, 1),
}  # fmt: skip
AXIAL = frozenset({
    "moment", "moment_orbital", "moment_spin", "direct_moment", "angular_velocity", "angular_acceleration",
    "angular_velocity_jump",
})  # fmt: skip
IN_A_MIRROR = frozenset({"Q2", "T", "M1"})  # scalars that change their sign: along e2 = n × e1, about n and e1
# attitudes are seen by points, momenta by velocities; lines are nowhere defined where loads vanish; B is a moment and
# a spin at once
SKIPPED = frozenset({
    "quaternion", "rotation", "normal", "first_axis", "axis", "line", "about", "system_vector", "kind", "condition",
    "begins", "to", "rodrigues", "momentum", "moment_of_momentum",
})  # fmt: skip
RUNS = ("bodies", "points", "coordinates", "foundation", "joints", "stops", "sections", "forces", "energy")
ROUNDING = 64.0 * float(np.finfo(float).eps)  # of what a number is summed from: some dozen sums of some dozen terms


@dataclass(frozen=True, eq=False)
class Retold:
    """A scene told otherwise: turned by Q (det -1: mirrored), a mass of 1 called `mass`, and so on; names by the old.

    skipped: words of paths that are not the same in it.
    """

    tree: Mapping[str, Any]
    Q: Array = field(default_factory=lambda: np.eye(3))
    mass: float = 1.0
    length: float = 1.0
    time: float = 1.0
    names: Mapping[str, str] = field(default_factory=dict)
    skipped: frozenset[str] = frozenset()

    def scale(self, unit: str) -> float:
        """What 1 of a unit is called."""
        m, l, t = POWERS[unit]
        return self.mass**m * self.length**l * self.time**t

    def name(self, key: str) -> str:
        """A name of the scene, or a point's."""
        body, dot, point = key.partition(".")
        return self.names.get(body, body) + dot + point

    def value(self, value: Array, name: str, unit: str, row: Quantity, turning: bool) -> Array:
        """A number of the first telling as this one has it; turning: of a joint about its axis, which is axial."""
        told, det = value * self.scale(unit), float(np.sign(np.linalg.det(self.Q)))
        if row.shape[-1:] == (SPACE,):
            return np.asarray(told @ self.Q.T * (det if name in AXIAL else 1.0))
        return told * (det if name in IN_A_MIRROR or (name == "axial" and turning) else 1.0)


class Difference(NamedTuple):
    """Two numbers that should be the same: where, how far apart, what is stated of both, what is rounding; in the unit
    of the second."""

    path: str
    off: float
    stated: float
    rounding: float

    @property
    def ratio(self) -> float:
        """The difference over what is stated, with rounding."""
        allowed = self.stated + self.rounding
        return self.off / allowed if allowed > 0.0 else math.inf if self.off > 0.0 else 0.0

    def __str__(self) -> str:
        return f"{self.path} off {self.off:.3g}, stated {self.stated:.3g}, rounding {self.rounding:.3g}"


def leaves(path: tuple[str, ...], node: Node | Quantity | None, one: Any, other: Any, told: Retold
           ) -> Iterator[tuple[tuple[str, ...], Quantity, Any, Any]]:  # fmt: skip
    """Numbers of two blocks by their path in the first; what only one of them has is None in the other."""
    if told.skipped & set(path) or SKIPPED & set(path):
        return
    if isinstance(node, Quantity):
        if node.units:
            yield path, node, one, other
        return
    if not isinstance(node, dict):
        return
    for key, value in (one or {}).items():
        there = (other or {}).get(key if key in node else told.name(key))
        yield from leaves((*path, key), find_child(node, key), value, there, told)


def differences(first: Study, second: Study, told: Retold, blocks: tuple[str, ...] = RUNS) -> Iterator[Difference]:
    """All numbers of the first run against those of the second."""
    for block in blocks:
        one, other = (getattr(study.results, block) for study in (first, second))
        for path, row, a, b in leaves((block,), TREE[block], one, other, told):
            yield compared(first, second, told, path, row, a, b)


def of_blows(first: Study, second: Study, told: Retold) -> Iterator[Difference]:
    """All numbers of the blows of two runs, one by one; their instants, by what both state of them."""
    node = TREE["impulses"]
    assert isinstance(node, dict)
    rows = node["NUMBER"]
    assert isinstance(rows, dict)
    when = [errors_of_blows(run) for run in (first, second)]
    for k, (one, other) in enumerate(zip(first.results.impulses, second.results.impulses, strict=True)):
        stated = when[0][k] * told.time + when[1][k]
        off = abs(float(one["time"]) * told.time - float(other["time"]))
        yield Difference(f"impulses.{k}.time", off, stated, ROUNDING * float(second.results.time[-1]))
        for block in STRUCK:
            for path, row, a, b in leaves((block,), rows.get(block), one.get(block), other.get(block), told):
                yield compared(first, second, told, path, row, a, b)


STRUCK = ("bodies", "foundation", "joints", "stops", "sections")


def errors_of_blows(run: Study) -> list[float]:
    """What is stated of the instants of a run's blows, as of events at them: by when its other runs have them."""
    history = run.history
    apart = [find_impulse_time_differences(history.impulses, other) for other in history.check_impulses]
    missed = 0.5 * history.estimate["motion"] * float(run.results.time[-1])
    found = [2.0 * max((a.get(jump.time, missed) for a in apart), default=missed) for jump in history.impulses]
    return [math.inf if math.isnan(error) else error for error in found]  # not a number: another run has none there


def compared(
    first: Study, second: Study, told: Retold, path: tuple[str, ...], row: Quantity, one: Any, other: Any
) -> Difference:
    """A number of two runs."""
    turning = turns(first, path)
    unit = row.select_unit(turning)
    word = ".".join(path)
    if other is None:
        return Difference(f"{word} is missing", math.inf, 0.0, 0.0)
    wanted = told.value(np.asarray(one, dtype=float), path[-1], unit, row, turning)
    found = np.asarray(other, dtype=float)
    if wanted.shape != found.shape:
        return Difference(f"{word} {wanted.shape} {found.shape}", math.inf, 0.0, 0.0)
    off = np.abs(wanted - found)
    stated = sum(error_of(study, path, unit) * scale for study, scale in ((first, told.scale(unit)), (second, 1.0)))
    rounding = ROUNDING * max(first.magnitudes.by_unit.get(unit, 0.0) * told.scale(unit),
                              second.magnitudes.by_unit.get(unit, 0.0))  # fmt: skip
    return Difference(word, float(np.nanmax(off, initial=0.0)), stated, rounding)


def turns(study: Study, path: tuple[str, ...]) -> bool:
    """Whether a coordinate, drive, load or stop is about an axis."""
    spec, name = study.spec, path[1]
    for of in (spec.forces, spec.stops):
        if name in of:
            joint = getattr(of[name], "joint", None)
            return type(of[name]).__name__ == "Couple" if joint is None else turns(study, ("joints", joint))
    return name in spec.joints and spec.joints[name].kind not in ("slide", "line", "plane", "curve", "rod")


def error_of(study: Study, path: tuple[str, ...], unit: str) -> float:
    """The error that a run states of a number, in its unit; of energy at rest what the pose's makes of it."""
    known, estimate = study.magnitudes, study.results.accuracy["estimate"]
    moved = estimate["motion"] * known.size
    if unit in ("m", "rad"):
        return moved if unit == "m" else 2.0 * moved / shortest(study)
    kind = error_kind_of_path(path[0], ".".join(path[1:-1]), path[-1])
    if (kind, unit) in known.errors:
        return float(known.errors[kind, unit])
    if unit == "J":
        return moved * known.by_unit["N"] if "kinetic" not in path else 0.0
    kind = ESTIMATE_OF_ERROR_KIND.get(kind, kind)
    return float(estimate.get(kind, 0.0)) * largest_of(study, kind, unit)  # type: ignore[arg-type]


def shortest(study: Study) -> float:
    """How far the points of each body are from its centre, of the smallest body [m]."""
    bodies, points = study.results.bodies, study.results.points
    far = dict.fromkeys(bodies, 0.0)
    for name, point in points.items():
        body = name.partition(".")[0]
        if body in far:
            far[body] = max(far[body], float(np.linalg.norm(point["position"][0] - bodies[body]["center"][0])))
    return min((x for x in far.values() if x > 1e-9 * study.magnitudes.size), default=study.magnitudes.size)


TOLD_IN = {"reactions": "joints", "drives": "joints", "sections": "sections", "foundation": "foundation"}


def largest_of(study: Study, kind: str, unit: str) -> float:
    """What an estimate of a kind is relative to: its largest force or moment, one by the other times the size."""
    block, size = getattr(study.results, TOLD_IN.get(kind, "joints")), study.magnitudes.size
    if kind == "drives":
        return max(
            (float(np.nanmax(np.abs(joint.get("drive", 0.0)), initial=0.0)) for joint in block.values()), default=0.0
        )
    wrenches = [block, *block.get("elements", {}).values()] if kind == "foundation" else [*block.values()]
    F, M = (max((largest(w[part]) for w in wrenches), default=0.0) for part in ("force", "moment"))
    if kind == "foundation":
        size += max(largest(body["center"]) for body in study.results.bodies.values())
    return max(F, M / size) if unit == "N" else max(M, F * size)


def largest(vectors: Any) -> float:
    """The longest of vectors (..., 3)."""
    return float(np.nanmax(np.sqrt(np.sum(np.asarray(vectors, dtype=float) ** 2, axis=-1)), initial=0.0))
