"""From the document as written to the scene as meant: references followed, forms made one, defaults filled in.

For documents in which no rule found an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.method_rows import canonical
from heuncli.base.records import record
from heuncli.scene.expressions.composed import product, renamed, total, with_factor, within
from heuncli.scene.expressions.grammar import Scope, compile_expression
from heuncli.scene.expressions.programs import LOADS, OWN, Expression, TableFunction
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_elastic as fe
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.couplings import Coupling
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.format_couplings import CouplingEntry
from heuncli.scene.file_format.format_rolling import RollingEntry
from heuncli.scene.file_format.motors import curve_of, rotors
from heuncli.scene.file_format.names import GROUND, UNTIL
from heuncli.scene.file_format.resolve_couplings import conditions_of_belts, conditions_of_wheels, meant, wheel_meant
from heuncli.scene.file_format.semantics import (
    body_axes,
    drive_of,
    end_of,
    held_of,
    instants_of,
    limits_of,
    point_in,
    tensor,
    type_of,
)
from heuncli.scene.file_format.turns import IDENTITY

if TYPE_CHECKING:
    from heuncli.scene.expressions.paths import Path
    from heuncli.scene.meshes.model import TriangleMesh

DEFAULT_TOLERANCE = 1e-9


@record
class Meaning:
    """What resolve needs beside the document."""

    path: str
    sha256: str
    parameters: Mapping[str, float]
    tables: Mapping[str, TableFunction]
    warnings: tuple[Problem, ...]
    locations: Mapping[str, SourceLocation]
    curves: Mapping[int, m.Curve]
    surfaces: Mapping[str, TriangleMesh]
    case: str | None


def resolve(document: f.Document, meaning: Meaning, by: Resolver | None = None) -> m.Spec:
    """The scene that a document without errors means; by: what follows the references, one of them by default."""
    r = by or Resolver(document, meaning.locations, meaning.curves, meaning.surfaces)
    joints = r.entries("joints", "joint")
    of_motors = rotors(document, joints, meaning.locations)
    return m.Spec(
        title=titled(document, meaning.case),
        path=meaning.path,
        sha256=meaning.sha256,
        space=document.head.space,
        parameters=meaning.parameters,
        gravity=document.head.gravity,
        ground=m.Ground(document.ground.points),
        bodies=r.entries("bodies", "body") | of_motors.bodies,
        joints=joints | of_motors.joints,
        drives=r.entries("drives", "drive"),
        forces=r.entries("forces", "force"),
        impulses=r.entries("impulses", "impulse"),
        stops=r.entries("stops", "stop"),
        couplings=r.entries("couplings", "coupling") | r.entries("rolling", "wheel") | of_motors.couplings,
        latches=r.entries("latches", "latch"),
        sections=r.entries("sections", "section"),
        tables=meaning.tables,
        analysis=r.single("analysis"),
        report=tuple(document.head.report) if document.head.report is not None else None,
        foundation=m.Foundation(r.about(document.foundation.about)),
        expect=tuple(r.entries("expect", "expect").values()),
        cases={name: case.title for name, case in document.cases.items()},
        case=meaning.case,
        warnings=meaning.warnings,
        locations={**meaning.locations, **of_motors.locations} if of_motors.locations else meaning.locations,
    )  # fmt: skip


def titled(document: f.Document, case: str | None) -> str:
    """The title of a scene, in a load case with that of the case."""
    if case is None:
        return document.head.title
    own = document.cases[case].title if case in document.cases else ""
    return f"{document.head.title} (case {case}{': ' if own else ''}{own})".strip()


class Resolver:
    """Follows the references of one document."""

    def __init__(
        self,
        document: f.Document,
        locations: Mapping[str, SourceLocation],
        curves: Mapping[int, m.Curve],
        surfaces: Mapping[str, TriangleMesh],
    ) -> None:
        self.document, self.locations, self.curves, self.surfaces = document, locations, curves, surfaces

    def entries(self, block: str, by: str) -> dict[Any, Any]:
        """What the entries of a block mean; by: the method that tells it of one."""
        made = getattr(self, by)
        return {name: made(name, entry) for name, entry in getattr(self.document, block).items()}

    def single(self, by: str) -> Any:
        """What the document as a whole means; by: the method that tells it."""
        return getattr(self, by)()

    def analysis(self) -> m.Analysis:
        analysis, kind = self.document.analysis, type_of(self.document)
        instants = instants_of(self.document)
        return m.Analysis(
            kind, instants, instants[-1] if kind == "motion" else None,
            analysis.tolerance if analysis.tolerance is not None else DEFAULT_TOLERANCE, canonical(analysis.method),
            analysis.step,
            (*self.conditions(analysis), *(self.brought() if kind == "motion" else ())),
            analysis.tolerance is not None,
            analysis.impacts,
        )  # fmt: skip

    def point(self, body: str, name: str) -> m.Vec:
        points = self.document.ground.points if body == GROUND else self.document.bodies[body].points
        return points[name]

    def end(self, end: EndEntry) -> m.End:
        if isinstance(end.at, str):
            return m.End(end.body, self.point(end.body, end.at), end.at)
        assert end.at is not None
        return m.End(end.body, end.at)

    def placed(self, value: Expression, path: str) -> Expression:
        location = self.locations.get(path)
        return value.at(location) if location is not None else value

    def vector(self, values: tuple[Expression, Expression, Expression], path: str, key: str = "vector") -> m.Vector:
        x, y, z = (self.placed(value, f"{path}.{key}.{i}") for i, value in enumerate(values))
        return x, y, z

    def shape(self, shape: fs.ShapeEntry) -> m.Shape:
        keys = (
            "mass",
            "density",
            "line_density",
            "from_",
            "to",
            "at",
            "center",
            "size",
            "radius",
            "inner_radius",
            "to_radius",
        )
        rotation = None
        if isinstance(shape, fs.BoxShape | fs.MeshShape):
            rotation = body_axes(shape.orientation) if shape.orientation is not None else IDENTITY
        meant = m.Shape(type=shape.type, rotation=rotation, **{key: getattr(shape, key, None) for key in keys})
        if not isinstance(shape, fs.MeshShape):
            return meant
        return meant._replace(
            at=shape.at or m.ZERO, scale=1.0 if shape.scale is None else shape.scale, mesh=self.surfaces[shape.file]
        )

    def piece(self, piece: f.PieceEntry | None) -> m.MassProperties | None:
        return m.MassProperties(piece.mass, piece.center, tensor(piece)) if piece is not None else None

    def body(self, name: str, body: f.BodyEntry) -> m.Body[m.Vec, m.Matrix]:
        near = body.near
        return m.Body(
            name=name,
            mass=body.mass if body.mass is not None else 0.0,
            center=body.center if body.center is not None else m.ZERO,
            inertia=tensor(body) if body.inertia is not None else (m.ZERO, m.ZERO, m.ZERO),
            points=body.points,
            position=body.position,
            rotation=body_axes(body.orientation) if body.orientation is not None else None,
            velocity=directed(body.velocity),
            angular_velocity=directed(body.angular_velocity),
            near_position=near.position if near is not None else None,
            near_rotation=body_axes(near.orientation) if near is not None and near.orientation else None,
            shapes=tuple(self.shape(shape) for shape in body.shapes) if body.shapes is not None else None,
        )

    def joint(self, name: str, joint: f.JointEntry) -> m.Joint[str, m.Vec]:
        a, b = self.end(joint.from_), self.end(joint.to)
        axis = getattr(joint, "axis", None) or getattr(joint, "normal", None) or m.Z
        to_axis = getattr(joint, "to_axis", None)
        initial = getattr(joint, "initial", None)
        return m.Joint(
            name=name,
            kind=joint.type,
            a=a.body,
            p=a.point,
            b=b.body,
            q=b.point,
            axis=axis,
            to_axis=to_axis if to_axis is not None else axis,
            to_axis_given=to_axis is not None,
            angle=getattr(initial, "angle", None),
            rate=getattr(initial, "rate", None),
            travel=getattr(initial, "travel", None),
            speed=getattr(initial, "speed", None),
            length=getattr(joint, "length", None),
            tension_only=getattr(joint, "tension_only", False),
            stiffness=stiffness(joint.stiffness),
            drive=None,
            restitution=getattr(joint, "restitution", None),
            bearing=area(getattr(joint, "bearing", None)),
            p_name=a.name,
            q_name=b.name,
            path=self.path(joint) if isinstance(joint, f.CurveJoint) else None,
            one_sided=getattr(joint, "one_sided", False),
        )

    def path(self, joint: f.CurveJoint) -> Path:
        """What the point of a curve runs along, or the centre of its roller beside."""
        from heuncli.scene.expressions.paths import (  # with NumPy, which a spec without one needs not
            path_beside,
            path_of,
        )

        found = path_of((joint.x, joint.y, joint.z))
        if joint.radius is None and not joint.one_sided:
            return found
        return path_beside(found, joint.radius or 0.0, joint.normal or (0.0, 0.0, 1.0))

    def drive(self, name: str, drive: f.DriveEntry) -> m.Drive:
        driven = drive_of(drive, self.document.joints[drive.joint].type)
        assert driven is not None
        value = self.placed(driven.value, f"drives.{name}.{driven.key}")
        return m.Drive(name, drive.joint, driven.quantity, value, drive.zero == "assembled", driven.by_rate)

    def force(self, name: str, load: f.LoadEntry) -> m.Force:
        path = f"forces.{name}"
        match load:
            case f.ForceEntry():
                return m.PointForce(self.end(load.on), self.vector(load.vector, path), load.frame)
            case f.CoupleEntry():
                on = self.end(load.on) if load.on.at is not None else None
                return m.Couple(load.on.body, on, self.vector(load.vector, path), load.frame)
            case f.TorqueEntry():
                return m.Torque(load.joint, self.placed(load.value, f"{path}.value"))
            case f.ActuatorEntry():
                return m.Actuator(self.end(load.from_), self.end(load.to), self.placed(load.value, f"{path}.value"))
            case f.SpringEntry():
                law = self.own(load.force, f"{path}.force", f"{LOADS}.{name}")
                numbers = load.stiffness or 0.0, load.length or 0.0, load.damping or 0.0
                return m.Spring(self.end(load.from_), self.end(load.to), *numbers, law)
            case f.TurnSpringEntry():
                law = self.own(load.torque, f"{path}.torque", load.joint)
                return m.TurnSpring(load.joint, load.stiffness or 0.0, load.angle or 0.0, load.damping or 0.0, law)
            case fe.BushingEntry():
                return self.bushing(name, load)
            case fe.MotorEntry():
                return self.motor(load, path)
            case f.DistributedEntry():
                return self.distributed(load, path)
            case f.DamperEntry():
                coefficient = constant(load.coefficient) if load.coefficient is not None else 0.0
                torque, force = (self.own(getattr(load, k), f"{path}.{k}", load.joint) for k in ("torque", "force"))
                return m.Damper(load.joint, coefficient, load.sliding, torque or force)
            case _:
                by_load = load.coefficient, load.radius, load.length
                torque, force = (
                    self.placed(value, f"{path}.{k}") if (value := getattr(load, k)) is not None else None
                    for k in ("torque", "force")
                )
                return m.Friction(load.joint, torque, force, constant(load.speed), *by_load)

    def own(self, law: Expression | None, path: str, owner: str) -> Expression | None:
        """A law of what a load itself acts between: of its line's length, or of its joint's coordinate."""
        if law is None:
            return None
        return renamed(self.placed(law, path), {use: (owner, use[1]) for use in law.uses if use[0] == OWN})

    def motor(self, load: fe.MotorEntry, path: str) -> m.Motor:
        """ratio * value * curve(ratio * rate), within the limit of the motor itself."""
        law = with_factor(self.placed(curve_of(load), f"{path}.curve"), (OWN, "rate"), load.ratio)
        law = within(law, load.limit) if load.limit is not None else law
        if load.value is not None:
            law = product(self.placed(load.value, f"{path}.value"), law)
        told = self.own(product(Expression.of(load.ratio), law), f"{path}.curve", load.joint)
        assert told is not None
        return m.Motor(load.joint, told)

    def bushing(self, name: str, load: fe.BushingEntry) -> m.Bushing:
        rotation = body_axes(load.orientation) if load.orientation is not None else IDENTITY
        to_rotation = body_axes(load.to_orientation) if load.to_orientation is not None else rotation
        shift = self.elastic(name, "shift", load.stiffness, load.damping, load.preload)
        turn = self.elastic(name, "turn", load.turning, load.turning_damping, load.turning_preload)
        return m.Bushing(self.end(load.from_), self.end(load.to), shift, turn, rotation, to_rotation)

    def elastic(self, name: str, of: str, stiffness: Any, damping: Any, preload: m.Vec | None) -> m.Elastic[m.Vec]:
        """The three springs of a bushing's shift or turn; what has no stiffness given is a table."""
        laws = self.storing(three(stiffness))
        preload = preload or m.ZERO
        given = [Expression.of(x) for x in preload]
        numbers = tuple(0.0 if isinstance(law, Expression) else law for law in laws)
        path = f"forces.{name}.{'stiffness' if of == 'shift' else 'turning'}"
        for i, law in enumerate(laws):
            if isinstance(law, Expression):
                placed = renamed(self.placed(law, path), {law.uses[0]: (f"{LOADS}.{name}", f"{of}_{'xyz'[i]}")})
                given[i] = total(given[i], placed)
        return m.Elastic((numbers[0], numbers[1], numbers[2]), three(damping), preload, (given[0], given[1], given[2]))

    def storing(self, laws: tuple[Any, Any, Any]) -> list[Any]:
        """Stiffnesses, those by a table with its areas; of one table for several axes they are found once."""
        if not any(isinstance(law, Expression) for law in laws):
            return list(laws)
        from heuncli.scene.expressions.areas import with_areas  # with NumPy, which a table has loaded

        own = {id(law): with_areas(law) for law in laws if isinstance(law, Expression)}
        return [own.get(id(law), law) for law in laws]

    def distributed(self, load: f.DistributedEntry, path: str) -> m.Distributed:
        body = self.document.bodies[load.on]
        start, end = point_in(body, load.from_), point_in(body, load.to)
        assert start is not None
        assert end is not None
        vector = self.vector(load.vector, path)
        to_vector = vector if load.to_vector is None else self.vector(load.to_vector, path, "to_vector")
        return m.Distributed(load.on, start, end, vector, to_vector, load.frame)

    def impulse(self, name: str, blow: f.ImpulseEntry) -> m.Blow[str, m.Vec]:
        body, point = blow.body, None
        if blow.on is not None:
            body, point = blow.on.body, self.end(blow.on).point if blow.on.at is not None else None
        assert body is not None
        in_body = blow.frame == "body"
        kind: Literal["impulse", "couple"] = "impulse" if blow.vector is not None else "couple"
        vector = blow.vector if blow.vector is not None else blow.couple
        assert vector is not None
        when = None
        if blow.when is not None:
            path = f"impulses.{name}"
            when = m.Condition(path, blow.when.source.strip(), False, self.placed(blow.when, f"{path}.when"))
        return m.Blow(name, body, point, vector, in_body, blow.time, kind, when, blow.every)

    def section(self, _: str, section: f.SectionEntry) -> m.Section:
        body = self.document.bodies[section.body]
        at, start, end = (point_in(body, at_or_name) for at_or_name in (section.at, section.from_, section.to))
        normal = section.normal
        if normal is None:
            assert start is not None
            assert end is not None
            normal = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
        point = end_of(section.reduce_to)
        reduce_to: Any = self.end(point) if point is not None else section.reduce_to
        return m.Section(
            body=section.body, normal=normal, at=at, from_=start, to=end, count=section.count or 1,
            first_axis=section.first_axis, reduce_to=reduce_to, side=section.side,
            properties=properties(section.properties), strength=section.strength,
            piece=self.piece(section.piece or (body.piece if at is not None else None)),
        )  # fmt: skip

    def about(self, about: object) -> m.Vec | None:
        if isinstance(about, str):
            return self.document.ground.points[about.rpartition(".")[2]]
        return about  # type: ignore[return-value]

    def conditions(self, analysis: f.AnalysisEntry) -> tuple[m.WatchedCondition, ...]:
        found = [(UNTIL, True, UNTIL, analysis.until)] if analysis.until is not None else []
        found += [(name, False, f"events.{name}", given) for name, given in analysis.events.items()]
        return tuple(self.condition(*row) for row in found)

    def brought(self) -> Iterator[m.ResultCondition]:
        """What entries bring with them to be watched for."""
        yield from conditions_of_wheels(self.document.rolling)
        yield from conditions_of_belts(self.document.couplings)

    def condition(
        self, name: str, ends: bool, path: str, given: Expression | f.ResultConditionEntry
    ) -> m.WatchedCondition:
        if isinstance(given, Expression):
            return m.Condition(name, given.source.strip(), ends, self.placed(given, f"analysis.{path}"))
        above = given.above is not None
        limit = given.above if given.above is not None else given.below
        assert limit is not None
        number = limit.source.strip() if limit.dimension is not None else f"{constant(limit):.9g}"
        text = f"{given.of} {'above' if above else 'below'} {number}"
        return m.ResultCondition(name, text, ends, given.of, constant(limit), above)

    def expect(self, i: int, item: f.ExpectEntry) -> m.Expect:
        location = self.locations.get(f"expect.{i}", SourceLocation("", 1, 1))
        return m.Expect(
            item.of, item.at, item.peak, numbers(item.is_), item.rel, numbers(item.abs), location,
            numbers(item.below), numbers(item.above), self.curves.get(i),
        )  # fmt: skip

    def wheel(self, name: str, given: RollingEntry) -> Coupling:
        return wheel_meant(self, given)

    def coupling(self, name: str, given: CouplingEntry) -> Coupling:
        return meant(self, name, given)

    def stop(self, name: str, given: f.StopEntry) -> m.Stop[str]:
        found = limits_of(given)
        assert found is not None
        quantity, (low, high) = found
        return m.Stop(name, given.joint, quantity, low, high, given.restitution)

    def latch(self, name: str, given: f.LatchEntry) -> m.Stop[str]:
        held = held_of(given, self.document)
        assert held is not None
        passes = None
        if held.at is not None:
            beyond = f"{held.joint}.{held.quantity} > {held.at!r}"
            kind = self.document.joints[held.joint].type
            passes = compile_expression(beyond, Scope(joints={held.joint: kind}, in_time=True))
        path = f"latches.{name}"
        when, release, crossed = (
            m.Condition(path, value.source.strip(), False, self.placed(value, f"{path}.{key}")) if value else None
            for key, value in (("when", given.when), ("release", given.release), ("angle", passes))
        )
        latch = m.Latch(held.at, given.stop, held.sides, when, release, crossed, given.every)
        return m.Stop(name, held.joint, held.quantity, None, None, 0.0, latch)


def directed(value: m.Vec | f.VelocityInFrame | f.RateInFrame | None) -> m.Directed[m.Vec] | None:
    """A vector in world axes unless it says otherwise."""
    if value is None:
        return None
    if isinstance(value, f.VelocityInFrame | f.RateInFrame):
        return m.Directed(value.vector, value.frame == "body")
    return m.Directed(value, False)


def three(value: Any) -> tuple[Any, Any, Any]:
    """What is given of three axes: of all alike, of each in a list or by its name; what is left out is none."""
    if value is None:
        return m.ZERO
    if isinstance(value, fe.ShiftLaws | fe.TurnLaws):
        return value.x, value.y, value.z
    return value if isinstance(value, tuple) else (value, value, value)


def area(bearing: f.BearingEntry | None) -> float | None:
    """Diameter times width of a bearing [m^2]: what a mean pressure stands on."""
    return bearing.diameter * bearing.width if bearing is not None else None


def stiffness(value: float | f.StiffnessParts | None) -> tuple[m.Vec, m.Vec] | None:
    """Of force and moment; one number is that of the force, in all directions."""
    if value is None:
        return None
    if isinstance(value, float):
        return (value, value, value), m.RIGID

    def three(part: float | m.Vec | None) -> m.Vec:
        if part is None:
            return m.RIGID
        return (part, part, part) if isinstance(part, float) else part

    return three(value.force), three(value.moment)


def properties(value: f.PropertiesEntry | Literal["auto"] | None) -> m.Properties | None:
    """A named shape with its sizes, the numbers themselves, or those of what is cut."""
    if value is None:
        return None
    if isinstance(value, str):
        return m.Properties("auto", {})
    for kind in ("circle", "tube", "rectangle"):
        if (sizes := getattr(value, kind)) is not None:
            return m.Properties(kind, vars(sizes))
    return m.Properties("general", {name: given for name, given in vars(value).items() if given is not None})


def numbers(value: Any) -> Any:
    """Expected numbers without their dimensions, in the same lists."""
    if isinstance(value, tuple):
        return tuple(map(numbers, value))
    return constant(value) if value is not None else None


def constant(value: Expression) -> float:
    """The number of an expression that depends on nothing."""
    assert value.constant is not None
    return value.constant
