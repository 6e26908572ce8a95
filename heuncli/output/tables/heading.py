"""What was solved, and its estimated errors: the lines above every table."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.tables.markdown_text import escape_line
from heuncli.output.tables.plurals import count
from heuncli.output.tables.text_table import labelled
from heuncli.results.results import Estimate, Results
from heuncli.study.quantities.digits import LOADS, rough

MOST_TOLD = 5
MOST_MOVED = 3
PLANAR = "; what points out of the xy plane does not exist and reads 0"
STIFF = "stiff: "  # how the reason begins for which a run was begun anew by an implicit method


def heading(results: Results, every: bool = False) -> list[tuple[str, str]]:
    """Label and text of each line; every: what was made smaller, too, which `heun model` tells."""
    lines = [
        ("heun", f"{results.version}  {results.title}"),
        ("model", _model(results)),
        *(_labelled("reduced", results.model.get("reduced", ())) if every else ()),
        *(("unseen", sentence) for sentence in results.model.get("cannot_tell", ())),
        *_moved(results.model.get("moved", ())),
        *_started(results.model.get("started", ())),
        ("run", _run(results)),
        *_anew(results.model.get("reasons", ())),
        *_labelled("rest", results.model.get("rest", ())),
        *(("until", sentence) for sentence in results.model.get("until", ())),
        ("accuracy", _errors(results)),
        ("", _residuals(results)),
        *_contacts(results.model.get("contacts", ())),
        *(("moves", sentence) for sentence in results.model.get("moves", ())),
    ]
    if results.model.get("split"):
        lines.append(("split", f"{results.model['split']}; other splits do as well"))
    if (horizon := results.horizon) is not None:
        lines.append(
            ("horizon", f"from t = {horizon:.4g} s on nothing is claimed: the error may pass 1e-3 (? in tables)")
        )
    if results.status.get("code", "completed") != "completed":
        lines.append(("status", f"{results.status['code']}: {results.status.get('message', '')}"))
    said = results.status.get("message", "")
    lines += [("warning", warning) for warning in results.warnings if not said or said not in warning]
    return [line for line in lines if line[1]]


def write_heading(results: Results, every: bool = False) -> str:
    """The heading as aligned text."""
    return labelled(heading(results, every))


def write_heading_markdown(results: Results, every: bool = False) -> str:
    """The heading as markdown."""
    lines = heading(results, every)
    body = "".join(f"- {escape_line(label + ': ' * bool(label) + text)}\n" for label, text in lines[1:])
    return f"## {escape_line(results.title)}\n\n- heun: {results.version}\n{body}\n"


def _labelled(label: str, sentences: Sequence[str]) -> list[tuple[str, str]]:
    """A line for each sentence: the label stands before the first."""
    return [(label * (not i), sentence) for i, sentence in enumerate(sentences)]


def _moved(ways: Sequence[str]) -> list[tuple[str, str]]:
    """Which bodies had to leave their place in the drawing, those that moved most first."""
    named = ", ".join(ways[:MOST_MOVED])
    more = f" and {len(ways) - MOST_MOVED} more" if len(ways) > MOST_MOVED else ""
    return [("moved", f"to close the joints: {named}{more}; heun model lists it")] if ways else []


def _started(sentences: Sequence[str]) -> list[tuple[str, str]]:
    """What starts to move, or rests, otherwise than one may expect."""
    told = list(sentences[:MOST_TOLD])
    if len(sentences) > MOST_TOLD:
        told.append(f"{len(sentences) - MOST_TOLD} more: heun model lists them")
    return _labelled("start", told)


def _contacts(sentences: Sequence[str]) -> list[tuple[str, str]]:
    """What is told of contacts, the first of it."""
    told = list(sentences[:MOST_TOLD])
    if len(sentences) > MOST_TOLD:
        told.append(f"{len(sentences) - MOST_TOLD} more in --format json, model.contacts")
    return _labelled("contacts", told)


def _anew(reasons: Sequence[str]) -> list[tuple[str, str]]:
    """Why the run was begun anew by an implicit method, if it was: stiffness nobody meant may be a slip in the spec.

    That a method of fewer stages took over, where events end most steps, points to no slip: `heun model` tells it.
    """
    return [("stiff", text.removeprefix(STIFF)) for text in reasons if text.startswith(STIFF)]


def _model(results: Results) -> str:
    model = results.model
    parts = [str(model.get("space", "spatial"))]
    things = (("bodies", "body"), ("freedoms", "freedom"), ("loops", "loop"), ("redundant", "redundant row"))
    parts += [
        count(int(model[key]), what)
        for key, what in things
        if isinstance(model.get(key), int) and (model[key] or key in ("bodies", "freedoms"))
    ]
    if model.get("given_way"):
        parts[-1] += f", of which {int(model['given_way'])} give way"
    if model.get("driven"):
        parts[2] += f" beside {int(model['driven'])} driven"
    return ", ".join(parts) + (PLANAR if model.get("plane") == "declared" else "")


def _run(results: Results) -> str:
    times = results.time
    work = results.work
    kernel = f"{work.get('kernel', 'pure')} kernel" if work else ""
    if len(times) == 1:
        parts = [f"one instant, t = {times[0]:.6g} s"]
    else:
        parts = [f"{times[0]:.6g} to {times[-1]:.6g} s, {len(times)} samples"]
    if work.get("steps"):
        method = f"{results.model['method']}, " if results.model.get("method") else ""
        if results.model.get("step"):
            method = f"{results.model['method']} in steps of {results.model['step']:.4g} s, "
        parts.append(f"{method}{count(int(work['steps']), 'step')}, {count(int(work['evaluations']), 'evaluation')}")
    elif len(times) == 1:
        parts.append("nothing integrated")
    return "; ".join(part for part in (*parts, kernel) if part)


def _errors(results: Results) -> str:
    estimate, parts = results.accuracy.get("estimate", Estimate()), []
    loads = max(estimate.get(kind) or 0.0 for kind in LOADS)
    if "rest" in results.model:
        parts = _sentence("pose within {} of the scene's size", estimate.get("motion"))
    elif results.work.get("steps"):
        parts = _sentence("motion within {} of the scene's size", estimate.get("motion"))
    elif loads <= tolerances.WRITTEN:
        return "exact but for rounding"
    parts += _sentence("loads within {} of the largest", loads or None)
    return ", ".join(parts) if parts else "not estimated"


def _residuals(results: Results) -> str:
    accuracy = results.accuracy
    moves = results.work.get("steps") and "rest" not in results.model
    parts = _sentence("energy kept to {}", accuracy.get("energy_drift")) if moves else []
    parts += _sentence("joints closed to {} m", accuracy.get("constraint_gap") or None)
    parts += _sentence("forces balance to {}", accuracy.get("balance_residual"))
    return ", ".join(parts)


def _sentence(text: str, value: float | None) -> list[str]:
    known = value is not None and math.isfinite(value)
    return [text.format(rough(float(np.float64(value))))] if known and value is not None else []
