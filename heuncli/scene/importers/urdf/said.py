"""A judged robot in the words of a spec: links as bodies and points, joints held by drives at their parameters."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from heuncli.base.errors import Problem, SpecError
from heuncli.base.nearest import listed
from heuncli.base.records import record
from heuncli.scene.file_format.models import Vec
from heuncli.scene.importers.asked import ImportAsked
from heuncli.scene.importers.attitudes import after, of_roll_pitch_yaw, shifted, turned, turned_tensor
from heuncli.scene.importers.described import LEFT_OUT, DescribedBody, DescribedEntry, DescribedMachine
from heuncli.scene.importers.names import called, names_of
from heuncli.scene.importers.urdf.carriers import GROUND, PlacedLink
from heuncli.scene.importers.urdf.coordinates import RobotCoordinates
from heuncli.scene.importers.urdf.document import Robot
from heuncli.scene.importers.urdf.fields import UrdfFields
from heuncli.scene.importers.urdf.links import Linked, links_of
from heuncli.scene.importers.urdf.masses import LinkMass
from heuncli.scene.importers.urdf.points import RobotPoints
from heuncli.scene.importers.urdf.tree import LinkTree

GRAVITY: Vec = (0.0, 0.0, -9.81)  # URDF has none; z is up in ROS
# What shifts in a plane fits it upside down, too: its attitude is held, not looked for. So no joint may turn the plane.
AS_DRAWN = {"axis": (0.0, 0.0, 1.0), "angle": "0 deg"}


@record
class JudgedRobot:
    """A robot in which all is as it must be: masses and shapes of its bodies, and where its links are."""

    robot: Robot
    tree: LinkTree
    masses: dict[str, LinkMass]
    shapes: dict[str, tuple[str, tuple[DescribedEntry, ...]]]
    placed: dict[str, PlacedLink]
    grounded: bool


def said(judged: JudgedRobot, asked: ImportAsked, fields: UrdfFields, sha256: str) -> DescribedMachine:
    """The machine. Raises SpecError where what was asked for does not go together with the file."""
    carriers = [link.name for link in judged.tree.links if judged.placed[link.name].carrier == link.name]
    bodies = dict(zip(carriers, names_of("link", carriers), strict=True))
    points = RobotPoints()
    linked = [*links_of(judged.tree, judged.placed, judged.grounded, points)]
    points.name_all(bodies)
    names = names_of("joint", [one.wanted for one in linked])
    coordinates = RobotCoordinates(linked, names, judged.tree.followed, asked, fields)
    _require_planes_that_stay(judged, fields)
    if fields.problems:
        raise SpecError(*fields.problems)
    starts = _starts(judged)
    return DescribedMachine(
        title=judged.robot.title,
        form="URDF",
        file=fields.file,
        sha256=sha256,
        gravity=GRAVITY,
        bodies=tuple(_body(judged, name, bodies[name], points, starts.get(name, {})) for name in carriers),
        ground=points.of(GROUND),
        parameters=tuple(coordinates.parameters),
        joints=tuple(
            _joint(one, name, points, coordinates.initial.get(name, {}))
            for one, name in zip(linked, names, strict=True)
        ),
        drives=tuple(coordinates.drives),
        forces=tuple(coordinates.dampers),
        stops=tuple(coordinates.stops),
        couplings=tuple(coordinates.couplings),
        told=(*_told(judged, fields), *coordinates.told),
        remarks={"gravity": "URDF has none; z is up", "parameters": "where the joints stand"},
        left_out=(*fields.left_out, *coordinates.left_out, *_undamped(judged, fields)),
    )


def _body(judged: JudgedRobot, link: str, name: str, points: RobotPoints, start: dict[str, Any]) -> DescribedBody:
    R, remark = judged.placed[link].R, called("link", name, link)
    mass = judged.masses.get(link)
    if mass is None:
        source, shapes = judged.shapes[link]
        notes = {"shapes": f"of the {source} elements" + (": what overlaps counts twice" if len(shapes) > 1 else "")}
        return DescribedBody(name, None, None, None, points.of(link), shapes, start, remark, notes)
    inertia = turned_tensor(after(R, of_roll_pitch_yaw(mass.rpy)), mass.inertia)
    center = turned(R, mass.center)
    return DescribedBody(name, mass.mass, center, inertia, points.of(link), (), start, remark, mass.notes)


def _joint(one: Linked, name: str, points: RobotPoints, initial: dict[str, Any]) -> DescribedEntry:
    keys = {"type": one.type, "from": points.end(one.from_), "to": points.end(one.to), **one.keys}
    renamed = one.joint is not None and name != one.wanted
    remarks = (f'joint "{one.joint.name}"' if renamed and one.joint is not None else "", *one.remarks)
    return DescribedEntry(name, keys | ({"initial": initial} if initial else {}), "; ".join(filter(None, remarks)))


def _starts(judged: JudgedRobot) -> dict[str, dict[str, Any]]:
    """Where bodies start that no joint places: what floats, and what shifts in a plane."""
    found: dict[str, dict[str, Any]] = {}
    for link in judged.tree.links:
        joint, own = judged.tree.above.get(link.name), judged.placed[link.name]
        x, y, z = own.offset
        origin = shifted(own.origin, (-x, -y, -z))  # of the body that carries it
        if (joint is None and not judged.grounded) or (joint is not None and joint.kind == "floating"):
            found[own.carrier] = {"position": origin}
        elif joint is not None and joint.kind == "planar":
            found[own.carrier] = {"orientation": AS_DRAWN, "near": {"position": origin}}
    return found


def _require_planes_that_stay(judged: JudgedRobot, fields: UrdfFields) -> None:
    """Refuse a planar joint whose plane another joint turns: what starts in it would have to turn with it."""
    above = judged.tree.above
    for joint in above.values():
        before = above.get(joint.parent) if joint.kind == "planar" else None
        while before is not None and before.kind in ("fixed", "prismatic"):
            before = above.get(before.parent)
        if before is not None and before.kind in ("revolute", "continuous"):
            message = f"a planar joint behind {before.name}, which turns its plane, has no counterpart yet"
            hint = "two prismatic joints and a revolute one say the same"
            fields.report("import-joint", joint.element, joint.path, message, hint)


def _undamped(judged: JudgedRobot, fields: UrdfFields) -> Iterator[Problem]:
    """Damping and friction in joints that have no one coordinate to resist."""
    for joint in judged.tree.above.values():
        if joint.movable and not joint.single and (joint.damping or joint.friction):
            message = f"the damping and friction of a joint of type {joint.kind} are not taken over"
            hint = "a force of type damper resists in a plane, a couple in time what floats"
            yield fields.problem(LEFT_OUT, joint.element, joint.path, message, hint)


def _told(judged: JudgedRobot, fields: UrdfFields) -> Iterator[str]:
    """What holds for the whole of it."""
    root = judged.tree.root.name
    if not judged.grounded:
        yield f'The root, link "{root}", is free; without --base free it stands on the ground.'
    elif judged.placed[root].carrier == GROUND:
        yield f'The root, link "{root}", is the ground.'
    else:
        yield f'The root, link "{root}", stands on the ground by a weld, whose load is told as that of a joint.'
    floating = [link.name for link in judged.tree.links if _kind(judged, link.name) == "floating"]
    if floating:
        yield f"Free by joints of type floating: {listed(floating)}."
    if fields.nearly_right:
        what = "taken for right angles (--repair right-angles)" if fields.to_right else "kept as they are"
        yield f"Angles like 1.5708, nearly right ones, are {what}: {listed(fields.nearly_right)}."
    for link in fields.emptied:
        yield f'Repaired (massless): the link "{link}" has the mass 0; its inertia is left out.'
    if judged.robot.silent:
        counts = ", ".join(f"{count} {tag}" for tag, count in judged.robot.silent.items())
        yield f"Not taken over, as it says nothing of the mechanics: {counts}."


def _kind(judged: JudgedRobot, link: str) -> str:
    joint = judged.tree.above.get(link)
    return "" if joint is None else joint.kind
