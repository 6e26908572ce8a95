"""What is said of a rest pose."""

from __future__ import annotations

import math

from heuncli.base import tolerances
from heuncli.base.errors import SolveError
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, solved

G = 9.81
GROUND = "ground: {points: {O: [0, 0, 0]}}\n"
MASS = "mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {c: [0, 0, 0]}"
BAR = "mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001], points: {top: [0, 0, 0], end: [0, 0, -1]}"


def scene(text: str, gravity: str = "[0, 0, 0]") -> str:
    return f"heun: 1\ngravity: {gravity}\nanalysis: {{type: rest}}\n{GROUND}{text}"


def slides(*names: str) -> str:
    """Masses of 1 kg on slides along x."""
    bodies = ", ".join(f"{name}: {{{MASS}}}" for name in names)
    joints = ", ".join(f"u{name}: {{type: slide, from: ground.O, to: {name}.c, axis: [1, 0, 0]}}" for name in names)
    return f"bodies: {{{bodies}}}\njoints: {{{joints}}}\n"


def rests(text: str) -> str:
    try:
        solved(text)
    except SolveError as error:
        assert error.problems[0].code == "no-rest-pose"
        return "refused"
    return "rests"


def far_away(x: float) -> str:
    """A force of 1 N against a spring that gives way by x times the scene's size, 2 sqrt(3/2) m."""
    size = 2.0 * math.sqrt(1.5)
    return rests(scene(f"{slides('a')}forces: {{f: {{type: torque, joint: ua, value: 1 - ua.travel/{x * size!r}}}}}"))


def wound_up(x: float) -> str:
    """A torque of 1 N m against a spring that it winds up by x."""
    body = f"bodies: {{a: {{{MASS}}}}}\njoints: {{p: {{type: pin, from: ground.O, to: a.c, axis: [1, 0, 0]}}}}\n"
    return rests(scene(f"{body}forces: {{f: {{type: torque, joint: p, value: 1 - p.angle/{x!r}}}}}"))


def pendulum(angle: str, more: str = "") -> str:
    joints = f"joints: {{p: {{type: pin, from: ground.O, to: a.top, axis: [0, 1, 0], initial: {{angle: {angle}}}}}}}\n"
    return scene(f"bodies: {{a: {{{BAR}}}}}\n{joints}{more}", f"[0, 0, -{G}]")


def beside_upright(x: float) -> str:
    """Drawn upright to x times the rounding of a pose."""
    found = solved(pendulum(repr(math.pi + x * tolerances.START_ROUNDING * math.pi)))
    angle = float(found.coordinates["p"]["angle"][0])
    if abs(angle - math.pi) < 1.0:
        near(angle, math.pi, 1.0, 1e-15)
        return "stays"
    near(angle, 2.0 * math.pi, 1.0, 1e-14)
    return "falls"


def tilted(x: float) -> str:
    """A bar on a spindle that turns about an axis which is upright to x."""
    bodies = f"bodies: {{s: {{{MASS}}}, a: {{{BAR}, orientation: {{axis: [0, 1, 0], angle: -40 deg}}}}}}\n"
    joints = (
        "joints: {m: {type: pin, axis: [0, 0, 1], from: ground.O, to: s.c}, "
        "p: {type: pin, axis: [0, 1, 0], from: s.c, to: a.top}}\n"
    )
    return rests(scene(f"{bodies}{joints}drives: {{w: {{joint: m, angle: 6*t}}}}", f"[0, {G * x!r}, -{G}]"))


def jumping(x: float) -> str:
    """A torque that jumps where it should hold, x of those that cancel there."""
    torques = ", ".join(
        f"{name}: {{type: torque, joint: p, value: {value}}}"
        for name, value in (("a", "10"), ("b", "-10"), ("c", f"{10.0 * x!r} - {20.0 * x!r}*sign(p.angle)"))
    )
    return rests(pendulum("0.3", f"forces: {{{torques}}}"))


PART = Part(
    ("rest",),
    rows=(
        Row("RUN_AWAY", far_away, "rests", "refused"),
        Row("TURNS_ON", wound_up, "rests", "refused"),
        Row("PUSHED_BY_ROUNDING", beside_upright, "stays", "falls", (0.01, 0.1, 10.0, 100.0)),
        Row("STEADY", tilted, "rests", "refused"),
        Row("NOT_HELD", jumping, "rests", "refused"),
    ),
    exempt={
        "INDIFFERENT": "along what a step of the search goes to its end; REAL_STIFFNESS_FACTOR decides the verdict",
        "NEARLY_DEFECTIVE": "how a step is taken: tests/closed_forms/test_rest.py has matrices, scenes on both sides",
        "REST_FIRST": "the first step of a search: its end is told to its digits",
        "REST_FARTHEST": "what accepts a step of the search",
        "REST_BENT": "what accepts a step of the search",
        "REST_STRAIGHT": "what accepts a step of the search",
        "REST_MISSED": "what accepts a step of the search",
        "REST_FINER": "how much finer a search is than the one that it checks",
        "REST_SAME": "whether two searches have found one pose: two poses lie farther apart",
        "REST_WAY": "how near two searches have to come along what nothing holds: what is left is stated",
        "REST_SEARCHES_DIFFER": "the same, of those that are made at most: farther apart is told as another pose",
        "REST_DOUBT": "when a finer search is made: tests/closed_forms/test_rest.py has starts beside a ridge",
    },
)
