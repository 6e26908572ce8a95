"""Freedoms of trusses, by Maxwell's count with the rank of the rods' directions: spins of nodes and rods are none."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.shared.scenes import solved

SCENES = 12


def truss(rng: np.random.Generator, planar: bool) -> tuple[dict[str, Any], Array]:
    """Some point masses with rods between them and to three points of the ground; and the directions of the rods.

    The directions are the rows of the rigidity matrix (m, d n): how each rod's length changes with the nodes.
    """
    n, d = int(rng.integers(1, 5)), 2 if planar else 3
    places = rng.uniform(-1.0, 1.0, (n + 3, 3))
    places[:, d:] = 0.0
    bodies = {
        f"n{k}": {"shapes": [{"type": "point", "at": [0, 0, 0], "mass": 1.0}], "points": {"p": [0, 0, 0]},
                  "position": places[k].tolist()}
        for k in range(n)
    }  # fmt: skip
    ends = [(i, j) for i, j in combinations(range(n + 3), 2) if i < n]
    chosen = [ends[i] for i in sorted(rng.choice(len(ends), int(rng.integers(1, len(ends) + 1)), replace=False))]
    names = [f"n{k}.p" for k in range(n)] + [f"ground.g{k}" for k in range(3)]
    joints = {f"r{i}{j}": {"type": "rod", "from": names[i], "to": names[j]} for i, j in chosen}
    rows = np.zeros((len(chosen), n + 3, d))
    for row, (i, j) in zip(rows, chosen, strict=True):
        row[i] = places[i, :d] - places[j, :d]
        row[j] = -row[i]
    ground = {"points": {f"g{k}": places[n + k].tolist() for k in range(3)}}
    scene: dict[str, Any] = {"ground": ground, "bodies": bodies, "joints": joints}
    return scene | ({"space": "planar"} if planar else {}), rows[:, :n].reshape(len(chosen), d * n)


@pytest.mark.parametrize("planar", [False, True])
@pytest.mark.parametrize("seed", range(SCENES))
def test_a_truss_has_maxwells_freedoms(seed: int, planar: bool) -> None:
    """d n less the rank of the rods; what is left of the rods is redundant. Each node has d (d - 1)/2 idle spins."""
    scene, rows = truss(np.random.default_rng([seed, planar]), planar)
    model = solved(scene).model
    rank = int(np.linalg.matrix_rank(rows))
    assert (model["freedoms"], model["redundant"]) == (rows.shape[1] - rank, len(rows) - rank)
    assert model["undetermined"] == len(scene["bodies"]) * (1 if planar else 3)
    assert any(note.startswith(f"{model['undetermined']} undetermined spin") for note in model["notes"])


@pytest.mark.parametrize("n", [1, 2, 5])
def test_a_chain_of_thin_rods_has_two_freedoms_each(n: int) -> None:
    """A direction each, as beads on strings have; with some inertia about its axis a rod may spin, too."""
    for thin in (True, False):
        inertia = [0.08, 0.08, 0.0 if thin else 0.001]
        bodies = {
            f"b{k}": {"mass": 1.0, "center": [0, 0, -0.5], "inertia": inertia,
                      "points": {"top": [0, 0, 0], "end": [0, 0, -1]}, "position": [0, 0, -k]}
            for k in range(n)
        }  # fmt: skip
        joints = {
            f"j{k}": {"type": "ball", "from": f"b{k - 1}.end" if k else "ground.O", "to": f"b{k}.top"} for k in range(n)
        }
        scene = {"ground": {"points": {"O": [0, 0, 0]}}, "bodies": bodies, "joints": joints}
        model = solved(scene).model
        assert (model["freedoms"], model.get("undetermined", 0)) == ((2 * n, n) if thin else (3 * n, 0))
        assert model["grubler"] == 3 * n


def test_a_link_on_two_balls_has_no_freedom_of_its_own() -> None:
    """The massive coupler of a spatial four-bar turns about its own line; a thin one has none of that to count."""
    for thin, freedoms in ((True, 0), (False, 1)):
        inertia = [0.0 if thin else 0.001, 0.08, 0.08]
        scene: dict[str, Any] = {
            "ground": {"points": {"A": [0, 0, 0], "B": [1, 0, 0]}},
            "bodies": {"link": {"mass": 1.0, "center": [0.5, 0, 0], "inertia": inertia,
                                "points": {"a": [0, 0, 0], "b": [1, 0, 0]}}},
            "joints": {"a": {"type": "ball", "from": "ground.A", "to": "link.a"},
                       "b": {"type": "line", "from": "ground.B", "to": "link.b", "axis": [1, 0, 0]}},
        }  # fmt: skip
        assert solved(scene).model["freedoms"] == freedoms
