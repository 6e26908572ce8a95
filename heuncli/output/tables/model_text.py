"""The model of a scene as an engineer would note it down."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from heuncli.base.foreign_text import shown
from heuncli.output.tables.plurals import count

WIDTH = 110
MOST_NAMES = 12
# Key of the model -> title of its list of sentences.
LISTS = (
    ("reasons", "Why this model"),
    ("reduced", "Left out, or made smaller"),
    ("not_reduced", "Not made smaller"),
    ("cannot_tell", "What this model cannot tell"),
    ("integrates", "What is integrated"),
    ("chosen", "Start values chosen for you"),
    ("moved", "Moved from the drawing"),
    ("started", "How it starts to move"),
    ("notes", "Worth knowing"),
)


def note(title: str, model: Mapping[str, Any]) -> str:
    """The model block as text."""
    lines = [shown(title) or "untitled", ""]
    counted = [(key, text) for key, text in facts(model) if text]
    width = max(len(key) for key, _ in counted)
    lines += [f"  {key.ljust(width)}  {text}" for key, text in counted]
    for key, heading in LISTS:
        sentences: Sequence[str] = model.get(key) or ()
        if sentences:
            lines += ["", heading]
            for sentence in sentences:
                lines += textwrap.wrap(shown(str(sentence)), WIDTH, initial_indent="  - ", subsequent_indent="    ")
    return "\n".join(lines) + "\n"


def facts(model: Mapping[str, Any]) -> list[tuple[str, str]]:
    """What is counted, and by which method, label and text; the text is empty where there is none."""
    freedoms, names = model.get("freedoms"), model.get("names", {})
    grubler = model.get("grubler")
    spins = int(model.get("undetermined", 0))
    among = f", {count(spins, 'undetermined spin')} among them" if spins else ""
    beside = f" (Grübler's count: {grubler}{among})" if grubler is not None else ""
    return [
        ("space", str(model.get("space", "")) + (f" ({model['plane']})" if "plane" in model else "")),
        ("bodies", _things(names.get("bodies", model.get("bodies")))),
        ("joints", _things(names.get("joints", model.get("joints")))),
        ("freedoms", f"{freedoms}{beside}" if freedoms is not None else ""),
        ("loops", _loops(model)),
        ("redundant", _redundant(model.get("redundant"))),
        ("method", str(model.get("method") or "")),
    ]


def _things(what: Any) -> str:
    """A count, or names with their count: `2: upper, lower`; a mapping's values say of what kind each is."""
    if isinstance(what, Mapping):
        names = [f"{name} ({kind})" if isinstance(kind, str) else str(name) for name, kind in what.items()]
    elif isinstance(what, (list, tuple)):
        names = [str(name) for name in what]
    else:
        return "" if what is None else str(what)
    rest = f", ... ({len(names) - MOST_NAMES} more)" if len(names) > MOST_NAMES else ""
    return f"{len(names)}: {', '.join(names[:MOST_NAMES])}{rest}" if names else "none"


def _loops(model: Mapping[str, Any]) -> str:
    """What is closed by joints, and how many couplings tie bodies beside them."""
    loops, coupled = model.get("loops"), int(model.get("couplings", 0))
    if not isinstance(loops, int):
        return ""
    closed = count(loops, "closed loop")
    return f"{closed} of joints; {count(coupled, 'coupling')} beside them" if coupled else closed


def _redundant(what: Any) -> str:
    if isinstance(what, int):
        return count(what, "redundant row") if what else "none"
    return _things(what) if what else ""
