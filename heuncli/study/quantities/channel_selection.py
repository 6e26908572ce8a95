"""Chosen channels of the results, collected at the instants of every round of a search.

The blocks of a run have the same quantities at all instants. So the first collection walks through the results and
notes where the chosen numbers stand; later ones read them there.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from typing import Any

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.path_words import split_leading_key
from heuncli.results.results import Array, Results
from heuncli.results.results_schema import SHARES
from heuncli.study.quantities.channels import (
    Channel,
    collect_series_loads,
    compute_lengths,
    iter_channels,
    make_energy_sum,
)
from heuncli.study.quantities.labels import Labels


class QuantityPlace(NamedTuple):
    """Where the chosen numbers of one quantity stand in results.

    keys: its block, and the keys below that lead to its array
    numbers: the chosen numbers as channels; their values are those of the instants first collected
    columns: the component of each, None for the magnitude
    """

    keys: tuple[str, ...]
    numbers: list[Channel]
    columns: list[int | None]

    def read(self, results: Results) -> list[Channel]:
        """Read the numbers of results at other instants."""
        block, *keys = self.keys
        array: Any = getattr(results, block)
        for key in keys:
            array = array[key]
        values: Array = np.asarray(array, dtype=np.float64).reshape(len(array), -1)
        return [
            number._replace(values=compute_lengths(values) if k is None else values[:, k])
            for number, k in zip(self.numbers, self.columns, strict=True)
        ]


class ChannelSelection:
    """Chosen numbers of the results of one run, in the order in which results hold them. Notes their places.

    components: of the chosen quantities by their paths, the components of the chosen numbers
    has_cut_series: whether section forces along series of cuts are chosen as well; they stand last
    """

    def __init__(self, labels: Labels, numbers: Iterable[Channel], *, has_cut_series: bool) -> None:
        self.labels, self.has_cut_series = labels, has_cut_series
        self.components: dict[str, set[str]] = {}
        for number in numbers:
            self.components.setdefault(number._replace(component="").path, set()).add(number.component)
        self._places: list[QuantityPlace] = []

    def collect(self, results: Results) -> list[Channel]:
        """Collect the chosen numbers from results at any instants."""
        if not self._places:
            self._places = [
                find_place(channel, self.components[channel.path], results)
                for channel in iter_channels(results, self.labels)
                if channel.path in self.components
            ]
        found = [number for place in self._places for number in place.read(results)]
        if "energy.sum" in self.components and (energy_sum := make_energy_sum(results)) is not None:
            found.append(energy_sum)
        return found + (collect_series_loads(results) if self.has_cut_series else [])


def find_place(channel: Channel, components: Collection[str], results: Results) -> QuantityPlace:
    """Find where the chosen components of a quantity stand."""
    share = [SHARES, channel.cause] if channel.cause else []
    words = [word for word in (*channel.name.split("."), *share, channel.quantity) if word]
    keys, block = list[str](), getattr(results, channel.kind)
    while words:
        key, words = split_leading_key(block, words)
        assert key is not None, f"{channel.path} is not in the results"
        keys.append(key)
        block = block[key]
    numbers = [number for number in channel.numbers if number.component in components]
    columns = {"": 0} | {component: k for k, component in enumerate(channel.components)}
    return QuantityPlace((channel.kind, *keys), numbers, [columns.get(number.component) for number in numbers])
