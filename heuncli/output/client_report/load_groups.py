"""Choose the numbers of a load table: of each joint, support and load, as in the tables of `heun run`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from heuncli.base.load_kinds import LOAD_KINDS
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
CARRIED_FORCES = frozenset({"force", "contact", "normal", "tension", "last_tension", "tight", "slack"})  # by a coupling


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


class LoadedObject(NamedTuple):
    """Something that carries a load between bodies: its words, its type where the words do not tell it, and the paths
    of the loads of which the largest counts.
    """

    name: str
    type: str
    paths: Sequence[str]


def iter_loaded_objects(data: ReportData) -> Iterator[LoadedObject]:
    """Yield all that joins bodies, each with the paths of its loads: joints, drives, stops, couplings, loads between
    bodies.

    For a coupling these are the force that it carries and the one it exerts ON each body: a sheave takes both spans of
    rope.
    """
    objects: dict[tuple[str, str], list[str]] = {}
    units = {path: number.unit for run in data.runs for path, number in run.snapshot.numbers.items()}
    for path, unit in units.items():
        kind, _, rest = path.partition(".")
        name, _, quantity = rest.partition(".")
        if unit not in ("N", "N·m") or (path.rpartition(".")[0] in units and path.rpartition(".")[2] in XYZ):
            continue
        if _is_joining_load(data, kind, name, quantity, unit):
            objects.setdefault((f"{kind}.drive" if quantity == "drive" else kind, name), []).append(path)
    for (kind, name), paths in objects.items():
        words = describe_object(kind.removesuffix(".drive"), name, data.labels)
        type_name = "drive" if kind.endswith(".drive") else _name_type(data, kind, name)
        yield LoadedObject(words, "" if type_name in words else type_name, paths)


def _name_type(data: ReportData, kind: str, name: str) -> str:
    """Return the type of a coupling or force in words, which its name may not tell."""
    if kind == "couplings":
        return str(getattr(data.spec.couplings.get(name), "type", "")).replace("_", " ")
    info = data.labels.forces.get(name) if kind == "forces" else None
    return LOAD_KINDS[info.type].display_name if info is not None else ""


def _is_joining_load(data: ReportData, kind: str, name: str, quantity: str, unit: str) -> bool:
    """Return whether a quantity is the load that a joint, stop, coupling or force carries between bodies."""
    if kind == "joints":
        return quantity == "drive" or (quantity == "force" and unit == "N")
    if kind == "stops":
        return quantity in ("force", "moment")
    if kind == "couplings":
        is_on_body = quantity.startswith("on.") and quantity.endswith(".force")
        return unit == "N" and (quantity in CARRIED_FORCES or is_on_body)
    info = data.labels.forces.get(name) if kind == "forces" else None
    return info is not None and quantity in ("force", "value") and not LOAD_KINDS[info.type].is_external


def drop_components(group: LoadGroup) -> LoadGroup:
    """Drop the components of vectors from a group, keeping their magnitudes."""
    return group._replace(rows=[row for row in group.rows if row.is_magnitude or not row.vector])
