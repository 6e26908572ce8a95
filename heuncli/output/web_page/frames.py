"""The instants that a page holds: those asked for, and more between them where the motion would look torn.

Nothing is shown beyond the horizon. Blows and jumps have both of their sides, and where a load is largest there is a
frame, too.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.base.named_tuples import NamedTuple
from heuncli.motion.integration.segments import limits_of
from heuncli.results.results import Array, Indices, Results
from heuncli.results.results_schema import REPORT_OF
from heuncli.study.ask.study import Study
from heuncli.study.search.extremes import distinct
from heuncli.study.search.instants import turned_between

LEAST = 120  # frames of a motion
TURNED = 0.3  # rad: how far a body may turn from one frame to the next
MOST = 600  # frames, where nobody says how many
MOST_JUMPS = 60  # whose sides are frames: knots of tables count as jumps, too
SAME = 1e-3  # of the way from one asked instant to the next: a summit is missed by the square of it
MISSED = (
    "Of the instants at which loads are largest {} found no room in this page: what is highest here is so at frames "
    "alone; heun run tells the largest."
)
MOST_BYTES = 24_000_000  # of the numbers of a page, before they are text


class PageFrames(NamedTuple):
    """The instants (n,) [s] of a page, and what is to be said of them."""

    times: Array
    told: tuple[str, ...]


def frames_of(study: Study, peaks: Array, most: int = MOST) -> PageFrames:
    """The frames of a page, at most so many; peaks: instants that are among them if there is room."""
    results = study.results
    if study.of_one_instant:
        return PageFrames(results.time, ())
    horizon = results.horizon
    asked = results.time if horizon is None else results.time[results.time < horizon]
    if len(asked) < 2:
        of_horizon = ("Nothing is claimed of this motion beyond its start.",) if len(results.time) > len(asked) else ()
        return PageFrames(results.time[:1], of_horizon)
    limit = max(2, min(most, MOST_BYTES // _bytes_of_a_frame(study)))
    beside, missed = _beside(study, peaks, asked, max(limit - len(asked), limit // 3))
    room = limit - len(beside)
    told = [MISSED.format(missed)] if missed else []
    if len(asked) > room:
        told.append(f"The run was asked for at {len(asked)} instants; {room} of them are in this page.")
        even = asked[np.linspace(0, len(asked) - 1, room).round().astype(np.intp)]
    else:
        even = _filled(study, asked, room)
    found = np.asarray(distinct(np.concatenate([even, beside])))
    turned = float(turned_between(study.setup, study.history, found).max(initial=0.0))
    if turned > tolerances.TORN:
        told.append(
            f"Between two frames a body turns up to {math.degrees(turned):.0f}°: only the frames show where it is."
        )
    return PageFrames(found, tuple(told))


def results_at(study: Study, times: Array) -> Results:
    """The results at the frames: where a frame was asked for they are those of the run to the last bit."""
    own = study.results
    if np.array_equal(times, own.time):
        return own
    found = study.resample(times)
    there = np.flatnonzero(np.isin(times, own.time))
    asked = np.searchsorted(own.time, times[there])
    blocks = {block: _with(getattr(found, block), getattr(own, block), there, asked) for block in REPORT_OF}
    return replace(found, **blocks)


def _with(block: Any, own: Any, there: Indices, asked: Indices) -> Any:
    """A block of results with some of the instants of another, of which it has more or fewer.

    So an array whose length differs runs over the instants, and all others do not.
    """
    if isinstance(block, dict):
        return {key: _with(value, own[key], there, asked) if key in own else value for key, value in block.items()}
    if not isinstance(block, np.ndarray) or len(block) == len(own):
        return block
    made = block.copy()
    made[there] = own[asked]
    return made


def _filled(study: Study, asked: Array, limit: int) -> Array:
    """The asked instants, and so many between each two of them that the motion can be followed."""
    wanted = turned_between(study.setup, study.history, asked) / TURNED
    if len(asked) < LEAST:
        wanted = np.maximum(wanted, np.diff(asked) / (asked[-1] - asked[0]) * LEAST)
    parts = _parts(wanted, limit - 1)
    first = np.repeat(np.arange(len(parts)), parts)
    share = (np.arange(len(first)) - np.repeat(np.cumsum(parts) - parts, parts)) / parts[first]
    return np.append(asked[first] + share * np.diff(asked)[first], asked[-1])


def _parts(wanted: Array, most: int) -> Indices:
    """Whole numbers (n,) from 1 on, not below those wanted as far as all together are at most so many."""
    more = np.maximum(np.ceil(wanted) - 1.0, 0.0)
    spare = most - len(wanted)
    if more.sum() > spare:
        more = np.floor(more * (spare / more.sum()))
    return np.asarray(1 + more.astype(np.intp))


def _beside(study: Study, peaks: Array, asked: Array, most: int) -> tuple[Array, int]:
    """Instants beside those asked for, at most so many: both sides of blows, then of jumps, then peaks.

    Of each kind all or none; and how many peaks found no room.
    """
    blows = [float(blow["time"]) for blow in study.results.impulses]
    jumps = study.history.jumps if len(study.history.jumps) <= MOST_JUMPS else []
    found: Array = np.zeros(0)
    missed = 0
    for kind in (_sides(blows, asked), _sides(jumps, asked), summits := _apart(peaks, asked)):
        more = np.asarray(distinct(np.concatenate([found, kind])))
        missed = len(summits) if kind is summits and len(more) > most else 0
        found = more if len(more) <= most else found
    return found, missed


def _sides(instants: Sequence[float] | Array, asked: Array) -> Array:
    """The last instants before some and the first after them, within those asked for."""
    inside = distinct(np.array([t for t in instants if asked[0] < t <= asked[-1]], dtype=np.float64))
    return np.concatenate(limits_of(inside)) if len(inside) else inside


def _apart(peaks: Array, asked: Array) -> Array:
    """Peaks that are none of the asked instants, and do not stand beside one that shows the same."""
    inside = peaks[(peaks > asked[0]) & (peaks < asked[-1])]
    after = np.searchsorted(asked, inside)
    near = np.minimum(inside - asked[after - 1], asked[after] - inside)
    return np.asarray(inside[near > SAME * (asked[after] - asked[after - 1])])


def _bytes_of_a_frame(study: Study) -> int:
    """How much the numbers of one instant take, nearly."""
    results = study.results
    count = sum(_numbers(getattr(results, block)) for block in REPORT_OF if block not in ("bodies", "points"))
    return 8 * count // len(results.time) + 28 * len(results.bodies) + 1


def _numbers(block: object) -> int:
    """How many numbers stand in a block."""
    if isinstance(block, dict):
        return sum(_numbers(member) for member in block.values())
    return int(block.size) if isinstance(block, np.ndarray) else 0
