"""Load cases whatever a run was asked for: the joints on the body are told, and the cases are the reader's own."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import heuncli
from heuncli.analyses.load_cases.model import LoadCases
from heuncli.output.fe_decks.decks import DECKS, DeckNames

SCENE: dict[str, Any] = {
    "heun": 1,
    "gravity": [0, 0, -9.81],
    "ground": {"points": {"O": [0, 0, 0], "P": [3, 0, 0]}},
    "bodies": {
        name: {"mass": 2, "center": [0, 0, -0.5], "inertia": [0.1, 0.1, 0.1],
               "points": {"top": [0, 0, 0], "end": [0, 0, -1]}, "angular_velocity": [0, rate, 0]}
        for name, rate in (("upper", 1), ("lower", -2), ("other", 3))
    },
    "joints": {
        "pivot": {"type": "pin", "axis": [0, 1, 0], "from": "ground.O", "to": "upper.top"},
        "elbow": {"type": "pin", "axis": [0, 1, 0], "from": "upper.end", "to": "lower.top"},
        "alone": {"type": "pin", "axis": [0, 1, 0], "from": "ground.P", "to": "other.top"},
    },
    "impulses": {"blow": {"on": "lower.end", "vector": [1, 0, 0], "time": 0.1}},
}  # fmt: skip
MOTION = {"duration": 0.2, "samples": 3}


def same(mine: LoadCases, its: LoadCases) -> None:
    for a, b in zip(mine.cases, its.cases, strict=True):
        assert [(one.kind, one.name) for one in a.actions] == [(one.kind, one.name) for one in b.actions]
        for one, other in zip(a.actions, b.actions, strict=True):
            np.testing.assert_allclose(one.force, other.force, rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize("only", ["energy", "joints.elbow", "joints.pivot"])
def test_the_joints_are_told_whatever_was_asked_for(only: str) -> None:
    """Of a motion and its blow, and of a state, as of the run that tells everything."""
    state = {key: value for key, value in SCENE.items() if key != "impulses"}
    for scene, at in ((SCENE | {"analysis": MOTION}, "0.05,impulse:blow"), (state, "first")):
        same(heuncli.solve(scene, only=only).load_cases("upper", at), heuncli.solve(scene).load_cases("upper", at))


def test_a_body_that_was_left_out() -> None:
    study = heuncli.solve(SCENE | {"analysis": MOTION}, only="joints.elbow")
    with pytest.raises(heuncli.UsageError, match="other: left out, because no requested result depends on it"):
        study.load_cases("other", "first")


def test_who_changes_a_case_changes_no_scene() -> None:
    study = heuncli.solve(SCENE | {"analysis": MOTION})
    before = study.load_cases("upper", "0.05")
    for one in (before.body.center, before.body.inertia, *(action.at for action in before.cases[0].actions)):
        one += 1.0
    same(study.load_cases("upper", "0.05"), heuncli.solve(SCENE | {"analysis": MOTION}).load_cases("upper", "0.05"))


def test_a_blow_with_the_name_of_a_force_is_a_blow() -> None:
    push = {"forces": {"blow": {"type": "force", "on": "lower.end", "vector": [0, 1, 0]}}, "analysis": MOTION}
    cases = heuncli.solve(SCENE | push).load_cases("lower", "first,impulse:blow").cases
    assert [next(one.kind for one in case.actions if one.name == "blow") for case in cases] == ["force", "impulse"]


def test_a_case_without_any_load_is_a_deck() -> None:
    """Of a body that nothing acts on Nastran's LOAD adds up a set all the same: without one it is no card."""
    body = {"mass": 1, "center": [0, 0, 0], "inertia": [1, 1, 1]}
    cases = heuncli.solve({"heun": 1, "bodies": {"idle": body}}).load_cases("idle", "first")
    deck = "".join(DECKS["nastran"].iter_text(cases, DeckNames(1001, "BODY")))
    load = deck[deck.index("LOAD* ") :].split()
    assert (
        load[1:6] == ["10", "1.0", "1.0", "12", "*"]
        and "GRAV*                 12               0             0.0" in deck
    )
