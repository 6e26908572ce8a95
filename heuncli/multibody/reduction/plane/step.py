"""Find the plane in which a scene stays: it moves as the flat scene in that plane does
(multibody/reduction/plane/mechanism.py).

Either the joints leave bodies only rotations about the normal and shifts across it, or bodies that could leave the
plane do not, because the scene is its own mirror image in it: then so is its motion, which is unique. So all that
moves, loads or strikes such a body must be its own image: points in the plane, forces and velocities along it, couples
and rotations about its normal, and the plane principal for the body. Coordinates that the mirror reverses keep their
start values: nothing may drive, limit or use them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import ABOUT_AXIS, JOINTS, NO_ROTATION
from heuncli.multibody.mechanism.loads import BushingLoad, JointLoad, PairLoad, PointLoad, ThreadLoad
from heuncli.multibody.mechanism.model import Joint
from heuncli.multibody.reduction.compose import Reduction
from heuncli.multibody.reduction.plane.mechanism import UnrepresentableLoadError, make_flat_scene
from heuncli.multibody.reduction.plane.plane_states import PlaneStateMap
from heuncli.multibody.reduction.plane.view import (
    Departure,
    PlaneView,
    find_neighbours,
    height_departures,
    iter_normals,
    make_view,
)
from heuncli.multibody.tree.prepare import PreparedScene
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import Expression

MAX_LISTED = 3  # departures from a plane: a scene with more large ones is not expected to be flat


def step(scene: PreparedScene) -> Reduction | tuple[str, ...]:
    """Return the flat scene, or sentences on what keeps it from being flat where that is little; nothing for a scene in
    space.
    """
    nearest: tuple[PlaneView, list[Departure]] | None = None
    joint_neighbours = find_neighbours(scene)
    for n in iter_normals(scene):
        plane_view = make_view(scene, n, joint_neighbours)
        leaving = list(islice(iter_departures(plane_view), MAX_LISTED + 1))
        if not leaving:
            return _make_reduction(plane_view)
        if nearest is None or _severity(nearest[1]) > _severity(leaving):
            nearest = plane_view, leaving
    if nearest is None:
        return ()
    plane_view, leaving = nearest
    leaving = leaving if _is_nearly_flat(leaving) else _coupling_departures(plane_view)
    if not leaving:
        return ()
    what = "; ".join(departure.what for departure in leaving[:MAX_LISTED])
    more = " and more" if len(leaving) > MAX_LISTED else ""
    return (f"not solved in the plane normal to {_format_normal(plane_view)}: {what}{more}",)


def _severity(leaving: list[Departure]) -> tuple[int, float]:
    return len(leaving), max(departure.size for departure in leaving)


def _is_nearly_flat(leaving: list[Departure]) -> bool:
    """Return whether a reader might expect the scene to be flat: one load or drive leaves the plane, or all departures
    are small.
    """
    return (len(leaving) == 1 and leaving[0].acts) or all(
        departure.size < tolerances.NEARLY_FLAT for departure in leaving
    )


def _coupling_departures(plane_view: PlaneView) -> list[Departure]:
    """Return the coordinates out of the plane that couplings contain, if all joints are along the normal or across
    it.
    """
    if not plane_view.scene.mechanism.couplings or any(
        stance.misalignment > tolerances.FLAT for stance in plane_view.orientations
    ):
        return []
    from heuncli.multibody.reduction.plane.mechanism import iter_coupling_departures  # few scenes have them

    return list(iter_coupling_departures(plane_view, None))


def _make_reduction(plane_view: PlaneView) -> Reduction | tuple[str, ...]:
    try:
        flat = make_flat_scene(plane_view)
    except UnrepresentableLoadError as missing:
        return (f"not solved in the plane normal to {_format_normal(plane_view)}: {missing}",)
    states = PlaneStateMap(plane_view, flat)
    where = f"solved in the plane normal to {_format_normal(plane_view)}: "
    if all(plane_view.upright):
        reason = "the joints allow only rotations about that direction and displacements perpendicular to it"
        return Reduction(flat, states.embed, states.restrict, (where + reason,))
    reason = "model and motion are symmetric about this plane; stability out of the plane is not considered"
    hidden = "stability of the planar motion against out-of-plane disturbances: the solved model cannot leave the plane"
    return Reduction(flat, states.embed, states.restrict, (where + reason,), (hidden,))


def _format_normal(plane_view: PlaneView) -> str:
    """Format the normal."""
    n = plane_view.n
    for k, name in enumerate("xyz"):
        if np.count_nonzero(n) == 1 and n[k] != 0.0:
            return name
    return "({})".format(", ".join(f"{0.0 if abs(x) <= tolerances.FLAT else x:.6g}" for x in n))


def iter_departures(plane_view: PlaneView) -> Iterator[Departure]:
    """Yield all that leaves the plane."""
    yield from _joint_departures(plane_view)
    yield from _path_departures(plane_view)
    height = None if all(plane_view.upright) else _plane_height(plane_view)
    if height is not None:
        yield from _body_departures(plane_view, height)
        yield from _hinge_departures(plane_view, height)
        yield from _load_departures(plane_view, height)
        yield from _impulse_departures(plane_view, height)
    yield from _fixed_coordinate_departures(plane_view)
    if plane_view.scene.mechanism.couplings:
        from heuncli.multibody.reduction.plane.mechanism import iter_coupling_departures  # few scenes have them

        yield from iter_coupling_departures(plane_view, height)


def _plane_height(plane_view: PlaneView) -> float:
    """Height of the plane: the median of the heights of the centres and joints of the bodies that are not upright."""
    mechanism = plane_view.scene.mechanism
    tiltable = [i for i, is_upright in enumerate(plane_view.upright) if not is_upright]
    heights = [plane_view.point_height(i, mechanism.bodies[i].center) for i in tiltable]
    for joint in mechanism.joints:
        heights += [
            plane_view.point_height(b, p)
            for b, p in ((joint.a, joint.p), (joint.b, joint.q))
            if not plane_view.is_upright(b)
        ]
    return sorted(heights)[len(heights) // 2]


def _vector_departures(what: str, component: float, size: float, unit: str, acts: bool = False) -> Iterator[Departure]:
    """Yield a departure if a vector of length `size` has a nonzero `component` out of the plane."""
    if component > tolerances.FLAT * size:
        yield Departure(f"{what} has an out-of-plane component of {component:.1g} {unit}", component / size, acts)


def _joint_departures(plane_view: PlaneView) -> Iterator[Departure]:
    """Yield axes that are neither along the normal nor perpendicular to it."""
    for joint, stance in zip(plane_view.scene.mechanism.joints, plane_view.orientations, strict=True):
        key = JOINTS[joint.kind].axis_key
        yield from _vector_departures(f"joints.{joint.name}.{key}", stance.misalignment, 1.0, "(sine)")


def _path_departures(plane_view: PlaneView) -> Iterator[Departure]:
    """Yield paths that rise out of the plane, and rollers whose axes are not normal to it."""
    for joint in plane_view.scene.mechanism.joints:
        if joint.path is None:
            continue
        n = plane_view.normal_components(joint.a)
        rise = float(np.ptp(joint.path.evaluate_track(joint.path.sample_parameters)[0] @ n))
        yield from _vector_departures(f"the path of joints.{joint.name}", rise, plane_view.reach, "m")
        if joint.path.radius:
            tilt = joint.path.normal - (joint.path.normal @ n) * n
            yield from _vector_departures(f"joints.{joint.name}.normal", float(np.sqrt(tilt @ tilt)), 1.0, "(sine)")


def _body_departures(plane_view: PlaneView, height: float) -> Iterator[Departure]:
    """Yield gravity, and centres, inertia and velocities of the bodies that are not upright."""
    mechanism, start, n = plane_view.scene.mechanism, plane_view.scene.start, plane_view.n
    g = mechanism.gravity
    yield from _vector_departures("gravity", abs(float(g @ n)), float(np.sqrt(g @ g)), "m/s^2", True)
    v, omega = start.velocity, start.angular_velocity
    size = plane_view.scene.layout.size
    fastest = np.sqrt(max([np.abs(v).max() ** 2, (size * np.abs(omega).max()) ** 2, size * np.sqrt(g @ g)]))
    artificial_inertia = {spin.body: spin.artificial_inertia for spin in plane_view.scene.idle_spins}
    for i, body in enumerate(mechanism.bodies):
        if plane_view.upright[i]:
            continue
        name = f"bodies.{body.name}"
        yield from height_departures(plane_view, height, i, body.center, f"{name}.center")
        J, body_normal = body.inertia + artificial_inertia.get(i, 0.0), plane_view.normal_components(i)
        across = J @ body_normal - (body_normal @ J @ body_normal) * body_normal
        yield from _vector_departures(
            f"{name}: its inertia", float(np.sqrt(across @ across)), float(np.trace(J)), "kg m^2"
        )
        turn = omega[i] - (omega[i] @ n) * n
        yield from _vector_departures(f"{name}.velocity", abs(float(v[i] @ n)), fastest, "m/s")
        yield from _vector_departures(f"{name}.angular_velocity", float(np.sqrt(turn @ turn)), fastest / size, "rad/s")


def _hinge_departures(plane_view: PlaneView, height: float) -> Iterator[Departure]:
    """Yield points about which a body that is not upright could tilt."""
    for joint, stance in zip(plane_view.scene.mechanism.joints, plane_view.orientations, strict=True):
        turn = JOINTS[joint.kind].turn
        common = turn is NO_ROTATION or (turn is ABOUT_AXIS and stance.is_normal)  # both bodies tilt as one
        if not common and not _cannot_tilt(plane_view, joint):
            ends = ((joint.a, joint.p), (joint.b, joint.q))
            for end, point in ends if joint.path is None else ends[1:]:  # a path is where what runs along it is
                yield from height_departures(plane_view, height, end, point, f"the point of joints.{joint.name}")


def _cannot_tilt(plane_view: PlaneView, joint: Joint) -> bool:
    return plane_view.is_upright(joint.a) and plane_view.is_upright(joint.b)


def _load_departures(plane_view: PlaneView, height: float) -> Iterator[Departure]:
    """Yield loads on bodies that are not upright."""
    mechanism = plane_view.scene.mechanism
    for load in mechanism.loads:
        name = f"forces.{load.name}"
        if isinstance(load, PointLoad):
            if plane_view.is_upright(load.body):
                continue
            if not load.is_couple and load.point is not None:
                yield from height_departures(plane_view, height, load.body, load.point, f"the point of {name}")
            n = plane_view.normal_components(load.body, load.in_body)
            yield from _component_departures(f"{name}.vector", load.vector, n, load.kind)
        elif isinstance(load, PairLoad):
            if load.a != load.b and not (plane_view.is_upright(load.a) and plane_view.is_upright(load.b)):
                for end, point in load.points:
                    yield from height_departures(plane_view, height, end, point, f"a point of {name}")
        elif isinstance(load, BushingLoad):
            yield from _bushing_departures(plane_view, load, height)
        elif isinstance(load, ThreadLoad):
            yield Departure(f"couplings.{load.name} has friction along its axis", 1.0, True)
        elif not isinstance(load, JointLoad):
            yield Departure(f"couplings.{load.name} may leave the plane", 1.0, True)
        elif load.row.has_potential:
            if not plane_view.orientations[load.joint].turns_in_plane and not _cannot_tilt(
                plane_view, mechanism.joints[load.joint]
            ):
                yield Departure(f"{name} acts about an axis in the plane", 1.0, True)
        elif not load.row.opposed_motion and load.value is not None and load.value.constant != 0.0:
            joint = mechanism.joints[load.joint]
            turns = "turning" in JOINTS[joint.kind].motions
            if turns != plane_view.orientations[load.joint].is_normal and not _cannot_tilt(plane_view, joint):
                yield Departure(f"{name} acts out of the plane", 1.0, True)


def _bushing_departures(plane_view: PlaneView, load: BushingLoad, height: float) -> Iterator[Departure]:
    """Yield departures of a bushing between bodies that could tilt: it must be level, with one axis along the
    normal.
    """
    if load.a == load.b or (plane_view.is_upright(load.a) and plane_view.is_upright(load.b)):
        return
    name = f"forces.{load.name}"
    for end, point in load.points:
        yield from height_departures(plane_view, height, end, point, f"a point of {name}")
    along = [F.T @ plane_view.normal_components(end) for end, F in ((load.a, load.frame), (load.b, load.to_frame))]
    k = int(np.argmax(np.abs(along[0])))
    misalignment = float(np.abs(along[0] - along[1]).max() + np.abs(np.delete(along[0], k)).max())
    if misalignment > tolerances.FLAT:
        yield Departure(f"{name} has no axis along the plane normal", misalignment, True)
    shift, turn = (np.array([e.constant != 0.0 for e in part.extra_load]) for part in (load.shift, load.turn))
    if shift[k] or np.delete(turn, k).any():
        yield Departure(f"{name} has an out-of-plane load", 1.0, True)
    in_plane = np.concatenate((np.arange(3) != k, np.arange(3) == k))
    for blocks in ((load.shift.stiffness, load.turn.stiffness, load.coupling),
                   (load.shift.damping, load.turn.damping, load.coupling_damping)):  # fmt: skip
        shift_block, turn_block, coupling = blocks
        whole = np.block([[shift_block, coupling], [coupling.T, turn_block]])
        if whole[np.ix_(in_plane, ~in_plane)].any():
            yield Departure(f"{name} couples the plane with other directions", 1.0, True)
            return


def _component_departures(what: str, vector: Sequence[Expression], n: Array, kind: str) -> Iterator[Departure]:
    """Yield the component of a force along the normal, or of a couple across it, unless it is zero at all times."""
    constant = np.array([0.0 if e.constant is None else e.constant for e in vector])
    projection = np.outer(n, n) if kind == "force" else np.eye(3) - np.outer(n, n)
    out_of_plane = projection @ constant
    unit = "N" if kind == "force" else "N m"
    yield from _vector_departures(
        what, float(np.sqrt(out_of_plane @ out_of_plane)), float(np.sqrt(constant @ constant)), unit, True
    )
    for k, e in enumerate(vector):
        part = float(np.sqrt(np.sum(np.square(projection[:, k]))))
        if e.constant is None and part > tolerances.FLAT:
            yield Departure(f"{what} varies along {'xyz'[k]}, of which {part:.1g} points out of the plane", part, True)


def _impulse_departures(plane_view: PlaneView, height: float) -> Iterator[Departure]:
    """Yield impulses on bodies that are not upright, whenever they occur."""
    for impulse in plane_view.scene.mechanism.impulses:
        if plane_view.is_upright(impulse.body):
            continue
        name = f"impulses.{impulse.name}"
        if impulse.kind == "impulse" and impulse.point is not None:
            yield from height_departures(plane_view, height, impulse.body, impulse.point, f"the point of {name}")
        n, h = plane_view.normal_components(impulse.body, impulse.in_body), impulse.vector
        out_of_plane = (h @ n) * n if impulse.kind == "impulse" else h - (h @ n) * n
        size = float(np.sqrt(out_of_plane @ out_of_plane))
        description = f"{name} at t = {impulse.time:.6g} s" if impulse.when is None else name
        yield from _vector_departures(description, size, float(np.sqrt(h @ h)), "N s", True)


def _fixed_coordinate_departures(plane_view: PlaneView) -> Iterator[Departure]:
    """Yield what drives, limits or uses a coordinate that keeps its start value in the plane."""
    mechanism = plane_view.scene.mechanism
    numbers = {joint.name: k for k, joint in enumerate(mechanism.joints)}
    for k, joint in enumerate(mechanism.joints):
        drive = joint.drive
        if drive is not None and drive.value.constant is None and plane_view.is_fixed_coordinate(k, drive.quantity):
            yield Departure(f"drives.{drive.name} moves joints.{joint.name} out of the plane", 1.0, True)
    for stop in mechanism.stops:
        if plane_view.is_fixed_coordinate(stop.joint, stop.quantity):
            yield Departure(f"{stop.path} limits an out-of-plane coordinate", 1.0, True)
    for friction in mechanism.iter_sticking():
        if friction.joint >= 0 and plane_view.is_fixed_coordinate(friction.joint, friction.quantity):
            yield Departure(f"{friction.load.path} holds an out-of-plane coordinate", 1.0, True)
    base = {"rate": "angle", "speed": "travel"}
    for load in mechanism.loads:
        for name, quantity in dict.fromkeys(use for e in load.values for use in e.uses if use[0] in numbers):
            if plane_view.is_fixed_coordinate(numbers[name], base.get(quantity, quantity)):
                yield Departure(f"forces.{load.name} uses {name}.{quantity}, an out-of-plane coordinate", 1.0, True)
