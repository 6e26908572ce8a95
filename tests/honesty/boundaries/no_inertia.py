"""Bodies that resist no turn about an axis, or hardly."""

from __future__ import annotations

import math

from heuncli.results.results import Results
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import BAR_SIZE, WEIGHT, bar, verdict
from tests.shared.scenes import near, solved


def carries_the_weight(found: Results) -> None:
    near(found.joints["pivot"]["force"][0], [0, 0, WEIGHT], WEIGHT, 1e-9)


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


PART = Part(
    ("no inertia", "kernel: inertia"),
    rows=(
        Row("NO_INERTIA", lambda x: spun(0.2 * x), "refused: no-inertia", "fine"),
        Row("AXISYMMETRIC", nearly_round, "slower", "as it is"),
        Row("AXISYMMETRIC", beside_the_axis, "slower", "as it is"),
        Row("NO_INERTIA", wire, "thin", "turning"),
        Row("POINT_MASS", point_mass, "refused: no-inertia", "fine"),
        Row("ON_AXIS", pushed_off_axis, "fine", "refused: no-inertia"),
        Row("NO_MOMENT", couple_about_a_wire, "fine", "refused: no-inertia"),
        Row("KERNEL.no_inertia", turns_hardly, "refused: no-inertia", "fine"),
        Row("KERNEL.own_share", moved_by_a_lever, "refused: no-inertia", "fine"),
    ),
    exempt={
        "NO_MASS": "which joints the tree cuts beside such a body: either way the same (laws/test_weightless_bodies)",
        "SLENDER": "which bodies' moments are looked at at all: those of the others are far above NO_INERTIA",
        "KERNEL.much_artificial": "how much inertia is lent: what it takes is given back",
        "SPINS_LIGHTLY": "what is integrated: either way the same motion, at other costs",
        "ARTIFICIAL_SHARE": "how much inertia is lent: what it takes is given back (laws/test_massless_frames)",
        "ARTIFICIAL_RADIUS": "an inertia lent to a spin on which nothing depends",
    },
    wanted={
        "ALONG": "which joint the tree cuts beside a thin rod",
        "ALONG_SQUARED": "whether a thin rod loaded along a line has that line as its axis",
    },
)
