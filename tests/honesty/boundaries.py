"""A row a threshold: what is seen on either side of it, by the smallest scene, or the smallest call, that reaches it.

`seen(x)` answers with the verdict where the judged quantity is x, in the threshold's own measure; what it answers with
numbers it holds against their closed form, so that both sides are honest: a refusal, a warning, or a right number.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from heuncli import tolerances
from heuncli.charting.reference import judged_instants
from heuncli.charting.results import COMPLETED, Charted, with_front
from heuncli.charting.results import Row as RowOfChart
from heuncli.errors import HeunError
from heuncli.integration.check.runs import shared_steps
from heuncli.integration.contacts.complementarity import complementary
from heuncli.integration.contacts.resting import short_flights
from heuncli.integration.contacts.touching import Touching, answerable
from heuncli.integration.run.pace import hopeless
from heuncli.kinetostatics.auto_properties import Cutting, joined
from heuncli.kinetostatics.energy import energy_drift
from heuncli.kinetostatics.foundation import central_axis
from heuncli.kinetostatics.section_axes import nearest_axis
from heuncli.linearisation.oscillations import oscillations
from heuncli.linearisation.reduced import Reduced
from heuncli.linearisation.steady import off_balance
from heuncli.mechanism.build import build
from heuncli.mechanism.model import Stop
from heuncli.modes.study import modes
from heuncli.probing.growth import told
from heuncli.probing.numerics.shadows import Growth
from heuncli.probing.study import probe
from heuncli.records import replace
from heuncli.redundancy.certain_sums import relations, tidy
from heuncli.redundancy.turning_sums import factors
from heuncli.report.labels import labels_of
from heuncli.report.page import page_of
from heuncli.results import Results
from heuncli.shapes.figures import Rectangle
from heuncli.shapes.forms import Form
from heuncli.spec.load import load
from heuncli.spec.turns import of_matrix
from heuncli.study.ask.expectations import compare
from heuncli.study.solve.near_singular import AMPLE, error, reached
from heuncli.study.solve.options import Options
from heuncli.study.solve.warnings import unbalanced
from heuncli.tree.prepare import prepare
from tests.honesty import rest
from tests.honesty.nearly_flat import PARTS, drawn_askew, leaving
from tests.shared.pushed_block import pushed_block
from tests.shared.scenes import near, solved, study
from tests.shared.stretched_chain import stretched_chain

FACTORS = (0.01, 1 / 3, 3.0, 100.0)


class Row(NamedTuple):
    """A threshold by name (KERNEL.x: of the kernel), its boundary as a scene, and the verdicts on either side.

    factors: of the threshold, where the verdict is looked at.
    """

    name: str
    seen: Callable[[float], str]
    below: str
    above: str
    factors: tuple[float, ...] = FACTORS


def tilted_by(x: float) -> str:
    """A body whose z is x off the world's."""
    body = f"{{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], orientation: {{axis: [1, 0, 0], angle: {x!r}}}}}"
    found = probe(load("scene.yaml", f"heun: 1\nbodies: {{b: {body}}}\nanalysis: {{type: state}}\n"), Options())
    wanted = 1.0 / math.tan(0.5 * x)
    near(found.attitudes[0].euler["zxz"][0], wanted, wanted, 1e-7)
    return found.events[0].kind if found.events else "none"


def grown(x: float) -> str:
    """A disturbance that grows x times over the second half of a run, and as evenly before."""
    times = np.linspace(0.0, 1.0, 11)
    growing, _ = told(Growth(times, 2.0 * math.log(x) * times, np.ones(11)), 1)
    assert growing is not None
    near(growing.rate, 2.0 * math.log(x), 1.0)
    return "exponential" if growing.exponential else "with the time"


# ---- what reading a spec says
def read(text: str) -> str:
    """The code of the first error, else of the first warning, else `fine`."""
    try:
        spec = load("scene.yaml", text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return f"warned: {spec.warnings[0].code}" if spec.warnings else "fine"


def steady_pace(x: float) -> str:
    """A run of which a hundred steps were done, at a pace that would take x times what may be left: 1e6 of 10,000."""
    return "told" if hopeless(np.arange(1.0, 101.0), x * 1e5, 10_000) else "goes on"


def steps_given(x: float) -> str:
    """A run whose check run goes in x steps, quarters of those given."""
    return read(bar(tail=f"analysis: {{duration: 1, method: RK4, step: {4.0 / x!r}}}\n"))


def step_in_common(x: float) -> str:
    """Of two runs of 1 s, of which the one has steps of 1 s and x s, and the other the latter alone of them."""
    return "shared" if shared_steps(np.array([1.0, 1.0 + x]), np.array([0.4, 1.0, 1.0 + x])) else "apart"


def step_beside(x: float) -> str:
    """Of two runs of one step, x of it longer in the one."""
    return "shared" if shared_steps(np.array([1.0]), np.array([1.0 + x])) else "apart"


def start_beyond(x: float) -> str:
    """A pin that starts at the angle 0, above the limit of its stop by x."""
    mechanism = build(load("scene.yaml", bar(kind="pin, axis: [0, 1, 0]")), {})
    stopped = replace(mechanism, stops=(Stop("s", 0, "angle", None, -x, 0.0),))
    try:
        prepare(stopped)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    return "fine"


def moved_by(x: float) -> str:
    """A load whose largest companion is 2 N, where its state is moved by rounding."""
    off = error(np.array([3.0]), np.array([3.0, 3.0 - 2.0 * x / AMPLE, 3.0]))
    return "not known" if reached(off, np.array([2.0])).any() else "told"


def judged(x: float) -> str:
    """Two references that agree, differ by x and then by everything."""
    error = np.array([0.0, 1e-14, x, 1.0])
    pair: Any = SimpleNamespace(error=error, first=SimpleNamespace(times=np.arange(4.0)))
    return {2: "not judged", 3: "judged"}[judged_instants(pair)[0]]


def off_by(x: float) -> str:
    """A run that came to its end, alone in its chart."""
    row = RowOfChart("RK4", "quaternion", True, 0.1)
    (run,) = with_front([Charted(row, COMPLETED, 1.0, 1, 10, 40, {"motion": x, "reactions": x, "sections": None})])
    return "on the front" if run.front else "lost"


def bar(more: str = "", tail: str = "", inertia: str = "[0.08, 0.08, 0.001]", kind: str = "ball") -> str:
    """A bar of 1 m and 1 kg that hangs from the origin."""
    return f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar: {{mass: 1, center: [0, 0, -0.5], inertia: {inertia}, points: {{top: [0, 0, 0], end: [0, 0, -1]}}{more}}}
joints:
  pivot: {{type: {kind}, from: ground.O, to: bar.top}}
{tail}"""


BAR_SIZE = 1.25  # m, of the scene: twice the largest distance of O, top, centre and end from their mean
WEIGHT = 9.81


def quaternion(x: float) -> str:
    return read(bar(f", orientation: {{quaternion: [{1 + x!r}, 0, 0, 0]}}"))


def matrix(x: float) -> str:
    given = ((1.0 + x / 2, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    R = of_matrix(given)
    near(R, np.eye(3), 1.0, 2 * x)
    return "as typed" if R == given else "made a rotation"


def principal(x: float) -> str:
    return read(bar(inertia=f"[1, 1, {2 / (1 - x)!r}]"))


def unsymmetric(x: float) -> str:
    return read(bar(inertia=f"[[1, {x!r}, 0], [0, 1, 0], [0, 0, 1]]"))


def periodic(x: float) -> str:
    return read(bar(tail=f"tables: {{w: {{x: [0, 1, 2], y: [0, 1, 0], period: {2 * (1 + x)!r}}}}}"))


def along_the_normal(x: float) -> str:
    section = f"{{body: bar, at: [0, 0, -0.3], normal: [0, 0, 1], first_axis: [{x!r}, 0, 1]}}"
    return read(bar(", piece: {mass: 0.7, center: [0, 0, -0.65], inertia: [1, 1, 1]}", f"sections: {{s: {section}}}"))


def tilted(x: float) -> str:
    text = bar(f", orientation: {{axis: [1, 0, 0], angle: {2 * math.asin(math.sqrt(x / 2))!r}}}", kind="pin")
    return read(text.replace("gravity: [0, 0, -9.81]", "space: planar"))


def held_and_driven(x: float) -> str:
    drive = "drives: {m: {joint: pivot, angle: 0.5 + t}}\nanalysis: {duration: 1, samples: 3}"
    joint = f"pin, axis: [0, 1, 0], initial: {{angle: {0.5 + x!r}}}"
    return read(bar(tail=drive, kind=joint))


def expected_at(x: float) -> str:
    expect = f"expect: [{{of: joints.pivot.force.z, at: {0.5 + x!r}, is: 9.81}}]"
    return read(bar(tail=f"analysis: {{duration: 1, samples: 3}}\n{expect}"))


def beyond_its_steps(x: float) -> str:
    """A fall of ten given steps and x of one more, into which the last one goes or which is a step by itself."""
    fall = {
        "gravity": [0, 0, -9.81], "bodies": {"b": {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1]}},
        "analysis": {"times": [0.0, 1.0 + 0.1 * x], "method": "RK4", "step": 0.1},
    }  # fmt: skip
    found = solved(fall, reduce=False)
    near(found.bodies["b"]["position"][-1][2], -0.5 * 9.81 * found.time[-1] ** 2, 5.0, 1e-14)
    return f"{found.work['steps']} steps"


def tolerance(x: float) -> str:
    return read(bar(tail=f"analysis: {{duration: 1, samples: 3, tolerance: {x!r}}}"))


def expectation(wanted: str) -> str:
    done = study(bar(tail=f"expect: [{wanted}]"))
    return "passed" if compare(done, done.spec.expect[0]).passed else "failed"


def relatively_off(x: float) -> str:
    return expectation(f"{{of: joints.pivot.force.z, is: {WEIGHT / (1 - x)!r}}}")


def absolutely_off(x: float) -> str:
    return expectation(f"{{of: joints.pivot.force.x, is: {x!r}}}")


def beside_a_half_turn(x: float) -> str:
    """A free body that starts 2 x before a half turn, in the global chart, and turns back: its angle after 1 s."""
    scene = f"""
heun: 1
bodies:
  wheel: {{mass: 1, center: [0, 0, 0], inertia: [1, 2, 3], angular_velocity: [0, 0, -1],
           orientation: {{axis: [0, 0, 1], angle: {math.pi - 2.0 * x!r}}}}}
analysis: {{times: [1], method: DOP853-rodrigues}}
"""
    try:
        R = solved(scene, reduce=False).bodies["wheel"]["rotation"][0]
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(R[:2, 0], [math.cos(math.pi - 2.0 * x - 1.0), math.sin(math.pi - 2.0 * x - 1.0)], 1.0)
    return "fine"


# ---- what solving says
def verdict(text: str, right: Callable[[Results], None] = lambda found: None) -> str:
    """The code of a refusal, else the first warning's first words, else `fine`; numbers are held against `right`."""
    try:
        found = solved(text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    right(found)
    return f"warned: {found.warnings[0].split(' at ')[0]}" if found.warnings else "fine"


def carries_the_weight(found: Results) -> None:
    near(found.joints["pivot"]["force"][0], [0, 0, WEIGHT], WEIGHT, 1e-9)


def moved(text: str) -> str:
    """Whether bodies are said to have left their place in the drawing."""
    return "moved" if study(text).results.model.get("moved") else "quiet"


def nearly_carried(x: float) -> str:
    """What hangs on an upright slide, pushed up by its weight and x of it more."""
    text = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{O: [0, 0, 0]}}}}}}
joints: {{j: {{type: slide, from: ground.O, to: b.O, axis: [0, 0, 1]}}}}
forces: {{up: {{type: force, on: b.O, vector: [0, 0, {19.62 * (1.0 + x)!r}]}}}}
"""
    return "moves" if study(text).results.model.get("moves") else "rests"


def misplaced(x: float) -> str:
    """The hanging bar, drawn x of the scene's size too far to the right."""
    return moved(bar(f", near: {{position: [{x * BAR_SIZE!r}, 0, 0]}}"))


def half_in_place(x: float) -> str:
    """Five posts of 2 m beside each other: one drawn 0.2 m off its foot, two off theirs by x of the lever, 1 m."""
    off = (0.2, x, x, 0.0, 0.0)
    feet = ", ".join(f"P{i}: [{2 * i}, 0, 0]" for i in range(5))
    posts = "\n".join(
        f"  b{i}: {{mass: 1, center: [{2 * i}, 0, {1 + o!r}], inertia: [1, 1, 1], points: {{p: [{2 * i}, 0, {o!r}]}}}}"
        for i, o in enumerate(off)
    )
    joints = "\n".join(f"  j{i}: {{type: ball, from: ground.P{i}, to: b{i}.p}}" for i in range(5))
    return moved(f"heun: 1\nground: {{points: {{{feet}}}}}\nbodies:\n{posts}\njoints:\n{joints}\n")


def too_far(gap: float, at: float = 0.0) -> str:
    """A bar of 1 m between two balls 1 m + gap apart."""

    def right(found: Results) -> None:
        near(found.foundation["force"][0], [0, 0, -WEIGHT], WEIGHT, 1e-8)
        assert found.accuracy["constraint_gap"] >= 0.3 * gap

    return verdict(f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{A: [{at!r}, 0, 0], B: [{at + 1 + gap!r}, 0, 0]}}}}
bodies:
  bar: {{mass: 1, center: [0.5, 0, 0], inertia: [0.001, 0.08, 0.08], points: {{a: [0, 0, 0], b: [1, 0, 0]}}}}
joints:
  A: {{type: ball, from: ground.A, to: bar.a}}
  B: {{type: ball, from: ground.B, to: bar.b}}
""", right)  # fmt: skip


def no_length(x: float) -> str:
    """A rod from the ground to a point of a hanging bar that is x of the size away."""
    here = f"H: [{x * BAR_SIZE!r}, 0, -1]"
    text = bar(tail="  short: {type: rod, from: ground.H, to: bar.end}", more=", position: [0, 0, 0]")
    return verdict(text.replace("O: [0, 0, 0]", f"O: [0, 0, 0], {here}"))


def rates(slip: float, spin: float) -> str:
    """The bar's top held at the origin, and told to move."""
    more = f", position: [0, 0, 0], velocity: [{slip!r}, 0, 0], angular_velocity: [0, {spin!r}, 0]"
    return verdict(bar(more), lambda found: near(found.joints["pivot"]["force"][0, 2], WEIGHT + spin**2 / 2, WEIGHT))


def spun(inertia: float) -> str:
    """A couple of 1 mN m about the bar's own axis, about which it has that much inertia."""

    def right(found: Results) -> None:
        carries_the_weight(found)
        near(found.bodies["bar"]["angular_acceleration"][0], [0, 0, 1e-3 / inertia], 1e-3 / inertia)

    couple = "forces: {c: {type: couple, on: bar, vector: [0, 0, 0.001]}}"
    return verdict(bar(tail=couple, inertia=f"[0.1, 0.1, {inertia!r}]"), right)


def wire(x: float) -> str:
    """A solid wire swings on a ball, its moment about its axis x of the trace: as a thin rod does.

    Its own spin, told or not, matters to nothing else.
    """
    radius = math.sqrt(x / 3)
    thin = "shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: 1}]"
    solid = thin.replace("type: rod", f"type: cylinder, radius: {radius!r}")
    swings = ", orientation: {axis: [1, 0, 0], angle: 1}, angular_velocity: [0.3, 0.2, 0.1]"
    text = bar(swings, "analysis: {duration: 0.02, samples: 2}")
    given = "mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]"
    found, rod = solved(text.replace(given, solid)), solved(text.replace(given, thin))
    near(found.bodies["bar"]["center"], rod.bodies["bar"]["center"], 1.0, 1e-9)
    near(found.joints["pivot"]["force"], rod.joints["pivot"]["force"], WEIGHT, 1e-8)
    return "thin" if any("spin about its own axis" in note for note in found.model["reasons"]) else "turning"


def point_mass(x: float) -> str:
    """A couple on a small ball of that inertia, of 1 kg: no point mass above x m L^2, which NO_INERTIA multiplies."""
    inertia = x * 1e-12 * BAR_SIZE**2
    more = "forces: {c: {type: couple, on: bar, vector: [0, 0, 0.001]}}"
    text = bar(tail=more, inertia=f"[{inertia!r}, {inertia!r}, {inertia!r}]")
    return verdict(text.replace("center: [0, 0, -0.5]", "center: [0, 0, 0]"), carries_the_weight)


def pushed_off_axis(x: float) -> str:
    """A thin bar pushed at a point x of the size off its axis, across."""
    push = f"forces: {{f: {{type: force, on: {{body: bar, at: [{x * BAR_SIZE!r}, 0, -1]}}, vector: [0, 1, 0]}}}}"
    return verdict(bar(tail=push, inertia="[0.1, 0.1, 0]"))


def topspin(inertia: str, end: str) -> str:
    """A top on a ball and a rod: whether it may spin slower in what is integrated for it."""
    body = f"mass: 1, center: [0, 0, 1], inertia: {inertia}, points: {{a: [0, 0, 0], b: [{end}, 0, 1]}}"
    text = (
        f"heun: 1\ntitle: top\nbodies: {{x: {{{body}, angular_velocity: [0, 0.1, 9]}}}}\n"
        "joints:\n  o: {type: ball, from: {body: ground, at: [0, 0, 0]}, to: x.a}\n"
        "forces: {f: {type: force, on: x.b, vector: [0, 1, 0]}}\nanalysis: {duration: 0.1, samples: 2}\n"
    )
    found, full = (solved(text, reduce=reduce) for reduce in (True, False))
    near(found.bodies["x"]["center"], full.bodies["x"]["center"], 1.0, 1e-9)
    return "slower" if found.work["evaluations"] < full.work["evaluations"] else "as it is"


def nearly_round(x: float) -> str:
    """A top whose two moments across its axis differ by x of the one about its tip, 1.2."""
    return topspin(f"[0.2, {0.2 + 1.2 * x!r}, 0.1]", "0")


def beside_the_axis(x: float) -> str:
    """A top pushed at a point x of the size beside its axis; the scene's size is 4/3."""
    return topspin("[0.2, 0.2, 0.1]", repr(x * 4.0 / 3.0))


def couple_about_a_wire(x: float) -> str:
    """A couple about the axis of a thin bar: x of the loads there (weight, support, couple)."""
    M = x * 2 * WEIGHT * BAR_SIZE / (1 - x)
    couple = f"forces: {{c: {{type: couple, on: bar, vector: [0, 0, {M!r}]}}}}"
    return verdict(bar(tail=couple, inertia="[0.1, 0.1, 0]"), carries_the_weight)


def turns_hardly(x: float) -> str:
    """A couple about a pin along a bar with inertia x of the trace, most of which a heavy weight on the axis makes."""
    heavy = 1e9
    inertia = 2 * x * heavy

    def right(found: Results) -> None:
        near(found.bodies["bar"]["angular_acceleration"][0], [0, 0, 1e-3 / inertia], 1e-3 / inertia)

    tail = "forces: {c: {type: couple, on: bar, vector: [0, 0, 0.001]}}"
    text = bar(kind="pin, axis: [0, 0, 1]", inertia=f"[{inertia!r}, {inertia!r}, {inertia!r}]", tail=tail)
    weight = f"  w: {{mass: {heavy!r}, center: [0, 0, -1], inertia: [0, 0, 0], points: {{c: [0, 0, -1]}}}}\njoints:\n"
    return verdict(text.replace("joints:\n", f"{weight}  weld: {{type: weld, from: bar.end, to: w.c}}\n"), right)


def across(x: float) -> str:
    """A straight chain pulled by 1 N along it, and x across, over what counts as arms: half a link and both of them."""
    return verdict(stretched_chain(0.0, f"[1, 0, {2.5 * x!r}]"))


def moved_by_a_lever(x: float) -> str:
    """An arm without inertia, whose end moves a block by a slope of sqrt(x): x is the block's share in the inertia.

    The arm of 1 m is lent the inertia of its 1 kg at its end, and pushed there; the block has 1 kg, too.
    """
    slope = math.sqrt(x / (1 - x))

    def right(found: Results) -> None:
        near(found.bodies["block"]["center_acceleration"][0], [1 / slope, 0, 0], 1 / slope, 1e-15 / math.sqrt(x))
        near(found.joints["guide"]["force"][0, :2], [-1 / slope, -1], 1 / slope, 1e-15 / math.sqrt(x))

    return verdict(f"""
heun: 1
space: planar
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0]}}}}
bodies:
  arm: {{mass: 1, center: [0, 0, 0], inertia: 0, points: {{a: [0, 0, 0], b: [1, 0, 0]}}}}
  block: {{mass: 1, center: [1, 0, 0], inertia: 1, points: {{b: [1, 0, 0]}}}}
joints:
  A: {{type: pin, from: ground.A, to: arm.a}}
  guide: {{type: line, axis: [{slope!r}, -1, 0], from: block.b, to: arm.b}}
  B: {{type: slide, axis: [1, 0, 0], from: ground.B, to: block.b}}
forces: {{f: {{type: force, on: arm.b, vector: [0, 1, 0]}}}}
""", right)  # fmt: skip


def needs_side(x: float) -> str:
    """A cut through a bar of 1 m, x off the place of a load."""
    push = f"forces: {{f: {{type: force, on: {{body: bar, at: [0, 0, {-0.3 - x!r}]}}, vector: [0, 1, 0]}}}}"
    section = "sections: {s: {body: bar, at: [0, 0, -0.3], normal: [0, 0, -1]}}"
    text = bar(tail=f"{push}\n{section}")
    solid = "shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 10 mm, mass: 1}]"
    text = text.replace("mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]", solid)

    def right(found: Results) -> None:
        near(found.sections["s"]["N"][0], 0.7 * WEIGHT, WEIGHT)

    return verdict(text, right)


def two_legs(x: float) -> str:
    """A cut through two legs, 0.1 m square, x of the sum of their half diagonals apart."""
    half = 0.05 + 0.5 * x * 0.1 * math.sqrt(2)
    legs = ", ".join(f"{{type: box, center: [{s * half!r}, 0, -0.5], size: [0.1, 0.1, 1], mass: 0.5}}" for s in (-1, 1))
    text = bar(tail="sections: {s: {body: bar, at: [0, 0, -0.3], normal: [0, 0, -1]}}")
    text = text.replace("mass: 1, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]", f"shapes: [{legs}]")
    return verdict(text, lambda found: near(found.sections["s"]["N"][0], 0.7 * WEIGHT, WEIGHT)).split(" in ")[0]


def one_place(x: float) -> str:
    """A body on a ball 1 m off the origin, and its centre 3/4 x beyond: a scene of the size x, or of 1 m."""
    body = f"{{mass: 1, center: [{0.75 * x!r}, 0, 0], inertia: [0, 0, 0], points: {{p: [0, 0, 0]}}}}"
    text = f"heun: 1\nground: {{points: {{O: [1, 0, 0]}}}}\nbodies: {{b: {body}}}\n"
    found = study(text + "joints: {j: {type: ball, from: ground.O, to: b.p}}").setup.scene.layout.size
    return "1 m" if found == 1.0 else "its extent"


def four_bar(p: Sequence[float], q: Sequence[float], more: str = "", tail: str = "") -> str:
    """Bars of 1 kg in the plane, from (0, 0) to p and from (1, 0) to q, and a coupler from p to q."""
    P, Q = (f"[{float(x)!r}, {float(y)!r}, 0]" for x, y in (p, q))
    return f"""
heun: 1
space: planar
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0], B: [1, 0, 0]}}}}
bodies:
  left: {{shapes: [{{type: rod, from: [0, 0, 0], to: {P}, mass: 1}}], points: {{f: [0, 0, 0], t: {P}}}{more}}}
  right: {{shapes: [{{type: rod, from: [1, 0, 0], to: {Q}, mass: 1}}], points: {{f: [1, 0, 0], t: {Q}}}}}
  top: {{shapes: [{{type: rod, from: {P}, to: {Q}, mass: 1}}], points: {{l: {P}, r: {Q}}}}}
joints:
  A: {{type: pin, from: ground.A, to: left.f}}
  B: {{type: pin, from: ground.B, to: right.f}}
  C: {{type: pin, from: left.t, to: top.l}}
  D: {{type: pin, from: top.r, to: right.t}}
{tail}"""


def parallelogram(angle: float) -> str:
    """Bars of 1 m, so far from flat: d'Alembert gives what the coupler's pin carries."""
    c, s = math.cos(angle), math.sin(angle)

    def right(found: Results) -> None:
        # theta'' = -6/5 g cos(theta); the coupler moves with the bars' ends, half of it hangs on either pin
        ax, ay = 1.2 * WEIGHT * c * s, -1.2 * WEIGHT * c * c
        force = found.joints["C"]["force"][0]
        near(force[1], 0.5 * (ay + WEIGHT), WEIGHT, 1e-7)
        if not np.isnan(force[0]):
            near(force[0], 0.5 * ax, WEIGHT, 1e-7)

    return verdict(four_bar((c, s), (1 + c, s)), right)


def beside_flat(x: float) -> str:
    """Bars of 1 m past the pose in which they lie flat, the coupler longer by the square of x, which keeps them off it.

    The closures' least singular value there goes with the root of that length. The right bar turns back.
    """
    b = 1.0 + 1.8e-9 * (x / 4.0) ** 2
    p = np.array([math.cos(2.6), math.sin(2.6)])
    to = np.array([1.0, 0.0]) - p
    L = math.sqrt(float(to @ to))
    k = (L * L + b * b - 1.0) / (2.0 * L)  # from p to the foot of the height on the diagonal
    q = p + (k * to + math.sqrt(b * b - k * k) * np.array([-to[1], to[0]])) / L

    def right(found: Results) -> None:
        ends = [found.points[name]["position"][-1] for name in ("left.t", "right.t")]
        assert ends[0][1] < 0.0 < ends[1][1]
        near(math.sqrt(float(np.sum((ends[1] - ends[0]) ** 2))), b, 1.0, 1e-11)

    tail = "analysis: {duration: 0.3, samples: 3}"
    return verdict(four_bar(p, q, ", angular_velocity: [0, 0, 4]", tail), right).split(" singular")[0]


def flat_by(x: float) -> str:
    """A parallelogram whose row has x left of it."""
    return parallelogram(x / math.sqrt(2))


def rates_at_flat(more: float) -> str:
    """Flat bars of 1 m, the right one told to turn faster: no accelerations would keep the coupler's length.

    The ends lack twice that much along the bars, of the 0.5 m/s^2 asked for: of a pin about its bar's centre.
    """
    faster = f"t: [2.0, 0.0, 0]}}, angular_velocity: [0, 0, {1 + more!r}]"
    text = four_bar((1, 0), (2, 0), ", angular_velocity: [0, 0, 1]").replace("t: [2.0, 0.0, 0]}", faster)
    return verdict(text, lambda found: near(found.bodies["right"]["angular_acceleration"][0, 2], -1.2 * WEIGHT, WEIGHT))


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


def carried_by_nothing(x: float) -> str:
    """A body on a ball at its centre, held up but for x of its weight: whether that is a load to judge by."""
    up = f"forces: {{f: {{type: force, on: bar.top, vector: [0, 0, {WEIGHT * (1 - x)!r}]}}}}"
    text = bar(", angular_velocity: [0, 0, 1]", f"{up}\nanalysis: {{duration: 0.1, samples: 3}}")
    found = solved(text.replace("center: [0, 0, -0.5]", "center: [0, 0, 0]"))
    near(found.joints["pivot"]["force"][:, 2], x * WEIGHT, WEIGHT, 1e-14)
    return "judged" if found.accuracy["estimate"]["reactions"] > 0.0 else "none"


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


def unseen_pulse(x: float) -> str:
    """A block pushed with 1 N and, for a moment, x more: whether steps end there."""
    run = study(pushed_block(f"1 + {x!r}*exp(-((t - 5.3)/1e-3)**2)"))
    near(run.results.coordinates["guide"]["speed"][-1], 10.0, 10.0, 2e-4 * x + 1e-9)
    return "looked into" if run.results.work["steps"] > 4 else "as seen"


# ---- the smallest calls
def proportional(x: float) -> str:
    found, _ = relations({"a": np.array([1.0, 0.0]), "b": np.array([1.0, x])})
    return "a sum" if found else "none"


def told_by_turning(x: float) -> str:
    rows = np.array([[[1.0, 0.0], [1.0, x]]])
    return "a sum" if factors(rows) is not None else "none"


def present(x: float) -> str:
    a, b, c = np.eye(3)
    (terms,), _ = relations({"a": a, "b": b, "c": c, "sum": a + b + x * c})
    return "present" if "c" in terms else "absent"


def whole(x: float) -> str:
    return "whole" if tidy({"a": 1.0, "b": 2.0 + x})["b"] == 2.0 else "as found"


def left_of(x: float) -> str:
    """The table's word for the force in a weld that is left of 1 N by 1 - x N."""
    run = study(
        f"""
heun: 1
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{b: {{mass: 1, center: [0, 0, 0], inertia: [1, 1, 1], points: {{o: [0, 0, 0]}}}}}}
joints: {{w: {{type: weld, from: ground.O, to: b.o}}}}
forces:
  one: {{type: force, on: b.o, vector: [1, 0, 0]}}
  other: {{type: force, on: b.o, vector: [{x - 1.0!r}, 0, 0]}}
""",
        wanted=frozenset({"joints"}),
    )
    near(run.results.joints["w"]["force"], [[-x, 0.0, 0.0]], 1.0, 1e-15)
    (table,) = page_of(run.results, labels_of(run.spec), run.magnitudes).instants(run.results)
    return "0" if table.notes == ("0 throughout",) else "a number"


def axis_of(x: float) -> str:
    found: Any = central_axis(np.array([[x, 0, 0]]), np.array([[0, 0, x]]), np.zeros(3), 1.0)
    return "no axis" if np.isnan(found["pitch"][0]) else "an axis"


def equal(x: float) -> str:
    # y is the nearest to the normal; of x and y alike, x is
    n = np.array([0.6, 0.6 + x, 0.4])
    return "xyz"[nearest_axis(n / math.sqrt(n @ n))]


def askew(x: float) -> str:
    """A web and two flanges, shifted either way until I12 is x of √(I1 I2)."""
    I1, I2 = 2 * 2.0 * 1.0**3 / 12 + 2 * 2.0 * 1.5**2 + 1.0 * 2.0**3 / 12, 2 * 2.0**3 / 12 + 2.0 / 12
    shift = x * math.sqrt(I1 * I2) / (2 * 2.0 * 1.5)
    met, at = np.array([True]), [[0.0, 0.0], [shift, 1.5], [-shift, -1.5]]
    parts = [
        Rectangle(met, np.array([[*place, 0.0]]), width, height)
        for place, width, height in zip(at, (1.0, 2.0, 2.0), (2.0, 1.0, 1.0), strict=True)
    ]
    zero, ex, ez = np.zeros(1), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    found = joined(parts, 0, Cutting(Form((), 1e-15), ez, ex, zero, zero), 1e-12)
    return "refused" if isinstance(found, str) else "taken"


def drift(x: float) -> str:
    found = energy_drift({"kinetic": np.array([0.0, x]), "potential": np.zeros(2), "work": np.zeros(2)}, 0.0, 1.0)
    return "at rest" if found == 0.0 else "a drift"


# ---- contacts
FLOOR = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{ball: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: ball.p, axis: [0, 0, 1], initial: {{travel: {at!r}}}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: 0.5}}}}
analysis: {{duration: 1, samples: 2}}
"""
SWUNG = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  ball:
    {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}},
     position: [0, 0, -1], velocity: [1, 0, {rate!r}]}}
joints: {{rope: {{type: rod, from: ground.O, to: ball.p, length: 1, tension_only: true, restitution: 1}}}}
analysis: {{duration: 0.1, samples: 2}}
"""


def near_the_floor(x: float) -> str:
    """A ball at rest above a floor, by so much of the size of the scene: its extent is that of its inertia."""
    setup = study(FLOOR.format(at=1.5 * x)).setup
    assert setup.scene.layout.size == pytest.approx(1.5)
    return "rests" if setup.runner.start_holding[0] else "falls"


def opening_rope(x: float) -> str:
    """A ball on a circle whose rope opens by a part of its speed."""
    run = study(SWUNG.format(rate=-x)).history.checked
    assert run is not None
    near(run.run.states[-1][4:7] @ run.run.states[-1][4:7], 1.0, 1.0, 1e-9)
    return "struck" if run.run.blows else "taut"


def pressed(x: float) -> str:
    """A contact pressed with an acceleration of a part of its terms."""
    found = complementary(np.eye(1), np.array([-x]), np.array([tolerances.CONTACT_ACCELERATION]))
    return "bears" if found.bears[0] else "open"


def leaning(x: float) -> str:
    """Two contacts of which the one leaves so much of the other, both without rate if the first bears."""
    c = 1.0 - x
    found = complementary(np.array([[1.0, c], [c, 1.0]]), np.array([-1.0, -c]), np.full(2, 1e-14))
    near(found.z, [1.0, 0.0], 1.0, 1e-6)
    return "leans" if found.depends[1] else "open"


def hardly_moved(x: float) -> str:
    """A contact on a body of 1 kg that gives way to a part of what it would if it were free."""
    layout: Any = SimpleNamespace(bodies={"mass": np.ones(1)}, size=1.0)
    one = np.ones(1)
    touch = Touching(np.zeros(1, dtype=int), np.array([[[0.0, 0, 0, 0, 0, 1.0]]]), one, one, one, one)
    return "moves" if answerable(layout, touch, np.array([[x]]))[0] else "held"


def low_hop(x: float) -> str:
    """A flight of so much height, of a gap that is a sum of 1."""
    one = np.ones(1)
    reach = tolerances.KERNEL["touching"] * one
    touch = Touching(np.zeros(1, dtype=int), np.zeros((1, 1, 6)), one, one, reach, one)
    return "none" if short_flights(touch, one, -one / (2.0 * x), 0.0)[0] else "flies"


def hop(x: float) -> str:
    """A flight of so much time, at once and too high to be none."""
    one = np.ones(1)
    touch = Touching(np.zeros(1, dtype=int), np.zeros((1, 1, 6)), one, one, np.zeros(1), one)
    short = short_flights(touch, one, -2.0 * one / x, tolerances.SHORTEST_FLIGHT)
    return "none" if short[0] else "flies"


# ---- small oscillations
def soft_beside_stiff(x: float) -> str:
    """Two motions, one of stiffness 1, the other of 2 x: the kind of the softer."""
    f = np.zeros((2, 2))
    system = Reduced(np.eye(2), f, np.eye(2), f, -np.diag([2.0 * x, 1.0]), f, np.zeros(2), 0.0, 0.0)
    return oscillations(system)[0].kind


def pushed_freely(x: float) -> str:
    """What nothing holds, pushed by x of the loads there."""
    f, one = np.zeros((1, 1)), np.eye(1)
    here = SimpleNamespace(system=Reduced(one, f, one, f, f, f, np.array([x]), 1.0, 0.0), weights=np.ones(1))
    return "falls" if np.isinf(off_balance(here)) else "rests"  # type: ignore[arg-type]


def heavy(x: float) -> str:
    """A bar of so much mass hangs: refused when it is read, or its weight."""
    text = f"""
heun: 1
gravity: [0, 0, -0.01]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{bar: {{mass: {x!r}, center: [0, 0, 0], inertia: [0, 0, 0], points: {{a: [0, 0, 0]}}}}}}
joints: {{pivot: {{type: ball, from: ground.O, to: bar.a}}}}
"""
    try:
        found = solved(text)
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(found.joints["pivot"]["force"][0, 2], 0.01 * x, x, 1e-12)
    return "fine"


def hanging(x: float, law: str = "0") -> str:
    """Modes of a pendulum drawn askew by x, with a torque: refused, or the right frequency."""
    text = f"""
heun: 1
gravity: [0, 0, -9.81]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  bar:
    mass: 1
    center: [0, 0, -1]
    inertia: [0, 0, 0]
    points: {{a: [0, 0, 0]}}
    orientation: {{axis: [0, 1, 0], angle: {x!r}}}
joints: {{pivot: {{type: pin, axis: [0, 1, 0], from: ground.O, to: bar.a}}}}
forces: {{law: {{type: torque, joint: pivot, value: "{law}"}}}}
"""
    try:
        found = modes(load("scene.yaml", text))
    except HeunError as error:
        return f"refused: {error.problems[0].code}"
    near(2.0 * np.pi * found.modes[0].frequency, np.sqrt(9.81), 1.0, 1e-12)
    return "fine"


def beside_a_kink(x: float) -> str:
    """The same at rest, with a torque that begins beyond an angle of x."""
    return hanging(0.0, f"max(0, pivot.angle - {x!r})")


ROWS = (
    # what is typed
    Row("UNIT_TYPED", quaternion, "fine", "refused: orientation"),
    Row("UNIT_EXACT", matrix, "as typed", "made a rotation"),
    Row("INERTIA_REFUSED", principal, "warned: inertia-rounded", "refused: inertia-not-physical"),
    Row("INERTIA_TYPED", principal, "fine", "warned: inertia-rounded"),
    Row("INERTIA_TYPED", unsymmetric, "fine", "refused: inertia-form"),
    Row("TABLE_ENDS", periodic, "fine", "refused: table-period"),
    Row("EXPECTED_RELATIVE", relatively_off, "passed", "failed"),
    Row("EXPECTED_ABSOLUTE", absolutely_off, "passed", "failed"),
    Row("LEAST_ASKED", tolerance, "refused: tolerance", "fine"),
    Row("MOST_ASKED", tolerance, "fine", "refused: tolerance"),
    # same instant, place, direction
    # given steps
    Row("KERNEL.given_end", beyond_its_steps, "10 steps", "11 steps"),
    # what a motion comes near to
    Row("GIMBAL", tilted_by, "gimbal lock", "none"),
    Row("FASTER_THAN_TIME", grown, "with the time", "exponential"),
    Row("EIGENVALUE", soft_beside_stiff, "free", "oscillation"),
    Row("FREELY_PUSHED", pushed_freely, "rests", "falls"),
    Row("OFF_BALANCE", hanging, "fine", "refused: not-at-rest"),
    Row("KINK", beside_a_kink, "refused: no-modes", "fine"),
    Row("SAME_INSTANT", expected_at, "fine", "refused: expect-instants"),
    Row("SAME_VALUE", held_and_driven, "fine", "refused: drive-contradicts"),
    Row("AT_LIMIT", start_beyond, "fine", "refused: beyond-stop"),
    Row("PARALLEL", along_the_normal, "refused: first-axis", "fine"),
    Row("UPRIGHT", tilted, "fine", "refused: not-planar"),
    Row("EQUAL_COMPONENTS", equal, "x", "y"),
    Row("PRINCIPAL", askew, "taken", "refused"),
    Row("IN_PLANE", needs_side, "refused: needs-side", "fine"),
    Row("OUTLINES_APART", two_legs, "fine", "warned: sections.s: the plane meets the body bar"),
    Row("ONE_PLACE", one_place, "1 m", "its extent"),
    # gaps
    Row("OPEN_GAP", too_far, "fine", "refused: does-not-fit"),
    Row("MOVED", misplaced, "quiet", "moved"),
    Row("SET_GOING", nearly_carried, "rests", "moves"),
    Row("DRAWN_IN_PLACE", half_in_place, "moved", "quiet"),
    Row("GAP_ROUNDING", lambda x: too_far(x * 1e5, 1e5), "fine", "refused: does-not-fit", (1 / 3, 3.0, 100.0)),
    Row("NO_LENGTH", no_length, "refused: no-length", "fine"),
    Row("OPEN_RATE", lambda x: rates(x * BAR_SIZE * 2.0, 2.0), "fine", "refused: rates-do-not-fit"),
    Row("AT_REST", lambda x: rates(x * 1e-10 * BAR_SIZE, 0.0), "fine", "refused: rates-do-not-fit"),
    Row("SOLVABLE", lambda x: rates_at_flat(x / 4), "warned: singular pose", "refused: singular-pose"),
    # no inertia
    Row("NO_INERTIA", lambda x: spun(0.2 * x), "refused: no-inertia", "fine"),
    Row("AXISYMMETRIC", nearly_round, "slower", "as it is"),
    Row("AXISYMMETRIC", beside_the_axis, "slower", "as it is"),
    Row("NO_INERTIA", wire, "thin", "turning"),
    Row("POINT_MASS", point_mass, "refused: no-inertia", "fine"),
    Row("ON_AXIS", pushed_off_axis, "fine", "refused: no-inertia"),
    Row("NO_MOMENT", couple_about_a_wire, "fine", "refused: no-inertia"),
    Row("KERNEL.no_inertia", turns_hardly, "refused: no-inertia", "fine"),
    Row("KERNEL.own_share", moved_by_a_lever, "refused: no-inertia", "fine"),
    # rank, open
    Row("KERNEL.independent", flat_by, "warned: singular pose", "warned: nearly singular pose"),
    Row("PUSHED", across, "warned: singular pose", "refused: singular-pose"),
    Row("NEARLY_SINGULAR", lambda x: parallelogram(x / math.sqrt(2)), "warned: nearly singular pose", "fine"),
    Row("SINGULAR_MET", beside_flat, "warned: passes through a", "fine", (1 / 3, 3.0)),
    Row("OPEN_SHARE", inclined, "a number", "open"),
    Row("STRAINED", stiff, "open", "shared"),
    Row("DEPENDENT_SHARES", proportional, "a sum", "none"),
    Row("DEPENDENT_SHARES", told_by_turning, "a sum", "none"),
    Row("ABSENT_FACTOR", present, "absent", "present"),
    Row("WHOLE_FACTOR", whole, "whole", "as found"),
    # loads
    Row("WRITTEN", left_of, "0", "a number"),
    Row("NO_FORCE", axis_of, "no axis", "an axis"),
    Row("NO_LOAD", carried_by_nothing, "none", "judged"),
    Row("NO_ENERGY", drift, "at rest", "a drift"),
    Row("JUDGED", judged, "judged", "not judged"),
    Row("LOST", off_by, "on the front", "lost"),
    Row("TOLD_BESIDE", moved_by, "told", "not known"),
    Row("MOST_STEPS", steps_given, "fine", "refused: step"),
    Row("HOPELESS", steady_pace, "goes on", "told"),
    Row("SHARED_STEP", step_in_common, "apart", "shared"),
    Row("SAME_STEP", step_beside, "shared", "apart"),
    Row("KERNEL.half_turn", beside_a_half_turn, "refused: half-turn", "fine"),
    Row("KERNEL.unseen", unseen_pulse, "as seen", "looked into"),
    Row("UNBALANCED", lambda x: "warned" if unbalanced(x) else "fine", "fine", "warned"),
    Row("CONTACT_TOUCHES", near_the_floor, "rests", "falls"),
    Row("KERNEL.touching", low_hop, "none", "flies"),
    Row("CONTACT_RATE", opening_rope, "taut", "struck"),
    Row("CONTACT_ACCELERATION", pressed, "open", "bears"),
    Row("CONTACT_DEPENDS", leaning, "leans", "open"),
    Row("NO_ANSWER", hardly_moved, "held", "moves"),
    Row("SHORTEST_FLIGHT", hop, "none", "flies"),
    # in the plane
    *(Row("FLAT", leaving(part), "flat", "not flat") for part in PARTS),
    Row("NEARLY_FLAT", drawn_askew, "told", "in space"),
    # range
    Row("LEAST_MAGNITUDE", heavy, "refused: magnitude", "fine"),
    Row("MOST_MAGNITUDE", heavy, "fine", "refused: magnitude"),
    # rest
    Row("RUN_AWAY", rest.far_away, "rests", "refused"),
    Row("TURNS_ON", rest.wound_up, "rests", "refused"),
    Row("PUSHED_BY_ROUNDING", rest.beside_upright, "stays", "falls", (0.01, 0.1, 10.0, 100.0)),
    Row("STEADY", rest.tilted, "rests", "refused"),
    Row("NOT_HELD", rest.jumping, "rests", "refused"),
    Row("GROWS", rest.pushed_off, "stable", "unstable"),
    Row("INDIFFERENT", rest.hardly_held, "indifferent", "held"),
)

# Those that decide no verdict: on either side the same numbers, to their digits.
EXEMPT = {
    "STIFF": "what is integrated by: either way the same motion, and its estimate",
    "EVENTFUL": "what is integrated by: either way the same motion, and its estimate",
    "EVENTS_RARE": "what is integrated by: either way the same motion, and its estimate",
    "VERNER98": "what is integrated by: either way the same motion, and its estimate",
    "RADAU5": "what is integrated by: either way the same motion, and its estimate",
    "MOST_FOREIGN": "when an independent check is given up that does not get on: after minutes, or more of them",
    "CHECK_STEPS": "how much finer a check run goes: 2 |A - B| is no less than the error on either side of 4",
    "INTEGRATED": "whether a stretch is halved once more: the integral is right to rounding on either side",
    "UNSEEN_RATE": "whether a stretch is halved once more; tests/spec/test_integrals.py has pulses that hide",
    "NEARLY_DEFECTIVE": "how a step is taken: tests/closed_forms/test_rest.py has matrices and scenes on both sides",
    "REST_FIRST": "the first step of a search: its end is told to its digits",
    "REST_FARTHEST": "what accepts a step of the search",
    "REST_BENT": "what accepts a step of the search",
    "REST_STRAIGHT": "what accepts a step of the search",
    "BEFORE_FAILURE": "where a search ends that lies before an error; of what is later the error is told",
    "EPS": "the rounding of one operation; others are told by it",
    "NEAR_DRAWING": "which start a search takes first; tests/laws/test_nearest.py looks at what comes of it",
    "FARTHER": "which of two poses that both close; tests/laws/test_nearest.py holds how far it may be",
    "CLOSED": "ends a search: the verdict is OPEN_GAP's",
    "NO_SLOPE": "ends a search, which then starts again from elsewhere: the verdict is OPEN_GAP's",
    "SHUT": "the instant of an error, to some digits: whether there is one is decided by `lost` and UNMET",
    "POLISHED": "ends a search: the poses are closed on either side",
    "SUMS_BLIND": "what accepts a step of the search, among closed poses",
    "SAME_SUM": "what accepts a step of the search, among closed poses",
    "UNMOVED": "whether the note says `as drawn`, or to six digits the same place",
    "DUST": "digits of a note",
    "LEAST_EXTENT": "what IN_PLANE is measured by where all lies in the origin",
    "OFF_AXIS": "two formulas for the same piece of a body of revolution",
    "QUADRATURE": "ends a quadrature",
    "SIDE_BY_SIDE": "ends a search at a jump that nobody told of",
    "CONSTANT": "whether a peak of a thirteenth digit is looked for",
    "ZERO_COMPONENT": "the digits of a direction that is proposed",
    "PLACE_ROUNDING": "a summand of the estimate",
    "SLENDER": "which bodies' moments are looked at at all: those of the others are far above NO_INERTIA",
    "KERNEL.much_lent": "how much inertia is lent: what it takes is given back",
    "START_ROUNDING": "where the check run starts: what it grows to is the estimate",
    "SUM_ROUNDING": "a summand of the estimate",
    "ROUNDING_MATTERS": "when rounding is followed in a run of its own: half of the estimate at most",
    "UNKNOWN": "the estimate where there is none",
    "SPINS_LIGHTLY": "what is integrated: either way the same motion, at other costs",
    "LENT_REACH": "an inertia lent to a spin on which nothing depends",
    "LEAST_RATE": "what steps are judged by where nothing moves: the estimate says what they are worth",
    "LEAST_TOLERANCE": "where finer runs are not tried: the estimate says what was reached",
    "COARSEST_RETRY": "where coarser runs are not tried: the collapse is refused, what came through has its estimate",
    "KERNEL.preference": "which of the rows alike carry the motion",
    "KERNEL.closed": "ends the settling of gaps, which the run reports",
    "KERNEL.nearly_closed": "ends the settling of gaps, which the run reports",
    "KERNEL.pivot_drop": "when rows are chosen anew: costs digits, which the estimate shows",
    "KERNEL.near_singular": "which stages are settled: costs digits, which the estimate shows",
    "KERNEL.dodges": "lengths of steps that are tried: the estimate says what was reached",
    "KERNEL.dodge": "lengths of steps that are tried: the estimate says what was reached",
    "KERNEL.pivot_rounding": "lengths of steps that are tried: the estimate says what was reached",
    "KERNEL.rounding": "the doubt of the multipliers, in steps of one rounding",
    "KERNEL.one_instant": "to what an event is landed on, in roundings of its instant",
    "KERNEL.window": "where the end of a step is looked at for an event; else all of the step is",
    "KERNEL.near_kink": "how near to a kink a step ends: its error, to the square, is that of the step",
    "KERNEL.no_jump": "which events are landed on to the last digit, which to near_kink",
    "KERNEL.leaving_first": "how an event's own rounding is left behind",
    "KERNEL.leaving_last": "how an event's own rounding is left behind; what chatters is driven back at once",
    "KERNEL.least_load": "which loads are so small that doubles lose their digits",
    "MOST_SOLVED": "time and memory; tests/convergence/test_collocation.py has a scene beyond",
    "KERNEL.newton_ends": "when an iteration ends that goes on to rounding: one more changes nothing but that",
    "KERNEL.newton_rounding": "when corrections of an iteration count as noise: what is left is rounding",
    "KERNEL.newton_part": "what an iteration that stalls may leave of a step whose error is judged besides",
    "KERNEL.newton_noise": "the same of a given step; tests/convergence/test_collocation.py has steps on both sides",
    "KERNEL.newton_stalls": "when corrections count as noise; what they may be as noise newton_rounding decides",
    "KERNEL.newton_diverges": "how soon an iteration is given up that does not contract; it is at its third step",
    "KERNEL.slow_rate": "lengths of steps where one body is slow beside others: the estimate says what they are worth",
    "KERNEL.held_rate": "lengths of the first steps from rest: the estimate says what they are worth",
    "KERNEL.chart_turn": "lengths of steps in a chart of attitudes; tests/closed_forms/test_half_turns.py: none jumps",
    "KERNEL.branch_bend": "lengths of steps along a branch, in which extremes are looked for: no number depends on it",
    "KERNEL.branch_beside": "lengths of the check run's steps along a branch, on which no number depends",
    "KERNEL.pivot_noise": "lengths of steps that are tried: the estimate says what was reached",
}
# Those that decide one, and have no scene at their boundary yet.
WANTED = {
    "GOES_ON": "whether what moves steadily goes on in the same way",
    "HELD_BY_OTHERS": "whether a joint gives way in a direction that others hold askew",
    "STILL": "whether what rates of rounding ask for is met, where a blow has ended all motion",
    "NEIGHBOUR": "which rank is the generic one, where a machine can hardly leave its singular start",
    "MOVES": "whether a displaced pose counts",
    "SUM_POSES": "which sums of one pose are accidents",
    "UNSEEN_GAP": "how far states beside a singular pose are moved; TOLD_BESIDE decides what is told",
    "NEAR_PIVOT": "whether a state is recovered again, moved by its rounding; TOLD_BESIDE decides what is told",
    "SUSPECT_PIVOT": "whether a singular pose is looked for in a step",
    "NO_SELF_STRESS": "whether a null vector is a self-stress",
    "STILL_OPEN": "what a split leaves open",
    "ONE_DIRECTION": "whether advice proposes a line",
    "ALONG": "which joint the tree cuts beside a thin rod",
    "ALONG_SQUARED": "whether a thin rod loaded along a line has that line as its axis",
    "NO_ACCELERATION": "whether accelerations exist at the start",
    "TOUCHING": "whether two outlines without extent are one",
    "CLAIMED": "the horizon",
    "BOUNDLESS": "the words on a run that fails",
    "KERNEL.branch_step": "lengths of steps along a branch: where they are too long another branch is taken",
    "KERNEL.across": "what a pivot is measured by",
    "RANK": "which motions of bodies without inertia, and of the assembly, are none; the kernel has its own of it",
    "RANK_OF_GAP": "which rows a gap feigns: what is near to a singular pose closes its gaps by a move",
    "SINGULAR_FALL": "whether a pose is passed through that is everywhere as near to a singular one",
    "NOT_QUITE": "whether a dependence is told as not quite one",
    "UNMET": "whether accelerations that leave rows unmet are refused",
    "KERNEL.passing": "which rows are left out on the way through a singular pose",
    "KERNEL.passing_of_start": "the same in a scene that begins beside one",
    "KERNEL.jump": "whether rates that the closures change are a blow",
    "KERNEL.jump_of_error": "the same at a coarse tolerance",
    "KERNEL.jump_of_given": "the same in a given step",
    "KERNEL.locked": "whether a step that collapsed is a lock",
    "KERNEL.locked_step": "whether a step that collapsed is a lock",
    "KERNEL.reopened": "when a row that was left out is taken in again",
    "KERNEL.lost": "whether closures are lost",
    "KERNEL.least_step": "whether a step has collapsed",
    "KERNEL.flurry": "whether events gather at an instant",
    "KERNEL.finest": "which events of a step are told apart",
}
