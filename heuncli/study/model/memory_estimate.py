"""How much memory the results of a run will take, before anything moves, and whether there is as much.

What is told of an instant is counted by the schema of results; what a number takes on its way out, and what the
kernel answers do, was measured (`Room`, ANSWERS). Where results are composed part by part (study/compose/parts.py),
their numbers stand in a file, and memory holds the states of all instants. Of the steps nobody knows how many they will
be, but that each jump or kink in time ends one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.errors import LimitError, Problem
from heuncli.base.records import record
from heuncli.motion.integration.run.step_records import KEPT
from heuncli.multibody.mechanism.model import BushingLoad
from heuncli.multibody.response import answer_kinds
from heuncli.results.results_schema import CUT, REPORT_OF, ROWS, SHARES, Quantity, is_share
from heuncli.scene.file_format.models import ResultCondition
from heuncli.study.model.setup import Setup

ANSWERS = 3.0  # times the kernel's answers at an instant: those of both runs, and what is made of them beside
STATES = 3.0  # times the state at an instant: those of both runs, of all instants that are compared, and the instants
RUNS = 3  # whose steps are held at once: the run that is told, its check run, the one from a moved start
A_STEP = 150.0  # bytes of a step beside what it starts from: its end, its segment, its place among the jumps
BESIDE_LOADS = 3  # causes beside the loads: gravity, drives, motion
UNITS = ((1e9, "GB"), (1e6, "MB"))


@record
class Room:
    """Memory that results may take [bytes], and what each of their numbers does on its way to where it is written."""

    memory: float
    a_number: float


def require_room(setup: Setup, room: Room, *, in_parts: bool = False) -> None:
    """Raise LimitError [too-much-memory] where the results take more than there is, with what would fit.

    in_parts: where they may be composed part by part.
    """
    instants, blocks = len(setup.spec.analysis.times), dict[str, float]()
    if in_parts and divisible(setup):
        an_instant = STATES * 8.0 * setup.scene.layout.n_state
    else:
        blocks = {block: count * room.a_number for block, count in numbers_by_block(setup)}
        an_instant = sum(blocks.values()) + ANSWERS * 8.0 * answer_count(setup)
    if instants * an_instant <= room.memory:
        return
    fit = int(two_digits(room.memory / an_instant))
    largest = max(blocks, key=lambda block: blocks[block], default="")
    message = (
        f"the results at {instants:,} instants would take about {in_words(instants * an_instant)} of memory; "
        f"{in_words(room.memory)} may be taken"
    )
    hint = f"{fit:,} instants would fit (analysis.samples)" if fit >= 2 else "not even two instants would fit"
    if largest and blocks[largest] > 0.1 * an_instant:
        share = 100.0 * blocks[largest] / an_instant
        hint += f"; {share:.0f} % are {largest}: --only leaves out what is not needed"
        hint += ", and runs of cuts may have a smaller count" if largest == "sections" else ""
    raise LimitError(Problem("too-much-memory", message, hint=hint))


def require_room_for_steps(setup: Setup, least: int, room: Room) -> None:
    """Raise LimitError [too-much-memory] where so many steps, the least of the run, take more than there is."""
    width = 2 * setup.runner.moving.layout.n_state
    takes = RUNS * (A_STEP * least + 2.0 * 8.0 * min(width * least, KEPT))  # twice: an array that grows is copied
    if takes <= room.memory:
        return
    message = (
        f"loads and drives jump or bend at {least - 1:,} instants, each the end of a step; so many steps would take "
        f"about {in_words(takes)} of memory; {in_words(room.memory)} may be taken"
    )
    raise LimitError(Problem("too-much-memory", message, hint="a shorter duration, or tables of fewer points"))


def in_words(size: float) -> str:
    """A size in bytes, in words."""
    unit, name = next(((unit, name) for unit, name in UNITS if size >= unit), UNITS[-1])
    return f"{two_digits(size / unit):,g} {name}"


def two_digits(value: float) -> float:
    """A value with its first two digits, the rest cut off."""
    whole = max(-1, math.floor(math.log10(value)) - 1) if value >= 1.0 else -1
    return math.floor(round(value / 10.0**whole, 6)) * 10.0**whole


def divisible(setup: Setup) -> bool:
    """Whether results can be composed of some instants at a time (study/compose/parts.py tells where not, and why)."""
    if setup.method is None or setup.scene.layout.rows or SHARES in setup.asked.reports:
        return False
    return not any(isinstance(condition, ResultCondition) for condition in setup.spec.analysis.conditions)


def numbers_at_an_instant(setup: Setup) -> float:
    """How many numbers there are of an instant: those that are told, and the answers that they follow from."""
    return sum(count for _, count in numbers_by_block(setup)) + answer_count(setup)


def answer_count(setup: Setup) -> float:
    """How many numbers the kernel answers at an instant."""
    layout = setup.scene.layout
    own = sum(kind.itemsize // 8 * count for kind, count in answer_kinds(layout).values())
    causes = len(layout.tables["loads"]) + BESIDE_LOADS if SHARES in setup.asked.reports else 0
    return float(own + layout.n_state + causes * setup.runner.workspace.column_width)


def numbers_by_block(setup: Setup) -> Iterator[tuple[str, int]]:
    """How many numbers of each block, if it is asked for as a whole, are told of an instant."""
    found: dict[str, int] = {}
    for row in ROWS:
        block = row.path.partition(".")[0]
        report = REPORT_OF.get(block)
        if row.timed and report is not None and setup.asked.whole(report) and applies(row, setup):
            found[block] = found.get(block, 0) + count(row, setup)
    yield from found.items()


def applies(row: Quantity, setup: Setup) -> bool:
    """Whether the results have a quantity."""
    if row.is_words or (is_share(row) and SHARES not in setup.asked.reports):
        return False
    return not row.path.startswith("sections.SECTION.stress.") or any(cuts.properties for cuts in setup.cuts)


def count(row: Quantity, setup: Setup) -> int:
    """How many numbers a quantity has at an instant, all bodies, joints, cuts taken together."""
    mechanism = setup.scene.mechanism
    grounded = sum(min(joint.a, joint.b) < 0 for joint in mechanism.joints)
    names = {
        "BODY": len(mechanism.bodies),
        "POINT": sum(len(body.points) for body in mechanism.bodies),
        "JOINT": grounded if row.path.startswith("foundation.") else len(mechanism.joints),
        "ELEMENT": len(mechanism.loads),
        "STOP": len(mechanism.stops),
        "COUPLING": len(mechanism.couplings),
        "END": 2,
        "SECTION": sum(len(cuts.side) for cuts in setup.cuts) if CUT in row.shape else len(setup.cuts),
        "FORCE": len(mechanism.loads),
        "CAUSE": len(mechanism.loads) + BESIDE_LOADS,
    }
    if row.meaning.startswith("of a bushing"):
        names["FORCE"] = sum(isinstance(load, BushingLoad) for load in mechanism.loads)
    whole = 1
    for axis in row.shape:
        whole *= axis.size or 1
    for word in row.path.split("."):
        whole *= names.get(word, 1)
    return whole
