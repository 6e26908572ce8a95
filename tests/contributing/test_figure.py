"""A figure is a row, the function that draws it, and a figure made of panels and items."""

from __future__ import annotations

from pathlib import Path

from tests.contributing.addition import Addition, after, heun

MASSES = Addition(
    "A figure",
    {
        "heuncli/app/commands/plot/command.py": (
            after('    "sweep": FigureKind("sweep", "sweeps", ("units",)),\n',
                  '    "masses": FigureKind("masses", "masses of bodies", SCENE_OPTIONS),\n'),
        ),
    },
    {
        "heuncli/app/commands/plot/masses.py": '''"""The masses of the bodies of a spec."""

from __future__ import annotations

from heuncli.app.commands.plot.request import PlotRequest
from heuncli.app.commands.plot.sources import PlotTarget, load_specs, require_no_paths
from heuncli.output.drawing.figure import Figure
from heuncli.output.figures.masses import make_masses_figure


def draw_masses(target: PlotTarget, request: PlotRequest) -> Figure:
    """Draw the figure of the first spec."""
    require_no_paths(target)
    return make_masses_figure(load_specs(target.files, request)[0][1])
''',
        "heuncli/output/figures/masses.py": '''"""The masses of bodies as bars."""

from __future__ import annotations

import numpy as np

from heuncli.output.drawing.figure import Bars, Figure, Panel, Scaling
from heuncli.scene.file_format.models import Spec


def make_masses_figure(spec: Spec) -> Figure:
    """Make the figure: a bar for each body."""
    masses = np.array([body.mass for body in spec.bodies.values()])
    places = np.arange(1.0, len(masses) + 1.0)
    ticks = tuple(zip(places.tolist(), spec.bodies, strict=True))
    bars = Bars("mass", places, masses)
    panel = Panel(Scaling("body", 0.5, len(masses) + 0.5, tick_texts=ticks), Scaling("[kg]", 0.0, 1.1 * masses.max()),
                  (bars,))
    return Figure("Masses of the bodies", (f"{masses.sum():g} kg in all",), (panel,))
''',
        "bars.yaml": """\
heun: 1
bodies:
  light: {mass: 2, center: [0, 0, 0], inertia: [1, 1, 1]}
  heavy: {mass: 5, center: [0, 0, 0], inertia: [1, 1, 1]}
""",
    },
)  # fmt: skip


def test_a_figure(tmp_path: Path) -> None:
    """It is drawn in letters and as a file, and takes the options of its row, no others."""
    MASSES.made_in(tmp_path)
    drawn = heun(tmp_path, "plot", "bars.yaml", "masses", "--set", "bodies.light.mass=3")
    assert drawn.returncode == 0, drawn.stderr
    assert "Masses of the bodies" in drawn.stdout and "8 kg in all" in drawn.stdout
    assert "light" in drawn.stdout and "heavy" in drawn.stdout
    done = heun(tmp_path, "plot", "bars.yaml", "masses", "-o", "masses.svg")
    assert done.returncode == 0, done.stderr
    assert "7 kg in all" in (tmp_path / "masses.svg").read_text(encoding="utf-8")
    refused = heun(tmp_path, "plot", "bars.yaml", "masses", "--at", "0")
    assert refused.returncode == 2 and "no effect on masses of bodies" in refused.stderr


def test_its_list() -> None:
    assert MASSES.is_as_listed()
