"""What is asked: instants in order, a type that fits them, a tolerance that can be met; what is expected of it."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli.spec.meanings import instants_of, type_of
from heuncli.spec.nearest import did_you_mean
from heuncli.spec.rules.registry import Found, Scene, rule

MOST_SAMPLES = 10_000_000
SAME_INSTANT = 1e-9

VECTOR = ("force", "moment")
OF_JOINTS = ("point", *VECTOR, "open", "drive", "axial", "radial", "tilting", "tension", "shares")
OF_SECTIONS = (
    "point", "normal", "first_axis", "open", *VECTOR, "N", "Q1", "Q2", "T", "M1", "M2", "line", "stress", "s", "side",
    "shares",
)  # fmt: skip
OF_BODIES = (
    "position", "velocity", "rotation", "center", "center_velocity", "center_acceleration", "angular_velocity",
    "angular_acceleration",
)  # fmt: skip
OF_COORDINATES = ("angle", "rate", "acceleration", "travel", "speed", "angular_acceleration")
OF_FOUNDATION = ("about", *VECTOR, "axis", "mass_effect", "supports", "elements", "shares")
# What stands under each word of the results, and which names of the scene stand between.
RESULTS: dict[str, tuple[str | None, tuple[str, ...]]] = {
    "model": (None, ("space", "freedoms", "bodies", "loops", "redundant", "method", "reasons")),
    "status": (None, ("code", "message")),
    "time": (None, ()),
    "bodies": ("bodies", OF_BODIES),
    "points": ("points", ("position", "velocity", "acceleration")),
    "coordinates": ("joints", OF_COORDINATES),
    "foundation": (None, OF_FOUNDATION),
    "joints": ("joints", OF_JOINTS),
    "sections": ("sections", OF_SECTIONS),
    "forces": ("forces", ("value", "length", "rate", "power")),
    "energy": (None, ("kinetic", "potential", "work")),
    "system_vector": (None, ("total", "bodies")),
    "impulses": (None, ()),
    "certain_sums": (None, ()),
    "accuracy": (None, ("energy_drift", "constraint_gap", "balance_residual", "horizon", "estimate")),
    "work": (None, ("kernel", "steps", "evaluations", "seconds")),
    "title": (None, ()),
}


@rule("times")
def times(scene: Scene) -> Iterator[Found]:
    """Instants are given once, ascend, and do not lie before the start."""
    analysis = scene.document.analysis
    path = ("analysis",)
    if analysis.times is not None:
        for key in ("duration", "samples"):
            if getattr(analysis, key) is not None:
                yield Found((*path, key), f"{key} beside times", "the last of the times is the end", key=True)
        if not analysis.times:
            yield Found((*path, "times"), "times is an empty list")
        for i, t in enumerate(analysis.times):
            if t < 0.0:
                yield Found((*path, "times", i), f"the run starts at 0; {t:g} s lies before it")
            elif i and t <= analysis.times[i - 1]:
                yield Found((*path, "times", i), f"times ascend, but {t:g} follows {analysis.times[i - 1]:g}")
        if analysis.times == [0.0] and analysis.type in (None, "motion"):
            yield Found((*path, "times"), "a motion that ends when it starts", "for one instant: type: state")
    elif analysis.samples is not None:
        if analysis.duration is None:
            yield Found(
                (*path, "samples"), "samples without a duration", "analysis: {duration: 2, samples: 201}", key=True
            )
        if not 2 <= analysis.samples <= MOST_SAMPLES:
            yield Found((*path, "samples"), f"samples counts both ends: 2 to {MOST_SAMPLES}, not {analysis.samples}")


@rule("analysis-type")
def analysis_type(scene: Scene) -> Iterator[Found]:
    """The type fits the rest."""
    analysis = scene.document.analysis
    path = ("analysis", "type")
    timed = analysis.duration is not None or analysis.times is not None
    if analysis.type == "motion" and not timed:
        yield Found(path, "a motion needs a duration or times", "analysis: {duration: 2, samples: 201}")
    if analysis.type in ("state", "impulse") and timed:
        yield Found(
            path,
            f"type: {analysis.type} is one instant and takes no duration or times",
            "leave the type out for a motion",
        )
    if analysis.type == "impulse" and not scene.names.entries["impulses"]:
        yield Found(path, "type: impulse without impulses", "impulses: {blow: {on: body.point, vector: [1, 0, 0]}}")


@rule("tolerance")
def tolerance(scene: Scene) -> Iterator[Found]:
    """A tolerance is between rounding and the whole."""
    value = scene.document.analysis.tolerance
    if value is not None and not 1e-15 < value < 1.0:
        yield Found(("analysis", "tolerance"), f"tolerance {value:g} is not between 1e-15 and 1", "the default is 1e-9")


@rule("expect-path")
def expect_path(scene: Scene) -> Iterator[Found]:
    """`of` leads to a result."""
    for i, item in scene.document.expect.items():
        problem = wrong_word(item.of.split("."), scene)
        if problem is not None:
            word, known = problem
            yield Found(
                ("expect", i, "of"), f"'{item.of}': '{word}' is not a result", did_you_mean(word, known, "words here")
            )


def wrong_word(words: list[str], scene: Scene) -> tuple[str, list[str]] | None:
    """The first word of a path that leads nowhere, with those that would lead on."""
    names = scene.names
    if words[0] not in RESULTS:
        return words[0], list(RESULTS)
    block, fields = RESULTS[words[0]]
    rest = words[1:]
    if words[0] == "foundation" and len(rest) > 1 and rest[0] in ("supports", "elements"):
        owners = names.entries["joints" if rest[0] == "supports" else "forces"]
        return (rest[1], list(owners)) if rest[1] not in owners else None
    if block == "points" and rest:
        if rest[0] not in names.points:
            return rest[0], list(names.points)
        if len(rest) > 1 and rest[1] not in names.points[rest[0]]:
            return rest[1], list(names.points[rest[0]])
        rest = rest[2:]
    elif block is not None and rest:
        if rest[0] not in names.entries[block]:
            return rest[0], list(names.entries[block])
        rest = rest[1:]
    if rest and fields and rest[0] not in fields:
        return rest[0], list(fields)
    return None


@rule("expect-form")
def expect_form(scene: Scene) -> Iterator[Found]:
    """An expectation is a number, a list or null, at an instant of the output or at a peak."""
    analysis = scene.document.analysis
    instants = instants_of(scene.document) if type_of(scene.document) == "motion" else (0.0,)
    for i, item in scene.document.expect.items():
        path = ("expect", i)
        if item.at is not None and item.peak is not None:
            yield Found((*path, "peak"), "both at and peak", "at is one instant, peak is over all of them", key=True)
        if item.at is not None and instants and analysis.type != "impulse" and "analysis" not in scene.unread:
            nearest = min(instants, key=lambda t: abs(t - item.at))  # type: ignore[operator]
            if abs(nearest - item.at) > SAME_INSTANT * max(instants[-1], abs(item.at)):
                message = f"{item.at:g} s is not an instant of the output; the nearest is {nearest:g} s"
                yield Found((*path, "at"), message, "add it to analysis.times, or choose other samples")
