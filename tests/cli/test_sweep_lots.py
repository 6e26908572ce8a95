"""Variants on their way to workers of a cluster: sizes of lots, and what becomes of those whose workers go."""

from __future__ import annotations

import pickle
import threading
import time
from pathlib import Path

import pytest

from heuncli.analyses.variants.evaluation import Recipe, VariantEvaluator
from heuncli.app.commands.sweep.cluster import worker as cluster_worker
from heuncli.app.commands.sweep.cluster.worker import HELLO, CachedRecipe, Variant, read_worker_version, solve_batch
from heuncli.app.commands.sweep.cluster.workers import (
    DEPTH,
    FIRST_SIZE,
    GROWTH,
    MAX_SIZE,
    SECONDS,
    WORKERS,
    BatchQueue,
    VariantBatch,
    WorkerPace,
)
from heuncli.output.tables import measure
from heuncli.study.model.options import Options
from heuncli.version import VERSION
from tests.shared.command import TURNED

SWINGING = TURNED + "analysis: {duration: 0.2, samples: 3}\n"


def variants(count: int) -> list[Variant]:
    return [(number, {"m": f"{1 + number}"}) for number in range(count)]


def lots(count: int) -> BatchQueue:
    return BatchQueue(iter(variants(count)), count)


def test_every_variant_goes_once() -> None:
    waiting, sent = lots(100), []
    while (lot := waiting.pop_next(7, 3)) is not None:
        sent += lot.variants
    assert sent == variants(100)
    assert waiting.is_empty()


def test_the_last_lots_leave_something_for_all() -> None:
    waiting, sizes = lots(100), []
    while (lot := waiting.pop_next(1000, 2)) is not None:
        sizes.append(len(lot.variants))
    assert sizes[0] == 100 / (2 * DEPTH)
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 1


def test_a_lot_takes_about_as_long_as_it_should() -> None:
    pace = WorkerPace()
    assert pace.size == FIRST_SIZE
    pace.record_time(FIRST_SIZE, 1e-9)
    assert pace.size == FIRST_SIZE * GROWTH
    pace.record_time(32, SECONDS / 2)
    assert pace.size == 64
    pace.record_time(3, 4 * SECONDS)
    assert pace.size == 1
    for _ in range(20):
        pace.record_time(pace.size, 1e-9)
    assert pace.size == MAX_SIZE


def test_a_lot_that_loses_workers_goes_again_and_then_one_by_one() -> None:
    waiting = lots(3)
    lot = waiting.pop_next(3 * DEPTH, 1)
    lot = VariantBatch((*lot.variants, *waiting.pop_next(9, 1).variants)) if lot else None
    for lost in range(1, WORKERS):
        assert lot is not None and not waiting.return_lost(lot)
        lot = waiting.pop_next(9, 1)
        assert lot is not None and lot.lost_workers == lost
    assert lot is not None and not waiting.return_lost(lot)
    assert [one.variants for one in waiting.isolated] == [(variant,) for variant in lot.variants]
    one = waiting.isolated.popleft()
    for _ in range(1, WORKERS):
        assert not waiting.return_lost(one)
        one = waiting.isolated.pop()
    assert waiting.return_lost(one)
    assert not waiting.is_empty()


def test_of_a_lot_the_rest_goes_again() -> None:
    waiting = lots(4)
    waiting.return_rest(VariantBatch(tuple(variants(4))), 3)
    assert waiting.pop_next(9, 1) == VariantBatch((variants(4)[3],))
    waiting.return_rest(VariantBatch(tuple(variants(4))), 4)
    assert not waiting.retries


@pytest.fixture
def held(tmp_path: Path) -> CachedRecipe:
    measures = tuple(measure.parse_measures(("max abs joints.pivot.force",)))
    return CachedRecipe(Recipe(str(tmp_path / "none.yaml"), SWINGING, measures, Options(), {}))


@pytest.mark.heavy
def test_tasks_of_one_process_work_one_after_the_other(held: CachedRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also those of several recipes: what heun keeps in its modules is that of one piece of work."""
    inside, most = [], []

    def watched(*inputs, plain=cluster_worker.solve_contained):  # type: ignore[no-untyped-def]
        inside.append(1)
        most.append(len(inside))
        time.sleep(0.001)
        answer = plain(*inputs)
        inside.pop()
        return answer

    monkeypatch.setattr(cluster_worker, "solve_contained", watched)
    other = pickle.loads(pickle.dumps(held))
    asked = [(held, variants(20)), (held, variants(20)[::-1]), (other, variants(20))]
    found: dict[int, object] = {}

    def work(place: int) -> None:
        recipe, batch = asked[place]
        part = solve_batch(recipe, batch, 100.0)
        found[place] = {number: answer for (number, _), answer in zip(batch, part.results, strict=True)}

    threads = [threading.Thread(target=work, args=(place,)) for place in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    asker = VariantEvaluator(held.recipe)
    assert found[0] == found[1] == found[2] == {number: asker.answer(values) for number, values in variants(20)}
    assert len(most) == 60 and max(most) == 1


def test_a_variant_has_its_limit_of_time_in_a_thread_too(held: CachedRecipe) -> None:
    """No signal reaches a thread; the loops look at the clock."""
    text = SWINGING.replace("duration: 0.2", "duration: 100000")
    limited = CachedRecipe(held.recipe._replace(text=text, options=Options(time_limit=0.2)))
    found = []
    thread = threading.Thread(target=lambda: found.append(solve_batch(limited, variants(1), 100.0)))
    thread.start()
    thread.join()
    assert [answer.code for answer in found[0].results] == ["time-limit"]


def test_a_worker_stops_in_time_and_says_what_it_cannot(held: CachedRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(solve_batch(held, variants(9), 0.0).results) == 1
    wrong = CachedRecipe(held.recipe._replace(text="heun: 1\nbodies: {}\n"))
    assert solve_batch(wrong, variants(1), 1.0).failure.startswith("SpecError: ")

    def fails(*inputs):  # type: ignore[no-untyped-def]
        raise RecursionError("too deep")

    monkeypatch.setattr(cluster_worker, "solve_contained", fails)
    assert solve_batch(held, variants(1), 1.0).failure == "RecursionError: too deep"


def test_a_bug_is_the_answer_of_its_variant(held: CachedRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(asker, values):  # type: ignore[no-untyped-def]
        if values["m"] == "2":
            raise ZeroDivisionError("none")
        return plain(asker, values)

    plain = VariantEvaluator.answer
    monkeypatch.setattr(VariantEvaluator, "answer", fails)
    assert [answer.code for answer in solve_batch(held, variants(3), 9.0).results] == ["", "bug", ""]


def test_what_a_worker_is_asked_first() -> None:
    """As text: it needs nothing of heun to be understood."""
    assert eval(HELLO) == (VERSION, read_worker_version())
    assert eval(HELLO.replace(repr(VERSION), "'0.0.1'")) == (VERSION, None)
