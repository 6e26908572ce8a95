"""What of two runs differs by more than both state: numbers, verdicts of open, sums, events, blows, counts.

Two honest runs differ by no more than the sum of their stated errors. What one of them lacks, or cannot tell (open,
beyond the horizon, beside a singular pose), and the other tells is a change whatever its size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.change import Change
from heuncli.output.snapshots.course_changes import at_other_instants, course_changes
from heuncli.output.snapshots.kept import BOUNDS, EVEN, KeptBlow, KeptEvent, KeptNumber, KeptRun, KeptSum, Value

MISSING, EXTRA = "missing", "extra"
THROUGHOUT = "throughout"  # the word for a number that is the same at all instants


class Allowance(NamedTuple):
    """How far two values of one quantity may differ: the errors of both, or a share of the largest of their kind.

    share: None for the errors; scales: the largest by kind (the first word of a path) and unit.
    """

    share: float | None
    scales: Mapping[tuple[str, str], float]

    def of(self, path: str, old: KeptNumber, new: KeptNumber) -> float:
        """For the values at known instants."""
        if self.share is None:
            return old.error + new.error
        return self.share * self.scales.get((path.split(".")[0], old.unit), 0.0)


def changes(old: KeptRun, new: KeptRun, share: float | None = None) -> list[Change]:
    """All that differs, the counts first, then in the order of paths; share: in place of the stated errors."""
    allowance = Allowance(share, _scales(old))
    parts: list[Iterator[Change]] = [
        _counts(old, new),
        _times(old, new),
        _open(old, new),
        *(
            _numbers(path, old.numbers.get(path), new.numbers.get(path), allowance, (old, new))
            for path in sorted(old.numbers.keys() | new.numbers.keys())
        ),
        *(
            _sums(name, old.certain_sums.get(name), new.certain_sums.get(name), allowance)
            for name in sorted(old.certain_sums.keys() | new.certain_sums.keys())
        ),
        *(
            _events(name, old.events.get(name), new.events.get(name))
            for name in sorted(old.events.keys() | new.events.keys())
        ),
        *(
            _blow(number, one, other, allowance)
            for number, (one, other) in enumerate(zip(old.impulses, new.impulses, strict=False))
        ),
    ]
    return list(chain.from_iterable(parts))


def _scales(run: KeptRun) -> dict[tuple[str, str], float]:
    """The largest of all numbers of a kind and unit."""
    scales: dict[tuple[str, str], float] = {}
    blows = (blow.numbers.items() for blow in run.impulses)
    sums = (("joints", one.value) for one in run.certain_sums.values())
    for path, number in chain(run.numbers.items(), *blows, sums):
        key = path.split(".")[0], number.unit
        own = (abs(value) for value in number.values.values() if not isinstance(value, str))
        scales[key] = max(scales.get(key, 0.0), *own, 0.0)
    return scales


def _counts(old: KeptRun, new: KeptRun) -> Iterator[Change]:
    """How the run ended, and the model's counts."""
    if old.status != new.status:
        yield Change("status", "", "", None, None, why=f"{old.status} became {new.status}")
    for key in sorted(old.model.keys() | new.model.keys()):
        before, after = old.model.get(key), new.model.get(key)
        if before != after:
            yield Change(f"model.{key}", "count", "", before, after, 0.0, why=_gone(before, after))
    if old.blows != new.blows:
        yield Change("impulses", "count", "", old.blows, new.blows, 0.0)


def _times(old: KeptRun, new: KeptRun) -> Iterator[Change]:
    """The ends of the run."""
    for word in ("first", "last"):
        allowed = sum(run.time.get(f"{word}_error", 0.0) for run in (old, new)) + _rounding(old)
        if abs(old.time[word] - new.time[word]) > allowed:
            yield Change("time", word, "s", old.time[word], new.time[word], allowed)


def _rounding(run: KeptRun) -> float:
    """What instants lose by rounding."""
    return 4.0 * 2.0**-52 * max(abs(at) for at in run.time.values())


def _open(old: KeptRun, new: KeptRun) -> Iterator[Change]:
    """Components that became open, or certain."""
    for path in sorted({*old.open} ^ {*new.open}):
        was_open = path in old.open
        why = "was open, and is certain" if was_open else "became open"
        yield Change(path, "verdict", "", "open" if was_open else "certain", "certain" if was_open else "open", why=why)


def _numbers(
    path: str, old: KeptNumber | None, new: KeptNumber | None, allowance: Allowance, runs: tuple[KeptRun, KeptRun]
) -> Iterator[Change]:
    """The worst of the values of one quantity that differ, of the extremes each."""
    if old is None or new is None:
        yield _lack(path, old)
        return
    if old.unit != new.unit:
        yield Change(path, "unit", "", None, None, why=f"{old.unit} became {new.unit}")
        return
    if old.constant is not None and new.constant is not None:
        change = _value(path, THROUGHOUT, (old, new), allowance, runs)
        yield from (change,) if change is not None else ()
        return
    found = [
        change for word in _words_of_both(old, new)
        if (change := _value(path, word, (old, new), allowance, runs)) is not None
    ]  # fmt: skip
    found += course_changes(path, (old, new), runs, allowance.of(path, old, new), by_error=allowance.share is None)
    extremes = [change for change in found if change.what in BOUNDS]
    if extremes:
        yield from (change._replace(alike=(len(found) - len(extremes)) * (not i)) for i, change in enumerate(extremes))
    elif found:
        worst = max(found, key=lambda change: change.excess)
        yield worst._replace(alike=len(found) - 1)


def _words_of_both(old: KeptNumber, new: KeptNumber) -> list[str | int]:
    """The values of two numbers that are compared; of one that is constant, those that the other has."""
    if old.constant is not None:
        return list(new.values)
    return [*old.values, *(() if new.constant is not None else sorted(new.values.keys() - old.values.keys(), key=str))]


def _value(
    path: str, word: str | int, pair: tuple[KeptNumber, KeptNumber], allowance: Allowance, runs: tuple[KeptRun, KeptRun]
) -> Change | None:
    """One value of a quantity, where it differs."""
    old, new = pair
    before, after = (old.constant, new.constant) if word == THROUGHOUT else (old.values.get(word), new.values.get(word))
    instants = [run.even_at for run in runs]
    if isinstance(word, int) and at_other_instants(runs):
        return None  # of runs of other lengths: their ends are told
    at = instants[0][word] if isinstance(word, int) and word < len(instants[0]) else None
    what = f"t = {at:.6g} s" if at is not None else str(word)
    allowed = allowance.of(path, old, new)
    if word in ("last", EVEN - 1) and allowance.share is None:  # at an event, which is known to its own error
        ends = sum(run.time.get("last_error", 0.0) for run in runs)
        allowed += ends * max(old.drift or 0.0, new.drift or 0.0)
    if isinstance(before, str) or isinstance(after, str) or before is None or after is None:
        change = Change(path, what, old.unit, before, after, allowed, _became(before, after), at=at)
        return change if before != after else None
    differs = not abs(after - before) <= allowed
    return Change(path, what, old.unit, before, after, allowed, at=at) if differs else None


def _became(old: Value | str | None, new: Value | str | None) -> str:
    """In words what became of a value."""
    if old is None or new is None:
        return _gone(old, new)
    known = {"open": "open", "beyond": "beyond the horizon", "unknown": "not known beside a singular pose"}
    return f"was {known.get(str(old), 'a number')}, is {known.get(str(new), 'a number')}"


def _gone(old: object, new: object) -> str:
    return EXTRA if old is None else MISSING if new is None else ""


def _lack(path: str, old: object) -> Change:
    return Change(path, MISSING if old is not None else EXTRA, "", None, None, why=_gone(old, None if old else 1))


def _sums(name: str, old: KeptSum | None, new: KeptSum | None, allowance: Allowance) -> Iterator[Change]:
    """A certain sum: its factors, and the worst of its values."""
    path = f"certain_sums: {name}"
    if old is None or new is None:
        yield _lack(path, old)
        return
    allowed = old.error + new.error if allowance.share is None else allowance.share
    for term, factor in old.factors.items():
        other = new.factors.get(term)
        numbers = not isinstance(factor, str) and not isinstance(other, str) and other is not None
        if factor != other and not (numbers and abs(factor - other) <= allowed):  # type: ignore[operator]
            yield Change(path, f"factor of {term}", "", factor, other, allowed)
    scaled = allowance.scales.get(("joints", old.value.unit), 0.0)
    bound = old.value.error + new.value.error if allowance.share is None else allowance.share * scaled
    found = []
    for word in old.value.values.keys() & new.value.values.keys():
        before, after = old.value.values[word], new.value.values[word]
        if isinstance(before, str) or isinstance(after, str):
            if before != after:
                found.append(Change(path, str(word), old.value.unit, before, after, bound, _became(before, after)))
        elif not abs(after - before) <= bound:
            found.append(Change(path, str(word), old.value.unit, before, after, bound))
    if found:
        yield max(found, key=lambda change: change.excess)


def _events(name: str, old: KeptEvent | None, new: KeptEvent | None) -> Iterator[Change]:
    """The instants of one event that have no counterpart; what happens only just need not happen in another run."""
    path = f"events.{name}"
    if old is None or new is None:
        yield _lack(path, old)
        return
    if old.begins != new.begins:
        yield Change(path, "at the start", "", float(old.begins), float(new.begins), why="another truth at the start")
    for one, other, why in ((old, new, MISSING), (new, old, EXTRA)):
        for t, error, to in zip(one.time, one.error, one.to, strict=True):
            if not isinstance(error, str) and not any(_same_instant(t, error, to, other)):
                told = "it becomes true" if to else "it becomes false"
                before, after = (t, None) if one is old else (None, t)
                yield Change(path, told, "s", before, after, why=why)


def _same_instant(t: float, error: float, to: bool, other: KeptEvent) -> Iterator[bool]:
    for at, its, becomes in zip(other.time, other.error, other.to, strict=True):
        yield becomes == to and (isinstance(its, str) or abs(t - at) <= error + its + 4.0 * 2.0**-52 * abs(t))


def _blow(number: int, old: KeptBlow, new: KeptBlow, allowance: Allowance) -> Iterator[Change]:
    """A blow: its instant, what struck, and its numbers."""
    path = f"impulses.{number}"
    if old.names != new.names:
        yield Change(path, "struck by", "", None, None, why=f"{', '.join(old.names)} became {', '.join(new.names)}")
        return
    allowed = old.time_error + new.time_error
    if not abs(old.time - new.time) <= allowed:
        yield Change(path, "time", "s", old.time, new.time, allowed)
    for name in sorted(old.numbers.keys() | new.numbers.keys()):
        before, after = old.numbers.get(name), new.numbers.get(name)
        if before is None or after is None:
            yield _lack(f"{path}.{name}", before)
            continue
        a, b, bound = before.constant, after.constant, allowance.of(name, before, after)
        if isinstance(a, str) or isinstance(b, str) or a is None or b is None:
            if a != b:
                yield Change(f"{path}.{name}", "", before.unit, a, b, bound, _became(a, b))
        elif not abs(b - a) <= bound:
            yield Change(f"{path}.{name}", "", before.unit, a, b, bound)
