"""`heun plot --with FILE:X:Y`: columns, their units, in which panel they stand."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest

from heuncli.results.results import Array
from tests.shared.command import Heun
from tests.shared.drawn_panels import DrawnPanel, read
from tests.shared.plotted import SVG

FORCE, RATE = "joints.pivot.force", "bodies.bar.angular_velocity"
TEXT = "t [ms];F [kN];w/rpm;plain\n0;0,004;0;1\n250;0,006;-3;2\n500;0,008;4,5;3\n"


@pytest.fixture
def bench(folder: Path) -> Path:
    (folder / "bench.csv").write_text(TEXT)
    return folder


def drawn(heun: Heun, folder: Path, *words: str) -> list[DrawnPanel]:
    done = heun("plot", "swinging.yaml", *words, "-o", "x.svg")
    assert (done.returncode, done.stderr) == (0, "")
    return read((folder / "x.svg").read_text())


def squares(panel: DrawnPanel, folder: Path) -> Array:
    """The hollow marks of a panel, in its units: squares are polygons without a name."""
    shapes = ElementTree.parse(folder / "x.svg").getroot()
    found = []
    for shape in shapes.iter(f"{SVG}polygon"):
        if shape.get("fill") == "#ffffff" and not len(shape):
            found.append(np.mean([[float(x) for x in p.split(",")] for p in shape.get("points", "").split()], axis=0))
    return np.array(found)


@pytest.mark.parametrize("columns", ["t:F", "1:2", "t [ms]:F [kN]", "t:2", "t[ms]:2 [kN]", "1 [ms]:F[kN]", "1:F/kN"])
def test_columns_are_named_or_counted_and_have_their_units(heun: Heun, bench: Path, columns: str) -> None:
    (panel,) = drawn(heun, bench, FORCE, "--with", f"bench.csv:{columns}")
    at = squares(panel, bench)
    assert len(at) == 4  # one of them in the legend
    pixels = np.diff(at[1:], axis=0)
    assert pixels[:, 0] * panel.across == pytest.approx([0.25, 0.25], abs=panel.across)
    assert -pixels[:, 1] * panel.pixel == pytest.approx([2.0, 2.0], abs=panel.pixel)


def test_a_unit_that_the_file_does_not_say_is_said_with_the_column(heun: Heun, bench: Path) -> None:
    (panel,) = drawn(heun, bench, FORCE, "--with", "bench.csv:t:plain[kg m/s^2]")
    assert len(squares(panel, bench)) == 4 and panel.label == "force [N]"
    done = heun("plot", "swinging.yaml", FORCE, "--with", "bench.csv:t:F[N]")
    assert done.returncode == 2 and "column 'F [kN]' is in kN, not in N" in done.stderr


def test_they_stand_in_the_panel_of_their_kind(heun: Heun, bench: Path) -> None:
    panels = drawn(heun, bench, FORCE, RATE, "--with", "bench.csv:t:w", "--with", "bench.csv:t:plain")
    at = squares(panels[0], bench)
    lower = [y for _, y in at if y > 300.0]
    assert [panel.label for panel in panels] == ["force [N]", "angular velocity [rad/s]"] and len(lower) == 3
    step = np.diff(lower) * -panels[1].pixel
    assert step == pytest.approx(np.array([-3.0, 7.5]) * 2.0 * np.pi / 60.0, abs=panels[1].pixel)


def test_names_with_colons_and_slashes(heun: Heun, bench: Path) -> None:
    (bench / "a:b.csv").write_text(TEXT)
    assert len(squares(drawn(heun, bench, FORCE, "--with", "a:b.csv:t:F")[0], bench)) == 4


def test_many_points_are_a_line_with_all_their_peaks(heun: Heun, bench: Path) -> None:
    t = np.linspace(0.0, 1.0, 50_000)
    y = 9.0 + np.sin(300.0 * t)
    y[31_234] = 25.0
    (bench / "long.csv").write_text("t,F\n" + "".join(f"{a:.6f},{b:.6f}\n" for a, b in zip(t, y, strict=True)))
    (panel,) = drawn(heun, bench, FORCE, "--with", "long.csv:t:F")
    curve = panel.curve("long.csv: F")
    assert curve[:, 1].max() == pytest.approx(25.0, abs=panel.pixel) and len(curve) < 5000
    assert curve[curve[:, 1].argmax(), 0] == pytest.approx(t[31_234], abs=panel.across)


def test_over_an_angle_in_degrees(heun: Heun, bench: Path) -> None:
    (bench / "over.csv").write_text("speed [rpm],F [N]\n0,5\n10,6\n")
    (panel,) = drawn(heun, bench, FORCE, "--x", "bodies.bar.angular_velocity.x", "--with", "over.csv:speed:F")
    at = squares(panel, bench)
    assert (at[2] - at[1])[0] * panel.across == pytest.approx(10.0 * 2.0 * np.pi / 60.0, abs=panel.across)
