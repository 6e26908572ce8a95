"""Variants on their way to workers of a cluster: sizes of lots, and what becomes of those whose workers go."""

from __future__ import annotations

import pickle
import threading
import time
from pathlib import Path

import pytest

from heuncli.analyses.variants.asking import Asker, Recipe
from heuncli.app.commands.sweep.cluster import worker as cluster_worker
from heuncli.app.commands.sweep.cluster.lots import DEPTH, FIRST, GROWTH, MOST, SECONDS, WORKERS, Lot, Lots, Pace
from heuncli.app.commands.sweep.cluster.worker import HELLO, HeldRecipe, Variant, answered, described
from heuncli.output.snapshots import measure
from heuncli.study.model.options import Options
from heuncli.version import VERSION
from tests.shared.command import TURNED

SWINGING = TURNED + "analysis: {duration: 0.2, samples: 3}\n"


def variants(count: int) -> list[Variant]:
    return [(number, {"m": f"{1 + number}"}) for number in range(count)]


def lots(count: int) -> Lots:
    return Lots(iter(variants(count)), count)


def test_every_variant_goes_once() -> None:
    waiting, sent = lots(100), []
    while (lot := waiting.next(7, 3)) is not None:
        sent += lot.variants
    assert sent == variants(100)
    assert waiting.nothing()


def test_the_last_lots_leave_something_for_all() -> None:
    waiting, sizes = lots(100), []
    while (lot := waiting.next(1000, 2)) is not None:
        sizes.append(len(lot.variants))
    assert sizes[0] == 100 / (2 * DEPTH)
    assert sizes == sorted(sizes, reverse=True)
    assert sizes[-1] == 1


def test_a_lot_takes_about_as_long_as_it_should() -> None:
    pace = Pace()
    assert pace.size == FIRST
    pace.took(FIRST, 1e-9)
    assert pace.size == FIRST * GROWTH
    pace.took(32, SECONDS / 2)
    assert pace.size == 64
    pace.took(3, 4 * SECONDS)
    assert pace.size == 1
    for _ in range(20):
        pace.took(pace.size, 1e-9)
    assert pace.size == MOST


def test_a_lot_that_loses_workers_goes_again_and_then_one_by_one() -> None:
    waiting = lots(3)
    lot = waiting.next(3 * DEPTH, 1)
    lot = Lot((*lot.variants, *waiting.next(9, 1).variants)) if lot else None
    for lost in range(1, WORKERS):
        assert lot is not None and not waiting.lost(lot)
        lot = waiting.next(9, 1)
        assert lot is not None and lot.lost == lost
    assert lot is not None and not waiting.lost(lot)
    assert [one.variants for one in waiting.alone] == [(variant,) for variant in lot.variants]
    one = waiting.alone.popleft()
    for _ in range(1, WORKERS):
        assert not waiting.lost(one)
        one = waiting.alone.pop()
    assert waiting.lost(one)
    assert not waiting.nothing()


def test_of_a_lot_the_rest_goes_again() -> None:
    waiting = lots(4)
    waiting.unanswered(Lot(tuple(variants(4))), 3)
    assert waiting.next(9, 1) == Lot((variants(4)[3],))
    waiting.unanswered(Lot(tuple(variants(4))), 4)
    assert not waiting.again


@pytest.fixture
def held(tmp_path: Path) -> HeldRecipe:
    measures = tuple(measure.parse_all(("max abs joints.pivot.force",)))
    return HeldRecipe(Recipe(str(tmp_path / "none.yaml"), SWINGING, measures, Options(), {}))


@pytest.mark.heavy
def test_tasks_of_one_process_work_one_after_the_other(held: HeldRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also those of several recipes: what heun keeps in its modules is that of one piece of work."""
    inside, most = [], []

    def watched(asker, values, plain=cluster_worker.answer_of):  # type: ignore[no-untyped-def]
        inside.append(1)
        most.append(len(inside))
        time.sleep(0.001)
        answer = plain(asker, values)
        inside.pop()
        return answer

    monkeypatch.setattr(cluster_worker, "answer_of", watched)
    other = pickle.loads(pickle.dumps(held))
    asked = [(held, variants(20)), (held, variants(20)[::-1]), (other, variants(20))]
    found: dict[int, object] = {}

    def work(place: int) -> None:
        recipe, batch = asked[place]
        part = answered(recipe, batch, 100.0)
        found[place] = {number: answer for (number, _), answer in zip(batch, part.answers, strict=True)}

    threads = [threading.Thread(target=work, args=(place,)) for place in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    asker = Asker(held.recipe)
    assert found[0] == found[1] == found[2] == {number: asker.answer(values) for number, values in variants(20)}
    assert len(most) == 60 and max(most) == 1


def test_a_variant_has_its_limit_of_time_in_a_thread_too(held: HeldRecipe) -> None:
    """No signal reaches a thread; the loops look at the clock."""
    text = SWINGING.replace("duration: 0.2", "duration: 100000")
    limited = HeldRecipe(held.recipe._replace(text=text, options=Options(time_limit=0.2)))
    found = []
    thread = threading.Thread(target=lambda: found.append(answered(limited, variants(1), 100.0)))
    thread.start()
    thread.join()
    assert [answer.code for answer in found[0].answers] == ["time-limit"]


def test_a_worker_stops_in_time_and_says_what_it_cannot(held: HeldRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(answered(held, variants(9), 0.0).answers) == 1
    wrong = HeldRecipe(held.recipe._replace(text="heun: 1\nbodies: {}\n"))
    assert answered(wrong, variants(1), 1.0).broken.startswith("SpecError: ")

    def fails(asker, values):  # type: ignore[no-untyped-def]
        raise RecursionError("too deep")

    monkeypatch.setattr(cluster_worker, "answer_of", fails)
    assert answered(held, variants(1), 1.0).broken == "RecursionError: too deep"


def test_a_bug_is_the_answer_of_its_variant(held: HeldRecipe, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(asker, values):  # type: ignore[no-untyped-def]
        if values["m"] == "2":
            raise ZeroDivisionError("none")
        return plain(asker, values)

    plain = Asker.answer
    monkeypatch.setattr(Asker, "answer", fails)
    assert [answer.code for answer in answered(held, variants(3), 9.0).answers] == ["", "bug", ""]


def test_what_a_worker_is_asked_first() -> None:
    """As text: it needs nothing of heun to be understood."""
    assert eval(HELLO) == (VERSION, described())
    assert eval(HELLO.replace(repr(VERSION), "'0.0.1'")) == (VERSION, None)
