"""Which components no law of rigid bodies decides, and the sums of them that are certain."""

from __future__ import annotations

import math

import numpy as np

from heuncli.loads.redundancy.determinate_sums import (
    find_dependent_components,
    find_factors,
    find_relations,
    tidy_factors,
)
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT
from tests.shared.scenes import near, solved


def inclined(x: float) -> str:
    """A bar on two balls, inclined by x: its axial force is open, and so what of it acts along z."""
    b = f"[{math.cos(x)!r}, 0, {math.sin(x)!r}]"
    found = solved(f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{A: [0, 0, 0], B: {b}}}}}
bodies:
  bar: {{mass: 1, center: [0, 0, 0], inertia: [0.1, 0.1, 0.1], points: {{a: [0, 0, 0], b: {b}}}}}
joints:
  A: {{type: ball, from: ground.A, to: bar.a}}
  B: {{type: ball, from: ground.B, to: bar.b}}
""")
    force = found.joints["A"]["force"][0, 2]
    if np.isnan(force):
        return "open"
    near(force, WEIGHT, WEIGHT)
    return "a number"


def stiff(x: float) -> str:
    """Two bars, each between two balls: one soft, one stiffer by x^-2, whose open force strains it x as much."""
    points, bodies, joints = [], [], []
    for k, stiffness in enumerate((1.0, x**-2)):
        points += [f"A{k}: [0, {k}, 0]", f"B{k}: [1, {k}, 0]"]
        bodies.append(f"  b{k}: {{mass: 1, center: [0.5, {k}, 0], inertia: [0.1, 0.1, 0.1], "
                      f"points: {{a: [0, {k}, 0], b: [1, {k}, 0]}}}}")  # fmt: skip
        joints += [f"  {n}{k}: {{type: ball, from: ground.{n}{k}, to: b{k}.{n.lower()}, stiffness: {stiffness!r}}}"
                   for n in "AB"]  # fmt: skip
    push = "forces: {f: {type: force, on: {body: b1, at: [0.5, 1, 0]}, vector: [1, 0, 0]}}"
    head = f"heun: 1\nground: {{points: {{{', '.join(points)}}}}}\nbodies:\n"
    found = solved(head + "\n".join(bodies) + "\njoints:\n" + "\n".join(joints) + "\n" + push)
    near(found.foundation["force"][0], [1, 0, 0], 1.0)
    force = found.joints["A1"]["force"][0, 0]
    if np.isnan(force):
        return "open"
    near(abs(force), 0.5, 1.0, 1e-6)
    return "shared"


def proportional(x: float) -> str:
    found, _ = find_relations({"a": np.array([1.0, 0.0]), "b": np.array([1.0, x])})
    return "a sum" if found else "none"


def told_by_turning(x: float) -> str:
    rows = np.array([[[1.0, 0.0], [1.0, x]]])
    return "a sum" if find_factors(rows) is not None else "none"


def nearly_vanishing(x: float) -> str:
    """Of a component that vanishes in one pose what is left there beside another one is rounding, or is not."""
    poses = {"a": np.array([[1.0, 0.0], [1.0, 0.0]]), "b": np.array([[1.0, 0.0], [0.0, x]])}
    return "a sum" if find_dependent_components(poses) else "none"


def present(x: float) -> str:
    a, b, c = np.eye(3)
    (terms,), _ = find_relations({"a": a, "b": b, "c": c, "sum": a + b + x * c})
    return "present" if "c" in terms else "absent"


def whole(x: float) -> str:
    return "whole" if tidy_factors({"a": 1.0, "b": 2.0 + x})["b"] == 2.0 else "as found"


PART = Part(
    ("open",),
    rows=(
        Row("OPEN_SHARE", inclined, "a number", "open"),
        Row("STRAINED_SELF_STRESS", stiff, "open", "shared"),
        Row("DEPENDENT_SHARES", proportional, "a sum", "none"),
        Row("DEPENDENT_SHARES", told_by_turning, "a sum", "none"),
        Row("DEPENDENT_SHARES", nearly_vanishing, "a sum", "none"),
        Row("ABSENT_FACTOR", present, "absent", "present"),
        Row("WHOLE_FACTOR", whole, "whole", "as found"),
    ),
    exempt={
        "ZERO_COMPONENT": "the digits of a direction that is proposed",
    },
    wanted={
        "HELD_BY_OTHERS": "whether a joint gives way in a direction that others hold askew",
        "SUM_POSES": "which sums of one pose are accidents",
        "NO_SELF_STRESS": "whether a null vector is a self-stress",
        "OPEN_AFTER_SPLIT": "what a split leaves open",
        "ONE_DIRECTION": "whether advice proposes a line",
    },
)
