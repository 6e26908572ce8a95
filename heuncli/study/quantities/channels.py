"""The channels of the results: every number that changes over the instants, with path, unit and components.

Search, tables, snapshots, CSV, the page and load cycles take their numbers from channels, in SI; display units
are applied where a number is printed.

The paths are those of manual/results.md, "Paths": `joints.elbow.force.z` is kind `joints`, name `elbow`, quantity
`force`, component `z`; in a series of cuts the component begins with the number of the cut, `3.z`. Units and shapes
come from the schema: a new quantity of the results needs a row there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.path_words import TREE, Node, error_kind_of_path, find_child  # fmt: skip
from heuncli.results.results import Array, Block, Results
from heuncli.results.results_paths import PathValues
from heuncli.results.results_schema import (
    AXIAL_FORCES,
    CUT,
    MAGNITUDES,
    REPORT_OF,
    RESULTANTS,
    SECTION_FORCES,
    SECTION_MOMENTS,
    SHARES,
    SPACE,
    STRESSES,
    TILTING_MOMENTS,
    XYZ,
    Quantity,
    Shape,
    find_row,
    is_share,
)
from heuncli.results.stored_arrays import StoredArray
from heuncli.study.quantities.labels import Labels

LENGTH = "length"  # the component that is a vector's magnitude
POSITIONS = frozenset({"position", "center", "point", "direction"})  # vectors whose length has no meaning
NO_UNITS: Mapping[str, str] = MappingProxyType({})
CSV_SIDES = {None: np.nan, "before": -1.0, "beyond": 1.0}  # in order along the bar; SIDE_SIGNS has the other signs


# Vector -> the symbol with which its components begin. Others keep their own name.
SYMBOLS = {
    "force": "F",
    "moment": "M",
    "radial_force": "F radial ",
    "moment_orbital": "M orbital ",
    "moment_spin": "M spin ",
    "position": "",
    "center": "",
    "velocity": "v",
    "center_velocity": "v",
    "acceleration": "a",
    "center_acceleration": "a",
    "angular_velocity": "ω",
    "angular_acceleration": "α",
    "center_velocity_jump": "Δv",
    "angular_velocity_jump": "Δω",
}
# Quantities with the same decimals as another, so that noise in one shows against the others.
DECIMALS_OF = {
    **dict.fromkeys((*AXIAL_FORCES, *SECTION_FORCES, "radial_force"), "force"),
    **dict.fromkeys((*TILTING_MOMENTS, *SECTION_MOMENTS, "moment_orbital", "moment_spin"), "moment"),
}


class Channel(NamedTuple):
    """A quantity of the results over the instants, SI: a number, a vector, or a quantity along a series of cuts.

    kind, name, quantity: the words of its path
    components: names of its components; one empty name for a single number
    values: (n_t, n_components), or (1, n_components) if it is static; (n_t,) of one of its `numbers`
    axes: what the components run over
    cause: the load whose share it is; empty for the whole quantity
    component: for one of the `numbers` of a quantity with several; LENGTH for the magnitude of a vector
    largest_term: the largest number of which it is a sum

    If results are written in parts, the values may be in a file.
    """

    kind: str
    name: str
    quantity: str
    unit: str
    components: tuple[str, ...]
    values: Array
    axes: Shape = ()
    is_static: bool = False
    cause: str = ""
    component: str = ""
    largest_term: float = 0.0

    @property
    def path(self) -> str:
        """The path in the JSON, as `--measure` takes it."""
        component = "" if self.component == LENGTH else self.component
        return ".".join(part for part in (self.kind, self._cause_name, self.quantity, component) if part)

    @property
    def error_kind(self) -> str:
        """The kind of estimate (`accuracy.estimate`) that states its error."""
        return error_kind_of_path(self.kind, self._cause_name, self.quantity)

    @property
    def _cause_name(self) -> str:
        """The words between kind and quantity in its path."""
        share = f"{SHARES}.{self.cause}" if self.cause else ""
        return f"{self.name}.{share}" if self.name and share else self.name or share

    @property
    def is_magnitude(self) -> bool:
        """Whether it counts by a number that is never negative, with a kink at zero that its square does not have."""
        return self.component == LENGTH or self.is_vector or self.quantity in MAGNITUDES

    @property
    def is_vector(self) -> bool:
        """Whether it has the components of vectors; it then counts by their magnitude."""
        return self.axes[-1:] == (SPACE,)

    @property
    def has_cuts(self) -> bool:
        """Whether it runs along a body: then components begin with the number of a cut."""
        return CUT in self.axes

    @property
    def is_nonlinear(self) -> bool:
        """Whether it belongs to a section and is no polynomial of its loads: stresses, deflections, and the reduction
        line.
        """
        return self.kind == "sections" and self.name.split(".")[1:2] in (["stress"], ["line"], ["deflection"])

    @property
    def label(self) -> str:
        """Its name in tables, within the quantities of one object."""
        if self.component == LENGTH:
            return f"|{self.vector}|"
        title = self.quantity.replace("_", " ")
        return SYMBOLS.get(self.quantity, f"{title} ") + self.component if self.component else title

    @property
    def vector(self) -> str:
        """The symbol that the components and the magnitude of one vector share."""
        if not self.component or self.quantity in POSITIONS:
            return ""
        return SYMBOLS.get(self.quantity, self.quantity.replace("_", " ")).strip()

    @property
    def family(self) -> str:
        """Channels of one family show the same decimals."""
        return DECIMALS_OF.get(self.quantity, self.quantity)

    @property
    def searched_values(self) -> Array:
        """The values whose extremes are searched, (n_t, 1) or (n_t, n_cuts); of magnitudes the squares."""
        values = self.values.reshape(len(self.values), -1)
        if self.is_vector:
            vectors = values.reshape(len(values), -1, len(XYZ))
            return np.asarray(np.einsum("...k,...k->...", vectors, vectors))
        return values * values if self.is_magnitude else values

    @property
    def numbers(self) -> list[Channel]:
        """Its single numbers: itself, or its components and the magnitude of a free vector."""
        if len(self.components) == 1:
            return [self._replace(values=self.values[:, 0])]
        columns = zip(self.components, self.values.T, strict=True)
        numbers = [self._replace(component=name, values=column, axes=()) for name, column in columns]
        if self.components == XYZ and self.quantity not in POSITIONS:
            numbers.append(self._replace(component=LENGTH, values=compute_lengths(self.values), axes=()))
        return numbers


def compute_lengths(vectors: Array) -> Array:
    """Compute the magnitudes of vectors (n, 3)."""
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", vectors, vectors)))


def make_path_channel(numbers: PathValues) -> Channel:
    """Make the channel of the numbers at a path that change over the instants; its unit is not needed to search it."""
    block, *words = numbers.keys
    *names, quantity = words or [""]  # `time` is one word
    values = numbers.values.reshape(len(numbers.values), -1)
    components = make_component_names(numbers.axes, numbers.values.shape[1:])
    return Channel(block, ".".join(names), quantity, "", components, values, numbers.axes)


def iter_channels(results: Results, labels: Labels) -> Iterator[Channel]:
    """Yield every quantity of the results that changes over the instants, in the order of the JSON."""
    for kind in REPORT_OF:
        if block := getattr(results, kind):
            yield from _Walk(kind, labels).iter_block((), _find_node(TREE, kind), block)


def make_energy_sum(results: Results) -> Channel | None:
    """Make the channel of the sum of the energies, which is constant; None without energies."""
    if not {"kinetic", "potential", "work"} <= results.energy.keys():
        return None
    kinetic, potential, work = (np.asarray(results.energy[key]) for key in ("kinetic", "potential", "work"))
    terms = max(float(np.abs(values).max(initial=0.0)) for values in (kinetic, potential, work))
    return Channel("energy", "", "sum", "J", ("",), kinetic + potential - work, largest_term=terms)


def collect_series_loads(results: Results) -> list[Channel]:
    """Collect the section forces along all series of cuts."""
    runs = [item for item in results.sections.items() if "s" in item[1]]
    return [channel for name, section in runs for channel in make_section_channels(name, section)[: len(RESULTANTS)]]


def make_section_channels(
    name: str, section: Mapping[str, Any], units: Mapping[str, str] = NO_UNITS
) -> tuple[Channel, ...]:
    """Make the channels of a section: its forces, then its stresses and deflections, if it has them.

    section: its block; that of a series of cuts gives channels along it, (n_t, n_cuts)
    units: replacements of units, for impulses instead of forces
    """
    stress = section.get("stress", {})
    parts = [(name, quantity, section[quantity]) for quantity in RESULTANTS if quantity in section]
    parts += [(f"{name}.stress", quantity, stress[quantity]) for quantity in STRESSES if quantity in stress]
    parts += [(f"{name}.deflection", quantity, values) for quantity, values in section.get("deflection", {}).items()]
    channels = []
    for part, quantity, values in parts:
        unit = find_row(f"sections.SECTION{part.removeprefix(name)}.{quantity}").select_unit()
        axes = (CUT,) if np.ndim(values) > 1 else ()
        components = make_component_names(axes, np.shape(values)[1:])
        channels.append(Channel("sections", part, quantity, units.get(unit, unit), components, values, axes))
    return tuple(channels)


def iter_impulse_channels(impulse: Block, labels: Labels) -> Iterator[Channel]:
    """Yield every quantity of one block of `impulses`, as at one instant; its forces are impulses."""
    node = _find_node(_find_node(TREE, "impulses"), "0")
    for kind, part in impulse.items():
        if isinstance(part, dict):
            yield from _Walk(kind, labels, is_impulse=True).iter_block((), _find_node(node, kind), part)
        elif kind not in ("time", "names", "certain_sums"):
            yield from _Walk("", labels, is_impulse=True).iter_block((), node, {kind: part})


@cache
def make_component_names(axes: Shape, sizes: tuple[int, ...]) -> tuple[str, ...]:
    """Make the names of the components of an array with these axes: `x`, `3.z`; one empty name for a single number."""
    names: tuple[str, ...] = ("",)
    for axis, size in zip(axes, sizes, strict=True):
        names = tuple(f"{outer}.{inner}" if outer else inner for outer in names for inner in axis.make_labels(size))
    return names


class _Walk(NamedTuple):
    """The walk over the blocks of one kind; of an impulse they have no axis of instants."""

    kind: str
    labels: Labels
    is_impulse: bool = False

    def iter_block(self, keys: tuple[str, ...], node: Node, block: Block, in_series: bool = False) -> Iterator[Channel]:
        """Yield the quantities of a block and of its sub-blocks; in_series: whether it belongs to a series of cuts."""
        in_series = in_series or (self.kind == "sections" and len(keys) == 1 and "s" in block)
        for key, value in block.items():
            if isinstance(value, dict):
                yield from self.iter_block((*keys, key), _find_node(node, key), value, in_series)
                continue
            row = find_child(node, key)
            assert isinstance(row, Quantity), f"{self.kind}.{'.'.join((*keys, key))} has no row in the schema"
            if row.is_timed:
                yield self.make_timed_channel(keys, key, row, value, in_series)
            elif row.shape == (CUT,) and np.ndim(value) == 1:  # in a search nodes may move with a load
                yield self.make_cut_channel(keys, key, row.select_unit(), np.asarray(value, dtype=np.float64))
            elif key == "side" and any(value):
                yield self.make_cut_channel(keys, key, "1", np.array([CSV_SIDES[side] for side in value]))

    def make_timed_channel(
        self, keys: tuple[str, ...], key: str, row: Quantity, value: Any, in_series: bool
    ) -> Channel:
        """Make the channel of a quantity that changes over the instants."""
        values: Any = value if isinstance(value, StoredArray) else np.asarray(value, dtype=np.float64)
        if self.is_impulse:
            values = values[None]
        cause = keys[-1] if is_share(row) else ""
        name = ".".join(keys[:-2] if cause else keys)
        unit = row.select_unit(len(row.units) > 1 and self.labels.is_rotational(self.kind, name))
        axes = row.instant_axes(in_series)
        components, columns = make_component_names(axes, values.shape[1:]), values.reshape(len(values), -1)
        return Channel(self.kind, name, key, unit, components, columns, axes, cause=cause)

    def make_cut_channel(self, keys: tuple[str, ...], key: str, unit: str, values: Array) -> Channel:
        """Make the channel of one number per cut that is the same at all instants."""
        components = make_component_names((CUT,), values.shape)
        return Channel(self.kind, ".".join(keys), key, unit, components, values[None, :], (CUT,), is_static=True)


def _find_node(node: Node, key: str) -> Node:
    """Return the rows below a key."""
    child = find_child(node, key)
    assert isinstance(child, dict), f"{key} has no rows in the schema"
    return child
