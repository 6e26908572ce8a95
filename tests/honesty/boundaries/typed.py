"""What is typed in a spec: units, inertias, tables, limits, expectations."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.errors import HeunError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.build import build
from heuncli.multibody.mechanism.model import Stop
from heuncli.multibody.tree.prepare import prepare
from heuncli.scene.expressions.measured_signals import differentiate_points, estimate_derivative_error
from heuncli.scene.file_format.load import load
from heuncli.scene.file_format.rotations import rotation_from_matrix
from heuncli.study.queries.expectations import compare
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import WEIGHT, bar, read
from tests.shared.imported import imported
from tests.shared.scenes import near, study


def start_beyond(x: float) -> str:
    """A pin that starts at the angle 0, above the limit of its stop by x."""
    mechanism = build(load("scene.yaml", bar(kind="pin, axis: [0, 1, 0]")), {})
    stopped = replace(mechanism, stops=(Stop("s", 0, "angle", None, -x, 0.0),))
    try:
        prepare(stopped)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "fine"


def quaternion(x: float) -> str:
    return read(bar(f", orientation: {{quaternion: [{1 + x!r}, 0, 0, 0]}}"))


def matrix(x: float) -> str:
    given = ((1.0 + x / 2, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    R = rotation_from_matrix(given)
    near(R, np.eye(3), 1.0, 2 * x)
    return "as typed" if R == given else "made a rotation"


def principal(x: float) -> str:
    return read(bar(inertia=f"[1, 1, {2 / (1 - x)!r}]"))


def unsymmetric(x: float) -> str:
    return read(bar(inertia=f"[[1, {x!r}, 0], [0, 1, 0], [0, 0, 1]]"))


def periodic(x: float) -> str:
    return read(bar(tail=f"tables: {{w: {{x: [0, 1, 2], y: [0, 1, 0], period: {2 * (1 + x)!r}}}}}"))


def derivative(x: float) -> str:
    """A line of slope 1 with one point off it, by so much that the part x of its derivative is uncertain."""
    points = np.arange(20.0)

    def uncertain_part(off: float) -> float:
        y = points + off * (points == 11.0)
        error = estimate_derivative_error(points, y, "cubic", False, 1, None)
        assert error is not None
        return error / float(np.abs(differentiate_points(points, y, "cubic", False, 1)).max())

    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if uncertain_part(middle) < x else (low, middle)
    y = (points + high * (points == 11.0)).tolist()
    return read(bar(tail=f"tables: {{w: {{x: {points.tolist()}, y: {y}, interpolation: cubic, derivative: 1}}}}"))


def moment(x: float) -> str:
    """A link of a robot of 1 m and 1 kg with one product of inertia of x."""
    names = ("ixx", "iyy", "izz", "ixy", "iyz")
    zeros = " ".join(f'{name}="0"' for name in names)
    inertial = f'<inertial><origin xyz="0 0 1"/><mass value="1"/><inertia {zeros} ixz="{x!r}"/></inertial>'
    try:
        imported(f'<robot name="r"><link name="a">{inertial}</link></robot>')
    except HeunError as error:
        return error.problems[0].message.partition(" but")[0].partition(":")[0]
    return "fine"


def strength(x: float) -> str:
    cut = (
        "{body: bar, at: [0, 0, -0.4], normal: [0, 0, -1], piece: {mass: 0.6, center: [0, 0, -0.7], inertia: [1, 1, 1]}"
    )
    return read(bar(tail=f"sections: {{c: {cut}, properties: {{circle: {{radius: 0.01}}}}, strength: {x!r}}}}}"))


def buckling(x: float) -> str:
    """A bar whose weight is so small against its modulus that its safety against buckling is x."""
    size = "from: [0, 0, -1], to: [0, 0, 0], radius: 0.01"
    modulus = x * WEIGHT / (math.pi**2 * math.pi / 4 * 0.01**4)
    done = study(f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{shapes: [{{type: cylinder, {size}, mass: 1}}], points: {{foot: [0, 0, -1], head: [0, 0, 0]}}}}
joints: {{head: {{type: weld, from: ground.O, to: bar.head}}}}
forces: {{push: {{type: force, on: bar.foot, vector: [0, 0, {WEIGHT}]}}}}
sections:
  c: {{body: bar, from: foot, to: head, count: 2, properties: auto, deflection: true, modulus: {modulus!r}}}
""")
    safety = float(done.results.sections["c"]["buckling"][0])
    return "as it is" if abs(safety / x - 1) < 1e-9 else "the greatest"


def bushing(turning: str) -> str:
    return read(bar(tail=f"forces: {{b: {{type: bushing, from: ground.O, to: bar.end, turning: {turning}}}}}"))


def skew_bushing(x: float) -> str:
    """Two elements off the diagonal that differ by x of the largest."""
    return bushing(f"[[5, 1, 0], [{1 + 5 * x!r}, 2, 0], [0, 0, 3]]")


def driving_bushing(x: float) -> str:
    """A direction with the stiffness -x where the diagonal is 1."""
    return bushing(f"[[4, {2 * (1 + x)!r}, 0], [{2 * (1 + x)!r}, 1, 0], [0, 0, 3]]")


def expectation(wanted: str) -> str:
    done = study(bar(tail=f"expect: [{wanted}]"))
    return "passed" if compare(done, done.spec.expect[0]).is_met else "failed"


def relatively_off(x: float) -> str:
    return expectation(f"{{of: joints.pivot.force.z, is: {WEIGHT / (1 - x)!r}}}")


def absolutely_off(x: float) -> str:
    return expectation(f"{{of: joints.pivot.force.x, is: {x!r}}}")


PART = Part(
    ("what is typed in a spec",),
    rows=(
        Row("UNIT_TYPED", quaternion, "fine", "refused: orientation"),
        Row("UNIT_EXACT", matrix, "as typed", "made a rotation"),
        Row("INERTIA_REFUSED", principal, "warned: inertia-rounded", "refused: inertia-not-physical"),
        Row("INERTIA_TYPED", principal, "fine", "warned: inertia-rounded"),
        Row("INERTIA_TYPED", unsymmetric, "fine", "refused: inertia-form"),
        Row("STIFFNESS_TYPED", skew_bushing, "fine", "refused: bushing-matrix"),
        Row("STIFFNESS_TYPED", driving_bushing, "fine", "refused: bushing-matrix"),
        Row("NO_IMPORTED_MOMENT", moment, "all moments of inertia are 0,", "a principal moment of inertia is negative"),
        Row("DERIVATIVE_ERROR", derivative, "fine", "warned: table-derivative", (0.01, 1 / 3, 3.0)),
        Row("TABLE_ENDS", periodic, "fine", "refused: table-period"),
        Row("LEAST_STRENGTH", strength, "warned: strength-small", "fine"),
        Row("GREATEST_SAFETY", buckling, "as it is", "the greatest"),
        Row("EXPECTED_RELATIVE", relatively_off, "passed", "failed"),
        Row("EXPECTED_ABSOLUTE", absolutely_off, "passed", "failed"),
        Row("AT_LIMIT", start_beyond, "fine", "refused: beyond-stop"),
    ),
)
