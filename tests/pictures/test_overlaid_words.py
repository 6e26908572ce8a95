"""Pictures of several specs: titles of all, and of which of them what stands along a bar is."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.shared.command import Heun
from tests.shared.plotted import texts_of

BEAM = """\
heun: 1
title: beam of {length}
gravity: [0, -9.81, 0]
ground: {{points: {{A: [0, 0, 0]}}}}
bodies:
  b: {{shapes: [{{type: rod, from: [0, 0, 0], to: [{length}, 0, 0], mass: 2}}], points: {{a: [0, 0, 0],
       e: [{length}, 0, 0]}}}}
joints: {{root: {{type: weld, from: ground.A, to: b.a}}}}
forces: {{push: {{type: force, on: b.e, vector: [0, -1, 0]}}}}
sections: {{beam: {{body: b, from: a, to: e, count: 5}}}}
"""


@pytest.fixture
def beams(heun: Heun, folder: Path) -> Heun:
    for name, length in (("short", 1), ("twin", 1), ("long", 3)):
        (folder / f"{name}.yaml").write_text(BEAM.format(length=length))
    return heun


def words(beams: Heun, *files: str) -> list[str]:
    done = beams("plot", *files, "sections.beam", "-o", "drawn.svg")
    assert done.returncode == 0
    return texts_of(Path("drawn.svg").read_text())


def test_bars_that_differ_have_their_own_names(beams: Heun) -> None:
    found = words(beams, "short.yaml", "long.yaml")
    assert found[0] == "beam of 1 · beam of 3"
    assert {"beam: short", "beam: long", "1 m", "3 m"} <= set(found) and found.count("push") == 2


def test_bars_that_agree_share_them(beams: Heun) -> None:
    found = words(beams, "short.yaml", "twin.yaml")
    assert found[0] == "beam of 1" and {"root", "push"} <= set(found)
