"""What a run solved, in words: the lines above every table, the model as `heun model` has it, warnings and hints."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.output.documents.document import Facts, Listing, OutputTable, Part
from heuncli.output.tables.nouns import format_count
from heuncli.results.results import Array, ErrorEstimate, Results
from heuncli.scene.file_format.models import Spec
from heuncli.study.compose.recovery import Recovery
from heuncli.study.quantities.digits import LOADS, OPEN_NOTE, format_error
from heuncli.study.queries.study import Study

MAX_SENTENCES = 5
MAX_MOVED_BODIES = 3
PLANAR_NOTE = "; out-of-plane components are 0"
STIFF_PREFIXES = ("stiff: ", "stiff system: ")  # beginnings of the reason for a restart with an implicit method
NO_METHOD = "none"  # how the name of a method begins that integrates nothing
PRESCRIBED = "motion fully prescribed: solved at each instant, nothing integrated"
MAX_NAMES = 12
PLANE = {"found": "detected", "declared": "declared"}  # how a model came to be planar -> its text
# Key of the model -> title of its list of sentences.
LIST_TITLES = (
    ("reasons", "Why this model"),
    ("reduced", "Simplifications"),
    ("not_reduced", "Not simplified"),
    ("cannot_tell", "Not covered by this model"),
    ("integrates", "Integrated variables"),
    ("chosen", "Initial values chosen by heun"),
    ("moved", "Moved from the given start position"),
    ("started", "Start of the motion"),
    ("members", "Cross-sections of members"),
    ("notes", "Notes"),
)


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
        *_label_first_sentences("start", results.model.get("started", ()), ": see heun model"),
        *([] if brief else [("run", _describe_run(results))]),
        *_describe_stiff_restart(results.model.get("reasons", ())),
        *_label_sentences("rest", results.model.get("rest", ())),
        *(("until", sentence) for sentence in results.model.get("until", ())),
        ("accuracy", _describe_errors(results)),
        *([] if brief else [("", _describe_residuals(results))]),
        *_label_first_sentences("contacts", results.model.get("contacts", ()), " in --format json, model.contacts"),
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


def _label_first_sentences(label: str, sentences: Sequence[str], source: str) -> list[tuple[str, str]]:
    """Return a line for each of the first MAX_SENTENCES sentences, then their further number and where these are."""
    shown_sentences = list(sentences[:MAX_SENTENCES])
    if len(sentences) > MAX_SENTENCES:
        shown_sentences.append(f"{len(sentences) - MAX_SENTENCES} more{source}")
    return _label_sentences(label, shown_sentences)


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


def make_description_parts(model: Mapping[str, Any], label_indent: str = "") -> list[Part]:
    """Make the facts of the model block, and its lists of sentences."""
    facts = Facts([(label_indent + label, text) for label, text in collect_facts(model) if text])
    lists = [Listing(title, list(map(str, model[key]))) for key, title in LIST_TITLES if model.get(key)]
    return [facts, *lists]


def collect_facts(model: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and text of each count, and of the method; the text is empty if there is none."""
    freedoms, names = model.get("freedoms"), model.get("names", {})
    grubler = model.get("grubler")
    spins = int(model.get("undetermined", 0))
    among = f", including {format_count(spins, 'undetermined spin')}" if spins else ""
    grubler_text = f" (Grübler's count: {grubler}{among})" if grubler is not None else ""
    return [
        ("space", str(model.get("space", "")) + (f" ({PLANE[model['plane']]})" if "plane" in model else "")),
        ("bodies", _format_names(names.get("bodies", model.get("bodies")))),
        ("joints", _format_names(names.get("joints", model.get("joints")))),
        ("DOF", f"{freedoms}{grubler_text}" if freedoms is not None else ""),
        ("loops", _format_loops(model)),
        ("redundant", _format_redundant(model.get("redundant"))),
        ("method", str(model.get("method") or "")),
    ]


def _format_names(counts: Any) -> str:
    """Format a count, or names with their count: `2: upper, lower`; the values of a mapping are the kinds of its
    names.
    """
    if isinstance(counts, Mapping):
        names = [f"{name} ({kind})" if isinstance(kind, str) else str(name) for name, kind in counts.items()]
    elif isinstance(counts, (list, tuple)):
        names = [str(name) for name in counts]
    else:
        return "" if counts is None else str(counts)
    hidden_text = f", ... ({len(names) - MAX_NAMES} more)" if len(names) > MAX_NAMES else ""
    return f"{len(names)}: {', '.join(names[:MAX_NAMES])}{hidden_text}" if names else "none"


def _format_loops(model: Mapping[str, Any]) -> str:
    """Format the number of loops closed by joints, and of couplings between bodies in addition."""
    loops, coupled = model.get("loops"), int(model.get("couplings", 0))
    if not isinstance(loops, int):
        return ""
    closed = format_count(loops, "closed loop")
    return f"{closed} of joints; {format_count(coupled, 'coupling')}" if coupled else closed


def _format_redundant(redundant: Any) -> str:
    if isinstance(redundant, int):
        return format_count(redundant, "redundant constraint") if redundant else "none"
    return _format_names(redundant) if redundant else ""


def collect_warnings(spec: Spec, results: Results | None, later: Iterable[str]) -> tuple[list[str], list[str]]:
    """Return the warnings of reading, with their places, and those of solving and later ones that are not among
    them.
    """
    reading_messages = {problem.message for problem in spec.warnings}
    solving_warnings = [text for text in results.warnings if text not in reading_messages] if results else []
    return [str(problem) for problem in spec.warnings], solving_warnings + list(later)


PINS_NOTE = (
    "pins in a spatial model constrain more than the motion requires: try `space: planar`, or `line` or `ball` in "
    "place of some pins; heun model lists what helps, heun explain open says why"
)
JOINTS_HEADING = "JOINTS"  # as tables of joints begin


def add_pins_note(tables: Sequence[OutputTable], study: Study) -> list[OutputTable]:
    """Add the hint to the tables of joints with open reactions, if parallel pins are the reason."""
    places = [n for n, each in enumerate(tables) if each.heading.startswith(JOINTS_HEADING) and OPEN_NOTE in each.notes]
    if not places or not has_open_parallel_pins(study):
        return list(tables)
    last = places[-1]
    return [
        table._replace(notes=(*table.notes, PINS_NOTE)) if number == last else table
        for number, table in enumerate(tables)
    ]


def has_open_parallel_pins(study: Study) -> bool:
    """Whether several pins of a spatial model have open reactions, the axes of all these are parallel, and something
    is open that a planar model does not have: gears leave open what is in the plane, which no other joints change.
    """
    names = {name for name, block in study.results.joints.items() if block["open"]}
    if len(names) < 2 or study.results.model.get("space") != "spatial":
        return False
    recovery = study.find_recovery(study.results.time[:1], frozenset({"joints"}))
    axes = [
        load.axis[0]
        for load in recovery.requested_joints
        if load.joint.name in names and load.joint.kind == "pin" and load.axis is not None
    ]
    if len(axes) < 2:
        return False
    sines = np.linalg.norm(np.cross(axes[0], np.array(axes[1:])), axis=1)
    return bool((sines < tolerances.PARALLEL).all()) and is_open_across_plane(recovery, axes[0])


def is_open_across_plane(recovery: Recovery, normal: Array) -> bool:
    """Whether a joint's force along a normal (3,), or its moment about an axis in the plane, is open."""
    stress = recovery.indeterminate
    if stress is None:
        return False
    forces, moments = stress.shares[:, :, :3], stress.shares[:, :, 3:]
    along = np.einsum("i,jtik->jtk", normal, forces)[:, :, None]
    tilting = moments - normal[:, None] * np.einsum("i,jtik->jtk", normal, moments)[:, :, None]
    return bool(stress.has_share(along).any() or stress.has_share(tilting, stress.length).any())
