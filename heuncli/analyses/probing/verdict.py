"""The verdict on a motion: what of it troubles heun's default method, worst first, and what troubles others."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.analyses.probing.results import DEAD_CENTRE, GIMBAL, HALF_TURN, NO_MASS, SINGULAR, Event, Probe
from heuncli.base import tolerances
from heuncli.study.model.counts_and_lists import count, some

MOST_TIMES = 3  # that a sentence lists


def trouble(found: Probe) -> Iterator[str]:
    """What troubles heun's default method."""
    if found.status:
        yield found.status
    yield from horizons(found)
    if found.implicit is None:
        yield from stiff(found)
    passed = [event for event in found.events if event.kind == SINGULAR]
    if passed:
        yield f"singular poses: closed chains lose rank at t = {instants(passed)} s; how they go on there is a choice"
    closure = found.closure
    if closure is not None and closure.value * tolerances.NEARLY_SINGULAR > 1.0 and not passed:
        yield (
            f"nearly singular closed chains at t = {closure.time:.4g} s, condition {closure.value:.1g}: reactions "
            "there lose as many digits"
        )
    across = found.across
    if across is not None and across.exponential and across.rate > 0.0:
        yield (
            "unstable against leaving the plane: a disturbance out of it grows e times every "
            f"{1.0 / across.rate:.3g} s; what is solved is the motion in the plane, which no machine keeps to for long"
        )


def stiff(found: Probe) -> Iterator[str]:
    """That stability bounds the steps of the explicit default."""
    of = found.stiffness
    if of is not None and of.ratio > 1.0:
        free = f"{found.implicit}, by which this run goes, has" if found.implicit else "an implicit method has"
        yield (
            f"stiff: rates up to {max(of.decay, of.oscillation):.3g} 1/s allow DOP853 steps of "
            f"{step_of(found, 'DOP853'):.2g} s only, {of.ratio:.2g} times shorter than accuracy asks for, "
            f"shortest at t = {of.time:.4g} s; {free} no such bound"
        )


def horizons(found: Probe) -> Iterator[str]:
    """Sentences on the horizon of the run, and of double precision."""
    growth = found.growth
    rate = ""
    if growth is not None and growth.rate > 0.0:
        rate = f": disturbances grow e times every {1.0 / growth.rate:.3g} s"
    if growth is not None and growth.horizon is not None:
        yield f"chaos: no run in double precision can be relied on beyond t = {growth.horizon:.4g} s{rate}"
    if found.run_horizon is not None:
        yield f"beyond t = {found.run_horizon:.4g} s this run claims nothing"


def others(found: Probe) -> Iterator[str]:
    """What troubles other methods: explicit ones, too, where the run goes by an implicit one."""
    if found.implicit is not None:
        yield from stiff(found)
    by_kind = {kind: [e for e in found.events if e.kind == kind] for kind in (HALF_TURN, GIMBAL, DEAD_CENTRE, NO_MASS)}
    more = {kind: sum(n for k, _, n in found.more if k == kind) for kind in by_kind}
    if turns := by_kind[HALF_TURN]:
        n = len(turns) + more[HALF_TURN]
        yield f"global Rodrigues parameters (DOP853-rodrigues) fail at {count(n, 'half turn')}: {bodies(turns)}"
    if locks := by_kind[GIMBAL]:
        yield f"Euler angles lock or lose digits: {bodies(locks)}"
    if centres := by_kind[DEAD_CENTRE]:
        n = len(centres) + more[DEAD_CENTRE]
        joints = some(list(dict.fromkeys(e.where.removeprefix("joints.") for e in centres)))
        yield f"{count(n, 'dead centre')}: {joints} cannot drive the mechanism there; at t = {instants(centres)} s"
    if by_kind[NO_MASS] or (found.mass is not None and math.isinf(found.mass.value)):
        yield "a mass matrix of the whole is singular: what factors it fails; heun's sweep turns about what moves mass"
    if found.stiffness is not None and found.stiffness.ratio <= 1.0:
        yield from limited(found)


def limited(found: Probe) -> Iterator[str]:
    """Explicit methods whose steps stability bounds, though the default's are not."""
    assert found.stiffness is not None
    names = [s.method for s in found.stiffness.steps if s.accuracy > s.stability]
    if names:
        yield f"stability, not accuracy, bounds the steps of {some(names)}"


def step_of(found: Probe, name: str) -> float:
    """The stable step of a method [s]."""
    assert found.stiffness is not None
    return next((s.stability for s in found.stiffness.steps if s.method == name), math.nan)


def bodies(events: list[Event]) -> str:
    """Bodies with their first instants."""
    first: dict[str, list[Event]] = {}
    for event in events:
        first.setdefault(event.where.removeprefix("bodies."), []).append(event)
    return "; ".join(f"{name} at t = {instants(own)} s" for name, own in first.items())


def instants(events: list[Event]) -> str:
    """The first instants of some events."""
    times = list(dict.fromkeys(f"{event.time:.6g}" for event in events))
    return ", ".join(times[:MOST_TIMES]) + (" ..." if len(times) > MOST_TIMES else "")
