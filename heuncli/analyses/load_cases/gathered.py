"""A solved scene -> the load cases of one of its bodies: balanced, unique, within the horizon, or refused.

Study -> LoadCases      asked.py tells when, actions.py what acts then
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.actions import actions_on, fields_of
from heuncli.analyses.load_cases.model import LoadCase, LoadCases, LoadedBody
from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block, CertainSum
from heuncli.results.results_schema import BLOWS
from heuncli.study.ask.asked_instants import AskedInstant, TakenInstant, taken
from heuncli.study.ask.study import Study
from heuncli.study.compose.blocks import blocks
from heuncli.study.compose.recovery import Recovery, certain_sums
from heuncli.study.model.selection import Selection

BALANCED = 1e-9  # of the largest: loads of one instant are answered together, and sum up to rounding
MOST_SUMS = 4  # that are named in a refusal
CHOOSE = "--least-norm or a stiffness of the joints chooses a split"
IN_PLANE = "; the scene moves in the plane: space: planar leaves out what is across it"
ALL_JOINTS = Selection(frozenset({"joints"}))
LOOSE = "heun explain open tells how to draw what the machine leaves loose"


def needed_for(body: str, joints: Iterable[str], blows: bool) -> Selection:
    """What has to be solved for the cases of a body, on which these joints act."""
    entries = frozenset(("joints", name) for name in joints) or frozenset({("bodies", body)})
    reports = frozenset({"joints" if ("bodies", body) not in entries else "motion", *({BLOWS} if blows else ())})
    return Selection(reports, entries)


def gathered(study: Study, body: str, asked: Sequence[AskedInstant]) -> LoadCases:
    """The load cases of a body.

    Raises SolveError for one that is open, or does not balance, UsageError of a body that was not solved for, and as
    `taken` does.
    """
    mechanism = study.setup.scene.mechanism
    index = next((i for i, one in enumerate(mechanism.bodies) if one.name == body), None)
    if index is None:
        message = f"{body}: nothing that this run was asked for depends on it, so it was left out"
        raise UsageError(Problem("bad-option", message, hint="solve the whole scene: without only="))
    instants = taken(asked, study)
    cases = dict([*_of_instants(study, index, instants), *_of_blows(study, index, instants)])
    own, results = mechanism.bodies[index], study.results
    loaded = LoadedBody(own.name, own.mass, own.center.copy(), own.inertia.copy(), mechanism.planar)  # the reader's own
    for case in cases.values():
        require_balance(loaded, case)
    errors = results.accuracy.get("estimate", {})
    return LoadCases(
        body=loaded,
        cases=tuple(cases[one] for one in instants),
        title=results.title,
        spec=results.spec["path"] or "",
        digest=results.spec["sha256"],
        version=results.version,
        estimate=float(errors.get("reactions", 0.0)),
        split=str(results.model.get("split", "")),
    )


def _of_instants(study: Study, body: int, instants: Sequence[TakenInstant]) -> Iterator[tuple[TakenInstant, LoadCase]]:
    """The cases that are no blows."""
    own = [one for one in instants if one.blow is None]
    if not own:
        return
    times = np.array(sorted({one.time for one in own}))
    reports = ALL_JOINTS.reports
    recovery = study.recovery if study.of_one_instant else study.recovery_at(times, reports)
    recovery = _telling_joints_on(body, recovery)
    joints = study.reports_of(recovery, reports).joints
    require_unique(recovery, body, joints, recovery.recovered.times)
    actions, fields = actions_on(recovery, study.spec, body), fields_of(recovery, body)
    for one in own:
        k = 0 if study.of_one_instant else int(np.searchsorted(times, one.time))
        yield one, LoadCase(one.name, one.time, actions[k], fields[k])


def _of_blows(study: Study, body: int, instants: Sequence[TakenInstant]) -> Iterator[tuple[TakenInstant, LoadCase]]:
    """The cases that are blows: answered as loads at rest, jumps of velocities as accelerations."""
    own = [one for one in instants if one.blow is not None]
    if not own or study.struck is None:
        return
    recovery = _telling_joints_on(body, study.struck.recovery)
    wanted = np.array([one.blow for one in own])
    joints = {name: _at(block, wanted) for name, block in blocks(recovery, ALL_JOINTS.reports)["joints"].items()}
    require_unique(recovery, body, joints, np.array([one.time for one in own]))
    actions, fields = actions_on(recovery, study.spec, body), fields_of(recovery, body)
    for one in own:
        assert one.blow is not None
        yield one, LoadCase(one.name, one.time, actions[one.blow], fields[one.blow], struck=True)


def _telling_joints_on(body: int, recovery: Recovery) -> Recovery:
    """The recovery, telling the joints on a body also where the run was asked for others, or for none."""
    setup = recovery.setup
    if setup.asked.whole("joints") or setup.asked.of("joints").issuperset(joints_on(setup.scene.mechanism, body)):
        return recovery
    return recovery.with_cuts(replace(setup, asked=ALL_JOINTS))


def _at(block: Block, which: Array) -> Block:
    return {name: value[which] for name, value in block.items() if isinstance(value, np.ndarray)}


def joints_on(mechanism: Mechanism, body: int) -> list[str]:
    """The names of the joints that act on a body."""
    return [joint.name for joint in mechanism.joints if body in (joint.a, joint.b)]


def require_unique(recovery: Recovery, body: int, joints: Block, times: Array) -> None:
    """Raise SolveError where a force on the body is open: what the laws leave open is no load."""
    mechanism = recovery.setup.scene.mechanism
    names = joints_on(mechanism, body)
    found = [
        (f"joints.{name}.{quantity}{axis}", times[int(np.flatnonzero(is_open)[0])])
        for name in names
        for quantity in ("force", "moment", "drive")
        for axis, is_open in _open_components(joints[name].get(quantity))
    ]
    if not found:
        return
    which = ", ".join(name for name, _ in found[:6]) + (", ..." if len(found) > 6 else "")
    at = min(t for _, t in found)
    certain = "".join(f"; certain is {told}" for told in _certain(certain_sums(recovery), names))
    message = f"open at t = {at:.6g} s: {which}: a load case of open forces is none{certain}"
    planar = IN_PLANE if recovery.setup.model.get("space") == "planar" and not mechanism.planar else ""
    raise SolveError(Problem("open-load-case", message, hint=f"{CHOOSE}{planar}; {LOOSE}"))


def _open_components(values: Array | None) -> Iterator[tuple[str, Array]]:
    """The components of (n_t, 3) or (n_t,) that are open at some instant, and when."""
    if values is None or not np.isnan(values).any():
        return
    columns = [("", values)] if values.ndim == 1 else [(f".{axis}", values[:, i]) for i, axis in enumerate("xyz")]
    yield from ((axis, np.isnan(column)) for axis, column in columns if np.isnan(column).any())


def _certain(sums: Sequence[CertainSum], names: Sequence[str]) -> list[str]:
    """The sums that are certain of these joints alone, as sentences."""
    begins = tuple(f"joints.{name}." for name in names)
    own = [one for one in sums if all(term.startswith(begins) for term in one["terms"])]
    return [_told(one) for one in own[:MOST_SUMS]]


def _told(one: CertainSum) -> str:
    terms = [
        f"{'-' if c < 0.0 else '+'} {'' if abs(c) == 1.0 else f'{abs(c):.6g} '}{name}"
        for name, c in ((name, float(np.ravel(factor)[0])) for name, factor in one["terms"].items())
    ]
    return f"{' '.join(terms).removeprefix('+ ')} = {float(np.ravel(one['value'])[0]):.6g}"


def require_balance(body: LoadedBody, case: LoadCase) -> None:
    """Raise SolveError where the sums of a case are no rounding: then a number of it is wrong."""
    worst = body.balance(case).relative
    if worst <= BALANCED:
        return
    message = (
        f"{case.name}: the forces or moments on {body.name} do not balance: they leave {worst:.2g} of the largest, "
        f"more than {BALANCED:g}"
    )
    hint = "near a singular pose rounding grows: take an instant beside it; else please report it"
    raise SolveError(Problem("unbalanced-load-case", message, hint=hint))
