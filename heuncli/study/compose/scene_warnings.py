"""Warn of what a reader of a state or of an impulse should check: accelerated bodies, belts, wheels and threads.

Bodies that the loads of a state accelerate may miss a cylinder or a support. This is checked only where everything
stands still, or where drives alone turn at constant rates and nothing moves against the bodies they carry. Belts,
wheels and threads are watched by events of a motion, which cover neither the instant of a state nor impulses.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from heuncli.base import tolerances
from heuncli.loads.kinetostatics.balance import inertia_scale
from heuncli.multibody.mechanism.loads import GROUND
from heuncli.results.results import Array
from heuncli.scene.file_format.couplings import Belt, RollingWheel, Screw
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.resolve_couplings import SLACK_BELT_MESSAGE, format_rounded_up
from heuncli.study.compose.recovery import Recovery

if TYPE_CHECKING:  # a state has no impulses
    from heuncli.study.compose.impulses import Impulses

MAX_NAMED = 3  # bodies that are named
UNITS = {"angle": "rad/s\u00b2", "travel": "m/s\u00b2"}
HINT = "not at rest; analysis: {type: rest} finds the rest position"


def describe_accelerations(recovery: Recovery) -> list[str]:
    """Return a sentence on a state that its loads set in motion; recovery: of one instant."""
    setup = recovery.setup
    if setup.spec.analysis.type != "state" or not setup.model["freedoms"]:
        return []
    mechanism, states = setup.scene.mechanism, recovery.states
    t = float(recovery.solutions.times[0])
    jets = [law.value.derivatives(t) for law in mechanism.laws]
    if any(second != 0.0 for _, _, second in jets):
        return []
    speed = np.abs(states.v_centre[0]).max() / setup.scene.layout.size + np.abs(states.omega[0]).max()
    if any(rate != 0.0 for _, rate, _ in jets):
        found = list_accelerated_coordinates(recovery)
    else:
        found = list_accelerated_bodies(recovery) if speed <= tolerances.AT_REST else []
    if not found:
        return []
    more = f" and {len(found) - MAX_NAMED} more" if len(found) > MAX_NAMED else ""
    return [f"{', '.join(found[:MAX_NAMED])}{more}: {HINT}"]


def list_accelerated_bodies(recovery: Recovery) -> list[str]:
    """List the bodies that are accelerated from rest, the fastest first: of the centre of mass, or turning."""
    mechanism, states = recovery.setup.scene.mechanism, recovery.states
    mass = mechanism.scale_masses
    radius = np.sqrt(np.array([np.trace(b.inertia) for b in mechanism.bodies]) / mass)
    shift, turn = (np.sqrt(np.sum(a[0] ** 2, axis=1)) for a in (states.a_centre, states.alpha))
    fastest = np.maximum(shift, turn * radius)
    is_accelerated = fastest > tolerances.STARTS_MOVING * load_scale(recovery) / mass
    return [
        f"{mechanism.bodies[i].name} " + (f"{shift[i]:.3g} m/s\u00b2" if shift[i] >= turn[i] * radius[i]
                                          else f"{turn[i]:.3g} rad/s\u00b2")
        for i in np.argsort(-fastest, kind="stable").tolist()
        if is_accelerated[i]
    ]  # fmt: skip


def list_accelerated_coordinates(recovery: Recovery) -> list[str]:
    """List the coordinates that are accelerated where only drives move, at constant rates."""
    layout = recovery.setup.scene.layout
    freedom_rows = recovery.solutions.freedoms[0]
    size = layout.size
    free_freedoms = [(f, row) for f, row in zip(layout.freedoms, freedom_rows, strict=True) if f.q >= 0]
    levers = [size if f.quantity == "angle" else 1.0 for f, _ in free_freedoms]
    if layout.bodies["ball"].any() or any(f.joint < 0 or f.quantity not in UNITS for f, _ in free_freedoms):
        return []  # a body that is free in space has no rate relative to a drive
    if any(
        abs(row["u"]) * lever > tolerances.AT_REST * size for (_, row), lever in zip(free_freedoms, levers, strict=True)
    ):
        return []
    least = tolerances.STARTS_MOVING * float((load_scale(recovery) / layout.mechanism.scale_masses).max())
    found = [
        (abs(row["udot"]) * lever, f, abs(row["udot"])) for (f, row), lever in zip(free_freedoms, levers, strict=True)
    ]
    return [
        f"{layout.mechanism.joints[f.joint].name}.{f.quantity} {a:.3g} {UNITS[f.quantity]}"
        for size_rate, f, a in sorted(found, key=lambda one: -one[0])
        if size_rate > least
    ]


def load_scale(recovery: Recovery) -> Array:
    """The largest load on each body, including its weight and inertia loads, (n,) [N]; moments are divided by the
    scene's size.
    """
    setup = recovery.setup
    largest: Array = inertia_scale(setup.scene.mechanism, recovery.states)[0]
    for action in recovery.actions:
        for end, F, M in action.iter_ends():
            if end.body != GROUND:
                size = max(float(np.abs(F[0]).max()), float(np.abs(M[0]).max()) / setup.scene.layout.size)
                largest[end.body] = max(largest[end.body], size)
    return largest


PUSHED_AT_IMPULSE = (
    "in the impulse at t = {:.6g} s the belt {} would have to push: no pretension withstands an impulse, and the force "
    "with which the belt then pulls its pulleys together is not computed"
)


def warn_of_belts_at_instant(spec: Spec, couplings: Mapping[str, Any], largest: float) -> Iterator[str]:
    """Warn of the belts that push at the single instant of a state; couplings: their block, largest: force of all
    [N].
    """
    for name, belt in find_belts(spec).items():
        slack = float(couplings[name]["slack"][0]) if name in couplings else 0.0
        if slack < -tolerances.NO_FORCE * largest:
            yield SLACK_BELT_MESSAGE.format(name, format_rounded_up(belt.pretension - slack))


def warn_of_belts_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the belts that take part in impulses, which no pretension withstands."""
    couplings, limit = impulses.all_blocks["couplings"], -tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_belts(spec):
            if couplings[name]["slack"][k] < limit:
                yield PUSHED_AT_IMPULSE.format(jump.reported_time, name)


def find_belts(spec: Spec) -> dict[str, Belt]:
    """Return the belts of a scene."""
    return {name: own for name, own in spec.couplings.items() if isinstance(own, Belt)}


LIFTS = "the wheel {} would have to be pulled onto its plane: it lifts off"
SLIPS = "the wheel {} would need more friction than available: it slips"


def warn_of_wheels_at_instant(spec: Spec, couplings: Mapping[str, Any]) -> Iterator[str]:
    """Warn of wheels that lift or slip at the single instant; couplings: their block."""
    for name, wheel in spec.rolling.items():
        if name in couplings:
            yield from (sentence.format(name) for sentence in iter_problems(wheel, couplings[name], 0))


def warn_of_wheels_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of wheels that would lift or slip at each impulse."""
    wheels = spec.rolling
    couplings = impulses.all_blocks["couplings"] if wheels else {}
    for k, jump in enumerate(impulses.jumps):
        for name, wheel in wheels.items():
            for sentence in iter_problems(wheel, couplings[name], k):
                yield f"in the impulse at t = {jump.reported_time:.6g} s {sentence.format(name)}"


def iter_problems(wheel: RollingWheel, block: Mapping[str, Any], k: int) -> Iterator[str]:
    """Yield the problems at instant k: a negative normal force, or more friction than the normal force allows."""
    limit = -tolerances.NO_FORCE * np.nan_to_num(block["force"][k])
    if not wheel.held and block["normal"][k] < limit:
        yield LIFTS
    elif wheel.friction is not None and block["grip"][k] < limit:
        yield SLIPS


FRICTIONLESS_AT_IMPULSE = (
    "the impulse at t = {:.6g} s passes the thread {} without friction: a self-locking thread would hold it, "
    "any other would take part of it"
)


def find_friction_threads(spec: Spec) -> list[str]:
    """Return the threads of a scene that have friction."""
    return [name for name, own in spec.couplings.items() if isinstance(own, Screw) and own.friction is not None]


def warn_of_threads_at_impulses(spec: Spec, impulses: Impulses) -> Iterator[str]:
    """Warn of the threads that take part in impulses."""
    couplings, limit = impulses.all_blocks["couplings"], tolerances.NO_FORCE * impulses.magnitudes_by_unit["N·s"]
    for k, jump in enumerate(impulses.jumps):
        for name in find_friction_threads(spec):
            if abs(couplings[name]["force"][k]) > limit:
                yield FRICTIONLESS_AT_IMPULSE.format(jump.reported_time, name)
