"""Random expectations: of paths that a run's results have or nearly have, with values right, nearly right and absurd.

Where an expectation is right by the run itself, or wrong by it, `heun check` must say so: 0 or 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from random import Random
from typing import Any

from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve
from tests.faults import sources
from tests.faults.mutate_spec import EXTREMES, OTHER_TYPES, misspelt
from tests.faults.random_expressions import random_expression

NO_NUMBERS = (
    "heun",
    "title",
    "spec",
    "version",
    "model",
    "status",
    "work",
    "warnings",
    "accuracy",
    "time",
    "certain_sums",
)
NOTHING = 1e-45  # in SI: what is smaller, or a part of it, may be smaller than what a spec may hold
OFF = 1e-3  # of what is told: no rounding, and no error of these motions, is as large


@cache
def results(name: str) -> dict[str, Any]:
    """What a run of a spec tells, as its JSON."""
    import json
    import tempfile
    from pathlib import Path

    from heuncli.output.tables.export import to_json

    with tempfile.TemporaryDirectory() as folder:
        for table, content in sources.tables().items():
            (Path(folder) / table).write_bytes(content)
        path = Path(folder) / "spec.yaml"
        path.write_bytes(sources.text({key: value for key, value in sources.tree(name).items() if key != "expect"}))
        told: dict[str, Any] = json.loads(to_json(solve(load(str(path)), Options()).results))
    return told


@cache
def numbers(name: str) -> tuple[tuple[str, Any], ...]:
    """Paths of a spec's results that run over the instants, each with its values."""
    told = results(name)
    return tuple(pair for block, value in told.items() if block not in NO_NUMBERS for pair in _paths(block, value))


def _paths(path: str, value: Any) -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for key, inner in value.items():
            if key not in ("open", "chosen", "side", "shares", "s", "about"):
                yield from _paths(f"{path}.{key}", inner)
    elif isinstance(value, list) and path.split(".")[0] not in ("impulses", "events"):
        yield path, value


def random_expectation(random: Random) -> tuple[sources.Tree, frozenset[int] | None]:
    """A spec with one expectation, or several, and the exit codes that `check` may leave with: None if any."""
    name = random.choice(sources.names())
    tree = sources.tree(name)
    right = random.choice((True, False, None, None))
    if right is None:
        tree["expect"] = [_absurd(random, name) for _ in range(random.choice((1, 1, 3)))]
        return tree, None
    item = _item(random, name, right)
    tree["expect"] = [item] if item else []
    return tree, frozenset({0 if right or not item else 1})


def _item(random: Random, name: str, right: bool) -> dict[str, Any]:
    """An expectation at an instant that holds, or does not; {} where a number there is open, or rounding."""
    path, values = random.choice(numbers(name))
    instants = results(name)["time"]
    k = random.randrange(len(instants))
    value = values[k]
    if isinstance(value, list) and value and random.random() < 0.7:
        i = random.randrange(len(value))
        path, value = f"{path}.{i}", value[i]
    flat = list(_flat(value))
    if not flat or None in flat or any(0.0 < abs(number) < NOTHING for number in flat) or not any(flat):
        return {}
    size = max(map(abs, flat))
    at = {"at": instants[k]} if len(instants) > 1 else {}
    if right:
        return {"of": path, **at, "is": value, "rel": 1e-6, "abs": 1e-6 * size}
    return {"of": path, **at, "is": _moved(value, OFF * size), "rel": 1e-9, "abs": 1e-9 * size}


def _flat(value: Any) -> Iterator[Any]:
    if isinstance(value, list):
        for inner in value:
            yield from _flat(inner)
    else:
        yield value


def _moved(value: Any, by: float) -> Any:
    return [_moved(inner, by) for inner in value] if isinstance(value, list) else value + by


def _absurd(random: Random, name: str) -> dict[str, Any]:
    """An expectation that somebody may have written all the same."""
    path, values = random.choice(numbers(name))
    path = random.choice((
        path, path, f"{path}.x", f"{path}.0", f"{path}.99", f"{path}.-1", f"{path}.0.0.0", misspelt(random, path),
        path.split(".")[0],
        "impulses.0.time", "impulses.99.energy_jump", "events.x.time", "certain_sums.0.value", "accuracy.horizon",
        "time", "work.steps",
        "model.freedoms", "title", "", ".", "..", "0", path.rpartition(".")[0], path.upper(), f"{path}.", f" {path}",
    ))  # fmt: skip
    item: dict[str, Any] = {"of": path}
    for _ in range(random.choice((0, 1, 1, 2, 3))):
        key = random.choice(("at", "peak", "is", "below", "above", "rel", "abs", "is", "below", "tolerance", "of"))
        item[key] = _value(random, key, values)
    return item


def _value(random: Random, key: str, values: Any) -> Any:
    if key == "peak":
        return random.choice(("max", "min", "abs", "mean", True, 0))
    usual: tuple[Any, ...] = (
        0,
        0.1,
        0.2,
        1,
        -1,
        1e9,
        values,
        values[0],
        values[:1],
        None,
        [0, 0, 0],
        [[0], [0, 1]],
        "1 N",
        "1 mm",
    )
    return random.choice(
        (*usual, *usual, random.choice(EXTREMES), random.choice(OTHER_TYPES), random_expression(random))
    )
