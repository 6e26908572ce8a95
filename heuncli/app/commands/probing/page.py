"""What a motion comes near to, as a page: the verdict, growth and stiffness, conditions, attitudes, instants."""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.analyses.probing.results import GrowthResults, Probe, StiffnessResults
from heuncli.output.tables.page_width import fit
from heuncli.output.tables.text_table import WIDTH, TextColumn, TextTable, labelled, plain
from heuncli.version import VERSION

MOST = 30  # events that a table lists; JSON has more
REST = "rest"  # as `model` names it instead of a method
GROWTH = "GROWTH  of a small disturbance, the largest of all directions that the joints leave free"
STEPS = "STEPS  of explicit methods: what stability allows where it allows least, what accuracy asks for, about"
STEPS_HERE = "STEPS  of explicit methods: what stability allows here"
CONDITION = "CONDITION  largest singular value over the smallest; shifts by the scene's size"
ATTITUDES = "ATTITUDES  bodies whose turns are all free: half turns, largest condition of the matrices of Euler angles"
EVENTS = "INSTANTS"
NAMES = {"mass": "mass matrix", "closure": "closures"}


def write(found: Probe) -> str:
    """The page as text."""
    parts = (part for table in tables(found) for part in fit(table, WIDTH))
    return labelled(list(lines(found))) + "".join("\n" + plain(part, WIDTH) for part in parts)


def lines(found: Probe) -> Iterator[tuple[str, str]]:
    """Label and text of the lines above the tables."""
    yield "heun", f"{VERSION}  {found.title}"
    yield "probe", f"{found.model['space']}, {how(found)}"
    yield "verdict", found.verdict
    yield from (("", text) for text in found.trouble[1:])
    yield from (("beside" if k == 0 else "", text) for k, text in enumerate(found.others))
    yield from (("unknown" if k == 0 else "", text) for k, text in enumerate(reasons(found)))


def how(found: Probe) -> str:
    """By what the motion was found, and how long it is."""
    none, colon, instead = str(found.model["method"]).partition(": ")
    if not found.duration:
        return "a rest pose" if none == REST else "one instant"
    return f"{instead if colon else f'by {none}'} over {found.duration:.6g} s"


def reasons(found: Probe) -> list[str]:
    """Why something is not told, each reason once."""
    by: dict[str, list[str]] = {}
    for key, text in found.reasons.items():
        by.setdefault(text, []).append(key.replace("_", " "))
    return [f"{', '.join(keys)}: {text}" for text, keys in by.items()]


def tables(found: Probe) -> Iterator[TextTable]:
    """All tables that have something to show."""
    if grown := tuple(growth_row(name, g) for name, g in growths(found) if g is not None):
        heads = ("of", "e times every [s]", "times", "until [s]", "horizon of double precision [s]")
        yield TextTable(GROWTH, columns(heads, 1), grown)
    if found.stiffness is not None and found.stiffness.steps:
        yield steps(found.stiffness, found.duration)
    if known := found.conditions():
        own = tuple((NAMES[name], condition(at.value), f"{at.time:.6g}", at.where) for name, at in known)
        yield TextTable(CONDITION, (*columns(("of", "condition", "t [s]"), 1), TextColumn("in", "left")), own)
    if found.attitudes:
        sequences = tuple(found.attitudes[0].euler)
        over = ("body", "half turns", *(f"{s} at [s]" if i else s for s in sequences for i in (0, 1)))
        bodies = tuple(
            (t.body, str(t.half_turns), *(x for k, at in t.euler.values() for x in (condition(k), f"{at:.6g}")))
            for t in found.attitudes
        )
        yield TextTable(ATTITUDES, columns(over, 1), bodies)
    if found.events:
        yield events(found)


def steps(stiff: StiffnessResults, duration: float) -> TextTable:
    """The steps of explicit methods, those that accuracy asks for of a motion alone; longer than the run is any."""
    note = f"rates of the tangent: decay up to {stiff.decay:.3g} 1/s, oscillation up to {stiff.oscillation:.3g} 1/s"
    if not duration:
        rows = tuple((s.method, str(s.order), seconds(s.stability, math.inf)) for s in stiff.steps)
        return TextTable(STEPS_HERE, columns(("method", "order", "stable [s]"), 1), rows, (note,))
    both = tuple(
        (s.method, str(s.order), *(seconds(x, duration) for x in (s.stability, s.accuracy))) for s in stiff.steps
    )
    return TextTable(STEPS, columns(("method", "order", "stable [s]", "accurate [s]"), 1), both, (note,))


def events(found: Probe) -> TextTable:
    """The instants, the first ones of many."""
    shown = [(f"{e.time:.6g}", e.kind, e.message) for e in found.events[:MOST]]
    left = len(found.events) - len(shown) + sum(count for _, _, count in found.more)
    notes = (f"{left} more; JSON lists a hundred of each kind and place",) if left else ()
    heads = (TextColumn("t [s]"), TextColumn("what", "left"), TextColumn("", "left"))
    return TextTable(EVENTS, heads, tuple(shown), notes)


def columns(heads: tuple[str, ...], words: int) -> tuple[TextColumn, ...]:
    """Columns, the first of them of words."""
    return tuple(TextColumn(head, "left") if k < words else TextColumn(head) for k, head in enumerate(heads))


def growths(found: Probe) -> tuple[tuple[str, GrowthResults | None], ...]:
    """The growths that are told, and of what."""
    own = "motion in the plane" if found.across is not None else "motion"
    return (own, found.growth), ("out of the plane", found.across)


def growth_row(name: str, growth: GrowthResults) -> tuple[str, ...]:
    """A growth's cells."""
    every = f"{1.0 / growth.rate:.3g}" if growth.exponential and growth.rate > 0.0 else "no faster than the time"
    if growth.rate < 0.0 and growth.times < 0.0:
        every = "fades"
    beyond = "beyond the run" if growth.stopped is None else f"beyond {growth.until:.4g}"
    horizon = f"{growth.horizon:.4g}" if growth.horizon is not None else beyond
    if growth.expected is not None:
        horizon += f", about {growth.expected:.2g} if it goes on so"
    times = f"{math.exp(growth.times):.2g}" if growth.times < 700.0 else f"e^{growth.times:.0f}"
    return name, every, times, f"{growth.until:.4g}", horizon


def condition(value: float) -> str:
    """A condition number in a cell."""
    return f"{value:.3g}" if value < 1e15 else "singular"


def seconds(value: float, longest: float) -> str:
    """A step in a cell; any that is longer than the run."""
    return f"{value:.2g}" if value <= longest and math.isfinite(value) else "any"
