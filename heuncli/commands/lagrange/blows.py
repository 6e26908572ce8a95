"""A blow on Lagrange's side: e [q'] = h + H, (32), and what a section passes on of it, (50), (51).

    h_i = sum h . x_P,i        [q'] = n (h + H), H what drives exert        r'_i = r' . x_P,i + M_r' . w_i
The reciprocal energy F = h n h / 2 is what h gives to the scene at rest.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from heuncli.commands.lagrange.coordinates import Chosen, accelerations
from heuncli.commands.lagrange.equations import Partials
from heuncli.commands.lagrange.instant import Instant
from heuncli.commands.lagrange.results import BlowResults
from heuncli.kinetostatics.bodies import body_states
from heuncli.results import Array
from heuncli.spec.models import Spec
from heuncli.study.compose.impulses import Impulses
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve


def blows(
    spec: Spec, at: Instant, by: Chosen, partials: Partials, epsilon: Array, eta: Array
) -> tuple[BlowResults, ...]:
    """The blows of an analysis of an impulse; none of another."""
    if spec.analysis.type != "impulse":
        return ()
    struck = solve(spec, Options(reduce=False)).struck
    count = 0 if struck is None else len(struck.jumps)
    return tuple(one(struck, k, at, by, partials, epsilon, eta) for k in range(count) if struck is not None)


def one(
    struck: Impulses, k: int, at: Instant, by: Chosen, partials: Partials, epsilon: Array, eta: Array
) -> BlowResults:
    """One blow of those that struck."""
    own = struck.recovery
    states = body_states(own.setup.scene.layout, own.recovered.at(np.array([k])))
    jumps = accelerations(at.freed.layout, by.names, states)[0]
    h = np.zeros(len(eta))
    for action in own.given:
        for end, force, moment in action.on_bodies():
            h = h + force[k] @ partials.at(end.body, end.position[k]) + moment[k] @ partials.turning(end.body)
    total = epsilon @ jumps
    drives = np.where(by.driven, total - h, 0.0)
    cut = struck.shown["sections"]
    return BlowResults(
        t=struck.jumps[k].time,
        h=h,
        drives=drives,
        jumps=jumps,
        reciprocal_energy=float(0.5 * h @ eta @ h),
        sections={cuts.name: passed_on(cut[cuts.name], k, partials, cuts.body) for cuts in at.setup.cuts},
    )


def passed_on(block: dict[str, Any], k: int, partials: Partials, body: int) -> Any:
    """r'_i of a section, a list over its cuts where these are a run; None where it is open."""
    single = block["force"][k].ndim == 1
    found = []
    for P, force, moment in zip(*(np.atleast_2d(block[name][k]) for name in ("point", "force", "moment")), strict=True):
        r = force @ partials.at(body, P) + moment @ partials.turning(body)
        found.append(None if np.isnan(r).any() else r.tolist())
    return found[0] if single else found
