"""The sentences of a probe's verdict: what is difficult for heun's default method, and for other methods."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.analyses.motion_diagnostics.results import (
    DEAD_CENTRE,
    GIMBAL,
    HALF_TURN,
    NO_MASS,
    SINGULAR,
    Event,
    Probe,
)
from heuncli.base import tolerances
from heuncli.base.spelling import format_count, list_some

MAX_LISTED_TIMES = 3  # instants that a sentence lists


def iter_troubles(result: Probe) -> Iterator[str]:
    """Yield what is difficult for heun's default method."""
    if result.status:
        yield result.status
    yield from iter_horizons(result)
    if result.implicit_method is None:
        yield from iter_stiffness(result)
    singular_events = [event for event in result.events if event.kind == SINGULAR]
    if singular_events:
        yield (
            f"singular positions: loop constraints lose rank at t = {format_instants(singular_events)} s; "
            "several motions are possible there"
        )
    closure = result.closure
    if closure is not None and closure.value * tolerances.NEARLY_SINGULAR > 1.0 and not singular_events:
        yield (
            f"nearly singular closed loops at t = {closure.time:.4g} s, condition number {closure.value:.1g}: "
            "reactions there lose accuracy by this factor"
        )
    out_of_plane = result.out_of_plane
    if out_of_plane is not None and out_of_plane.exponential and out_of_plane.rate > 0.0:
        yield (
            "unstable out of plane: an out-of-plane disturbance grows by a factor e every "
            f"{1.0 / out_of_plane.rate:.3g} s; heun solves the planar motion, which no "
            "real machine keeps for long"
        )


def iter_stiffness(result: Probe) -> Iterator[str]:
    """Yield a sentence if stability limits the steps of the explicit default."""
    stiffness = result.stiffness
    if stiffness is not None and stiffness.ratio > 1.0:
        alternative = (
            f"{result.implicit_method}, used in this run, has" if result.implicit_method else "an implicit method has"
        )
        yield (
            f"stiff: rates up to {max(stiffness.decay, stiffness.oscillation):.3g} 1/s limit DOP853 to steps of "
            f"{get_stable_step(result, 'DOP853'):.2g} s, {stiffness.ratio:.2g} times shorter "
            "than accuracy requires, "
            f"shortest at t = {stiffness.time:.4g} s; {alternative} no such limit"
        )


def iter_horizons(result: Probe) -> Iterator[str]:
    """Yield sentences on the horizon of the run, and of double precision."""
    growth = result.growth
    rate = ""
    if growth is not None and growth.rate > 0.0:
        rate = f": disturbances grow by a factor e every {1.0 / growth.rate:.3g} s"
    if growth is not None and growth.horizon is not None:
        yield f"chaos: no run in double precision is reliable past t = {growth.horizon:.4g} s{rate}"
    if result.run_horizon is not None:
        yield f"this run is not reliable past t = {result.run_horizon:.4g} s"


def iter_other_troubles(result: Probe) -> Iterator[str]:
    """Yield what is difficult for other methods, including explicit ones if the run uses an implicit one."""
    if result.implicit_method is not None:
        yield from iter_stiffness(result)
    by_kind = {kind: [e for e in result.events if e.kind == kind] for kind in (HALF_TURN, GIMBAL, DEAD_CENTRE, NO_MASS)}
    further_counts = {kind: sum(n for k, _, n in result.further_events if k == kind) for kind in by_kind}
    if turns := by_kind[HALF_TURN]:
        n = len(turns) + further_counts[HALF_TURN]
        yield (
            f"global Rodrigues parameters (DOP853-rodrigues) fail at {format_count(n, 'half revolution')}: "
            f"{format_bodies(turns)}"
        )
    if locks := by_kind[GIMBAL]:
        yield f"Euler angles at or near gimbal lock: {format_bodies(locks)}"
    if centres := by_kind[DEAD_CENTRE]:
        n = len(centres) + further_counts[DEAD_CENTRE]
        joints = list_some(list(dict.fromkeys(e.where.removeprefix("joints.") for e in centres)))
        yield (
            f"{format_count(n, 'dead centre')} of {joints}, which cannot drive the mechanism there; at t = "
            f"{format_instants(centres)} s"
        )
    if by_kind[NO_MASS] or (result.mass is not None and math.isinf(result.mass.value)):
        yield "the full mass matrix is singular: methods that factorise it fail; heun's recursion does not"
    if result.stiffness is not None and result.stiffness.ratio <= 1.0:
        yield from iter_limited_methods(result)


def iter_limited_methods(result: Probe) -> Iterator[str]:
    """Yield a sentence on explicit methods whose steps stability limits, though not the default's."""
    assert result.stiffness is not None
    names = [s.method for s in result.stiffness.steps if s.accuracy > s.stability]
    if names:
        yield f"stability, not accuracy, limits the steps of {list_some(names)}"


def get_stable_step(result: Probe, name: str) -> float:
    """Return the stable step of a method [s]."""
    assert result.stiffness is not None
    return next((s.stability for s in result.stiffness.steps if s.method == name), math.nan)


def format_bodies(events: list[Event]) -> str:
    """List bodies with their first instants."""
    first: dict[str, list[Event]] = {}
    for event in events:
        first.setdefault(event.where.removeprefix("bodies."), []).append(event)
    return "; ".join(f"{name} at t = {format_instants(body_events)} s" for name, body_events in first.items())


def format_instants(events: list[Event]) -> str:
    """List the first instants of events."""
    times = list(dict.fromkeys(f"{event.time:.6g}" for event in events))
    return ", ".join(times[:MAX_LISTED_TIMES]) + (" ..." if len(times) > MAX_LISTED_TIMES else "")
