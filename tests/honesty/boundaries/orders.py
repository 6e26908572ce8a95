"""Orders of a cycle that cancel, and those that do not; a motion that comes back with a period, and one that grows."""

from __future__ import annotations

from heuncli.analyses.balancing.orders import classify_order
from heuncli.analyses.balancing.results import BalanceOptions
from heuncli.analyses.balancing.study import balance
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


PART = Part(
    headings=("orders",),
    rows=(Row("CANCELS", left, "cancels", "remains"), Row("SAME_PERIOD", growing, "told", "no-period")),
    exempt={
        "ORDERS_SETTLED": "how many samples are taken: with more of them the orders are the same to their digits",
        "SAME_WEIGHT": "which of several weights that serve alike are proposed: what they leave is the same",
    },
)
