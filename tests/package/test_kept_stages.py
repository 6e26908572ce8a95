"""Stages that are kept: what a stage looked at decides, and nothing else does."""

from __future__ import annotations

import numpy as np
import pytest

from heuncli.base.records import record, replace
from heuncli.multibody.stage_cache import RecordingStages, ReusingStages, Stages
from heuncli.results.results import Array


@record
class Bar:
    name: str
    length: float
    center: Array
    mass: float = 1.0

    @property
    def moment(self) -> float:
        return self.mass * self.length**2


@record
class Scene:
    bars: tuple[Bar, ...]
    gravity: float


def reach(scene: Scene) -> Array:
    """Looks at lengths and centres; at the mass of what is longer than 1 alone."""
    return np.array([bar.length + bar.center[0] + (bar.moment if bar.length > 1.0 else 0.0) for bar in scene.bars])


def scene(length: float = 0.5, mass: float = 1.0, gravity: float = 9.81, x: float = 0.0) -> Scene:
    return Scene((Bar("a", length, np.array([x, 0.0]), mass), Bar("b", 2.0, np.zeros(2))), gravity)


def test_a_stage_is_run_again_where_what_it_saw_is_another() -> None:
    first = RecordingStages()
    result = first.run(reach, scene())
    later = ReusingStages(first)
    assert result.tolist() == reach(scene()).tolist()
    for other in (scene(), scene(mass=3.0), scene(gravity=1.62)):
        assert later.run(reach, other) is result
    for other in (scene(length=0.6), scene(x=-0.0), replace(scene(), bars=scene().bars[:1])):
        assert later.run(reach, other) is not result
        assert later.run(reach, other).tolist() == reach(other).tolist()
    heavier = scene()
    heavier = replace(heavier, bars=(heavier.bars[0], replace(heavier.bars[1], mass=5.0)))
    assert later.run(reach, heavier).tolist() == reach(heavier).tolist() != result.tolist()


def test_what_a_replaced_record_takes_over_counts_where_it_is_looked_at() -> None:
    def lighter(given: Scene) -> float:
        again = replace(replace(given.bars[0], length=2.0), name="c")
        return again.moment

    first = RecordingStages()
    assert first.run(lighter, scene(mass=3.0)) == 12.0
    seen = first.cached[lighter, ""].traces[0]
    assert seen.matches(scene(mass=3.0, length=7.0, x=1.0))
    assert not seen.matches(scene(mass=2.0))
    later = ReusingStages(first)
    assert later.run(lighter, scene(mass=2.0)) == 8.0


def test_a_result_that_holds_input_is_not_kept() -> None:
    def shortened(given: Scene) -> Bar:
        return replace(given.bars[0], length=0.1)

    def told(given: Scene) -> tuple[Bar, ...]:
        return given.bars

    first = RecordingStages()
    for stage in (shortened, told):
        result = first.run(stage, scene())
        assert not first.cached
        assert all(type(bar) is Bar for bar in ([result] if isinstance(result, Bar) else result))


def test_a_stage_that_asks_for_objects_and_not_for_values_is_not_kept() -> None:
    known = scene()

    def whose(given: Scene) -> str:
        return "its own" if given.bars is known.bars else "another's"

    def by_object(given: Scene) -> str:
        return {id(bar): bar.name for bar in known.bars}[id(given.bars[0])]

    first = RecordingStages()
    assert first.run(whose, known) == "its own"
    assert first.run(by_object, known) == "a"
    assert not first.cached


def test_what_fails_is_not_kept_and_what_is_kept_cannot_be_written_to() -> None:
    def failing(given: Scene) -> None:
        raise ValueError(given.gravity)

    first = RecordingStages()
    with pytest.raises(ValueError, match=r"9\.81"):
        first.run(failing, scene())
    assert (failing, "") not in first.cached
    with pytest.raises(ValueError, match="read-only"):
        first.run(reach, scene())[0] = 1.0


def test_a_stage_of_stages_is_kept_as_a_whole_and_else_made_of_those_that_stand() -> None:
    made: list[str] = []

    def lengths(given: Scene) -> Array:
        made.append("lengths")
        return np.array([bar.length for bar in given.bars])

    def moments(given: Scene, of: Array) -> Array:
        made.append("moments")
        return np.array([bar.mass for bar in given.bars]) * of**2

    def both(given: Scene) -> Array:
        return moments(given, lengths(given))

    def of_stages(given: Scene, stages: Stages) -> Array:
        return stages.run(
            both, given, fallback=lambda: stages.run(moments, given, stages.run(lengths, given))
        )  # fmt: skip

    first = RecordingStages()
    of_stages(scene(), first)
    later = ReusingStages(first)
    for other, again in (
        (scene(x=1.0), []),
        (scene(mass=2.0), ["moments"]),
        (scene(length=0.7), ["lengths", "moments"]),
    ):
        made.clear()
        assert of_stages(other, later).tolist() == both(other).tolist()
        assert made[: len(again)] == again
        assert made[len(again) :] == ["lengths", "moments"]


def test_a_stage_of_stages_that_give_something_else_is_not_kept() -> None:
    first = RecordingStages()
    assert first.run(reach, scene(), fallback=lambda: np.zeros(2)).tolist() == [0.0, 0.0]
    assert not first.cached
