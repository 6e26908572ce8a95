"""Describe the model of a scene as an engineer would note it down."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from heuncli.output.documents.document import Facts, Listing, Part
from heuncli.output.tables.nouns import format_count

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
