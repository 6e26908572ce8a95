"""A tuning as plain data for JSON, and as the command line that solves the best variant by itself."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from typing import Any

from heuncli.analyses.tune.results import Leeway, Move, Reading, Trial, TrialOutcome, TuneResults, texts_at
from heuncli.analyses.variants.asking import Recipe
from heuncli.app.commands.tune.asked import AskedTuning
from heuncli.app.commands.tune.history import best_by
from heuncli.base.named_tuples import NamedTuple
from heuncli.version import VERSION


class TunedScene(NamedTuple):
    """What is tuned: the spec, and the line by which `heun run` gives the best variant's numbers."""

    title: str
    path: str
    sha256: str
    line: str


def line_to_paste(asked: AskedTuning, recipe: Recipe, found: TuneResults) -> str:
    """The command whose measures are those of the best variant, to the bit."""
    words = ["heun", "run", recipe.path]
    if recipe.case is not None:
        words += ["--case", recipe.case]
    for name, text in {**recipe.overrides, **found.texts}.items():
        words += ["--set", f"{name}={text}"]
    if recipe.options.tolerance is not None:
        words += ["--tolerance", repr(recipe.options.tolerance)]
    if not recipe.options.reduce:
        words += ["--no-reduce"]
    for text in (asked.goal, *(one.measure for one in asked.conditions)):
        words += ["--measure", text]
    return shlex.join(words)


def block(found: TuneResults, scene: TunedScene) -> dict[str, Any]:
    """All of it."""
    task, best = found.task, found.best
    assert best is not None
    goal = task.goal
    return {
        "title": scene.title,
        "spec": {"path": scene.path, "sha256": scene.sha256},
        "version": VERSION,
        "ended": found.ending,
        "converged": found.ending == "converged",
        "feasible": found.feasible,
        "goal": {
            "measure": goal.measure, "unit": goal.unit, "kind": "maximise" if goal.greatest else "minimise",
            "before": reading(found.own, 0), "best": reading(best.outcome, 0), "gain": found.gain, "floor": found.floor,
        },
        "variables": [variable(found, which) for which in range(len(task.variables))],
        "constraints": [constraint(found, which) for which in range(len(task.constraints))],
        "set": found.texts,
        "command": scene.line,
        "evaluations": len(found.history),
        "allowed": task.most,
        "seed": task.seed,
        "unsolved": dict(found.failures),
        "history": [trial_of(found, trial, best) for trial, best in zip(found.history, best_by(found), strict=True)],
    }  # fmt: skip


def variable(found: TuneResults, which: int) -> dict[str, Any]:
    """One variable; its moves: how far down and up until the goal is worse by the floor, by a hundredth."""
    one = found.task.variables[which]
    assert found.best is not None
    told: dict[str, Any] = {
        "name": one.name, "unit": one.unit, "low": one.low, "high": one.high, "before": one.own,
        "value": one.value(found.best.place[which]), "active": found.at_bound(which) or None,
    }  # fmt: skip
    freedom = found.freedoms[which] if found.freedoms else Leeway()
    told["moves"] = {"floor": [*map(move, freedom.of_floor)], "hundredth": [*map(move, freedom.of_hundredth)]}
    return told


def move(one: Move | None) -> dict[str, Any] | None:
    """How far, and until what."""
    return None if one is None else {"by": one.by, "until": one.until}


def constraint(found: TuneResults, which: int) -> dict[str, Any]:
    """One constraint; left: to its limit, negative where that is passed."""
    one = found.task.constraints[which]
    assert found.best is not None
    best = reading(found.best.outcome, which + 1)
    value = found.best.kept_to[which]
    return {
        "measure": one.measure, "sign": one.sign, "limit": one.limit, "unit": one.unit,
        "before": reading(found.own, which + 1), "best": best, "left": -one.excess(value), "met": one.met(value),
        "active": found.active[which],
    }  # fmt: skip


def reading(outcome: TrialOutcome, which: int) -> dict[str, Any] | None:
    """A measure; None where the variant could not be solved."""
    if not outcome.readings:
        return {"code": outcome.code, "reason": outcome.reason}
    one: Reading = outcome.readings[which]
    told: dict[str, Any] = {"value": one.value, "error": one.error, "at": one.at}
    return told | ({"word": one.word} if one.word else {})


def trial_of(found: TuneResults, trial: Trial, best: float | None) -> dict[str, Any]:
    """A variant that was tried, and the best so far."""
    values: Mapping[str, str] = texts_at(found.task.variables, trial.place)
    told: dict[str, Any] = {"number": trial.number, "phase": trial.phase, "set": values}
    if trial.solved:
        told |= {"goal": trial.goal, "constraints": list(trial.kept_to)}
    else:
        told |= {"goal": None, "code": trial.failure[0]}
    return told | {"best": best}
