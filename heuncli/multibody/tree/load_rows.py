"""The tables of a layout's loads, of the values in time that are watched, and of the variables that these name."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.base.joint_kinds import JOINTS
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.records import replace
from heuncli.kernel.choose import scene as kernel
from heuncli.multibody.mechanism.model import (
    GROUND,
    BushingLoad,
    JointLoad,
    Mechanism,
    NamedPoint,
    PairLoad,
    PointLoad,
    RopeLoad,
    ThreadLoad,
)
from heuncli.multibody.stages import ANEW, Stages
from heuncli.multibody.tree.frame import LayoutFrame, layout_of, no_loads
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.rows import NO_PROGRAM, ZERO, LoadRow, Program, VariableRow, WatchRow, table_of
from heuncli.multibody.tree.tables import Table, flat
from heuncli.scene.expressions.programs import LOADS, Expression, Pack, Variable
from heuncli.scene.shapes.rotations import perpendicular

JOINT_LOADS = {  # of the turning, of the sliding
    "torque": (kernel.TORQUE, kernel.THRUST),
    "turn_spring": (kernel.TURN_SPRING, kernel.THRUST),
    "damper": (kernel.TURN_DAMPER, kernel.SHIFT_DAMPER),
    "friction": (kernel.TURN_FRICTION, kernel.SHIFT_FRICTION),
}
PRESSES = {"whole": kernel.WHOLE, "across": kernel.ACROSS, "ends": kernel.ENDS}
ONE = (1.0, 0.0, 0.0)  # of friction without a size of its own, by what presses
Components = tuple[Program, Program, Program]


class ValuePrograms(NamedTuple):
    """The values in time of a mechanism: their pack, and where the program of each stands, by its identity.

    drives: that of each joint's drive, then of each coupling's law. Theirs come first in the pack: where they stand
    hangs on no load.
    """

    pack: Pack
    at: dict[int, Program]
    drives: tuple[Program, ...]

    def of(self, e: Expression) -> Program:
        """That of a load's value; none where it does not vary."""
        return self.at[id(e)] if e.constant is None else NO_PROGRAM

    def more(self, mechanism: Mechanism) -> ValuePrograms:
        """With those of another mechanism, whose own come after these."""
        for e in mechanism.expressions():
            if e.constant is None and id(e) not in self.at:
                self.at[id(e)] = self.pack.add(e)
        return self._replace(drives=drives_of(mechanism, self.at))


def programs_of(mechanism: Mechanism) -> ValuePrograms:
    """Every expression in time."""
    pack = Pack()
    at = {id(law.value): pack.add(law.value) for law in mechanism.laws}
    drives = drives_of(mechanism, at)
    at |= {id(e): pack.add(e) for e in applied(mechanism) if e.constant is None}
    return ValuePrograms(pack, at, drives)


def drives_of(mechanism: Mechanism, at: dict[int, Program]) -> tuple[Program, ...]:
    """The program of the law of each joint and coupling."""
    laws = {law.owner: at[id(law.value)] for law in mechanism.laws}
    return tuple(laws.get(k, NO_PROGRAM) for k in range(len(mechanism.joints) + len(mechanism.couplings)))


def applied(mechanism: Mechanism) -> list[Expression]:
    """The values of the loads, then of the conditions."""
    return [*(e for load in mechanism.loads for e in load.values), *(c.value for c in mechanism.conditions)]


def named_in(mechanism: Mechanism) -> frozenset[str]:
    """The joints and points that these name."""
    return frozenset(name for e in applied(mechanism) for name, _ in e.uses)


def with_loads(frame: LayoutFrame, mechanism: Mechanism, programs: ValuePrograms, stages: Stages = ANEW) -> Layout:
    """The layout of a frame with the loads and conditions of its mechanism; stages: but for their values it is one."""
    placed = tuple(tuple(programs.of(e) for e in load.values) for load in mechanism.loads)
    found = stages.run(load_table, mechanism, frame, placed).copy()
    vector = found["vector"].view(flat(found.dtype["vector"]))
    for load, rows in mechanism.load_rows():
        if isinstance(load, BushingLoad):
            vector[rows] = load.shift.preload, load.turn.preload
            continue
        for i, e in enumerate(load.values):
            vector[rows, i] = 0.0 if e.constant is None else e.constant
    tables = no_loads() | {"loads": found}
    if programs.pack.code:
        tables["watches"] = table_of(kernel.Watch, watch_rows(mechanism, programs))
    if len(programs.pack.variables) > 1:
        tables["variables"] = table_of(kernel.Variable, variable_rows(frame, mechanism, programs.pack.variables))
    return layout_of(frame, mechanism, programs.pack, tables)


def load_table(mechanism: Mechanism, frame: LayoutFrame, programs: tuple[tuple[Program, ...], ...]) -> Table:
    """The table of loads without those values that do not vary; programs: of each load's values."""
    return table_of(kernel.Load, _LoadRows(mechanism, frame, programs).made)


class _LoadRows:
    """Makes the rows of the loads; lives for one call of load_table."""

    def __init__(self, mechanism: Mechanism, frame: LayoutFrame, programs: tuple[tuple[Program, ...], ...]) -> None:
        self.mechanism, self.frame = mechanism, frame
        self.made: list[LoadRow] = []
        self.parts = sum(len(row.parts) for coupling in mechanism.couplings for row in coupling.rows)  # before a rope's
        for load, own in zip(mechanism.loads, programs, strict=True):
            x, y, z = (own + (NO_PROGRAM,) * (3 - len(own)))[:3]
            values = x, y, z
            if isinstance(load, PointLoad):
                self._point_load(load, values)
            elif isinstance(load, PairLoad):
                self._pair_load(load, values)
            elif isinstance(load, BushingLoad):
                self._bushing(load, own)
            elif isinstance(load, RopeLoad):
                self._rope(load, values)
            elif isinstance(load, ThreadLoad):
                self._thread(load)
            else:
                self._joint_load(load, values)

    def _point_load(self, load: PointLoad, values: Components) -> None:
        q = np.zeros(3) if load.point is None else self.frame.relative(load.body, load.point)
        kind = kernel.FORCE if load.kind == "force" else kernel.COUPLE
        body, in_body = self.frame.in_tree(load.body), int(load.in_body)
        self.made.append(LoadRow(kind, GROUND, body, *values, ZERO, in_body=in_body, q=q, factor=load.factor))

    def _pair_load(self, load: PairLoad, values: Components) -> None:
        self.made.append(
            LoadRow(
                kernel.SPRING if load.value is None else kernel.ACTUATOR,
                self.frame.in_tree(load.a),
                self.frame.in_tree(load.b),
                *values,
                ZERO,
                p=self.frame.relative(load.a, load.p),
                q=self.frame.relative(load.b, load.q),
                stiffness=load.stiffness,
                length=load.length,
                coefficient=load.damping,
            )
        )

    def _bushing(self, load: BushingLoad, programs: tuple[Program, ...]) -> None:
        """Two rows: of the shift, of the turn."""
        parts = (kernel.BUSHING_SHIFT, load.shift, programs[:3]), (kernel.BUSHING_TURN, load.turn, programs[3:])
        for kind, elastic, own in parts:
            self.made.append(
                LoadRow(
                    kind,
                    self.frame.in_tree(load.a),
                    self.frame.in_tree(load.b),
                    own[0],
                    own[1],
                    own[2],
                    ZERO,
                    p=self.frame.relative(load.a, load.p),
                    q=self.frame.relative(load.b, load.q),
                    length=math.pi - tolerances.TURNED_OVER,
                    frame=load.frame.ravel().tolist(),
                    to_frame=load.to_frame.ravel().tolist(),
                    stiffnesses=elastic.stiffness,
                    resistances=elastic.damping,
                )
            )

    def _rope(self, load: RopeLoad, values: Components) -> None:
        """A rope that stretches, along its parts."""
        self.made.append(
            LoadRow(
                kernel.ROPE,
                GROUND,
                GROUND,
                *values,
                ZERO,
                in_body=int(load.only_pulls),
                stiffness=load.stiffness,
                length=load.length,
                coefficient=load.damping,
                part=self.parts,
                part_count=len(load.parts),
            )
        )
        self.parts += len(load.parts)

    def _thread(self, load: ThreadLoad) -> None:
        row = self.frame.rows.index(len(self.mechanism.joints) + load.coupling)
        self.made.append(
            LoadRow(
                kernel.THREAD_FRICTION,
                self.frame.in_tree(load.a),
                self.frame.in_tree(load.b),
                NO_PROGRAM,
                NO_PROGRAM,
                NO_PROGRAM,
                ONE,
                in_body=1,
                q=self.frame.relative(load.b, load.q),
                coefficient=load.coefficient,
                axis=load.axis,
                speed=load.speed,
                factor=load.factor,
                presses=kernel.THRUST_OF_ROW,
                held_by=GROUND,
                row=row,
                row_count=1,
            )
        )

    def _joint_load(self, load: JointLoad, values: Components) -> None:
        joint = self.mechanism.joints[load.joint]
        kind = JOINTS[joint.kind]
        turns, slides = JOINT_LOADS[load.kind]
        parts = {"turning": (turns, load.turning), "sliding": (slides, load.sliding)}
        for motion in kind.moved_by(load.kind):
            number, coefficient = parts[motion]
            row = LoadRow(
                number,
                self.frame.in_tree(joint.a),
                self.frame.in_tree(joint.b),
                *values,
                ONE if load.kind == "friction" else ZERO,
                in_body=int(kind.has_one_axis),
                p=self.frame.relative(joint.a, joint.p),
                q=self.frame.relative(joint.b, joint.q),
                coefficient=coefficient,
                axis=joint.axis,
                speed=load.speed,
            )
            if load.kind == "turn_spring":
                row = self._turn_spring(load, row)
            elif load.presses is not None:
                row = self._pressed(load, row)
            self.made.append(row)

    def _pressed(self, load: JointLoad, row: LoadRow) -> LoadRow:
        """Where what presses is found: in the balance of the branch on the joint, or in the rows of a cut one."""
        held = next((i for i, h in enumerate(self.frame.spanning.hangs) if h.joint == load.joint), GROUND)
        own = [r for r, joint in enumerate(self.frame.rows) if joint == load.joint]
        own = own[: JOINTS[self.mechanism.joints[load.joint].kind].rows]  # those of its stops come after
        presses, first = PRESSES[load.presses or "whole"], own[0] if own else 0
        return replace(row, presses=presses, held_by=held, row=first, row_count=len(own), reach=load.reach)

    def _turn_spring(self, load: JointLoad, row: LoadRow) -> LoadRow:
        """What a spring about a joint's axis has of its own: where its angle stands, or tells it where that was cut."""
        joint, start = self.mechanism.joints[load.joint], self.frame.starts[load.joint]
        named = enumerate(self.frame.freedoms)
        freedom = next((i for i, f in named if f.joint == load.joint and f.quantity in ("angle", "first")), -1)
        across = perpendicular(joint.axis)[0]
        return replace(
            row,
            stiffness=load.stiffness,
            length=load.angle,
            freedom=freedom,
            counter=list(self.frame.counters).index(load.joint) if load.joint in self.frame.counters else -1,
            # a universal's coordinate is counted from the start; without any the angle stays what it is there
            offset=0.0 if freedom >= 0 and self.frame.freedoms[freedom].quantity == "angle" else start.angle,
            across=across,
            mark=start.R_ref.T @ across,
        )


def watch_rows(mechanism: Mechanism, programs: ValuePrograms) -> list[WatchRow]:
    """The programs of loads and drives: what they do between the stages of a step must not be passed over.

    Of conditions only where they change, and of ropes that stretch where they go slack: else those are springs, which
    the steps' own error follows.
    """
    springy = {id(load.value) for load in mechanism.loads if isinstance(load, RopeLoad)}
    driven = {id(law.value): law.value for law in mechanism.laws}
    loads = {id(e): e for load in mechanism.loads for e in load.values}
    parts = {
        id(e): row
        for load, rows in mechanism.load_rows()
        if isinstance(load, BushingLoad)
        for row, part in ((rows.start, load.shift), (rows.start + 1, load.turn))
        for e in part.given
    }
    watched = [
        WatchRow(programs.at[key], curved=int(key in driven), condition=int(key in springy), load=parts.get(key, -1))
        for key, e in (loads | driven).items()
        if e.constant is None and (e.held or key not in springy)
    ]
    conditions = (programs.at[id(condition.value)] for condition in mechanism.conditions)
    return watched + [WatchRow(program, curved=0, condition=1, load=-1) for program in conditions]


def variable_rows(frame: LayoutFrame, mechanism: Mechanism, variables: Sequence[Variable]) -> list[VariableRow]:
    """The variables of the programs; the first is the time, which is no coordinate."""
    joints = mechanism.joints
    by_name = {(joints[f.joint].name, f.quantity): i for i, f in enumerate(frame.freedoms) if f.joint >= 0}
    own = {f"{LOADS}.{load.name}": rows.start for load, rows in mechanism.load_rows()}
    rows = [VariableRow()]
    for name, quantity in (use for use in variables if not isinstance(use, str)):
        if name in mechanism.points:
            rows.append(point_row(frame, mechanism.points[name], quantity))
            continue
        if name in own:
            rows.append(load_row(own[name], quantity))
            continue
        base = {"rate": "angle", "speed": "travel"}.get(quantity, quantity)
        rows.append(VariableRow(by_name[name, base], int(base != quantity)))
    return rows


def load_row(row: int, quantity: str) -> VariableRow:
    """The variable that is a part of what a load acts between; row: the first of its rows."""
    if quantity in ("length", "speed"):
        return VariableRow(is_rate=int(quantity == "speed"), is_point=kernel.OF_LOAD, load=row, part=kernel.ALONG_LINE)
    if quantity == "drawn":
        return VariableRow(is_point=kernel.OF_LOAD, load=row, part=kernel.DRAWN)
    of, _, axis = quantity.partition("_")
    return VariableRow(is_point=kernel.OF_LOAD, load=row + int(of == "turn"), part="xyz".index(axis))


def point_row(frame: LayoutFrame, point: NamedPoint, quantity: str) -> VariableRow:
    """The variable that is a point's place or velocity along one of its axes."""
    axis = "xyz".index(quantity[-1])
    return VariableRow(
        is_rate=int(quantity.startswith("v")),
        is_point=kernel.AT_POINT,
        body=frame.in_tree(point.body),
        q=frame.relative(point.body, point.place),
        direction=point.axes[axis],
        offset=float(point.offset[axis]),
    )
