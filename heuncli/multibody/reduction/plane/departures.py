"""What of a scene leaves a plane: nothing does if its motion is one along the plane, for all times.

A body that is not upright could leave the plane, but does not if the scene is its own mirror image in it: then so is
its motion, which is one alone. So all that moves, loads or strikes such a body must be its own image: points in the
plane, forces and velocities along it, couples and turns about its normal, and the plane principal for the body.
Coordinates that the mirror reverses keep their start values: nothing may drive, limit or name them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, JOINTS, NOT_AT_ALL
from heuncli.multibody.mechanism.model import BushingLoad, Joint, JointLoad, PairLoad, PointLoad, ThreadLoad
from heuncli.multibody.reduction.plane.departure import Departure, beside
from heuncli.multibody.reduction.plane.view import View
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression


def departures(seen: View) -> Iterator[Departure]:
    """All that leaves the plane."""
    yield from _joints(seen)
    yield from _paths(seen)
    height = None if all(seen.upright) else _height(seen)
    if height is not None:
        yield from _bodies(seen, height)
        yield from _held_in_plane(seen, height)
        yield from _loads(seen, height)
        yield from _blows(seen, height)
    yield from _still(seen)
    if seen.scene.mechanism.couplings:
        from heuncli.multibody.reduction.plane.coupled import leaving  # few scenes have them

        yield from leaving(seen, height)


def _height(seen: View) -> float:
    """Of the plane: the middle one of the heights of the centres and joints of the bodies that are not upright."""
    mechanism = seen.scene.mechanism
    loose = [i for i, stays in enumerate(seen.upright) if not stays]
    heights = [seen.height(i, mechanism.bodies[i].center) for i in loose]
    for joint in mechanism.joints:
        heights += [seen.height(b, p) for b, p in ((joint.a, joint.p), (joint.b, joint.q)) if not seen.stays(b)]
    return sorted(heights)[len(heights) // 2]


def _vector(what: str, off: float, size: float, unit: str, acts: bool = False) -> Iterator[Departure]:
    """What should have no part `off`, of `size`."""
    if off > tolerances.FLAT * size:
        yield Departure(f"{what} leaves it by {off:.1g} {unit}", off / size, acts)


def _joints(seen: View) -> Iterator[Departure]:
    """Axes that stand neither along the normal nor across it."""
    for joint, stance in zip(seen.scene.mechanism.joints, seen.stances, strict=True):
        key = JOINTS[joint.kind].axis_key
        yield from _vector(f"joints.{joint.name}.{key}", stance.off, 1.0, "(sine)")


def _paths(seen: View) -> Iterator[Departure]:
    """Paths that rise out of the plane, and rollers that run beside them out of it."""
    for joint in seen.scene.mechanism.joints:
        if joint.path is None:
            continue
        n = seen.normal_in(joint.a)
        rise = float(np.ptp(joint.path.track(joint.path.looked_at)[0] @ n))
        yield from _vector(f"the path of joints.{joint.name}", rise, seen.reach, "m")
        if joint.path.radius:
            off = joint.path.normal - (joint.path.normal @ n) * n
            yield from _vector(f"joints.{joint.name}.normal", float(np.sqrt(off @ off)), 1.0, "(sine)")


def _bodies(seen: View, height: float) -> Iterator[Departure]:
    """Gravity; centres, inertia and velocities of the bodies that are not upright."""
    mechanism, start, n = seen.scene.mechanism, seen.scene.start, seen.n
    g = mechanism.gravity
    yield from _vector("gravity", abs(float(g @ n)), float(np.sqrt(g @ g)), "m/s^2", True)
    v, omega = start.velocity, start.angular_velocity
    size = seen.scene.layout.size
    fastest = np.sqrt(max([np.abs(v).max() ** 2, (size * np.abs(omega).max()) ** 2, size * np.sqrt(g @ g)]))
    lent = {spin.body: spin.lent for spin in seen.scene.idle}
    for i, body in enumerate(mechanism.bodies):
        if seen.upright[i]:
            continue
        name = f"bodies.{body.name}"
        yield from beside(seen, height, i, body.center, f"{name}.center")
        J, own = body.inertia + lent.get(i, 0.0), seen.normal_in(i)
        across = J @ own - (own @ J @ own) * own
        yield from _vector(f"{name}: its inertia", float(np.sqrt(across @ across)), float(np.trace(J)), "kg m^2")
        turn = omega[i] - (omega[i] @ n) * n
        yield from _vector(f"{name}.velocity", abs(float(v[i] @ n)), fastest, "m/s")
        yield from _vector(f"{name}.angular_velocity", float(np.sqrt(turn @ turn)), fastest / size, "rad/s")


def _held_in_plane(seen: View, height: float) -> Iterator[Departure]:
    """Points about which a body that is not upright could tilt."""
    for joint, stance in zip(seen.scene.mechanism.joints, seen.stances, strict=True):
        turn = JOINTS[joint.kind].turn
        common = turn is NOT_AT_ALL or (turn is ABOUT_AXIS and stance.along)  # both bodies tilt as one
        if not common and not _all_stay(seen, joint):
            ends = ((joint.a, joint.p), (joint.b, joint.q))
            for end, point in ends if joint.path is None else ends[1:]:  # a path is where what runs along it is
                yield from beside(seen, height, end, point, f"the point of joints.{joint.name}")


def _all_stay(seen: View, joint: Joint) -> bool:
    return seen.stays(joint.a) and seen.stays(joint.b)


def _loads(seen: View, height: float) -> Iterator[Departure]:
    """Loads on bodies that are not upright."""
    mechanism = seen.scene.mechanism
    for load in mechanism.loads:
        name = f"forces.{load.name}"
        if isinstance(load, PointLoad):
            if seen.stays(load.body):
                continue
            if load.kind == "force" and load.point is not None:
                yield from beside(seen, height, load.body, load.point, f"the point of {name}")
            n = seen.normal_in(load.body, load.in_body)
            yield from _in_time(f"{name}.vector", load.vector, n, load.kind)
        elif isinstance(load, PairLoad):
            if load.a != load.b and not (seen.stays(load.a) and seen.stays(load.b)):
                for end, point in load.points:
                    yield from beside(seen, height, end, point, f"a point of {name}")
        elif isinstance(load, BushingLoad):
            yield from _bushing(seen, load, height)
        elif isinstance(load, ThreadLoad):
            yield Departure(f"couplings.{load.name} rubs along its axis", 1.0, True)
        elif not isinstance(load, JointLoad):
            yield Departure(f"couplings.{load.name} may run out of it", 1.0, True)
        elif load.kind == "turn_spring":
            if not seen.stances[load.joint].winds and not _all_stay(seen, mechanism.joints[load.joint]):
                yield Departure(f"{name} turns about an axis in it", 1.0, True)
        elif load.kind == "torque" and load.value is not None and load.value.constant != 0.0:
            joint = mechanism.joints[load.joint]
            turns = "turning" in JOINTS[joint.kind].motions
            if turns != seen.stances[load.joint].along and not _all_stay(seen, joint):
                yield Departure(f"{name} acts out of it", 1.0, True)


def _bushing(seen: View, load: BushingLoad, height: float) -> Iterator[Departure]:
    """A bushing between bodies that are not held in the plane: level, and one of its axes along the normal."""
    if load.a == load.b or (seen.stays(load.a) and seen.stays(load.b)):
        return
    name = f"forces.{load.name}"
    for end, point in load.points:
        yield from beside(seen, height, end, point, f"a point of {name}")
    along = [F.T @ seen.normal_in(end) for end, F in ((load.a, load.frame), (load.b, load.to_frame))]
    k = int(np.argmax(np.abs(along[0])))
    askew = float(np.abs(along[0] - along[1]).max() + np.abs(np.delete(along[0], k)).max())
    if askew > tolerances.FLAT:
        yield Departure(f"{name} has no axis along the normal", askew, True)
    shift, turn = (np.array([e.constant != 0.0 for e in part.given]) for part in (load.shift, load.turn))
    if shift[k] or np.delete(turn, k).any():
        yield Departure(f"{name} pushes out of it", 1.0, True)


def _in_time(what: str, vector: Sequence[Expression], n: Array, kind: str) -> Iterator[Departure]:
    """A force's part along the normal, a couple's parts across it: zero at all times."""
    constant = np.array([0.0 if e.constant is None else e.constant for e in vector])
    off = np.outer(n, n) if kind == "force" else np.eye(3) - np.outer(n, n)
    leaving = off @ constant
    unit = "N" if kind == "force" else "N m"
    yield from _vector(what, float(np.sqrt(leaving @ leaving)), float(np.sqrt(constant @ constant)), unit, True)
    for k, e in enumerate(vector):
        part = float(np.sqrt(np.sum(np.square(off[:, k]))))
        if e.constant is None and part > tolerances.FLAT:
            yield Departure(f"{what} varies along {'xyz'[k]}, {part:.1g} of which points out of it", part, True)


def _blows(seen: View, height: float) -> Iterator[Departure]:
    """Blows on bodies that are not upright, whenever they come."""
    for blow in seen.scene.mechanism.blows:
        if seen.stays(blow.body):
            continue
        name = f"impulses.{blow.name}"
        if blow.kind == "impulse" and blow.point is not None:
            yield from beside(seen, height, blow.body, blow.point, f"the point of {name}")
        n, h = seen.normal_in(blow.body, blow.in_body), blow.vector
        leaving = (h @ n) * n if blow.kind == "impulse" else h - (h @ n) * n
        off = float(np.sqrt(leaving @ leaving))
        at = f"{name} at t = {blow.time:.6g} s" if blow.when is None else name
        yield from _vector(at, off, float(np.sqrt(h @ h)), "N s", True)


def _still(seen: View) -> Iterator[Departure]:
    """What drives, limits or names a coordinate that keeps its start value in the plane."""
    mechanism = seen.scene.mechanism
    numbers = {joint.name: k for k, joint in enumerate(mechanism.joints)}
    for k, joint in enumerate(mechanism.joints):
        drive = joint.drive
        if drive is not None and drive.value.constant is None and seen.still(k, drive.quantity):
            yield Departure(f"drives.{drive.name} moves joints.{joint.name} out of it", 1.0, True)
    for stop in mechanism.stops:
        if seen.still(stop.joint, stop.quantity):
            yield Departure(f"{stop.path} limits a coordinate out of it", 1.0, True)
    base = {"rate": "angle", "speed": "travel"}
    for load in mechanism.loads:
        for name, quantity in dict.fromkeys(use for e in load.values for use in e.uses if use[0] in numbers):
            if seen.still(numbers[name], base.get(quantity, quantity)):
                yield Departure(f"forces.{load.name} names {name}.{quantity}, a coordinate out of it", 1.0, True)
