"""Orders of a cycle that cancel, and those that do not; a motion that comes back with a period, and one that grows."""

from __future__ import annotations

import numpy as np

from heuncli.analyses.balancing.counterweight_fit import Candidate, WeightPlace
from heuncli.analyses.balancing.orders import classify_order, format_direction, format_remaining_orders
from heuncli.analyses.balancing.results import BalanceOptions, FlywheelRequest, OrderRow
from heuncli.analyses.balancing.sampling import select_shown_orders
from heuncli.analyses.balancing.study import balance
from heuncli.analyses.balancing.work_curve import choose_constant_torque
from heuncli.base.errors import SolveError
from heuncli.scene.file_format.load import load
from tests.honesty.boundaries.part import Part, Row

PERIOD = 0.5


def left(x: float) -> str:
    """Two bodies whose forces of an order, 2 N and 2 N, leave 4 x N of it."""
    return classify_order(4.0 * x, 4.0, 10.0)


def growing(x: float) -> str:
    """A mass to and fro, by x of its stroke more from period to period."""
    text = f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{m: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{c: [0, 0, 0]}}}}}}
joints: {{S: {{type: slide, from: ground.O, to: m.c, axis: [1, 0, 0]}}}}
drives: {{to: {{joint: S, travel: cos(4*pi*t)*(1 + {x!r}*t/{PERIOD})}}}}
analysis: {{duration: {2.0 * PERIOD}, samples: 3}}
"""
    try:
        found = balance(load("scene.yaml", text), BalanceOptions(period=PERIOD))
    except SolveError as error:
        return error.problems[0].code
    assert found.period is not None and found.period.relative_difference >= 0.3 * x
    return "told"


def order_row(order: float, size: float, *, against: float = 0.0) -> OrderRow:
    """An order that turns across the axis, and remains."""
    amplitude = np.array([size, size, 0.0])
    return OrderRow(
        order, amplitude, np.zeros(3), size, size, "remains",
        with_turn=size, against_turn=against * size, is_across_axis=True,
    )  # fmt: skip


def turning(x: float) -> str:
    """A force with the turn, and x of it against."""
    return format_direction(order_row(1.0, 1.0, against=x)) or "an ellipse"


def named(x: float) -> str:
    """Two orders, the second x of the first."""
    text = format_remaining_orders([order_row(1.0, 1.0), order_row(2.0, x)])
    return "smaller" if "smaller ones up to order 2" in text else "named" if "1 and 2" in text else text


def listed(x: float) -> str:
    return {(1.0,): "on request", (1.0, 2.0): "listed"}[
        select_shown_orders({"force": (order_row(1.0, 1.0), order_row(2.0, x))})
    ]


def unbalanced(x: float) -> str:
    """Loads of 2 N m, of either sign, whose mean is 2 x."""
    torque = choose_constant_torque(2.0 * x, 2.0)
    return "nothing" if torque == 0.0 else "a torque" if torque == -2.0 * x else f"{torque}"


def turning_evenly(x: float) -> str:
    """A flywheel that lets a shaft under a wave of torque fluctuate by x."""
    text = """
heun: 1
ground: {points: {O: [0, 0, 0]}}
bodies: {s: {mass: 1, center: [0, 0, 0], inertia: [5, 5, 5], points: {c: [0, 0, 0]}}}
joints: {s: {type: pin, from: ground.O, to: s.c, axis: [0, 0, 1]}}
forces: {tool: {type: torque, joint: s, value: 40*sin(2*s.angle)}}
"""
    try:
        wheel = balance(load("scene.yaml", text), BalanceOptions(rate=2.0, flywheel=FlywheelRequest("", x))).flywheel
    except SolveError as error:
        return error.problems[0].code
    assert wheel is not None and abs(wheel.added / (10.0 / x) - 1.0) <= 2e-7
    return "sized"


def weighing(x: float) -> str:
    """A place where a weight's own mass does x of what its product does."""
    place = WeightPlace(0, "rim", np.zeros(3), 1.0)
    candidate = Candidate(place, 1.0, np.eye(3)[:, :2], np.full(4, x), np.ones((4, 2)), np.zeros((4, 2, 2)))
    return "linear" if candidate.is_linear(1.0) else "by its mass"


PART = Part(
    headings=("orders",),
    rows=(
        Row("CANCELS", left, "cancels", "remains"),
        Row("SAME_PERIOD", growing, "told", "no-period"),
        Row("NO_PART", turning, "rotating with the shaft", "an ellipse"),
        Row("NAMED_ORDER", named, "smaller", "named"),
        Row("LISTED_ORDER", listed, "on request", "listed"),
        Row("NO_NET_WORK", unbalanced, "nothing", "a torque"),
        Row("EVEN_RATE", turning_evenly, "no-flywheel", "sized"),
        Row("NO_EFFECT", weighing, "linear", "by its mass"),
    ),
    exempt={
        "ORDERS_SETTLED": "how many samples are taken: with more of them the orders are the same to their digits",
        "NO_SQUARE": "how finely loads are sampled: beyond it they are the same to their digits",
        "NO_WEIGHT": "whether a weight of a billionth of another is proposed, or none",
        "LAW_FOLLOWED": "where a law is sampled once more: what is told has its own error",
        "BESIDE_BREAK": "how near to a known break a law is sampled: nothing is between",
        "RESOLVED_TO_NOISE": "when a piece is halved no more: its orders keep their digits",
        "SHORTEST_PIECE": "likewise",
        "SAME_WEIGHT": "which of several weights that serve alike are proposed: what they leave is the same",
    },
)
