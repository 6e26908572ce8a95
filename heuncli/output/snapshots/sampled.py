"""A result in JSON as a run that is kept: its samples alone, for what lies between them is not in it.

Of the scene it holds names, not kinds: whether a joint turns or slides follows from its coordinates.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from heuncli.base.errors import Finding
from heuncli.base.joint_kinds import TYPES
from heuncli.base.tolerances import SAME_INSTANT
from heuncli.output.snapshots.columns import KeptScope, Told, all_columns
from heuncli.output.snapshots.kept import EVEN, KeptRun
from heuncli.output.snapshots.record import KeptBounds, KeptCourse, record_of
from heuncli.output.tables.page import Page, page_of
from heuncli.results.results import Array, Block, Magnitudes, Results
from heuncli.results.results_schema import REPORT_OF, quantity
from heuncli.study.quantities.digits import largest
from heuncli.study.quantities.labels import ForceInfo, JointInfo, Labels
from heuncli.study.quantities.series import walk
from heuncli.study.quantities.table_units import Units

NEEDED = ("model", "status", "time", "accuracy")
ONE_FORM = "heun run SPEC --format json writes one"
TWOFOLD = ("value", "rate")  # of a load: their unit depends on its kind
OF_NO_KNOWN_KIND = ""  # the unit of a load that its block does not tell apart


def run_of(data: Mapping[str, Any], only: Sequence[int] | None = None) -> KeptRun:
    """What a result holds, as it is kept; only: of these of its instants. Raises Finding [not-a-result].

    Its errors are those of the whole result: they are shares of the largest number in it.
    """
    lacking = [key for key in NEEDED if key not in data]
    if lacking:
        raise Finding("not-a-result", f"this is no result of heun run: it has no '{lacking[0]}'", ONE_FORM)
    try:
        results = _results(data)
        labels = _labels(results)
        page = page_of(results, labels, _magnitudes(results, labels))
        scope = KeptScope(frozenset(REPORT_OF[block] for block in REPORT_OF if getattr(results, block)), labels)
        if only is not None:
            results = _results(_at_instants(data, only))
            page = page_of(results, labels, _magnitudes(results, labels))._replace(certain=page.certain)
        run = record_of(_course(page, results, scope), page, scope)
    except (KeyError, IndexError, TypeError, ValueError, AttributeError) as error:
        raise Finding("not-a-result", f"this is no whole result of heun run: {error!s:.100}", ONE_FORM) from None
    unclear = {f"joints.{name}.drive" for name in results.joints if name not in labels.joints}
    unclear |= {f"forces.{name}.{key}" for name in results.forces if name not in labels.forces for key in TWOFOLD}
    numbers = {
        path: number.model_copy(update={"unit": OF_NO_KNOWN_KIND}) if path in unclear else number
        for path, number in run.numbers.items()
    }
    return run.model_copy(update={"numbers": numbers})


def instants_of(data: Mapping[str, Any]) -> Array:
    """The instants of a result that is whole, (n,)."""
    return np.atleast_1d(np.asarray(data["time"], dtype=np.float64))


def common_instants(one: Mapping[str, Any], other: Mapping[str, Any]) -> tuple[list[int], list[int]]:
    """Which instants of one result are instants of another, and which of that they are."""
    times, others = instants_of(one), instants_of(other)
    same = SAME_INSTANT * max(float(np.ptp(times)), float(np.ptp(others)))
    near = np.abs(times[:, None] - others[None, :]).argmin(axis=1) if len(others) else np.zeros(0, dtype=np.intp)
    pairs = [(i, int(k)) for i, k in enumerate(near) if abs(times[i] - others[k]) <= same]
    fresh = [pair for n, pair in enumerate(pairs) if not n or pair[1] > pairs[n - 1][1]]
    return [i for i, _ in fresh], [k for _, k in fresh]


def _at_instants(data: Mapping[str, Any], only: Sequence[int]) -> dict[str, Any]:
    """A result at some of its instants alone."""
    n = len(instants_of(data))

    def part(keys: tuple[str, ...], value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: part((*keys, key), member) for key, member in value.items()}
        row = quantity(keys)
        timed = row is not None and row.timed and isinstance(value, list) and len(value) == n
        return [value[i] for i in only] if timed else value

    def summed(values: Any) -> Any:
        return [values[i] for i in only] if isinstance(values, list) and len(values) == n else values

    found = {key: part((key,), value) for key, value in data.items()}
    found["time"] = [instants_of(data)[i] for i in only]
    if "certain_sums" in data:
        found["certain_sums"] = [
            {"terms": {path: summed(x) for path, x in block["terms"].items()}, "value": summed(block["value"])}
            for block in data["certain_sums"]
        ]
    return found


def _results(data: Mapping[str, Any]) -> Results:
    """The blocks with arrays for lists of numbers, nan for `null` there. Raises ValueError where a length is wrong."""
    known = {field.name for field in fields(Results)}
    blocks = {key: _arrays((key,), value) for key, value in data.items() if key in known}
    blocks["time"] = np.atleast_1d(np.asarray(data["time"], dtype=np.float64))
    if blocks["time"].ndim != 1 or not len(blocks["time"]) or not np.all(np.isfinite(blocks["time"])):
        raise ValueError("time: expected instants")
    accuracy = dict(data["accuracy"])
    estimate = accuracy.get("estimate") or {}
    accuracy["estimate"] = {kind: float("inf") if error is None else float(error) for kind, error in estimate.items()}
    results = Results(**{"title": "", "spec": {}, "version": "", **blocks, "accuracy": accuracy})
    for keys, value in _leaves(data):
        row = quantity(keys)
        if row is not None and row.timed and row.units and isinstance(value, list) and len(value) != len(results.time):
            raise ValueError(f"{'.'.join(keys)}: {len(value)} values at {len(results.time)} instants")
    return results


def _leaves(block: Any, keys: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """What stands below all keys, but in lists of blocks."""
    if not isinstance(block, Mapping):
        yield keys, block
        return
    for key, value in block.items():
        yield from _leaves(value, (*keys, key))


def _arrays(keys: tuple[str, ...], value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _arrays((*keys, key), member) for key, member in value.items()}
    if not isinstance(value, list) or not value:
        return value
    if any(isinstance(member, dict) for member in value):
        return [_arrays((*keys, str(number)), member) for number, member in enumerate(value)]
    return np.array(value, dtype=np.float64) if _is_numeric(value) else value


def _is_numeric(value: Any) -> bool:
    """Whether there are numbers and `null` alone in nested lists."""
    if isinstance(value, list):
        return all(map(_is_numeric, value))
    return value is None or (isinstance(value, (int, float)) and not isinstance(value, bool))


def _labels(results: Results) -> Labels:
    """The kinds of joints and loads as far as their blocks tell them."""
    joints = {name: JointInfo("rod", "", "") for name, joint in results.joints.items() if "tension" in joint}
    for name, block in results.coordinates.items():
        coordinates = tuple(word for word in ("angle", "travel") if word in block)
        kind = next((kind.name for kind in TYPES.values() if kind.coordinates == coordinates), "ball")
        joints[name] = JointInfo(kind, "", "")
    forces = {
        name: ForceInfo("turn_spring", turning=True) if "angle" in block else ForceInfo("spring")
        for name, block in results.forces.items()
        if "angle" in block or "length" in block
    }
    return Labels(joints, forces, units=Units({}))


def _magnitudes(results: Results, labels: Labels) -> Magnitudes:
    """The largest numbers by unit, and the size of the scene by where its bodies and points go [m]."""
    by_unit: dict[str, float] = {}
    for series in walk(results, labels):
        by_unit[series.unit] = max(by_unit.get(series.unit, 0.0), largest(series.values))
    places = [block[key].reshape(-1, 3) for block, key in _placed(results)]
    size = float(np.ptp(np.concatenate(places), axis=0).max()) if places else 0.0
    return Magnitudes(by_unit, size or 1.0, size or 1.0, {})


def _placed(results: Results) -> Iterator[tuple[Block, str]]:
    for body in results.bodies.values():
        yield from ((dict(body), key) for key in ("position", "center") if key in body)
    for blocks, key in ((results.points, "position"), (results.joints, "point")):
        yield from ((dict(block), key) for block in blocks.values() if key in block)


def _course(page: Page, results: Results, scope: KeptScope) -> KeptCourse:
    """The columns with the extremes of their samples; at even instants where samples are there."""
    told = Told(results, page.labels, page.certain)
    columns = all_columns(results, scope)
    known = all_columns(page.results, scope)
    which = _even(results.time)
    even = {path: column.values[which] for path, column in columns.items()}
    bounds = {path: _bounds(path, column.values, page.results.time) for path, column in known.items()}
    return KeptCourse(told, columns, even, results.time[which], bounds, {})


def _even(times: Array) -> slice:
    """Eleven of the samples, where that many of them lie evenly."""
    last = len(times) - 1
    evenly = np.linspace(times[0], times[-1], len(times))
    if last < EVEN - 1 or last % (EVEN - 1) or np.any(np.abs(evenly - times) > SAME_INSTANT * (times[-1] - times[0])):
        return slice(0)
    return slice(None, None, last // (EVEN - 1))


def _bounds(path: str, values: Array, times: Array) -> KeptBounds:
    """The lowest and highest of the samples; of a run of cuts the one that the column is of."""
    if not np.isfinite(values).any():
        low = high = (float("nan"), float(times[0]), None)
    else:
        lowest, highest = int(np.nanargmin(values)), int(np.nanargmax(values))
        low = float(values[lowest]), float(times[lowest]), None
        high = float(values[highest]), float(times[highest]), None
    return KeptBounds(None if path.endswith(".highest") else low, None if path.endswith(".lowest") else high)
