"""What is asked: instants in order, a type that fits them, a tolerance that can be met."""

from __future__ import annotations

from collections.abc import Iterator

from heuncli import tolerances
from heuncli.spec.rules.registry import Found, Scene, rule

MOST_SAMPLES = 10_000_000


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
    if value is not None and not tolerances.LEAST_ASKED < value < 1.0:
        yield Found(("analysis", "tolerance"), f"tolerance {value:g} is not between 1e-15 and 1", "the default is 1e-9")
