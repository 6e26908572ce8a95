"""Find the expressions without a value where a run fails: which, where in the spec, and why. Imported only for an
error.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.errors import Problem
from heuncli.base.records import replace
from heuncli.base.units import range_error
from heuncli.motion.integration.conditions import point_motion
from heuncli.motion.integration.diagnosis.guide_departures import Moving, cut_path_coordinates, find_left_paths
from heuncli.motion.integration.evaluator import Evaluation
from heuncli.multibody.mechanism.loads import GROUND, BushingLoad, Load, PairLoad, RopeLoad
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.multibody.tree.layout import Layout
from heuncli.multibody.tree.tables import Table
from heuncli.results.results import Array
from heuncli.scene.expressions.programs import KNOT, LOADS, TABLE, Expression, TableFunction, out_of_range_texts
from heuncli.scene.shapes.rotations import cross_rows, inverse_jacobian

# An expression may lose its value only just after t: instants from 2**-52 to 2**-20 of the run's length later.
NEAREST, FARTHEST = 52, 20
HELD_TABLE = 1  # a table's kind (scene/expressions/programs.py)
DERIVATIVES = ("value", "rate", "acceleration")


def evaluate_coordinates(layout: Layout, evaluation: Evaluation, instant: int) -> Moving:
    """Return the coordinates of the joints, and of the points that expressions name, at one of the instants."""
    freedoms = evaluation.freedoms[instant]
    coordinates: dict[tuple[str, str], tuple[float, float]] = {}
    joints = layout.mechanism.joints
    for freedom, (q, u, a, _) in zip(layout.freedoms, freedoms.tolist(), strict=True):
        if freedom.joint >= 0 and freedom.quantity in ("angle", "travel"):
            name = joints[freedom.joint].name
            coordinates[name, freedom.quantity] = q, u
            coordinates[name, "rate" if freedom.quantity == "angle" else "speed"] = u, a if math.isfinite(a) else 0.0
    coordinates |= cut_path_coordinates(layout, evaluation.states[instant], evaluation.bodies[instant])
    for name, point in layout.mechanism.points.items():
        jets = point_motion(layout, point, evaluation.bodies[instant : instant + 1])[0]
        coordinates |= {(name, quantity): (x, rate) for quantity, (x, rate, _) in jets.items()}
    for load, rows in layout.mechanism.iter_load_rows():
        coordinates |= load_coordinates(load, evaluation.loads[instant, rows])
        if isinstance(load, BushingLoad):
            coordinates |= find_bushing_strains(layout, load, rows.start, evaluation, instant)
    return coordinates


def load_coordinates(load: Load, rows: np.ndarray[Any, Any]) -> Moving:
    """Return the coordinates between which a load acts, as its own law may name them; second derivatives are
    unknown.
    """
    name = f"{LOADS}.{load.name}"
    if isinstance(load, PairLoad | RopeLoad):
        length, rate = float(rows["span"][0]), float(rows["rate"][0])
        return {(name, "length"): (length, rate), (name, "speed"): (rate, 0.0)}
    return {}


def find_bushing_strains(layout: Layout, load: BushingLoad, first: int, evaluation: Evaluation, instant: int) -> Moving:
    """Return the shift and the rotation of a bushing with their rates, in its own axes; first: its row of kernel
    loads.
    """
    bodies, row = evaluation.bodies[instant], layout.tables["loads"][first]
    (x_a, v_a, R_a, omega_a), (x_b, v_b, _, omega_b) = (
        find_point_state(bodies, int(row[body]), to_vector(row[point])) for body, point in (("a", "p"), ("b", "q"))
    )
    axes = R_a @ load.frame
    shift, turn = (
        np.array(to_vector(components)) for components in evaluation.loads[instant, first : first + 2]["strain"]
    )
    slip = axes.T @ (v_b - v_a - cross_rows(omega_a, x_b - x_a))
    turning = inverse_jacobian(turn) @ axes.T @ (omega_b - omega_a)
    return {
        (f"{LOADS}.{load.name}", f"{quantity}_{axis}"): (float(x), float(rate))
        for quantity, strain, rates in (("shift", shift, slip), ("turn", turn, turning))
        for axis, x, rate in zip("xyz", strain, rates, strict=True)
    }


def to_vector(components: Any) -> Array:
    """Convert a vector of the kernel's tables to an array."""
    return np.array(components.tolist())


def find_point_state(bodies: Table, body: int, arm: Array) -> tuple[Array, Array, Array, Array]:
    """Return position and velocity of a point of a body or the ground, and attitude and angular velocity of the
    body.
    """
    if body == GROUND:
        return arm, np.zeros(3), np.eye(3), np.zeros(3)
    body_row = bodies[body]
    rotated_arm = body_row["R"] @ arm
    return (
        body_row["r"] + rotated_arm,
        body_row["v"] + cross_rows(body_row["omega"], rotated_arm),
        body_row["R"],
        body_row["omega"],
    )


def find_without_value(mechanism: Mechanism, t: float, length: float, coordinates: Moving) -> list[Problem]:
    """Find the expressions without a finite value at t or just after it, else those that grow without bound there.

    length: of the run
    coordinates: at t, by joint and quantity
    """
    scale = max(abs(t), length)
    later = scale * 2.0**-FARTHEST
    if problems := find_left_paths(mechanism, t, later, coordinates):
        return problems
    for later in (0.0, *(scale * 2.0**-k for k in range(NEAREST, FARTHEST - 1, -1))):
        problems = [
            _make_problem(expression, t + later, _extrapolate_coordinates(expression, later, coordinates), not_finite)
            for expression, driven in _iter_variable_expressions(mechanism)
            if (
                not_finite := _find_not_finite(
                    expression, t + later, _extrapolate_coordinates(expression, later, coordinates), driven
                )
            )
        ]
        if problems:
            return problems
    back = -scale * 2.0**-FARTHEST
    return [
        _make_problem(expression, t, _extrapolate_coordinates(expression, 0.0, coordinates), "")
        for expression, _ in _iter_variable_expressions(mechanism)
        if abs(expression.value(t, _extrapolate_coordinates(expression, 0.0, coordinates)))
        > tolerances.BOUNDLESS
        * abs(expression.value(t + back, _extrapolate_coordinates(expression, back, coordinates)))
        > 0.0
    ]


def find_grown(mechanism: Mechanism, current: tuple[float, Moving], earlier: tuple[float, Moving]) -> list[Problem]:
    """Find the expressions that have grown out of all proportion; current, earlier: instants, and the coordinates
    there.
    """
    problems = []
    for expression, _ in _iter_variable_expressions(mechanism):
        values = _extrapolate_coordinates(expression, 0.0, current[1])
        size = abs(expression.value(current[0], values))
        if (
            size
            > tolerances.BOUNDLESS
            * abs(expression.value(earlier[0], _extrapolate_coordinates(expression, 0.0, earlier[1])))
            > 0.0
        ):
            problem = _make_problem(expression, current[0], values, "")
            problems.append(problem._replace(message=f"{problem.message}, where it is {size:.3g}"))
    return problems


def find_large_values(mechanism: Mechanism, t: float, coordinates: Moving) -> list[Problem]:
    """Find the expressions whose value, or for drives rate or acceleration, is too large to compute with at an
    instant.
    """
    problems = []
    for expression, driven in _iter_variable_expressions(mechanism):
        values = _extrapolate_coordinates(expression, 0.0, coordinates)
        jet = expression.derivatives(t) if driven else (expression.value(t, values),)
        derivative, value = max(zip(DERIVATIVES, jet, strict=False), key=lambda pair: abs(pair[1]))
        if abs(value) > tolerances.MOST_MAGNITUDE:
            what = "" if derivative == "value" else f"the {derivative} of "
            range_problem = range_error(value, f"at t = {t:.9g} s {what}'{expression.source.strip()}'")
            problems.append(Problem(range_problem.code, range_problem.message, expression.location, range_problem.hint))
    return problems


def _iter_variable_expressions(mechanism: Mechanism) -> Iterator[tuple[Expression, bool]]:
    """Yield every expression that is not constant, and whether it drives a joint or a rope."""
    driving = {id(law.value) for law in mechanism.laws}
    for expression in mechanism.iter_expressions():
        if expression.constant is None:
            yield expression, id(expression) in driving


def _extrapolate_coordinates(expression: Expression, later: float, coordinates: Moving) -> list[float]:
    """Return the coordinates an expression uses, extrapolated linearly by their rates."""
    return [q + later * u for q, u in (coordinates.get(use, (math.nan, 0.0)) for use in expression.uses)]


def _find_not_finite(expression: Expression, t: float, values: list[float], is_driving: bool) -> str:
    """Return which of an expression's value and, for a drive, its rate and acceleration is not finite; empty if
    none.
    """
    if any(map(math.isnan, values)):
        return ""  # a coordinate is unknown: no statement is possible
    jet = expression.derivatives(t) if is_driving else (expression.value(t, values),)
    return next((name for name, x in zip(DERIVATIVES, jet, strict=False) if not math.isfinite(x)), "")


def _make_problem(expression: Expression, t: float, values: list[float], not_finite: str) -> Problem:
    """Make the problem of an expression that has no finite value at an instant, or (not_finite empty) no bound."""
    coordinates_text = "".join(
        f", {joint}.{key} = {x:.9g}" for (joint, key), x in zip(expression.uses, values, strict=True)
    )
    subject = f"'{expression.source.strip()}'"
    table = _find_left_table(expression, t, values) if not_finite else None
    if table is not None:
        message, hint = out_of_range_texts(table)
        return Problem(
            "no-value",
            f"{subject} has no value at t = {t:.9g} s{coordinates_text}: {message}",
            expression.location,
            hint,
        )
    what = f"has no finite {not_finite}" if not_finite else "grows without bound"
    hint = "keep it within the domain of its functions, as with max(x, 0) or 'a if c else b', or end the run earlier"
    return Problem("no-value", f"{subject} {what} at t = {t:.9g} s{coordinates_text}", expression.location, hint)


def _find_left_table(expression: Expression, t: float, values: list[float]) -> TableFunction | None:
    """Find the table whose range was left: the one that, extended by its end values, makes the expression finite."""
    for index, table in enumerate(expression.tables):
        code = list(expression.code)
        for i in range(0, len(code) - 3, 2):
            if code[i] in (TABLE, KNOT) and code[i + 1 : i + 4] == [index, table.pieces, table.kind]:
                code[i + 3] = HELD_TABLE
        extended = replace(expression, code=tuple(code))
        if math.isfinite(extended.value(t, values)):
            return table
    return None
