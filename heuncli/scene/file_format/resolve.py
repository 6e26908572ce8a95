"""Resolve a document as written into a scene: follow references, unify alternative forms, fill in defaults.

For documents in which no rule found an error.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal

from heuncli.base.errors import Problem, SourceLocation
from heuncli.base.method_rows import canonical_name
from heuncli.base.records import record
from heuncli.scene.expressions.grammar import compile_expression
from heuncli.scene.expressions.programs import Expression, TableFunction
from heuncli.scene.expressions.scope import Scope
from heuncli.scene.file_format import format as f
from heuncli.scene.file_format import format_joints as fj
from heuncli.scene.file_format import format_loads as fl
from heuncli.scene.file_format import format_shapes as fs
from heuncli.scene.file_format import loads
from heuncli.scene.file_format import models as m
from heuncli.scene.file_format.couplings import Coupling
from heuncli.scene.file_format.fields import EndEntry
from heuncli.scene.file_format.format_couplings import CouplingEntry, RollingEntry
from heuncli.scene.file_format.members import find_ends, find_member, find_section_measures, is_member
from heuncli.scene.file_format.names import GROUND, UNTIL
from heuncli.scene.file_format.resolve_couplings import (
    iter_belt_conditions,
    iter_wheel_conditions,
    resolve_coupling,
    resolve_wheel,
)
from heuncli.scene.file_format.resolve_loads import constant_value, resolve_load
from heuncli.scene.file_format.rotations import IDENTITY
from heuncli.scene.file_format.semantics import (
    find_analysis_type,
    find_driven_coordinate,
    find_held_coordinate,
    find_limits,
    find_point,
    find_reduction_end,
    inertia_tensor,
    list_instants,
    make_rotors,
    orientation_matrix,
)

if TYPE_CHECKING:
    from heuncli.scene.expressions.paths import Path
    from heuncli.scene.meshes.model import TriangleMesh

DEFAULT_TOLERANCE = 1e-9


@record
class ResolveInputs:
    """What `resolve` needs besides the document."""

    path: str
    sha256: str
    parameters: Mapping[str, float]
    tables: Mapping[str, TableFunction]
    warnings: tuple[Problem, ...]
    locations: Mapping[str, SourceLocation]
    curves: Mapping[int, m.Curve]
    surfaces: Mapping[str, TriangleMesh]
    case: str | None
    labels: Mapping[str, str]
    logo: m.Logo | None


def resolve(document: f.Document, inputs: ResolveInputs, resolver: Resolver | None = None) -> m.Spec:
    """Resolve a document without errors into a scene.

    resolver: resolves the references; by default a plain Resolver
    """
    active_resolver = resolver or Resolver(document, inputs.locations, inputs.curves, inputs.surfaces)
    joints = active_resolver.resolve_entries("joints", "joint")
    motor_rotors = make_rotors(document, joints, inputs.locations)
    case_titles = {name: case.title or inputs.labels.get(f"cases.{name}", "") for name, case in document.cases.items()}
    return m.Spec(
        title=m.format_case_title(document.head.title, inputs.case, case_titles),
        path=inputs.path,
        sha256=inputs.sha256,
        space=document.head.space,
        parameters=inputs.parameters,
        gravity=document.head.gravity,
        ground=m.Ground(document.ground.points),
        bodies=active_resolver.resolve_entries("bodies", "body") | motor_rotors.bodies,
        joints=joints | motor_rotors.joints,
        drives=active_resolver.resolve_entries("drives", "drive"),
        forces=active_resolver.resolve_entries("forces", "force"),
        impulses=active_resolver.resolve_entries("impulses", "impulse"),
        stops=active_resolver.resolve_entries("stops", "stop"),
        labels=inputs.labels,
        couplings=active_resolver.resolve_entries("couplings", "coupling")
        | active_resolver.resolve_entries("rolling", "wheel")
        | motor_rotors.couplings,
        latches=active_resolver.resolve_entries("latches", "latch"),
        sections=active_resolver.resolve_entries("sections", "section"),
        sensors=active_resolver.resolve_entries("sensors", "sensor"),
        tables=inputs.tables,
        analysis=active_resolver.resolve_single("analysis"),
        report=make_report_settings(document.head.report, inputs.logo),
        foundation=m.Foundation(active_resolver.find_reference_point(document.foundation.about)),
        expect=tuple(active_resolver.resolve_entries("expect", "expect").values()),
        cases=case_titles,
        case=inputs.case,
        warnings=inputs.warnings,
        locations={**inputs.locations, **motor_rotors.locations} if motor_rotors.locations else inputs.locations,
    )


def make_report_settings(value: list[f.Report] | f.ReportEntry | None, logo: m.Logo | None) -> m.ReportSettings:
    """Make the settings of the report; a list names the results to compute."""
    if value is None or isinstance(value, list):
        return m.ReportSettings(results=None if value is None else tuple(value))
    return m.ReportSettings(
        value.company or "", value.project or "", value.author or "", value.revision or "", value.part or "", logo,
        None if value.chapters is None else tuple(value.chapters),
        None if value.results is None else tuple(value.results),
    )  # fmt: skip


class Resolver:
    """Resolves the references of one document."""

    def __init__(
        self,
        document: f.Document,
        locations: Mapping[str, SourceLocation],
        curves: Mapping[int, m.Curve],
        surfaces: Mapping[str, TriangleMesh],
    ) -> None:
        self.document, self.locations, self.curves, self.surfaces = document, locations, curves, surfaces

    def resolve_entries(self, block: str, method: str) -> dict[Any, Any]:
        """Resolve the entries of a block.

        method: name of the method that resolves one of them
        """
        resolve_entry = getattr(self, method)
        return {name: resolve_entry(name, entry) for name, entry in getattr(self.document, block).items()}

    def resolve_single(self, method: str) -> Any:
        """Resolve a part that belongs to the document as a whole.

        method: name of the method that resolves it
        """
        return getattr(self, method)()

    def analysis(self) -> m.Analysis:
        analysis, kind = self.document.analysis, find_analysis_type(self.document)
        instants = list_instants(self.document)
        return m.Analysis(
            kind,
            instants,
            instants[-1] if kind == "motion" else None,
            analysis.tolerance if analysis.tolerance is not None else DEFAULT_TOLERANCE,
            canonical_name(analysis.method),
            analysis.step,
            (*self.make_conditions(analysis), *(self.iter_entry_conditions() if kind == "motion" else ())),
            analysis.tolerance is not None,
            analysis.impacts,
            analysis.start,
        )

    def point(self, body: str, name: str) -> m.Vec:
        points = self.document.ground.points if body == GROUND else self.document.bodies[body].points
        return points[name]

    def end(self, end: EndEntry) -> m.End:
        if isinstance(end.at, str):
            return m.End(end.body, self.point(end.body, end.at), end.at)
        assert end.at is not None
        return m.End(end.body, end.at)

    def attach_location(self, value: Expression, path: str) -> Expression:
        location = self.locations.get(path)
        return value.with_location(location) if location is not None else value

    def attach_locations(
        self, values: tuple[Expression, Expression, Expression], path: str, key: str = "vector"
    ) -> loads.Vector:
        x, y, z = (self.attach_location(value, f"{path}.{key}.{i}") for i, value in enumerate(values))
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
        if is_member(shape):
            return resolve_member(shape)
        assert not isinstance(shape, fs.MemberShape | fs.ProfileShape)
        rotation = None
        if isinstance(shape, fs.BoxShape | fs.MeshShape):
            rotation = orientation_matrix(shape.orientation) if shape.orientation is not None else IDENTITY
        resolved = m.Shape(type=shape.type, rotation=rotation, **{key: getattr(shape, key, None) for key in keys})
        if not isinstance(shape, fs.MeshShape):
            return resolved
        return resolved._replace(
            at=shape.at or m.ZERO, scale=1.0 if shape.scale is None else shape.scale, mesh=self.surfaces[shape.file]
        )

    def piece(self, piece: f.PieceEntry | None) -> m.MassProperties | None:
        return m.MassProperties(piece.mass, piece.center, inertia_tensor(piece)) if piece is not None else None

    def body(self, name: str, body: f.BodyEntry) -> m.Body[m.Vec, loads.Matrix]:
        near = body.near
        return m.Body(
            name=name,
            mass=body.mass if body.mass is not None else 0.0,
            center=body.center if body.center is not None else m.ZERO,
            inertia=inertia_tensor(body) if body.inertia is not None else (m.ZERO, m.ZERO, m.ZERO),
            points=body.points,
            position=body.position,
            rotation=orientation_matrix(body.orientation) if body.orientation is not None else None,
            velocity=make_framed_vector(body.velocity),
            angular_velocity=make_framed_vector(body.angular_velocity),
            near_position=near.position if near is not None else None,
            near_rotation=orientation_matrix(near.orientation) if near is not None and near.orientation else None,
            shapes=tuple(self.shape(shape) for shape in body.shapes) if body.shapes is not None else None,
        )

    def joint(self, name: str, joint: fj.JointEntry) -> m.Joint[str, m.Vec]:
        """Resolve a joint: its ends to bodies and points; keys that its kind does not have to their defaults."""
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
            stiffness=expand_stiffness(joint.stiffness),
            drive=None,
            restitution=getattr(joint, "restitution", None),
            bearing=bearing_area(getattr(joint, "bearing", None)),
            p_name=a.name,
            q_name=b.name,
            path=self.make_path(joint) if isinstance(joint, fj.CurveJoint) else None,
            one_sided=getattr(joint, "one_sided", False),
            bearings=make_bearing_pair(joint.bearings),
        )

    def make_path(self, joint: fj.CurveJoint) -> Path:
        """Return the path of a curve joint's point, or of its roller's centre next to it."""
        from heuncli.scene.expressions.paths import (  # loads NumPy, which other specs do not need
            make_path,
            make_roller_path,
        )

        raw_path = make_path((joint.x, joint.y, joint.z))
        if joint.radius is None and not joint.one_sided:
            return raw_path
        return make_roller_path(raw_path, joint.radius or 0.0, joint.normal or (0.0, 0.0, 1.0))

    def drive(self, name: str, drive: f.DriveEntry) -> m.Drive:
        driven = find_driven_coordinate(drive, self.document.joints[drive.joint].type)
        assert driven is not None
        value = self.attach_location(driven.value, f"drives.{name}.{driven.key}")
        return m.Drive(name, drive.joint, driven.quantity, value, drive.zero == "assembled", driven.by_rate)

    def force(self, name: str, load: fl.LoadEntry) -> m.Force:
        return resolve_load(self, name, load)

    def impulse(self, name: str, blow: f.ImpulseEntry) -> m.AppliedImpulse[str, m.Vec]:
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
            when = m.Condition(path, blow.when.source.strip(), False, self.attach_location(blow.when, f"{path}.when"))
        return m.AppliedImpulse(name, body, point, vector, in_body, blow.time, kind, when, blow.every)

    def section(self, _: str, section: f.SectionEntry) -> m.Section:
        body = self.document.bodies[section.body]
        at, start, end = (find_point(body, at_or_name) for at_or_name in (section.at, section.from_, section.to))
        normal = section.normal
        if normal is None:
            assert start is not None
            assert end is not None
            normal = (end[0] - start[0], end[1] - start[1], end[2] - start[2])
        point = find_reduction_end(section.reduce_to)
        reduce_to: Any = self.end(point) if point is not None else section.reduce_to
        beam_theory = None
        if section.deflection:
            assert section.modulus is not None
            beam_theory = m.BeamTheory(section.modulus, section.reference or "chord", section.length_factor or 1.0)
        return m.Section(
            body=section.body, normal=normal, at=at, from_=start, to=end, count=section.count or 1,
            first_axis=section.first_axis, reduce_to=reduce_to, side=section.side,
            properties=make_properties(section.properties), strength=section.strength,
            beam_theory=beam_theory,
            piece=self.piece(section.piece or (body.piece if at is not None else None)),
        )  # fmt: skip

    def sensor(self, _: str, sensor: f.SensorEntry) -> m.Sensor:
        block, _, name = sensor.of.partition(".")
        point = None if sensor.point is None else self.end(sensor.point)
        is_joint = block == "joints"
        return m.Sensor(name if is_joint else None, None if is_joint else name, point, sensor.axes)

    def find_reference_point(self, point: object) -> m.Vec | None:
        if isinstance(point, str):
            return self.document.ground.points[point.rpartition(".")[2]]
        return point  # type: ignore[return-value]

    def make_conditions(self, analysis: f.AnalysisEntry) -> tuple[m.WatchedCondition, ...]:
        rows = [(UNTIL, True, UNTIL, analysis.until)] if analysis.until is not None else []
        rows += [(name, False, f"events.{name}", condition) for name, condition in analysis.events.items()]
        return tuple(self.make_condition(*row) for row in rows)

    def iter_entry_conditions(self) -> Iterator[m.ResultCondition]:
        """Yield the conditions that entries bring with them, such as wheels and belts."""
        yield from iter_wheel_conditions(self.document.rolling)
        yield from iter_belt_conditions(self.document.couplings)

    def make_condition(
        self, name: str, ends: bool, path: str, entry: Expression | f.ResultConditionEntry
    ) -> m.WatchedCondition:
        if isinstance(entry, Expression):
            return m.Condition(name, entry.source.strip(), ends, self.attach_location(entry, f"analysis.{path}"))
        is_above = entry.above is not None
        limit = entry.above if entry.above is not None else entry.below
        assert limit is not None
        number = limit.source.strip() if limit.dimension is not None else f"{constant_value(limit):.9g}"
        text = f"{entry.of} {'above' if is_above else 'below'} {number}"
        return m.ResultCondition(name, text, ends, entry.of, constant_value(limit), is_above)

    def expect(self, i: int, item: f.ExpectEntry) -> m.Expect:
        location = self.locations.get(f"expect.{i}", SourceLocation("", 1, 1))
        return m.Expect(
            item.of, item.at, item.peak, evaluate_numbers(item.is_), item.rel, evaluate_numbers(item.abs), location,
            evaluate_numbers(item.below), evaluate_numbers(item.above), self.curves.get(i),
        )  # fmt: skip

    def wheel(self, name: str, entry: RollingEntry) -> Coupling:
        return resolve_wheel(self, entry)

    def coupling(self, name: str, entry: CouplingEntry) -> Coupling:
        return resolve_coupling(self, name, entry)

    def stop(self, name: str, entry: f.StopEntry) -> m.Stop[str]:
        quantity_and_limits = find_limits(entry)
        assert quantity_and_limits is not None
        quantity, (low, high) = quantity_and_limits
        return m.Stop(name, entry.joint, quantity, low, high, entry.restitution)

    def latch(self, name: str, entry: f.LatchEntry) -> m.Stop[str]:
        coordinate = find_held_coordinate(entry, self.document)
        assert coordinate is not None
        passes = None
        if coordinate.position is not None:
            condition_text = f"{coordinate.joint}.{coordinate.quantity} > {coordinate.position!r}"
            kind = self.document.joints[coordinate.joint].type
            passes = compile_expression(condition_text, Scope(joints={coordinate.joint: kind}, in_time=True))
        path = f"latches.{name}"
        when, release, passing = (
            m.Condition(path, value.source.strip(), False, self.attach_location(value, f"{path}.{key}"))
            if value
            else None
            for key, value in (("when", entry.when), ("release", entry.release), ("angle", passes))
        )
        latch = m.Latch(coordinate.position, entry.stop, coordinate.sides, when, release, passing, entry.every)
        return m.Stop(name, coordinate.joint, coordinate.quantity, None, None, 0.0, latch)


def resolve_member(shape: fs.ShapeEntry) -> m.Shape:
    """Return a member, or the cylinder that a circular tube is."""
    member, (start, end) = find_member(shape), find_ends(shape)
    mass, density = getattr(shape, "mass", None), getattr(shape, "density", None)
    if not isinstance(member, m.Member):
        return m.Shape(
            "cylinder", mass, density, from_=start, to=end, radius=member.radius, inner_radius=member.inner_radius
        )
    return m.Shape("member", mass, density, from_=start, to=end, member=member)


def make_framed_vector(value: m.Vec | f.VelocityInFrame | f.RateInFrame | None) -> m.FramedVector[m.Vec] | None:
    """Return a vector in world axes unless the value says otherwise."""
    if value is None:
        return None
    if isinstance(value, f.VelocityInFrame | f.RateInFrame):
        return m.FramedVector(value.vector, value.frame == "body")
    return m.FramedVector(value, False)


def make_bearing_pair(pair: fj.BearingPairEntry | None) -> m.BearingPair | None:
    """Return the two bearings of a joint, if it has them."""
    return None if pair is None else m.BearingPair(pair.at, {"first": 0, "second": 1}.get(pair.axial or ""))


def bearing_area(bearing: fj.BearingEntry | None) -> float | None:
    """Return diameter times width of a bearing [m^2], the area of the mean pressure."""
    return bearing.diameter * bearing.width if bearing is not None else None


def expand_stiffness(value: float | fj.StiffnessParts | None) -> tuple[m.Vec, m.Vec] | None:
    """Return the stiffness of force and of moment along the three axes; a single number is that of force in all
    directions.
    """
    if value is None:
        return None
    if isinstance(value, float):
        return (value, value, value), m.RIGID

    def expand(part: float | m.Vec | None) -> m.Vec:
        if part is None:
            return m.RIGID
        return (part, part, part) if isinstance(part, float) else part

    return expand(value.force), expand(value.moment)


def make_properties(value: f.PropertiesEntry | Literal["auto"] | None) -> m.Properties | None:
    """Make the cross-section properties: a named shape with its dimensions, the numbers, or `auto`."""
    if value is None:
        return None
    if isinstance(value, str):
        return m.Properties("auto", {})
    if (member := find_section_measures(value)) is not None:
        return member
    for kind in ("circle", "tube", "rectangle"):
        if (sizes := getattr(value, kind)) is not None:
            return m.Properties(kind, vars(sizes))
    return m.Properties(
        "general", {name: value_given for name, value_given in vars(value).items() if value_given is not None}
    )


def evaluate_numbers(value: Any) -> Any:
    """Evaluate expected numbers, without their dimensions, in the same nested lists."""
    if isinstance(value, tuple):
        return tuple(map(evaluate_numbers, value))
    return constant_value(value) if value is not None else None
