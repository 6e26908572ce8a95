"""The applied loads of a page: springs, gas, bushings, torques and forces from outside, as vectors over the frames."""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.base import tolerances
from heuncli.output.web_page.number_rows import choose_family_style
from heuncli.output.web_page.packing import pack_points, pack_values
from heuncli.results.results import Array
from heuncli.study.quantities.captions import describe_object
from heuncli.study.quantities.digits import StatedErrors
from heuncli.study.quantities.labels import Labels
from heuncli.study.queries.study import Study

MIN_LOAD = 1e-4  # of the largest of its kind: a smaller one has no arrow
UNITS = {"force": "N", "moment": "N·m"}


def make_acting_loads(study: Study, times: Array, labels: Labels, certain: StatedErrors) -> list[dict[str, Any]]:
    """Make an entry for each force and moment ON the `to` body: name, point of action and vector at all frames.

    times: of the frames (n,)
    """
    is_own = study.has_one_instant or np.array_equal(times, study.results.time)
    recovery = study.recovery if is_own else study.find_recovery(times, frozenset({"joints"}))
    applied = [(load.load.name, load.action) for load in recovery.loads]
    found = [
        (name, what, action.to_end.position, vectors)
        for name, action in applied
        for what, vectors in (("force", action.force), ("moment", action.moment))
    ]
    largest = {what: max((_find_size(row[3]) for row in found if row[1] == what), default=0.0) for what in UNITS}
    entries = []
    for name, what, points, vectors in found:
        size = _find_size(vectors)
        rounding = tolerances.NOTHING_ACTS * study.load_magnitudes.by_unit.get(UNITS[what], 0.0)
        if size > max(rounding, MIN_LOAD * largest[what]):
            style = choose_family_style("forces", UNITS[what], size, labels, certain)
            entries.append({
                "name": name, "caption": describe_object("forces", name, labels), "what": what, **style,
                "at": pack_points(points), "forces": pack_values(vectors, 3),
            })  # fmt: skip
    return entries


def _find_size(vectors: Array) -> float:
    """Find the largest magnitude among vectors (n, 3)."""
    return float(np.sqrt((np.asarray(vectors) ** 2).sum(axis=1)).max(initial=0.0))
