"""Gaps of poses and rates that are assembled, and of the closures of a run."""

from __future__ import annotations

from heuncli.results.results import Results
from tests.honesty.boundaries.part import Part, Row
from tests.honesty.boundaries.scenes import BAR_SIZE, WEIGHT, bar, four_bar, read, verdict
from tests.shared.scenes import near, study


def held_and_driven(x: float) -> str:
    drive = "drives: {m: {joint: pivot, angle: 0.5 + t}}\nanalysis: {duration: 1, samples: 3}"
    joint = f"pin, axis: [0, 1, 0], initial: {{angle: {0.5 + x!r}}}"
    return read(bar(tail=drive, kind=joint))


def moved(text: str) -> str:
    """Whether bodies are said to have left their place in the drawing."""
    return "moved" if study(text).results.model.get("moved") else "quiet"


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


def rates_of_a_beginning(slip: float) -> str:
    """The bar's top told to move, while a drive sets it going from rest at 1 rad/s^2."""
    tail = "drives: {m: {joint: pivot, angle: t**2/2}}\nanalysis: {type: state}"
    text = bar(f", position: [0, 0, 0], velocity: [{slip!r}, 0, 0]", tail, kind="pin, axis: [0, 1, 0]")
    return verdict(text, lambda found: near(found.joints["pivot"]["drive"][0], 0.08 + 0.25, 1.0))


def rates_at_flat(more: float) -> str:
    """Flat bars of 1 m, the right one told to turn faster: no accelerations would keep the coupler's length.

    The ends lack twice that much along the bars, of the 0.5 m/s^2 asked for: of a pin about its bar's centre.
    """
    faster = f"t: [2.0, 0.0, 0]}}, angular_velocity: [0, 0, {1 + more!r}]"
    text = four_bar((1, 0), (2, 0), ", angular_velocity: [0, 0, 1]").replace("t: [2.0, 0.0, 0]}", faster)
    return verdict(text, lambda found: near(found.bodies["right"]["angular_acceleration"][0, 2], -1.2 * WEIGHT, WEIGHT))


PART = Part(
    ("gaps of poses and rates that are assembled", "kernel: gaps, of the scene's size"),
    rows=(
        Row("SAME_VALUE", held_and_driven, "fine", "refused: drive-contradicts"),
        Row("OPEN_GAP", too_far, "fine", "refused: does-not-fit"),
        Row("MOVED", misplaced, "quiet", "moved"),
        Row("DRAWN_IN_PLACE", half_in_place, "moved", "quiet"),
        Row("GAP_ROUNDING", lambda x: too_far(x * 1e5, 1e5), "fine", "refused: does-not-fit", (1 / 3, 3.0, 100.0)),
        Row("NO_LENGTH", no_length, "refused: no-length", "fine"),
        Row("OPEN_RATE", lambda x: rates(x * BAR_SIZE * 2.0, 2.0), "fine", "refused: rates-do-not-fit"),
        Row("OPEN_RATE", lambda x: rates_of_a_beginning(x * BAR_SIZE), "fine", "refused: rates-do-not-fit"),
        Row("AT_REST", lambda x: rates(x * 1e-10 * BAR_SIZE, 0.0), "fine", "refused: rates-do-not-fit"),
        Row("SOLVABLE", lambda x: rates_at_flat(x / 4), "warned: singular position", "refused: singular-pose"),
    ),
    exempt={
        "NEAR_DRAWING": "which start a search takes first; tests/laws/test_nearest.py looks at what comes of it",
        "FARTHER": "which of two poses that both close; tests/laws/test_nearest.py holds how far it may be",
        "CLOSED": "ends a search: the verdict is OPEN_GAP's",
        "NO_SLOPE": "ends a search, which then starts again from elsewhere: the verdict is OPEN_GAP's",
        "DRIVE_FOLLOWED": "the instant of an error, to some digits: `lost` and UNMET_ROW_FACTOR decide if there is one",
        "POLISHED": "ends a search: the poses are closed on either side",
        "SUM_OF_SQUARES_LIMIT": "what accepts a step of the search, among closed poses",
        "SAME_SUM": "what accepts a step of the search, among closed poses",
        "UNMOVED": "whether the note says `as drawn`, or to six digits the same place",
        "PRINTED_COMPONENT": "digits of a note",
        "KERNEL.closed": "ends the settling of gaps, which the run reports",
        "KERNEL.nearly_closed": "ends the settling of gaps, which the run reports",
    },
    wanted={
        "STILL": "whether what rates of rounding ask for is met, where a blow has ended all motion",
        "NO_ACCELERATION": "whether accelerations exist at the start",
        "KERNEL.reopened": "when a row that was left out is taken in again",
        "KERNEL.closures_lost": "whether closures are lost",
    },
)
