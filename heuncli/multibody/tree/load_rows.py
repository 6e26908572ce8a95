"""The tables of a layout's loads, of the watched values in time, and of the variables that these use."""

from __future__ import annotations

import math
from collections.abc import Sequence

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.loads import (
    GROUND,
    BushingLoad,
    JointLoad,
    Load,
    PairLoad,
    PointLoad,
    RopeLoad,
    ThreadLoad,
)
from heuncli.multibody.mechanism.model import Joint, Mechanism, NamedPoint
from heuncli.multibody.stage_cache import NO_CACHE, Stages
from heuncli.multibody.tree.layout import Layout, LayoutFrame, empty_load_tables, make_layout
from heuncli.multibody.tree.tables import NO_PROGRAM, ZERO, FieldValue, Program, Table, flat_dtype, make_table
from heuncli.scene.expressions.programs import LOADS, Expression, Pack, Variable
from heuncli.scene.shapes.rotations import perpendicular_pair

PRESSES = {"whole": kernel.WHOLE, "across": kernel.ACROSS, "ends": kernel.ENDS}
ONE = (1.0, 0.0, 0.0)  # of friction that is proportional to a normal force
Components = dict[str, Program]  # of a load's vector, by x, y, z


class ValuePrograms(NamedTuple):
    """The values in time of a mechanism: their pack, and the program of each expression by its identity.

    drives: of each joint's drive, then of each coupling's law. These come first in the pack, so that their positions do
    not depend on the loads.
    """

    pack: Pack
    by_identity: dict[int, Program]
    drives: tuple[Program, ...]

    def find_program(self, e: Expression) -> Program:
        """Return the program of a load's value; NO_PROGRAM if it is constant."""
        return self.by_identity[id(e)] if e.constant is None else NO_PROGRAM

    def extend(self, mechanism: Mechanism) -> ValuePrograms:
        """Add the programs of another mechanism after these."""
        for e in mechanism.iter_expressions():
            if e.constant is None and id(e) not in self.by_identity:
                self.by_identity[id(e)] = self.pack.add(e)
        return self._replace(drives=drive_programs(mechanism, self.by_identity))


def make_programs(mechanism: Mechanism) -> ValuePrograms:
    """Make the programs of every expression in time."""
    pack = Pack()
    by_identity = {id(law.value): pack.add(law.value) for law in mechanism.laws}
    drives = drive_programs(mechanism, by_identity)
    by_identity |= {id(e): pack.add(e) for e in applied_expressions(mechanism) if e.constant is None}
    return ValuePrograms(pack, by_identity, drives)


def drive_programs(mechanism: Mechanism, by_identity: dict[int, Program]) -> tuple[Program, ...]:
    """Return the program of the law of each joint and coupling."""
    laws = {law.owner: by_identity[id(law.value)] for law in mechanism.laws}
    return tuple(laws.get(k, NO_PROGRAM) for k in range(len(mechanism.joints) + len(mechanism.couplings)))


def applied_expressions(mechanism: Mechanism) -> list[Expression]:
    """Return the values of the loads, then of the conditions, then the piece numbers of cams."""
    values = (e for load in mechanism.loads for e in load.values)
    return [*values, *(c.value for c in mechanism.conditions), *mechanism.piece_numbers]


def find_used_names(mechanism: Mechanism) -> frozenset[str]:
    """Return the joints and points that these use."""
    return frozenset(name for e in applied_expressions(mechanism) for name, _ in e.uses)


def lay_out_loads(
    frame: LayoutFrame,
    mechanism: Mechanism,
    programs: ValuePrograms,
    stages: Stages = NO_CACHE,
    left_out: Sequence[Expression] = (),
) -> Layout:
    """Make the layout of a frame with the loads and conditions of its mechanism; the table without the values is a
    stage.

    left_out: more values whose branches the kernel follows, though they load nothing here
    """
    load_programs = tuple(tuple(programs.find_program(e) for e in load.values) for load in mechanism.loads)
    loads = stages.run(make_load_table, mechanism, frame, load_programs).copy()
    vector = loads["vector"].view(flat_dtype(loads.dtype["vector"]))
    for load, rows in mechanism.iter_load_rows():
        if isinstance(load, BushingLoad):
            vector[rows] = load.shift.preload, load.turn.preload
            continue
        for i, e in enumerate(load.values):
            vector[rows, i] = 0.0 if e.constant is None else e.constant
    tables = empty_load_tables() | {"loads": loads}
    if programs.pack.code:
        tables["watches"] = make_table(kernel.Watch, make_watch_rows(mechanism, programs, left_out))
        tables |= hold_lifts(mechanism, frame, programs.pack)
    if len(programs.pack.variables) > 1:
        tables["variables"] = make_table(kernel.Variable, make_variable_rows(frame, mechanism, programs.pack.variables))
    return make_layout(frame, mechanism, programs.pack, tables)


def hold_lifts(mechanism: Mechanism, frame: LayoutFrame, pack: Pack) -> dict[str, Table]:
    """Return the table of parts in which cams with lifts in segments know the branch that holds their piece."""
    if not mechanism.piece_numbers:
        return {}
    held = {id(e): i for i, (e, _) in enumerate(pack.branches)}
    parts = [part for coupling in mechanism.couplings for row in coupling.rows for part in row.parts]
    table = frame.tables["parts"].copy()
    for i, part in enumerate(parts):
        if part.cam is not None and part.cam.piece_number is not None:
            table[i]["piece_branch"] = 1 + held[id(part.cam.piece_number)]
    return {"parts": table}


def make_load_table(mechanism: Mechanism, frame: LayoutFrame, programs: tuple[tuple[Program, ...], ...]) -> Table:
    """Make the table of loads without constant values; programs: of each load's values."""
    return make_table(kernel.Load, _LoadRowBuilder(mechanism, frame, programs).made)


class _LoadRowBuilder:
    """Builds the rows of the loads; used for one call of make_load_table."""

    def __init__(self, mechanism: Mechanism, frame: LayoutFrame, programs: tuple[tuple[Program, ...], ...]) -> None:
        self.mechanism, self.frame = mechanism, frame
        self.made: list[kernel.Load] = []
        self.parts = sum(len(row.parts) for coupling in mechanism.couplings for row in coupling.rows)  # before a rope's
        for load, own in zip(mechanism.loads, programs, strict=True):
            values = name_components(own[:3])
            if isinstance(load, PointLoad):
                self._add_point_load(load, values)
            elif isinstance(load, PairLoad):
                self._add_pair_load(load, values)
            elif isinstance(load, BushingLoad):
                self._add_bushing(load, own)
            elif isinstance(load, RopeLoad):
                self._add_rope(load, values)
            elif isinstance(load, ThreadLoad):
                self._add_thread(load)
            else:
                self._add_joint_load(load, values)

    def _find_ends(self, pair: PairLoad | BushingLoad | Joint) -> dict[str, FieldValue]:
        """Return the two bodies of a load or a joint, and its points on them."""
        a, b = self.frame.in_tree(pair.a), self.frame.in_tree(pair.b)
        return {"a": a, "b": b, "p": self.frame.relative(pair.a, pair.p), "q": self.frame.relative(pair.b, pair.q)}

    def _add_point_load(self, load: PointLoad, values: Components) -> None:
        self.made.append(
            kernel.Load(
                kind=law_numbers(load)[0],
                a=GROUND,
                b=self.frame.in_tree(load.body),
                q=ZERO if load.point is None else self.frame.relative(load.body, load.point),
                in_body=int(load.in_body),
                factor=load.factor,
                **values,
            )
        )

    def _add_pair_load(self, load: PairLoad, values: Components) -> None:
        self.made.append(
            kernel.Load(
                kind=law_numbers(load)[0],
                stiffness=load.stiffness,
                length=load.length,
                coefficient=load.damping,
                **self._find_ends(load),
                **values,
            )
        )

    def _add_bushing(self, load: BushingLoad, programs: tuple[Program, ...]) -> None:
        """Add the rows of the shift and of the turn."""
        parts = (
            (load.shift, (load.coupling, load.coupling_damping), programs[:3]),
            (load.turn, (load.coupling.T, load.coupling_damping.T), programs[3:]),
        )
        for kind, (elastic, (stiffness, damping), part_programs) in zip(law_numbers(load), parts, strict=True):
            self.made.append(
                kernel.Load(
                    kind=kind,
                    length=math.pi - tolerances.TURNED_OVER,
                    frame=load.frame.ravel().tolist(),
                    to_frame=load.to_frame.ravel().tolist(),
                    own_stiffness=elastic.stiffness.ravel().tolist(),
                    own_damping=elastic.damping.ravel().tolist(),
                    is_coupled=int(stiffness.any() or damping.any()),
                    coupled_stiffness=stiffness.ravel().tolist(),
                    coupled_damping=damping.ravel().tolist(),
                    **self._find_ends(load),
                    **name_components(part_programs),
                )
            )

    def _add_rope(self, load: RopeLoad, values: Components) -> None:
        """Add an elastic rope, along its parts."""
        self.made.append(
            kernel.Load(
                kind=law_numbers(load)[0],
                a=GROUND,
                b=GROUND,
                in_body=int(load.only_pulls),
                stiffness=load.stiffness,
                length=load.length,
                coefficient=load.damping,
                part=self.parts,
                part_count=len(load.parts),
                **values,
            )
        )
        self.parts += len(load.parts)

    def _add_thread(self, load: ThreadLoad) -> None:
        self.made.append(
            kernel.Load(
                kind=law_numbers(load)[0],
                a=self.frame.in_tree(load.a),
                b=self.frame.in_tree(load.b),
                q=self.frame.relative(load.b, load.q),
                vector=ONE,
                in_body=1,
                coefficient=load.coefficient,
                axis=load.axis,
                speed=load.speed,
                breakaway=load.static,
                factor=load.factor,
                normal_force_kind=kernel.THRUST_OF_ROW,
                joint_body=GROUND,
                row=self.frame.rows.index(len(self.mechanism.joints) + load.coupling),
                row_count=1,
            )
        )

    def _add_joint_load(self, load: JointLoad, values: Components) -> None:
        joint = self.mechanism.joints[load.joint]
        kind = JOINTS[joint.kind]
        laws = zip(law_numbers(load), (load.turning, load.sliding), strict=False)
        parts = dict(zip(("turning", "sliding"), laws, strict=False))
        for motion in kind.motions_for_load(load.kind):
            number, coefficient = parts[motion]
            row = kernel.Load(
                kind=number,
                vector=ONE if load.row.is_friction else ZERO,
                in_body=int(kind.has_one_axis),
                coefficient=coefficient,
                axis=joint.axis,
                speed=load.speed,
                breakaway=load.static,
                **self._find_ends(joint),
                **values,
            )
            if load.row.has_potential:
                row = self._complete_turn_spring(load, row)
            elif load.presses is not None:
                row = self._complete_joint_friction(load, row)
            self.made.append(row)

    def _complete_joint_friction(self, load: JointLoad, row: kernel.Load) -> kernel.Load:
        """Add to a friction row where its normal force comes from: the balance of the branch on the joint, or rows of a
        cut joint.
        """
        tree_index = next((i for i, h in enumerate(self.frame.spanning.links) if h.joint == load.joint), GROUND)
        closure_rows = [r for r, joint in enumerate(self.frame.rows) if joint == load.joint]
        # those of its stops come after
        closure_rows = closure_rows[: JOINTS[self.mechanism.joints[load.joint].kind].row_count]
        presses, first = PRESSES[load.presses or "whole"], closure_rows[0] if closure_rows else 0
        return row.replace(
            normal_force_kind=presses, joint_body=tree_index, row=first, row_count=len(closure_rows), reach=load.reach
        )

    def _complete_turn_spring(self, load: JointLoad, row: kernel.Load) -> kernel.Load:
        """Add to a spring's row the index of its angle, or the data to compute the angle where the joint was cut."""
        joint, start = self.mechanism.joints[load.joint], self.frame.starts[load.joint]
        freedoms = enumerate(self.frame.freedoms)
        freedom = next((i for i, f in freedoms if f.joint == load.joint and f.quantity in ("angle", "first")), -1)
        across = perpendicular_pair(joint.axis)[0]
        return row.replace(
            stiffness=load.stiffness,
            length=load.angle,
            freedom=freedom,
            counter=list(self.frame.counters).index(load.joint) if load.joint in self.frame.counters else -1,
            # a universal's coordinate is counted from the start; without any the angle stays what it is there
            offset=0.0 if freedom >= 0 and self.frame.freedoms[freedom].quantity == "angle" else start.angle,
            mark_a=across,
            mark_b=start.R_ref.T @ across,
        )


def name_components(programs: Sequence[Program]) -> Components:
    """Return the programs of a load's components by the names of the kernel's fields."""
    return dict(zip("xyz", programs, strict=False))


def law_numbers(load: Load) -> tuple[int, ...]:
    """Return the kernel's numbers of the laws of a load."""
    return tuple(getattr(kernel, law) for law in load.row.kernel_laws)


def make_watch_rows(
    mechanism: Mechanism, programs: ValuePrograms, left_out: Sequence[Expression] = ()
) -> list[kernel.Watch]:
    """Make the rows of the watched programs of loads and drives, whose changes between the stages of a step must not be
    missed; left_out: more values that are watched as loads are.

    Conditions are watched only where they change sign, and elastic ropes only where they go slack: otherwise these are
    springs, which the error control of the steps follows.
    """
    rope_values = {id(load.value) for load in mechanism.loads if isinstance(load, RopeLoad)}
    law_values = {id(law.value): law.value for law in mechanism.laws}
    loads = {id(e): e for load in mechanism.loads for e in load.values} | {id(e): e for e in left_out}
    parts = {
        id(e): row
        for load, rows in mechanism.iter_load_rows()
        if isinstance(load, BushingLoad)
        for row, part in ((rows.start, load.shift), (rows.start + 1, load.turn))
        for e in part.extra_load
    }
    watched = [
        kernel.Watch(
            program=programs.by_identity[key],
            curved=int(key in law_values),
            condition=int(key in rope_values),
            load=parts.get(key, -1),
        )
        for key, e in (loads | law_values).items()
        if e.constant is None and (e.held_branches or key not in rope_values)
    ]
    switching = (*(condition.value for condition in mechanism.conditions), *mechanism.piece_numbers)
    return watched + [
        kernel.Watch(program=programs.by_identity[id(e)], curved=0, condition=1, load=-1) for e in switching
    ]


def make_variable_rows(
    frame: LayoutFrame, mechanism: Mechanism, variables: Sequence[Variable]
) -> list[kernel.Variable]:
    """Make the variables of the programs; the first is the time, which is no coordinate."""
    joints = mechanism.joints
    by_name = {(joints[f.joint].name, f.quantity): i for i, f in enumerate(frame.freedoms) if f.joint >= 0}
    load_rows_by_name = {f"{LOADS}.{load.name}": rows.start for load, rows in mechanism.iter_load_rows()}
    rows = [kernel.Variable()]
    for name, quantity in (use for use in variables if not isinstance(use, str)):
        if name in mechanism.points:
            rows.append(make_point_variable(frame, mechanism.points[name], quantity))
            continue
        if name in load_rows_by_name:
            rows.append(make_load_variable(load_rows_by_name[name], quantity))
            continue
        base = {"rate": "angle", "speed": "travel"}.get(quantity, quantity)
        rows.append(kernel.Variable(freedom=by_name[name, base], is_rate=int(base != quantity)))
    return rows


def make_load_variable(row: int, quantity: str) -> kernel.Variable:
    """Make the variable that is a deformation of a load; row: the first of its rows."""
    if quantity in ("length", "speed"):
        return kernel.Variable(
            is_rate=int(quantity == "speed"), is_point=kernel.OF_LOAD, load=row, part=kernel.ALONG_LINE
        )
    if quantity == "drawn":
        return kernel.Variable(is_point=kernel.OF_LOAD, load=row, part=kernel.DRAWN)
    component, _, axis = quantity.partition("_")
    return kernel.Variable(is_point=kernel.OF_LOAD, load=row + int(component == "turn"), part="xyz".index(axis))


def make_point_variable(frame: LayoutFrame, point: NamedPoint, quantity: str) -> kernel.Variable:
    """Make the variable that is a point's position or velocity along one of its axes."""
    axis = "xyz".index(quantity[-1])
    return kernel.Variable(
        is_rate=int(quantity.startswith("v")),
        is_point=kernel.AT_POINT,
        body=frame.in_tree(point.body),
        q=frame.relative(point.body, point.place),
        direction=point.axes[axis],
        offset=float(point.offset[axis]),
    )
