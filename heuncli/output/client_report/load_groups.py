"""Choose the numbers of a load table: of each joint, support and load, as in the tables of `heun run`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.client_report.report_data import ReportData
from heuncli.output.tables.table_blocks import format_component
from heuncli.output.tables.table_plans import TablePlan
from heuncli.results.results import Results
from heuncli.results.results_schema import MAGNITUDES, XYZ
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import FAMILIES

MAGNITUDE_LABELS = {"force": "|F|", "moment": "|M|"}  # of a vector
TOTAL = "total"  # of the foundation


class LoadNumber(NamedTuple):
    """A number of the results: label, path, and the family of numbers with which it shares its decimals.

    is_magnitude: whether it is a magnitude, whose minimum governs nothing
    vector: path of the vector of which it is a component or the magnitude
    """

    label: str
    path: str
    family: str
    is_magnitude: bool = False
    vector: str = ""


class LoadGroup(NamedTuple):
    """The numbers of one object, with its words and the note next to it; key: its name in the spec."""

    name: str
    note: str
    rows: Sequence[LoadNumber]
    key: str = ""


def iter_groups(data: ReportData, plan: TablePlan) -> Iterator[LoadGroup]:
    """Yield the objects of a kind, each with its numbers."""
    results = data.runs[0].results
    for name, prefix in _iter_objects(results, plan):
        rows = list(_iter_numbers(data, prefix, plan.quantities))
        if rows:
            words = name if plan.is_foundation else describe_object(plan.kind, name, data.labels)
            yield LoadGroup(words, plan.note(name, data.labels), rows, name)


def _iter_objects(results: Results, plan: TablePlan) -> Iterator[tuple[str, str]]:
    """Yield the names of the objects of a kind, each with the prefix of its paths."""
    block = getattr(results, plan.kind)
    if not plan.is_foundation:
        yield from ((name, f"{plan.kind}.{name}") for name in block)
        return
    yield TOTAL, "foundation"
    for part, word in (("supports", "support"), ("elements", "element")):
        yield from ((f"{word} {name}", f"foundation.{part}.{name}") for name in block.get(part, {}))


def _iter_numbers(data: ReportData, prefix: str, quantities: Sequence[str]) -> Iterator[LoadNumber]:
    """Yield the numbers of one object; for a vector its components and its magnitude."""
    numbers = data.runs[0].snapshot.numbers
    for quantity in quantities:
        path, family = f"{prefix}.{quantity}", FAMILIES.get(quantity, quantity)
        components = [f"{path}.{axis}" for axis in XYZ]
        is_vector = all(component in numbers for component in components)
        for axis, component in zip(XYZ, components, strict=True):
            if is_vector:
                yield LoadNumber(format_component(f"{quantity}.{axis}"), component, family, vector=path)
        if is_vector:
            yield LoadNumber(
                MAGNITUDE_LABELS.get(quantity, f"|{quantity}|"), path, family, is_magnitude=True, vector=path
            )
        elif path in numbers:
            yield LoadNumber(quantity.replace("_", " "), path, family, quantity in MAGNITUDES)


def drop_components(group: LoadGroup) -> LoadGroup:
    """Drop the components of vectors from a group, keeping their magnitudes."""
    return group._replace(rows=[row for row in group.rows if row.is_magnitude or not row.vector])
