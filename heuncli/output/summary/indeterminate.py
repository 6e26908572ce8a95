"""What a run leaves indeterminate, in groups: one line for all things of a kind with the same open loads."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.output.tables.extremes_tables import PART
from heuncli.output.tables.nouns import format_count, join_ranges
from heuncli.output.tables.page import Page
from heuncli.results.results_schema import RESULTANTS
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.channels import Channel
from heuncli.study.quantities.cut_runs import collect_runs
from heuncli.study.quantities.labels import Labels

ADJECTIVES = ("radial", "axial")  # of the loads of a joint with an axis
MAX_COMPONENTS = 4  # with more, "loads" says as much


class IndeterminateGroup(NamedTuple):
    """Things of one kind, and what of their loads is indeterminate throughout, in words.

    paths: of the numbers
    """

    kind: str
    what: str
    names: tuple[str, ...]
    paths: tuple[str, ...]


def find_indeterminate_groups(page: Page, channels: Sequence[Channel]) -> list[IndeterminateGroup]:
    """Find the groups of a run, in the order of its tables; channels: those that are searched."""
    if not any(np.isnan(channel.values).any() for channel in channels):
        return []
    groups: dict[tuple[str, str], tuple[list[str], list[str]]] = {}
    for kind, name, rows in _iter_things(page):
        unknown = [channel for channel in rows if np.isnan(channel.values).all()]
        if unknown and PART not in name:
            names, paths = groups.setdefault((kind, _describe_loads(kind, unknown)), ([], []))
            names.append(name)
            paths += [channel.path for channel in unknown]
    return [IndeterminateGroup(*key, tuple(names), tuple(paths)) for key, (names, paths) in groups.items()]


def _iter_things(page: Page) -> Iterator[tuple[str, str, Sequence[Channel]]]:
    """Yield kind, name and channels of all that may be indeterminate; supports and elements repeat joints and loads."""
    for block in page.make_blocks(page.results, only_searched=True):
        if block.kind in ("joints", "stops", "couplings", "sections"):
            yield from ((block.kind, group.name, group.rows) for group in block.groups)
    yield from (("sections", run.name, run.loads) for run in collect_runs(page.results, page.labels))


def _describe_loads(kind: str, unknown: Sequence[Channel]) -> str:
    """Describe indeterminate loads: "radial loads", "tooth forces", "N, M1"."""
    quantities = dict.fromkeys(channel.quantity for channel in unknown)
    adjectives = [word for word in ADJECTIVES if word in quantities]
    if kind == "couplings":
        return "tooth forces" if "normal" in quantities else "tensions" if "tension" in quantities else "loads"
    if adjectives:
        return f"{' and '.join(adjectives)} loads"
    if kind == "sections":
        components = [quantity for quantity in quantities if quantity in RESULTANTS]
    else:
        components = [channel.label for channel in unknown if channel.vector and not channel.is_magnitude]
    return ", ".join(components) if 0 < len(components) < MAX_COMPONENTS else "loads"


def format_indeterminate(groups: Iterable[IndeterminateGroup], labels: Labels, redundant: int = 0) -> list[str]:
    """Format one line for each group; the last gives the number of redundant constraints."""
    lines = []
    for group in groups:
        names = join_ranges(describe_object(group.kind, name, labels) for name in group.names)
        lines.append(f"indeterminate: {group.what} of {', '.join(names)}")
    if lines and redundant:
        lines[-1] += f" ({format_count(redundant, 'redundant constraint')})"
    return lines
