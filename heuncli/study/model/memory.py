"""Estimate the memory that results take before anything moves, and refuse what does not fit.

The schema of results gives the count of numbers at an instant; the bytes per number on its way to the output, and those
of the kernel's solutions, are measured (`MemoryBudget`, SOLUTION_COPIES). Where results are composed part by part
(study/compose/results.py), their numbers go to a file, and memory holds the states of all instants. The number of steps
is unknown beforehand, except that each jump or kink in time ends one.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from heuncli.base.errors import LimitError, Problem
from heuncli.base.records import record
from heuncli.motion.integration.run.progress import MAX_RECORD_NUMBERS
from heuncli.multibody.mechanism.loads import BushingLoad
from heuncli.multibody.response import solution_parts
from heuncli.results.results_schema import CUT, REPORT_OF, ROWS, SHARES, Quantity, is_share
from heuncli.scene.file_format.models import ResultCondition
from heuncli.study.model.setup import Setup

SOLUTION_COPIES = 3.0  # copies of the kernel's solution at an instant: two runs, and what is derived from them
STATE_COPIES = 3.0  # copies of the state at an instant: two runs, and the compared instants with their times
FEW = 2_000_000  # numbers that fit into memory without parts
RUNS = 3  # whose steps are in memory at once: the run, its check run, the one from a perturbed start
BYTES_PER_STEP = 150.0  # bytes of a step besides its start state: its end, its segment, its index among the jumps
CAUSES_WITHOUT_LOAD = 3  # causes other than loads: gravity, drives, motion
UNITS = ((1e9, "GB"), (1e6, "MB"))
CORNERS_OF_MEMBER = 5  # points with stresses in most profiles: four corners and the middle of the web


@record
class MemoryBudget:
    """The memory that results may take [bytes], and the bytes that each of their numbers needs on its way to the
    output.
    """

    memory: float
    bytes_per_number: float


def require_memory(setup: Setup, budget: MemoryBudget, *, in_parts: bool = False) -> None:
    """Raise LimitError [too-much-memory] where the results take more memory than the budget, with the number of
    instants that would fit.

    in_parts: whether they may be composed part by part
    """
    instants, blocks = len(setup.spec.analysis.times), dict[str, float]()
    if in_parts and can_compose_in_parts(setup):
        bytes_per_instant = STATE_COPIES * 8.0 * setup.scene.layout.n_state
    else:
        blocks = {block: count * budget.bytes_per_number for block, count in iter_numbers_by_block(setup)}
        bytes_per_instant = sum(blocks.values()) + SOLUTION_COPIES * 8.0 * count_solution_numbers(setup)
    if instants * bytes_per_instant <= budget.memory:
        return
    fitting = int(truncate_to_two_digits(budget.memory / bytes_per_instant))
    largest = max(blocks, key=lambda block: blocks[block], default="")
    message = (
        f"the results at {instants:,} output times need about "
        f"{format_bytes(instants * bytes_per_instant)} of memory; "
        f"{format_bytes(budget.memory)} is allowed"
    )
    hint = f"{fitting:,} samples would fit (analysis.samples)" if fitting >= 2 else "not even two samples would fit"
    if largest and blocks[largest] > 0.1 * bytes_per_instant:
        share = 100.0 * blocks[largest] / bytes_per_instant
        hint += f"; {share:.0f} % are {largest}: use --only to leave out blocks"
        hint += ", or fewer cuts" if largest == "sections" else ""
    raise LimitError(Problem("too-much-memory", message, hint=hint))


def require_memory_for_steps(setup: Setup, min_steps: int, budget: MemoryBudget) -> None:
    """Raise LimitError [too-much-memory] where the least number of steps of the run takes more memory than the
    budget.
    """
    width = 2 * setup.runner.integrated_scene.layout.n_state
    # twice, because a growing array is copied
    takes = RUNS * (BYTES_PER_STEP * min_steps + 2.0 * 8.0 * min(width * min_steps, MAX_RECORD_NUMBERS))
    if takes <= budget.memory:
        return
    message = (
        f"loads and drives have {min_steps - 1:,} jumps or kinks, each of which ends a step; "
        "that many steps need "
        f"about {format_bytes(takes)} of memory; {format_bytes(budget.memory)} is allowed"
    )
    raise LimitError(Problem("too-much-memory", message, hint="a shorter duration, or tables with fewer points"))


def format_bytes(size: float) -> str:
    """Format a size in bytes with its unit."""
    unit, name = next(((unit, name) for unit, name in UNITS if size >= unit), UNITS[-1])
    return f"{truncate_to_two_digits(size / unit):,g} {name}"


def truncate_to_two_digits(value: float) -> float:
    """Return a value cut off after its first two digits."""
    exponent = max(-1, math.floor(math.log10(value)) - 1) if value >= 1.0 else -1
    return math.floor(round(value / 10.0**exponent, 6)) * 10.0**exponent


def can_compose_in_parts(setup: Setup) -> bool:
    """Return whether results can be composed in parts (study/compose/results.py says where not, and why)."""
    layout = setup.scene.layout
    may_be_indeterminate = bool(
        setup.model["redundant"] or layout.contacts or layout.friction_contacts or layout.mechanism.couplings
    )
    if setup.method is None or (layout.rows and may_be_indeterminate):
        return False
    return not any(isinstance(condition, ResultCondition) for condition in setup.spec.analysis.conditions)


def has_few_numbers(setup: Setup, instants: int) -> bool:
    """Return whether the numbers of all instants are so few that they are composed at once."""
    return count_numbers_per_instant(setup) * instants <= FEW


def count_numbers_per_instant(setup: Setup) -> float:
    """Count the numbers of an instant: those of the results, and those of the kernel's solution."""
    return sum(count for _, count in iter_numbers_by_block(setup)) + count_solution_numbers(setup)


def count_solution_numbers(setup: Setup) -> float:
    """Count the numbers of the kernel's solution at an instant."""
    layout = setup.scene.layout
    solution_numbers = sum(kind.itemsize // 8 * count for kind, count in solution_parts(layout).values())
    causes = len(layout.tables["loads"]) + CAUSES_WITHOUT_LOAD if SHARES in setup.selection.reports else 0
    return float(solution_numbers + layout.n_state + causes * setup.runner.workspace.column_width)


def iter_numbers_by_block(setup: Setup) -> Iterator[tuple[str, int]]:
    """Yield each block that is requested as a whole, with its count of numbers per instant."""
    found: dict[str, int] = {}
    for row in ROWS:
        block = row.path.partition(".")[0]
        report = REPORT_OF.get(block)
        if row.is_timed and report is not None and setup.selection.has_whole(report) and is_in_results(row, setup):
            found[block] = found.get(block, 0) + count_numbers(row, setup)
    yield from found.items()


def is_in_results(row: Quantity, setup: Setup) -> bool:
    """Return whether the results have a quantity."""
    if row.is_words or (is_share(row) and SHARES not in setup.selection.reports):
        return False
    if row.path.startswith("sections.SECTION.stress.points."):
        return any(cuts.cuts_members for cuts in setup.cuts)
    if row.path.startswith(("sections.SECTION.deflection.", "sections.SECTION.buckling")):
        return any(cuts.beam for cuts in setup.cuts)
    return not row.path.startswith("sections.SECTION.stress.") or any(cuts.properties for cuts in setup.cuts)


def count_numbers(row: Quantity, setup: Setup) -> int:
    """Count the numbers of a quantity at an instant, over all bodies, joints and cuts."""
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
        "CORNER": CORNERS_OF_MEMBER,
        "SENSOR": len(setup.spec.sensors),
        "BEARING": 2,
        "FORCE": len(mechanism.loads),
        "CAUSE": len(mechanism.loads) + CAUSES_WITHOUT_LOAD,
    }
    if ".BEARING." in row.path:
        names["JOINT"] = sum(joint.bearings is not None for joint in mechanism.joints)
    if row.path.startswith("forces.") and row.shape:  # only a bushing has vectors
        names["FORCE"] = sum(isinstance(load, BushingLoad) for load in mechanism.loads)
    total = 1
    for axis in row.shape:
        total *= axis.size or 1
    for word in row.path.split("."):
        total *= names.get(word, 1)
    return total
