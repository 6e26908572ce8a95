"""Which numbers a table of loads tells: of each joint, support and load, by the plans of the tables of `heun run`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.reported import Reported
from heuncli.output.tables.table_blocks import FAMILIES, short
from heuncli.output.tables.table_plans import TablePlan
from heuncli.results.results import Results
from heuncli.results.results_schema import MAGNITUDES, XYZ

WHOLE = {"force": "|F|", "moment": "|M|"}  # of a vector
TOTAL = "total"  # of the foundation
CARRIED = frozenset({"force", "contact", "normal", "tension", "last_tension", "tight", "slack"})  # by a coupling
FROM_OUTSIDE = frozenset({"force", "couple", "distributed"})  # loads on one body, without a counterpart


class LoadNumber(NamedTuple):
    """A number of the results: its label, its path, and to which family of numbers it belongs.

    even: a magnitude, of which the least governs nothing; vector: of which it is a component or the magnitude.
    """

    label: str
    path: str
    family: str
    even: bool = False
    vector: str = ""


class LoadGroup(NamedTuple):
    """The numbers of one thing, by its name, and what is said beside that."""

    name: str
    note: str
    rows: Sequence[LoadNumber]


def groups_of(of: Reported, plan: TablePlan) -> Iterator[LoadGroup]:
    """What there is of a kind, each with its numbers."""
    results = of.runs[0].results
    for name, prefix in _things(results, plan):
        rows = list(_rows(of, prefix, plan.quantities))
        if rows:
            yield LoadGroup(name, plan.note(name, of.labels), rows)


def _things(results: Results, plan: TablePlan) -> Iterator[tuple[str, str]]:
    """The names of a kind of results with what their paths begin with."""
    block = getattr(results, plan.kind)
    if not plan.of_foundation:
        yield from ((name, f"{plan.kind}.{name}") for name in block)
        return
    yield TOTAL, "foundation"
    for part, word in (("supports", "support"), ("elements", "element")):
        yield from ((f"{word} {name}", f"foundation.{part}.{name}") for name in block.get(part, {}))


def _rows(of: Reported, prefix: str, quantities: Sequence[str]) -> Iterator[LoadNumber]:
    """The numbers of one thing: of a vector its components and its magnitude."""
    numbers = of.runs[0].kept.numbers
    for quantity in quantities:
        path, family = f"{prefix}.{quantity}", FAMILIES.get(quantity, quantity)
        parts = [f"{path}.{axis}" for axis in XYZ]
        vector = all(part in numbers for part in parts)
        for axis, part in zip(XYZ, parts, strict=True):
            if vector:
                yield LoadNumber(short(f"{quantity}.{axis}"), part, family, vector=path)
        if vector:
            yield LoadNumber(WHOLE[quantity], path, family, even=True, vector=path)
        elif path in numbers:
            yield LoadNumber(quantity, path, family, quantity in MAGNITUDES)


def joining_forces(of: Reported) -> Iterator[tuple[str, str]]:
    """The forces of all that joins bodies, each with its name: joints, drives, stops, couplings, and loads between two.

    Of a coupling what it carries and what it exerts ON each body: a sheave takes both strands of its rope.
    """
    units = {path: number.unit for run in of.runs for path, number in run.kept.numbers.items()}
    for path, unit in units.items():
        kind, _, rest = path.partition(".")
        name, _, quantity = rest.partition(".")
        if unit != "N" or (path.rpartition(".")[0] in units and path.rpartition(".")[2] in XYZ):
            continue
        if kind == "joints" and quantity in ("force", "drive"):
            yield path, name if quantity == "force" else f"the drive of {name}"
        elif kind == "stops" and quantity == "force":
            yield path, f"stop {name}"
        elif kind == "couplings" and (
            quantity in CARRIED or (quantity.startswith("on.") and quantity.endswith(".force"))
        ):
            where = quantity.removeprefix("on.").removesuffix(".force") if quantity.startswith("on.") else ""
            yield path, f"coupling {name}{f' on {where}' if where else ''}"
        elif kind == "forces" and quantity in ("force", "value"):
            info = of.labels.forces.get(name)
            if info is not None and info.type not in FROM_OUTSIDE:
                yield path, f"{info.type.replace('_', ' ')} {name}"


def without_components(group: LoadGroup) -> LoadGroup:
    """A group of which the magnitudes of vectors are told alone."""
    return group._replace(rows=[row for row in group.rows if row.even or not row.vector])
