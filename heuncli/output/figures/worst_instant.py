"""Find the instant at which a machine is drawn if none is given: that of the greatest joint force."""

from __future__ import annotations

import math

import numpy as np

from heuncli.base.named_tuples import NamedTuple
from heuncli.results.results import Results
from heuncli.results.results_paths import find_values
from heuncli.study.quantities.channels import Channel, make_path_channel
from heuncli.study.queries.measure_uncertainty import find_search_error
from heuncli.study.queries.study import Study
from heuncli.study.search.columns import ChannelSearch

JOINT_REPORTS = frozenset({"joints"})


class WorstInstant(NamedTuple):
    """The instant [s] of the greatest joint force, the joint, and the force [N].

    joint: empty where no joint has a known force; the instant is then the first of the run
    """

    time: float
    joint: str = ""
    force: float = 0.0


def find_worst_instant(study: Study) -> WorstInstant:
    """Find the greatest joint force of a run before its horizon, between the samples too."""
    first, names = float(study.results.time[0]), list(study.spec.joints)
    if study.has_one_instant or not names:
        return WorstInstant(first)

    def collect(results: Results) -> list[Channel]:
        return [make_path_channel(find_values(results, f"joints.{name}.force")) for name in names]

    error = find_search_error(study, ("joints", names[0], "force"))
    search = ChannelSearch(collect, lambda channel: error if math.isfinite(error) else math.nan, (1.0,))
    bounds = study.search_extremes(search, JOINT_REPORTS)
    forces = np.nan_to_num(np.asarray(bounds.high), nan=-math.inf)
    k = int(np.argmax(forces))
    if not forces[k] > 0.0:
        return WorstInstant(first)
    return WorstInstant(float(bounds.high_at[k]), names[k], float(forces[k]))
