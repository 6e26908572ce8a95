"""Find what differs between two runs by more than both state: numbers, open components, sums, events, impacts, counts.

Two correct runs differ by no more than the sum of their stated errors. If only one of two runs has a value, or can
state it (it is not open, beyond the horizon, or uncertain near a singular position), that is a change whatever its
size.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.snapshots.change import Change, find_course_changes, have_different_instants
from heuncli.output.snapshots.golden_file import (
    BOUNDS,
    N_EVEN,
    EventSnapshot,
    ImpactSnapshot,
    NumberSnapshot,
    RunSnapshot,
    SumSnapshot,
    Value,
)

MISSING, EXTRA = "missing", "extra"
THROUGHOUT = "throughout"  # the word for a number that is constant


class Tolerance(NamedTuple):
    """How far two values of one quantity may differ: by their errors, or by a share of the largest of their kind.

    share: None to use the errors
    scales: the largest value by kind (the first word of a path) and unit
    """

    share: float | None
    scales: Mapping[tuple[str, str], float]

    def find_tolerance(self, path: str, old: NumberSnapshot, new: NumberSnapshot) -> float:
        """Return the tolerance of the two values at given instants."""
        if self.share is None:
            return old.error + new.error
        return self.share * self.scales.get((path.split(".")[0], old.unit), 0.0)


def find_changes(old: RunSnapshot, new: RunSnapshot, share: float | None = None) -> list[Change]:
    """Find all differences: the counts first, the others in the order of paths.

    share: of the largest value of a kind, used as tolerance instead of the stated errors
    """
    tolerance = Tolerance(share, _find_scales(old))
    parts: list[Iterator[Change]] = [
        _compare_counts(old, new),
        _compare_times(old, new),
        _compare_open_components(old, new),
        *(
            _compare_numbers(path, old.numbers.get(path), new.numbers.get(path), tolerance, (old, new))
            for path in sorted(old.numbers.keys() | new.numbers.keys())
        ),
        *(
            _compare_sums(name, old.certain_sums.get(name), new.certain_sums.get(name), tolerance)
            for name in sorted(old.certain_sums.keys() | new.certain_sums.keys())
        ),
        *(
            _compare_events(name, old.events.get(name), new.events.get(name))
            for name in sorted(old.events.keys() | new.events.keys())
        ),
        *(
            _compare_impacts(number, old_impact, new_impact, tolerance)
            for number, (old_impact, new_impact) in enumerate(zip(old.impulses, new.impulses, strict=False))
        ),
    ]
    return list(chain.from_iterable(parts))


def _find_scales(run: RunSnapshot) -> dict[tuple[str, str], float]:
    """Find the largest number of each kind and unit."""
    scales: dict[tuple[str, str], float] = {}
    impact_numbers = (impact.numbers.items() for impact in run.impulses)
    sums = (("joints", certain_sum.value) for certain_sum in run.certain_sums.values())
    for path, number in chain(run.numbers.items(), *impact_numbers, sums):
        key = path.split(".")[0], number.unit
        magnitudes = (abs(value) for value in number.values.values() if not isinstance(value, str))
        scales[key] = max(scales.get(key, 0.0), *magnitudes, 0.0)
    return scales


def _compare_counts(old: RunSnapshot, new: RunSnapshot) -> Iterator[Change]:
    """Compare how the runs ended, and the counts of their models."""
    if old.status != new.status:
        yield Change("status", "", "", None, None, reason=f"{old.status} became {new.status}")
    for key in sorted(old.model.keys() | new.model.keys()):
        before, after = old.model.get(key), new.model.get(key)
        if before != after:
            yield Change(f"model.{key}", "count", "", before, after, 0.0, reason=_name_absence(before, after))
    if old.blows != new.blows:
        yield Change("impulses", "count", "", old.blows, new.blows, 0.0)


def _compare_times(old: RunSnapshot, new: RunSnapshot) -> Iterator[Change]:
    """Compare the first and last instants."""
    for word in ("first", "last"):
        tolerance = sum(run.time.get(f"{word}_error", 0.0) for run in (old, new)) + _find_time_rounding(old)
        if abs(old.time[word] - new.time[word]) > tolerance:
            yield Change("time", word, "s", old.time[word], new.time[word], tolerance)


def _find_time_rounding(run: RunSnapshot) -> float:
    """Return the rounding error of the instants."""
    return 4.0 * 2.0**-52 * max(abs(time) for time in run.time.values())


def _compare_open_components(old: RunSnapshot, new: RunSnapshot) -> Iterator[Change]:
    """Yield the components that became open, or determinate."""
    for path in sorted({*old.open} ^ {*new.open}):
        was_open = path in old.open
        reason = "was open, now determinate" if was_open else "became open"
        yield Change(
            path, "verdict", "", "open" if was_open else "certain", "certain" if was_open else "open", reason=reason
        )


def _compare_numbers(
    path: str,
    old: NumberSnapshot | None,
    new: NumberSnapshot | None,
    tolerance: Tolerance,
    runs: tuple[RunSnapshot, RunSnapshot],
) -> Iterator[Change]:
    """Yield the worst changed value of one quantity, and each of its changed extremes."""
    if old is None or new is None:
        yield _make_absence_change(path, old)
        return
    if old.unit != new.unit:
        yield Change(path, "unit", "", None, None, reason=f"{old.unit} became {new.unit}")
        return
    if old.constant is not None and new.constant is not None:
        change = _compare_value(path, THROUGHOUT, (old, new), tolerance, runs)
        yield from (change,) if change is not None else ()
        return
    changes = [
        change for word in _choose_words(old, new)
        if (change := _compare_value(path, word, (old, new), tolerance, runs)) is not None
    ]  # fmt: skip
    changes += find_course_changes(
        path, (old, new), runs, tolerance.find_tolerance(path, old, new), by_error=tolerance.share is None
    )
    extremes = [change for change in changes if change.what in BOUNDS]
    if extremes:
        yield from (
            change._replace(n_similar=(len(changes) - len(extremes)) * (not i)) for i, change in enumerate(extremes)
        )
    elif changes:
        worst = max(changes, key=lambda change: change.excess)
        yield worst._replace(n_similar=len(changes) - 1)


def _choose_words(old: NumberSnapshot, new: NumberSnapshot) -> list[str | int]:
    """Return the words of the values to compare; if one number is constant, those of the other."""
    if old.constant is not None:
        return list(new.values)
    return [*old.values, *(() if new.constant is not None else sorted(new.values.keys() - old.values.keys(), key=str))]


def _compare_value(
    path: str,
    word: str | int,
    pair: tuple[NumberSnapshot, NumberSnapshot],
    tolerance: Tolerance,
    runs: tuple[RunSnapshot, RunSnapshot],
) -> Change | None:
    """Compare one value of a quantity; None if it did not change."""
    old, new = pair
    before, after = (old.constant, new.constant) if word == THROUGHOUT else (old.values.get(word), new.values.get(word))
    instants = [run.even_at for run in runs]
    if isinstance(word, int) and have_different_instants(runs):
        return None  # the runs have different lengths: their ends are compared instead
    time = instants[0][word] if isinstance(word, int) and word < len(instants[0]) else None
    what = f"t = {time:.6g} s" if time is not None else str(word)
    bound = tolerance.find_tolerance(path, old, new)
    if word in ("last", N_EVEN - 1) and tolerance.share is None:  # the end is an event, whose instant has an error
        end_error = sum(run.time.get("last_error", 0.0) for run in runs)
        bound += end_error * max(old.drift or 0.0, new.drift or 0.0)
    change = _compare(path, what, old.unit, (before, after), bound)
    return change._replace(time=time) if change is not None else None


def _compare(
    path: str, what: str, unit: str, pair: tuple[Value | None, Value | None], tolerance: float
) -> Change | None:
    """Compare an old and a new value, each a number, a word or missing; None if they agree within the tolerance."""
    before, after = pair
    if isinstance(before, str) or isinstance(after, str) or before is None or after is None:
        reason = _describe_transition(before, after)
        return Change(path, what, unit, before, after, tolerance, reason) if before != after else None
    differs = not abs(after - before) <= tolerance  # also where one of them is nan
    return Change(path, what, unit, before, after, tolerance) if differs else None


def _describe_transition(old: Value | str | None, new: Value | str | None) -> str:
    """Describe in words how a value changed."""
    if old is None or new is None:
        return _name_absence(old, new)
    phrases = {"open": "open", "beyond": "past the horizon", "unknown": "unknown near a singular position"}
    return f"was {phrases.get(str(old), 'a number')}, now {phrases.get(str(new), 'a number')}"


def _name_absence(old: object, new: object) -> str:
    """Return the word for a value that only one of two runs has; "" if both have it."""
    return EXTRA if old is None else MISSING if new is None else ""


def _make_absence_change(path: str, old: object) -> Change:
    """Make the change of what only one run has; old: None if it is the new one."""
    word = EXTRA if old is None else MISSING
    return Change(path, word, "", None, None, reason=word)


def _compare_sums(
    name: str, old: SumSnapshot | None, new: SumSnapshot | None, tolerance: Tolerance
) -> Iterator[Change]:
    """Compare a determinate sum: its factors, and the worst of its values."""
    path = f"certain_sums: {name}"
    if old is None or new is None:
        yield _make_absence_change(path, old)
        return
    factor_bound = old.error + new.error if tolerance.share is None else tolerance.share
    for term in {**old.factors, **new.factors}:
        change = _compare(path, f"factor of {term}", "", (old.factors.get(term), new.factors.get(term)), factor_bound)
        yield from (change,) if change is not None else ()
    scaled = tolerance.scales.get(("joints", old.value.unit), 0.0)
    bound = old.value.error + new.value.error if tolerance.share is None else tolerance.share * scaled
    values, new_values = old.value.values, new.value.values
    compared = [
        _compare(path, str(word), old.value.unit, (values.get(word), new_values.get(word)), bound)
        for word in _choose_words(old.value, new.value)
        if isinstance(word, str) or (word in values and word in new_values)  # runs may differ in even instants
    ]
    changes = [change for change in compared if change is not None]
    if changes:
        yield max(changes, key=lambda change: change.excess)


def _compare_events(name: str, old: EventSnapshot | None, new: EventSnapshot | None) -> Iterator[Change]:
    """Yield the instants of one event without a counterpart in the other run.

    An event whose margin is as small as its error need not happen in another run.
    """
    path = f"events.{name}"
    if old is None or new is None:
        yield _make_absence_change(path, old)
        return
    if old.begins != new.begins:
        yield Change(
            path, "at the start", "", float(old.begins), float(new.begins), reason="different state at the start"
        )
    for run_event, other_event, reason in ((old, new, MISSING), (new, old, EXTRA)):
        for t, error, becomes in zip(run_event.time, run_event.error, run_event.to, strict=True):
            if not isinstance(error, str) and not any(_match_instants(t, error, becomes, other_event)):
                what = "becomes true" if becomes else "becomes false"
                before, after = (t, None) if run_event is old else (None, t)
                yield Change(path, what, "s", before, after, reason=reason)


def _match_instants(t: float, error: float, becomes_true: bool, other: EventSnapshot) -> Iterator[bool]:
    """Yield for each instant of the other event whether it may be that at t, with its error [s]."""
    for other_time, other_error, becomes in zip(other.time, other.error, other.to, strict=True):
        yield becomes == becomes_true and (
            isinstance(other_error, str) or abs(t - other_time) <= error + other_error + 4.0 * 2.0**-52 * abs(t)
        )


def _compare_impacts(number: int, old: ImpactSnapshot, new: ImpactSnapshot, tolerance: Tolerance) -> Iterator[Change]:
    """Compare two impacts: their instants, what met, and their numbers."""
    path = f"impulses.{number}"
    if old.names != new.names:
        yield Change(path, "cause", "", None, None, reason=f"{', '.join(old.names)} became {', '.join(new.names)}")
        return
    time_bound = old.time_error + new.time_error
    if not abs(old.time - new.time) <= time_bound:
        yield Change(path, "time", "s", old.time, new.time, time_bound)
    for name in sorted(old.numbers.keys() | new.numbers.keys()):
        before, after = old.numbers.get(name), new.numbers.get(name)
        if before is None or after is None:
            yield _make_absence_change(f"{path}.{name}", before)
            continue
        bound = tolerance.find_tolerance(name, before, after)
        change = _compare(f"{path}.{name}", "", before.unit, (before.constant, after.constant), bound)
        yield from (change,) if change is not None else ()
