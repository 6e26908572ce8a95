"""Assemble the load cases of one body of a solved scene: balanced, unique, within the horizon, or refused.

Study -> LoadCases        the requested instants say when, actions.py says what acts
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.analyses.load_cases.actions import collect_actions, compute_fields
from heuncli.analyses.load_cases.model import LoadCase, LoadCases, LoadedBody
from heuncli.base.errors import Problem, SolveError, UsageError
from heuncli.base.records import replace
from heuncli.multibody.mechanism.model import Mechanism
from heuncli.results.results import Array, Block, DeterminateSum
from heuncli.results.results_schema import IMPULSES
from heuncli.study.compose.blocks import make_blocks
from heuncli.study.compose.recovery import Recovery, find_determinate_sums
from heuncli.study.model.selection import Selection
from heuncli.study.queries.at_option import InstantRequest, LoadCaseInstant, find_load_case_instants
from heuncli.study.queries.study import Study

BALANCE_TOLERANCE = 1e-9  # of the largest: loads of one instant are solved together, and balance to rounding
MAX_SUMS = 4  # named in an error message
CHOOSE_HINT = "choose a split with --least-norm or joint stiffnesses"
PLANAR_HINT = "; the motion is planar: space: planar leaves out the out-of-plane components"
ALL_JOINTS = Selection(frozenset({"joints"}))
EXPLAIN_HINT = "heun explain open shows how to release what the real machine leaves free"


def select_results(body: str, joints: Iterable[str], with_impulses: bool) -> Selection:
    """Return what must be solved for the load cases of a body on which these joints act."""
    entries = frozenset(("joints", name) for name in joints) or frozenset({("bodies", body)})
    reports = frozenset(
        {"joints" if ("bodies", body) not in entries else "motion", *({IMPULSES} if with_impulses else ())}
    )
    return Selection(reports, entries)


def assemble_load_cases(study: Study, body: str, requested: Sequence[InstantRequest]) -> LoadCases:
    """Return the load cases of a body.

    Raises SolveError [open-load-case, unbalanced-load-case]; UsageError [bad-option] for a body that was not solved,
    and for instants that do not exist.
    """
    mechanism = study.setup.scene.mechanism
    index = next((i for i, other in enumerate(mechanism.bodies) if other.name == body), None)
    if index is None:
        message = f"{body}: left out, because no requested result depends on it"
        raise UsageError(Problem("bad-option", message, hint="solve the whole model: without only="))
    instants = find_load_case_instants(requested, study)
    cases = dict([*_iter_instant_cases(study, index, instants), *_iter_impulse_cases(study, index, instants)])
    mechanism_body, results = mechanism.bodies[index], study.results
    loaded_body = LoadedBody(
        mechanism_body.name,
        mechanism_body.mass,
        mechanism_body.center.copy(),
        mechanism_body.inertia.copy(),
        mechanism.planar,
    )  # copies
    for case in cases.values():
        require_balance(loaded_body, case)
    errors = results.accuracy.get("estimate", {})
    return LoadCases(
        body=loaded_body,
        cases=tuple(cases[instant] for instant in instants),
        title=results.title,
        spec=results.spec["path"] or "",
        digest=results.spec["sha256"],
        version=results.version,
        estimate=float(errors.get("reactions", 0.0)),
        split=str(results.model.get("split", "")),
    )


def _iter_instant_cases(
    study: Study, body: int, instants: Sequence[LoadCaseInstant]
) -> Iterator[tuple[LoadCaseInstant, LoadCase]]:
    """Yield the cases that are not impulses."""
    requested = [instant for instant in instants if instant.impulse is None]
    if not requested:
        return
    times = np.array(sorted({instant.time for instant in requested}))
    reports = ALL_JOINTS.reports
    recovery = study.recovery if study.has_one_instant else study.find_recovery(times, reports)
    recovery = _include_joints(body, recovery)
    joints = study.compose_reports(recovery, reports).joints
    require_unique(recovery, body, joints, recovery.solutions.times)
    actions, fields = collect_actions(recovery, study.spec, body), compute_fields(recovery, body)
    for instant in requested:
        k = 0 if study.has_one_instant else int(np.searchsorted(times, instant.time))
        yield instant, LoadCase(instant.name, instant.time, actions[k], fields[k])


def _iter_impulse_cases(
    study: Study, body: int, instants: Sequence[LoadCaseInstant]
) -> Iterator[tuple[LoadCaseInstant, LoadCase]]:
    """Yield the cases of impulses, solved as loads at rest, with jumps of velocities as accelerations."""
    requested = [instant for instant in instants if instant.impulse is not None]
    if not requested or study.impulse_results is None:
        return
    recovery = _include_joints(body, study.impulse_results.recovery)
    impulse_indices = np.array([instant.impulse for instant in requested])
    joints = {
        name: _select_rows(block, impulse_indices)
        for name, block in make_blocks(recovery, ALL_JOINTS.reports)["joints"].items()
    }
    require_unique(recovery, body, joints, np.array([instant.time for instant in requested]))
    actions, fields = collect_actions(recovery, study.spec, body), compute_fields(recovery, body)
    for instant in requested:
        k = instant.impulse
        assert k is not None
        yield instant, LoadCase(instant.name, instant.time, actions[k], fields[k], is_impulse=True)


def _include_joints(body: int, recovery: Recovery) -> Recovery:
    """Return a recovery that includes the joints on a body even if the run did not select them."""
    setup = recovery.setup
    if setup.selection.has_whole("joints") or setup.selection.names_in("joints").issuperset(
        list_joints(setup.scene.mechanism, body)
    ):
        return recovery
    return recovery.with_cuts(replace(setup, selection=ALL_JOINTS))


def _select_rows(block: Block, which: Array) -> Block:
    """Return the arrays of a block at some instants."""
    return {name: value[which] for name, value in block.items() if isinstance(value, np.ndarray)}


def list_joints(mechanism: Mechanism, body: int) -> list[str]:
    """Return the names of the joints on a body."""
    return [joint.name for joint in mechanism.joints if body in (joint.a, joint.b)]


def require_unique(recovery: Recovery, body: int, joints: Block, times: Array) -> None:
    """Raise SolveError [open-load-case] if a force on the body is indeterminate."""
    mechanism = recovery.setup.scene.mechanism
    names = list_joints(mechanism, body)
    indeterminate = [
        (f"joints.{name}.{quantity}{axis}", times[int(np.flatnonzero(is_open)[0])])
        for name in names
        for quantity in ("force", "moment", "drive")
        for axis, is_open in _iter_indeterminate(joints[name].get(quantity))
    ]
    if not indeterminate:
        return
    listed = ", ".join(name for name, _ in indeterminate[:6]) + (", ..." if len(indeterminate) > 6 else "")
    first_time = min(t for _, t in indeterminate)
    sums_text = "".join(
        f"; determinate: {text}" for text in _format_determinate_sums(find_determinate_sums(recovery), names)
    )
    message = f"open at t = {first_time:.6g} s: {listed}: a load case cannot contain open forces{sums_text}"
    planar = PLANAR_HINT if recovery.setup.model.get("space") == "planar" and not mechanism.planar else ""
    raise SolveError(Problem("open-load-case", message, hint=f"{CHOOSE_HINT}{planar}; {EXPLAIN_HINT}"))


def _iter_indeterminate(values: Array | None) -> Iterator[tuple[str, Array]]:
    """Yield the components of (n_t, 3) or (n_t,) that are indeterminate at some instant, and when."""
    if values is None or not np.isnan(values).any():
        return
    columns = [("", values)] if values.ndim == 1 else [(f".{axis}", values[:, i]) for i, axis in enumerate("xyz")]
    yield from ((axis, np.isnan(column)) for axis, column in columns if np.isnan(column).any())


def _format_determinate_sums(sums: Sequence[DeterminateSum], names: Sequence[str]) -> list[str]:
    """Return the determinate sums of these joints alone, as sentences."""
    prefixes = tuple(f"joints.{name}." for name in names)
    joint_sums = [one for one in sums if all(term.startswith(prefixes) for term in one["terms"])]
    return [_format_sum(one) for one in joint_sums[:MAX_SUMS]]


def _format_sum(determinate_sum: DeterminateSum) -> str:
    """Format a determinate sum as an equation."""
    terms = [
        f"{'-' if c < 0.0 else '+'} {'' if abs(c) == 1.0 else f'{abs(c):.6g} '}{name}"
        for name, c in ((name, float(np.ravel(factor)[0])) for name, factor in determinate_sum["terms"].items())
    ]
    return f"{' '.join(terms).removeprefix('+ ')} = {float(np.ravel(determinate_sum['value'])[0]):.6g}"


def require_balance(body: LoadedBody, case: LoadCase) -> None:
    """Raise SolveError [unbalanced-load-case] if the sums of a case exceed rounding: then one of its numbers is
    wrong.
    """
    relative_remainder = body.balance(case).relative
    if relative_remainder <= BALANCE_TOLERANCE:
        return
    message = (
        f"{case.name}: the forces or moments on {body.name} do not balance: residual "
        f"{relative_remainder:.2g} of the largest, "
        f"more than {BALANCE_TOLERANCE:g}"
    )
    hint = "rounding errors grow near a singular position: use an instant away from it; otherwise please report this"
    raise SolveError(Problem("unbalanced-load-case", message, hint=hint))
