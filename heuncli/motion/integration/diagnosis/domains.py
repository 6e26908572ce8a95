"""Expressions without a value where a run fails: which, their location, and why. Imported only for an error."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.base.number_range import out_of_range
from heuncli.base.records import replace
from heuncli.motion.integration.diagnosis.ways import Moving, along_cut_paths, ways_left
from heuncli.motion.integration.evaluator import Recovered
from heuncli.motion.integration.named_points import motion_of
from heuncli.multibody.mechanism.model import GROUND, BushingLoad, Load, Mechanism, PairLoad, RopeLoad
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import KNOT, LOADS, TABLE, Expression, TableFunction, outside
from heuncli.scene.shapes.rotations import cross_rows, inverse_jacobian

# An expression may lose its value only just after t: instants from 2**-52 to 2**-20 of the run's length later.
NEAREST, FARTHEST = 52, 20
HELD = 1  # a table's kind (scene/expressions/programs.py)
DERIVATIVES = ("value", "rate", "acceleration")


def coordinates_at(layout: Layout, recovered: Recovered, instant: int) -> Moving:
    """The coordinates of the joints, and of the points that expressions name, at one of the instants."""
    freedoms = recovered.freedoms[instant]
    coordinates: dict[tuple[str, str], tuple[float, float]] = {}
    joints = layout.mechanism.joints
    for freedom, (q, u, a, _) in zip(layout.freedoms, freedoms.tolist(), strict=True):
        if freedom.joint >= 0 and freedom.quantity in ("angle", "travel"):
            name = joints[freedom.joint].name
            coordinates[name, freedom.quantity] = q, u
            coordinates[name, "rate" if freedom.quantity == "angle" else "speed"] = u, a if math.isfinite(a) else 0.0
    coordinates |= along_cut_paths(layout, recovered.states[instant], recovered.bodies[instant])
    for name, point in layout.mechanism.points.items():
        jets = motion_of(layout, point, recovered.bodies[instant : instant + 1])[0]
        coordinates |= {(name, quantity): (x, rate) for quantity, (x, rate, _) in jets.items()}
    for load, rows in layout.mechanism.load_rows():
        coordinates |= acted_between(load, recovered.loads[instant, rows])
        if isinstance(load, BushingLoad):
            coordinates |= strains(layout, load, rows.start, recovered, instant)
    return coordinates


def acted_between(load: Load, rows: np.ndarray[Any, Any]) -> Moving:
    """What a load acts between, as its own law may name it; of rates of rates nothing is known."""
    name = f"{LOADS}.{load.name}"
    if isinstance(load, PairLoad | RopeLoad):
        length, rate = float(rows["span"][0]), float(rows["rate"][0])
        return {(name, "length"): (length, rate), (name, "speed"): (rate, 0.0)}
    return {}


def strains(layout: Layout, load: BushingLoad, first: int, recovered: Recovered, instant: int) -> Moving:
    """The shift and the turn of a bushing with their rates, in its own axes; first: its row of the kernel's loads."""
    bodies, row = recovered.bodies[instant], layout.tables["loads"][first]
    (x_a, v_a, R_a, omega_a), (x_b, v_b, _, omega_b) = (
        point_of(bodies, int(row[body]), vector(row[point])) for body, point in (("a", "p"), ("b", "q"))
    )
    axes = R_a @ load.frame
    shift, turn = (np.array(vector(own)) for own in recovered.loads[instant, first : first + 2]["strain"])
    slip = axes.T @ (v_b - v_a - cross_rows(omega_a, x_b - x_a))
    turning = inverse_jacobian(turn) @ axes.T @ (omega_b - omega_a)
    return {
        (f"{LOADS}.{load.name}", f"{of}_{axis}"): (float(x), float(rate))
        for of, strain, rates in (("shift", shift, slip), ("turn", turn, turning))
        for axis, x, rate in zip("xyz", strain, rates, strict=True)
    }


def vector(own: Any) -> Array:
    """A vector of the kernel's tables."""
    return np.array(own.tolist())


def point_of(bodies: Table, body: int, arm: Array) -> tuple[Array, Array, Array, Array]:
    """Of a body's point, or the ground's: place, velocity; of the body attitude and angular velocity."""
    if body == GROUND:
        return arm, np.zeros(3), np.eye(3), np.zeros(3)
    own = bodies[body]
    turned = own["R"] @ arm
    return own["r"] + turned, own["v"] + cross_rows(own["omega"], turned), own["R"], own["omega"]


def without_value(mechanism: Mechanism, t: float, length: float, coordinates: Moving) -> list[Problem]:
    """The expressions without a finite value at t or just beyond, else those that grow without bound there.

    length: of the run; coordinates: at t, by joint and quantity.
    """
    scale = max(abs(t), length)
    beyond = scale * 2.0**-FARTHEST
    if problems := ways_left(mechanism, t, beyond, coordinates):
        return problems
    for beyond in (0.0, *(scale * 2.0**-k for k in range(NEAREST, FARTHEST - 1, -1))):
        problems = [
            _problem(expression, t + beyond, _values(expression, beyond, coordinates), not_finite)
            for expression, driven in _in_time(mechanism)
            if (not_finite := _not_finite(expression, t + beyond, _values(expression, beyond, coordinates), driven))
        ]
        if problems:
            return problems
    back = -scale * 2.0**-FARTHEST
    return [
        _problem(expression, t, _values(expression, 0.0, coordinates), "")
        for expression, _ in _in_time(mechanism)
        if abs(expression.value(t, _values(expression, 0.0, coordinates)))
        > tolerances.BOUNDLESS * abs(expression.value(t + back, _values(expression, back, coordinates)))
        > 0.0
    ]


def grown(mechanism: Mechanism, now: tuple[float, Moving], before: tuple[float, Moving]) -> list[Problem]:
    """The expressions that have grown out of all proportion; now, before: instants, and the coordinates there."""
    problems = []
    for expression, _ in _in_time(mechanism):
        values = _values(expression, 0.0, now[1])
        size = abs(expression.value(now[0], values))
        if size > tolerances.BOUNDLESS * abs(expression.value(before[0], _values(expression, 0.0, before[1]))) > 0.0:
            problem = _problem(expression, now[0], values, "")
            problems.append(problem._replace(message=f"{problem.message}, where it is {size:.3g}"))
    return problems


def large_values(mechanism: Mechanism, t: float, coordinates: Moving) -> list[Problem]:
    """The expressions whose value, or of drives rate or acceleration, is at an instant too large to compute with."""
    problems = []
    for expression, driven in _in_time(mechanism):
        values = _values(expression, 0.0, coordinates)
        jet = expression.derivatives(t) if driven else (expression.value(t, values),)
        of, value = max(zip(DERIVATIVES, jet, strict=False), key=lambda pair: abs(pair[1]))
        if abs(value) > tolerances.MOST_MAGNITUDE:
            what = "" if of == "value" else f"the {of} of "
            found = out_of_range(value, f"at t = {t:.9g} s {what}'{expression.source.strip()}'")
            problems.append(Problem(found.code, found.message, expression.location, found.hint))
    return problems


def _in_time(mechanism: Mechanism) -> Iterator[tuple[Expression, bool]]:
    """Every expression that is not constant, and whether it drives a joint or a rope."""
    driven = {id(law.value) for law in mechanism.laws}
    for expression in mechanism.expressions():
        if expression.constant is None:
            yield expression, id(expression) in driven


def _values(expression: Expression, later: float, coordinates: Moving) -> list[float]:
    """The coordinates an expression uses, extrapolated linearly by their rates."""
    return [q + later * u for q, u in (coordinates.get(use, (math.nan, 0.0)) for use in expression.uses)]


def _not_finite(expression: Expression, t: float, values: list[float], driven: bool) -> str:
    """Which of an expression's value and, for a drive, its rate and acceleration is not finite; empty if none."""
    if any(map(math.isnan, values)):
        return ""  # a coordinate is unknown: no statement is possible
    jet = expression.derivatives(t) if driven else (expression.value(t, values),)
    return next((name for name, x in zip(DERIVATIVES, jet, strict=False) if not math.isfinite(x)), "")


def _problem(expression: Expression, t: float, values: list[float], not_finite: str) -> Problem:
    """The problem of an expression without a finite value (empty: without a bound) at an instant."""
    at = "".join(f", {joint}.{key} = {x:.9g}" for (joint, key), x in zip(expression.uses, values, strict=True))
    subject = f"'{expression.source.strip()}'"
    table = _table_left(expression, t, values) if not_finite else None
    if table is not None:
        message, hint = outside(table)
        return Problem("no-value", f"{subject} has no value at t = {t:.9g} s{at}: {message}", expression.location, hint)
    what = f"has no finite {not_finite}" if not_finite else "grows without bound"
    hint = "keep it within the domain of its functions, as with max(x, 0) or 'a if c else b', or end the run before"
    return Problem("no-value", f"{subject} {what} at t = {t:.9g} s{at}", expression.location, hint)


def _table_left(expression: Expression, t: float, values: list[float]) -> TableFunction | None:
    """The table whose range was left: the one that, extended by its end values, makes the expression finite."""
    for index, table in enumerate(expression.tables):
        code = list(expression.code)
        for i in range(0, len(code) - 3, 2):
            if code[i] in (TABLE, KNOT) and code[i + 1 : i + 4] == [index, table.pieces, table.kind]:
                code[i + 3] = HELD
        held = replace(expression, code=tuple(code))
        if math.isfinite(held.value(t, values)):
            return table
    return None
