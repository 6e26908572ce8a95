"""The lines above every table: what was solved, and its estimated errors."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from heuncli.base import tolerances
from heuncli.output.tables.nouns import format_count
from heuncli.results.results import ErrorEstimate, Results
from heuncli.study.quantities.digits import LOADS, format_error

MAX_SENTENCES = 5
MAX_MOVED_BODIES = 3
PLANAR_NOTE = "; out-of-plane components are 0"
STIFF_PREFIXES = ("stiff: ", "stiff system: ")  # beginnings of the reason for a restart with an implicit method
NO_METHOD = "none"  # how the name of a method begins that integrates nothing
PRESCRIBED = "motion fully prescribed: solved at each instant, nothing integrated"


def make_heading(results: Results, show_reductions: bool = False, *, brief: bool = False) -> list[tuple[str, str]]:
    """Return the label and text of each line below the title.

    show_reductions: also list the simplifications, as `heun model` does
    brief: without the lines on method, effort and residuals
    """
    lines = [
        ("model", _describe_model(results) + (f"; {_describe_span(results)}" if brief else "")),
        *(_label_sentences("reduced", results.model.get("reduced", ())) if show_reductions else ()),
        *(("omitted", sentence) for sentence in results.model.get("cannot_tell", ())),
        *_describe_moved_bodies(results.model.get("moved", ())),
        *_describe_start(results.model.get("started", ())),
        *([] if brief else [("run", _describe_run(results))]),
        *_describe_stiff_restart(results.model.get("reasons", ())),
        *_label_sentences("rest", results.model.get("rest", ())),
        *(("until", sentence) for sentence in results.model.get("until", ())),
        ("accuracy", _describe_errors(results)),
        *([] if brief else [("", _describe_residuals(results))]),
        *_describe_contacts(results.model.get("contacts", ())),
        *(("moves", sentence) for sentence in results.model.get("moves", ())),
    ]
    if results.model.get("split"):
        lines.append(("split", f"{results.model['split']}; other distributions are equally possible"))
    if (horizon := results.horizon) is not None:
        lines.append(
            ("horizon", f"no results are claimed from t = {horizon:.4g} s on: the error may exceed 1e-3 (? in tables)")
        )
    if results.status.get("code", "completed") != "completed":
        lines.append(("status", f"{results.status['code']}: {results.status.get('message', '')}"))
    status_message = results.status.get("message", "")
    lines += [
        ("warning", warning) for warning in results.warnings if not status_message or status_message not in warning
    ]
    return [line for line in lines if line[1]]


def _label_sentences(label: str, sentences: Sequence[str]) -> list[tuple[str, str]]:
    """Return a line for each sentence, with the label before the first."""
    return [(label * (not i), sentence) for i, sentence in enumerate(sentences)]


def _describe_moved_bodies(displacements: Sequence[str]) -> list[tuple[str, str]]:
    """Return the line on bodies that had to leave their given start position, those that moved most first."""
    first_displacements = ", ".join(displacements[:MAX_MOVED_BODIES])
    more = f" and {len(displacements) - MAX_MOVED_BODIES} more" if len(displacements) > MAX_MOVED_BODIES else ""
    return [("moved", f"to assemble the joints: {first_displacements}{more}; see heun model")] if displacements else []


def _describe_start(sentences: Sequence[str]) -> list[tuple[str, str]]:
    """Return the lines on what starts to move, or rests, in an unexpected manner."""
    shown_sentences = list(sentences[:MAX_SENTENCES])
    if len(sentences) > MAX_SENTENCES:
        shown_sentences.append(f"{len(sentences) - MAX_SENTENCES} more: see heun model")
    return _label_sentences("start", shown_sentences)


def _describe_contacts(sentences: Sequence[str]) -> list[tuple[str, str]]:
    """Return the lines on contacts, at most MAX_SENTENCES of them."""
    shown_sentences = list(sentences[:MAX_SENTENCES])
    if len(sentences) > MAX_SENTENCES:
        shown_sentences.append(f"{len(sentences) - MAX_SENTENCES} more in --format json, model.contacts")
    return _label_sentences("contacts", shown_sentences)


def _describe_stiff_restart(reasons: Sequence[str]) -> list[tuple[str, str]]:
    """Return why the run was restarted with an implicit method: unintended stiffness may be a mistake in the spec.

    A restart with a method of fewer stages, where events end most steps, points to no mistake; only `heun model` tells
    it.
    """
    return [("stiff", text.partition(": ")[2]) for text in reasons if text.startswith(STIFF_PREFIXES)]


def _describe_model(results: Results) -> str:
    model = results.model
    parts = [str(model.get("space", "spatial"))]
    counted_keys = (
        ("bodies", "body"),
        ("freedoms", "degree of freedom"),
        ("loops", "loop"),
        ("redundant", "redundant constraint"),
    )
    parts += [
        format_count(int(model[key]), what)
        for key, what in counted_keys
        if isinstance(model.get(key), int) and (model[key] or key in ("bodies", "freedoms"))
    ]
    if model.get("given_way"):
        parts[-1] += f" ({int(model['given_way'])} released by zero stiffness)"
    if model.get("driven"):
        parts[2] += f", {int(model['driven'])} driven"
    return ", ".join(parts) + (PLANAR_NOTE if model.get("plane") == "declared" else "")


def _describe_span(results: Results) -> str:
    times = results.time
    return f"{times[0]:.6g} to {times[-1]:.6g} s" if len(times) > 1 else f"one instant, t = {times[0]:.6g} s"


def _describe_run(results: Results) -> str:
    times = results.time
    work = results.work
    kernel = f"{work.get('kernel', 'pure')} kernel" if work else ""
    parts = [_describe_span(results) + (f", {len(times)} samples" if len(times) > 1 else "")]
    if work.get("steps"):
        method = f"{results.model['method']}, " if results.model.get("method") else ""
        if results.model.get("step"):
            method = f"{results.model['method']} in steps of {results.model['step']:.4g} s, "
        counts = [format_count(int(work[key]), key.removesuffix("s")) for key in ("steps", "evaluations")]
        parts.append(PRESCRIBED if method.startswith(NO_METHOD) else f"{method}{', '.join(counts)}")
    elif len(times) == 1:
        parts.append("nothing integrated")
    return "; ".join(part for part in (*parts, kernel) if part)


def _describe_errors(results: Results) -> str:
    estimate, parts = results.accuracy.get("estimate", ErrorEstimate()), []
    loads = max(estimate.get(kind) or 0.0 for kind in LOADS)
    if "rest" in results.model:
        parts = _fill_number("position within {} of model size", estimate.get("motion"))
    elif results.work.get("steps"):
        parts = _fill_number("motion within {} of model size", estimate.get("motion"))
    elif loads <= tolerances.WRITTEN:
        return "rounding errors only"
    parts += _fill_number("loads within {} of the largest load", loads or None)
    return ", ".join(parts) if parts else "not estimated"


def _describe_residuals(results: Results) -> str:
    accuracy = results.accuracy
    moves = results.work.get("steps") and "rest" not in results.model
    parts = _fill_number("relative energy error {}", accuracy.get("energy_drift")) if moves else []
    parts += _fill_number("largest constraint error {} m", accuracy.get("constraint_gap") or None)
    parts += _fill_number("force balance error {}", accuracy.get("balance_residual"))
    return ", ".join(parts)


def _fill_number(text: str, value: float | None) -> list[str]:
    known = value is not None and math.isfinite(value)
    return [text.format(format_error(float(np.float64(value))))] if known and value is not None else []
