"""All thresholds, part by part: a part is a file that is named for its headings in heuncli/tolerances.py."""

from __future__ import annotations

from tests.honesty.boundaries import (
    accuracy,
    attitude_charts,
    bushings,
    closure_rates,
    comes_near,
    contacts,
    events,
    followed_branches,
    friction,
    gaps,
    in_the_plane,
    lagrange,
    magnitudes,
    method_choice,
    no_inertia,
    no_load,
    open_components,
    orders,
    oscillations,
    pictures,
    rank,
    rest,
    same_place,
    solved_stages,
    steps,
    typed,
)

PARTS = (
    typed.PART,
    magnitudes.PART,
    same_place.PART,
    gaps.PART,
    rank.PART,
    open_components.PART,
    in_the_plane.PART,
    no_inertia.PART,
    friction.PART,
    bushings.PART,
    contacts.PART,
    no_load.PART,
    oscillations.PART,
    orders.PART,
    lagrange.PART,
    pictures.PART,
    rest.PART,
    comes_near.PART,
    accuracy.PART,
    method_choice.PART,
    steps.PART,
    solved_stages.PART,
    closure_rates.PART,
    events.PART,
    followed_branches.PART,
    attitude_charts.PART,
)
ROWS = tuple(row for part in PARTS for row in part.rows)
EXEMPT = {name: why for part in PARTS for name, why in part.exempt.items()}
WANTED = {name: what for part in PARTS for name, what in part.wanted.items()}
