"""The first page: of what the report is, and at a glance what it says. What keeps it from being true stands here."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence

import numpy as np

from heuncli.base.method_rows import row_of
from heuncli.output.client_report.extremes import GreatestOfCases, lacking, spread_of
from heuncli.output.client_report.load_groups import joining_forces
from heuncli.output.client_report.parts import Facts, Mood, Part, Sentence, some
from heuncli.output.client_report.reported import Reported
from heuncli.output.tables.extremes_tables import MARK
from heuncli.output.tables.impulse_tables import sizes_of
from heuncli.output.tables.plurals import count
from heuncli.version import VERSION


def first_page(of: Reported) -> list[Part]:
    """What stands below the title."""
    return [Facts(list(_identity(of))), *summary(of)]


def _identity(of: Reported) -> Iterator[tuple[str, str]]:
    """Whose report, of which files, by which program."""
    for label, text in zip(("project", "author", "date"), (of.imprint.project, of.imprint.author, of.imprint.date),
                           strict=True):  # fmt: skip
        if text:
            yield label, text
    yield "spec", of.spec.path
    yield "SHA-256", of.spec.sha256
    for name, digest in of.digests.items():
        yield f"file {name}", f"SHA-256 {digest}"
    if of.has_cases:
        yield "load cases", ", ".join(_told(run.name, run.title) for run in of.runs)
    if of.left_out:
        yield "not reported", f"the load cases {', '.join(of.left_out)}"
    for text in of.given:
        yield "given", text
    yield "solved by", _versions(of)


def _told(name: str, title: str) -> str:
    return f"{name} ({title})" if title and title != name else name


def _versions(of: Reported) -> str:
    """What computed it."""
    kernels = dict.fromkeys(str(run.results.work.get("kernel", "")) for run in of.runs)
    parts = [f"heun {VERSION}", *(f"{kernel} kernel" for kernel in kernels if kernel), f"NumPy {np.__version__}"]
    rows = [row_of(str(run.results.model.get("method", ""))) for run in of.runs]
    if any(row is not None and row.kind == "SciPy" for row in rows):
        parts.append(f"SciPy {sys.modules['scipy'].__version__}")
    return ", ".join(parts)


def summary(of: Reported) -> list[Part]:
    """What is to be known before anything else: what failed, what is open, what governs."""
    return [*_ended(of), *_checked(of), *_used(of), *_largest(of), *_struck(of), *_open(of), *_warned(of)]


def _ended(of: Reported) -> Iterator[Sentence]:
    """Whether every run went to its end, and how far it is claimed."""
    for run in of.runs:
        case = f"Case {run.name}: " if run.name else ""
        status = run.results.status
        if status.get("code", "completed") != "completed":
            yield Sentence(f"{case}the run {status['code']}: {status.get('message', '')}", "bad")
        if (horizon := run.results.horizon) is not None:
            text = f"{case}from t = {horizon:.4g} s on nothing is claimed: the error may pass 1e-3 there"
            yield Sentence(f"{text}. All extremes are those before.", "unsure")
        if not run.searched:
            instants = count(len(run.page.results.time), "instant")
            yield Sentence(f"{case}extremes are those of {instants} alone; between them loads may be larger.", "unsure")


def _checked(of: Reported) -> Iterator[Sentence]:
    """How many expectations hold."""
    failed = [outcome for outcome in of.outcomes if not outcome.passed]
    if failed:
        names = some([outcome.name for outcome in failed])
        total = len(of.outcomes)
        text = f"{len(failed)} of {count(total, 'check')} of the spec FAIL: {names}."
        yield Sentence(text + _unchecked(of), "bad")
    elif of.outcomes:
        text = "all of them hold" if len(of.outcomes) > 1 else "it holds"
        mood: Mood = "unsure" if of.unchecked else "good"
        yield Sentence(f"{count(len(of.outcomes), 'check')} of the spec: {text}.{_unchecked(of)}", mood)
    elif of.unchecked:
        yield Sentence(f"No result was checked.{_unchecked(of)}", "unsure")
    else:
        yield Sentence("The spec expects nothing: no result was checked against a known number.", "unsure")


def _unchecked(of: Reported) -> str:
    """Of which scenes what the spec expects was not looked at."""
    return f" Not checked, as it was not asked for: {some(of.unchecked)}." if of.unchecked else ""


def _used(of: Reported) -> Iterator[Sentence]:
    """The section that is used most, and those beyond their strength."""
    paths = {f"sections.{name}.stress.utilisation": name for name in of.runs[0].results.sections}
    known = _known(of, list(paths))
    found = [spread for path, name in paths.items() if (spread := spread_of(of, path, name)) is not None]
    if not found:
        if known:
            yield Sentence("No utilisation of strength is known: what loads the sections is open.", "unsure")
        return
    beyond = [spread.name for spread in found if spread.high.value > 1.0]
    near = [spread.name for spread in found if spread.high.value <= 1.0 < spread.high.value + spread.error]
    most = max(found, key=_greatest)
    text = f"Largest utilisation of strength{known}: {most.high_text()} in section {most.name}{most.where}."
    text += f" Beyond strength: {some(beyond)}." if beyond else ""
    text += f" Beyond it, if the stated error is added: {some(near)}." if near else ""
    certain = not (known or near) and all(run.searched for run in of.runs)
    yield Sentence(text, "bad" if beyond else "good" if certain else "unsure")


def _known(of: Reported, paths: Sequence[str]) -> str:
    """What is said beside the largest of some numbers, where one of them is open or not known and might be larger."""
    return " that is known" if any(lacking(of, path) for path in paths) else ""


def _greatest(spread: GreatestOfCases) -> float:
    return spread.high.value


def _largest(of: Reported) -> Iterator[Sentence]:
    """The largest load of a joint, that of all that joins bodies where it is larger, and on the foundation."""
    whole = spread_of(of, "foundation.force", "the foundation")
    paths = dict(joining_forces(of))
    joints = [path for path in paths if path.startswith("joints.") and path.endswith(".force")]
    told: GreatestOfCases | None = None
    for what, some_paths in (("joint force", joints), ("force between bodies", list(paths))):
        found = [spread for path in some_paths if (spread := spread_of(of, path, paths[path], signed=True)) is not None]
        most = max(found, key=_greatest, default=None)
        if most is not None and (told is None or most.high.value > told.high.value + told.error):
            told, known = most, _known(of, some_paths)
            yield Sentence(f"Largest {what}{known}: {most.high_text()} in {most.name}{most.where}.")
            yield from _near_rest(of, most)
    if whole is not None:
        known = _known(of, ["foundation.force"])
        yield Sentence(f"Largest force on the foundation{known}: {whole.high_text()}{whole.where}.")


def _near_rest(of: Reported, most: GreatestOfCases) -> Iterator[Sentence]:
    """That a number stands where smoothed friction is not at its value."""
    run = next((run for run in of.runs if run.name == most.high.case), None)
    if run is not None and most.at and most.high.at in run.doubted.instants:
        yield Sentence(f"There, {run.doubted.note.removeprefix(f'{MARK} ')}.", "unsure")


def _struck(of: Reported) -> Iterator[Sentence]:
    """The blows before the horizon, and their largest impulse."""
    for run in of.runs:
        horizon = run.results.horizon
        blows = [blow for blow in run.results.impulses if horizon is None or float(blow["time"]) < horizon]
        if not blows:
            continue
        unit, size = of.units.of("N·s")
        most = size * max(sizes_of(blow, of.labels)[0] for blow in blows)
        text = f"{count(len(blows), 'blow')}; the largest impulse of a joint, on the ground or of all bodies together:"
        yield Sentence(f"{f'Case {run.name}: ' if run.name else ''}{text} {most:.6g} {unit}.")


def _open(of: Reported) -> Iterator[Sentence]:
    """What the laws of rigid bodies leave open."""
    paths = list(dict.fromkeys(path for run in of.runs for path in run.kept.open))
    if paths:
        text = f"{count(len(paths), 'component')} of loads are open: the supports are redundant, and rigid bodies do"
        yield Sentence(f"{text} not say how they share ({some(paths)}).", "unsure")
    chosen = dict.fromkeys(run.results.model["split"] for run in of.runs if run.results.model.get("split"))
    for words in chosen:
        yield Sentence(f"What redundant supports leave open was split: {words}; other splits do as well.", "unsure")


def _warned(of: Reported) -> Iterator[Sentence]:
    """Every warning, with its case."""
    for problem in of.spec.warnings:
        yield Sentence(f"Warning: {problem.message}", "unsure")
    read = {problem.message for problem in of.spec.warnings}
    told: dict[str, list[str]] = {}
    for run in of.runs:
        for text in (*run.results.warnings, *run.study.later_warnings):
            if text not in read:
                told.setdefault(text, []).append(run.name)
    for text, names in told.items():
        case = f" (case {some(names)})" if any(names) else ""
        yield Sentence(f"Warning: {text}{case}", "unsure")
