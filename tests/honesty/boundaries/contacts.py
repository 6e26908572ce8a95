"""Contacts: what touches, bears, leans on another one, or hops."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from heuncli.base import tolerances
from heuncli.motion.integration.contacts.complementarity import solve_complementarity
from heuncli.motion.integration.contacts.restitution import (
    is_short_flight,
    solve_contact_impulses,
)
from heuncli.motion.integration.contacts.sequential_impacts import find_independent
from heuncli.motion.integration.contacts.touching import TouchingContacts, can_move_bodies
from tests.honesty.boundaries.part import Part, Row
from tests.shared.scenes import near, study

FLOOR = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies: {{ball: {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}}}}}}
joints: {{guide: {{type: slide, from: ground.O, to: ball.p, axis: [0, 0, 1], initial: {{travel: {at!r}}}}}}}
stops: {{floor: {{joint: guide, travel: [0, null], restitution: 0.5}}}}
analysis: {{duration: 1, samples: 2}}
"""


SWUNG = """
heun: 1
gravity: [0, 0, -10]
ground: {{points: {{O: [0, 0, 0]}}}}
bodies:
  ball:
    {{mass: 2, center: [0, 0, 0], inertia: [1, 1, 1], points: {{p: [0, 0, 0]}},
     position: [0, 0, -1], velocity: [1, 0, {rate!r}]}}
joints: {{rope: {{type: rod, from: ground.O, to: ball.p, length: 1, tension_only: true, restitution: 1}}}}
analysis: {{duration: 0.1, samples: 2}}
"""


def near_the_floor(x: float) -> str:
    """A ball at rest above a floor, by so much of the size of the scene: its extent is that of its inertia."""
    setup = study(FLOOR.format(at=1.5 * x)).setup
    assert setup.scene.layout.size == pytest.approx(1.5)
    return "rests" if setup.runner.start_holding[0] else "falls"


def opening_rope(x: float) -> str:
    """A ball on a circle whose rope opens by a part of its speed."""
    run = study(SWUNG.format(rate=-x)).history.checked_run
    assert run is not None
    near(run.run.states[-1][4:7] @ run.run.states[-1][4:7], 1.0, 1.0, 1e-9)
    return "struck" if run.run.impulse_events else "taut"


def pressed(x: float) -> str:
    """A contact pressed with an acceleration of a part of its terms."""
    found = solve_complementarity(np.eye(1), np.array([-x]), np.array([tolerances.CONTACT_ACCELERATION]))
    return "bears" if found.bears[0] else "open"


def leaning(x: float) -> str:
    """Two contacts of which the one leaves so much of the other, both without rate if the first bears."""
    c = 1.0 - x
    found = solve_complementarity(np.array([[1.0, c], [c, 1.0]]), np.array([-1.0, -c]), np.full(2, 1e-14))
    near(found.z, [1.0, 0.0], 1.0, 1e-6)
    return "leans" if found.depends[1] else "open"


def hardly_moved(x: float) -> str:
    """A contact on a body of 1 kg that gives way to a part of what it would if it were free."""
    mechanism, links = SimpleNamespace(scale_masses=np.ones(1)), [SimpleNamespace(body=0)]
    layout: Any = SimpleNamespace(mechanism=mechanism, spanning=SimpleNamespace(links=links), size=1.0)
    one = np.ones(1)
    touch = TouchingContacts(np.zeros(1, dtype=int), np.array([[[0.0, 0, 0, 0, 0, 1.0]]]), one, one, one, one, one)
    return "moves" if can_move_bodies(layout, touch, np.array([[x]]))[0] else "held"


def hop(x: float) -> str:
    """A flight of so much time, at once and too high to be none."""
    one = np.ones(1)
    touch = TouchingContacts(np.zeros(1, dtype=int), np.zeros((1, 1, 6)), one, one, np.zeros(1), one, one)
    short = is_short_flight(touch, one, -2.0 * one / x, tolerances.SHORTEST_FLIGHT)
    return "none" if short[0] else "flies"


def closing_together(x: float) -> str:
    """Two contacts of one body whose equal gaps close at times that differ by twice a part of them."""
    A, rate, none = np.array([[1.0, 0.5], [0.5, 1.0]]), np.array([-1.0, -1.0 - 2.0 * x]), np.zeros(2)
    touch = TouchingContacts(np.arange(2), np.zeros((2, 1, 6)), rate, none, none, np.ones(2), np.ones(2))
    found = solve_contact_impulses(touch, A, np.ones(2, dtype=bool), none, np.zeros(2, dtype=bool), "sequential")
    return "together" if np.allclose(found.impulses, 4.0 / 3.0, rtol=1e-6) else "in turn"


def own_answer(x: float) -> str:
    """A contact of which the one before it leaves so much of its own answer."""
    c = np.sqrt(1.0 - x)
    return "solved" if len(find_independent(np.array([[1.0, c], [c, 1.0]]))) == 2 else "stays"


PART = Part(
    ("contacts",),
    rows=(
        Row("CONTACT_TOUCHES", near_the_floor, "rests", "falls"),
        Row("CONTACT_RATE", opening_rope, "taut", "struck"),
        Row("CONTACT_ACCELERATION", pressed, "open", "bears"),
        Row("CONTACT_TOGETHER", closing_together, "together", "in turn"),
        Row("CONTACT_BASIS", own_answer, "stays", "solved"),
        Row("CONTACT_DEPENDS", leaning, "leans", "open"),
        Row("NO_ANSWER", hardly_moved, "held", "moves"),
        Row("SHORTEST_FLIGHT", hop, "none", "flies"),
    ),
)
