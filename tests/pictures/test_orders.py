"""The orders of a cycle as bars, read back against the JSON of `heun balance`."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as tree
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from heuncli.output.drawing.style import find_pen
from tests.shared.command import Heun
from tests.shared.plotted import SVG, PlottedPanel, panels_of, points_of, texts_of

SPECS = Path(__file__).parents[2] / "specs"
CRANK, ENGINE = str(SPECS / "slider_crank.yaml"), str(SPECS / "engine.yaml")
LAST = 7  # of the orders that tables of these two show


def bars(panel: PlottedPanel) -> list[float]:
    """How high the bars of a panel are, from the left."""
    areas = [points_of(e) for e in panel.root.iter(f"{SVG}polygon") if e.findtext(f"{SVG}title")]
    return [float(panel.y.values(points[:, 1].min())) for points in areas if panel.holds(points)]


def label_of(panel: PlottedPanel) -> str:
    """What stands along the axis upwards of a panel."""
    upright = (e for e in panel.root.iter(f"{SVG}text") if e.get("transform"))
    return next(e.text or "" for e in upright if panel.top <= float(e.get("y", 0)) <= panel.bottom)


def reach(row: dict[str, Any]) -> float:
    """The largest magnitude of an order over a turn, looked for at many angles."""
    turn = np.linspace(0.0, 2.0 * np.pi, 3601)[:, None]
    values = np.array(row["amplitude"]) * np.cos(turn - np.array(row["phase"]))
    return float(np.sqrt((values**2).sum(axis=1)).max())


@pytest.mark.parametrize("spec", [CRANK, ENGINE])
def test_bars_are_as_high_as_the_orders(heun: Heun, spec: str) -> None:
    assert heun("plot", spec, "balance", "-o", "drawn.svg").returncode == 0
    found = json.loads(heun("balance", spec, "--format", "json").stdout)
    text = Path("drawn.svg").read_text()
    panels = panels_of(text)
    present = [rows for rows in found["harmonics"].values() if any(reach(row) > 0.0 for row in rows)]
    assert len(panels) == len(present)
    for panel, rows in zip(panels, present, strict=True):
        sizes = {row["order"]: reach(row) for row in rows}
        shown = [size for order, size in sizes.items() if size > 0.0 and order in range(1, LAST + 1)]
        scale = 1e3 if "[k" in label_of(panel) else 1.0
        assert scale * np.array(bars(panel)) == pytest.approx(np.array(shown), abs=scale * abs(panel.y.step))


def test_of_what_goes_round_it_is_the_radius(heun: Heun) -> None:
    heun("plot", str(SPECS / "rotor.yaml"), "balance", "-o", "drawn.svg")
    panel = panels_of(Path("drawn.svg").read_text())[0]
    assert bars(panel) == pytest.approx([0.02 * 0.04 * (100.0 * np.pi) ** 2], abs=abs(panel.y.step))


def test_the_words_are_those_of_the_tables(heun: Heun) -> None:
    heun("plot", CRANK, "balance", "-o", "drawn.svg")
    words = "\n".join(texts_of(Path("drawn.svg").read_text()))
    table = heun("balance", CRANK).stdout
    assert "force: orders 1, 2 (along x) and 4 (along x) remain" in words
    assert "orders 1, 2 (along x) and 4 (along x) remain" in re.sub(r"\s+", " ", table)
    assert "about O = (0, 0, 0) m" in words and "one revolution of the main angle" in words


def test_save_draws_the_same_and_counterweights_beside_it(heun: Heun) -> None:
    heun("plot", CRANK, "balance", "-o", "one.svg")
    heun("balance", CRANK, "--save", "two.svg")
    assert Path("one.svg").read_bytes() == Path("two.svg").read_bytes()
    heun("balance", CRANK, "--counterweight", "crank.main", "--save", "three.svg", "-o", "three.json")
    left = json.loads(Path("three.json").read_text())["left"]["harmonics"]["force"]
    panel = panels_of(Path("three.svg").read_text())[0]
    remaining = [e for e in tree.parse("three.svg").iter(f"{SVG}polygon") if e.get("fill") == find_pen(1).colour]
    first = next(points for e in remaining if panel.holds(points := points_of(e)))
    scale = 1e3 if "[k" in label_of(panel) else 1.0
    assert scale * panel.y.values(first[:, 1].min()) == pytest.approx(reach(left[0]), abs=scale * abs(panel.y.step))


def test_units_and_refusals(heun: Heun) -> None:
    heun("plot", CRANK, "balance", "--units", "kN,mm", "-o", "drawn.svg")
    words = texts_of(Path("drawn.svg").read_text())
    assert "force [kN]" in words and "torque [kN·mm]" in words
    for more, why in [(("joints.main",), "draws the whole model"), (("--view", "x"), "--view")]:
        done = heun("plot", CRANK, "balance", *more, "-o", "other.svg")
        assert done.returncode == 2 and why in done.stderr and not Path("other.svg").exists()
    done = heun("plot", str(SPECS / "door.yaml"), "balance", "-o", "other.svg")
    assert done.returncode == 3 and "no-cycle" in done.stderr and not Path("other.svg").exists()
