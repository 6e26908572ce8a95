"""What `heun plot` refuses: in one line, with a hint, and nothing is written."""

from __future__ import annotations

from pathlib import Path

import pytest

from heuncli.app.cli.options import list_fields
from heuncli.app.commands.plot.command import COMMON_OPTIONS, KINDS
from heuncli.app.commands.plot.request import PlotRequest
from heuncli.output.drawing import drawing_files
from tests.shared.command import HANGING, Heun

SECTIONED = (
    HANGING.replace(
        "mass: m, center: [0, 0, -0.5], inertia: [0.08, 0.08, 0.001]",
        "shapes: [{type: rod, from: [0, 0, 0], to: [0, 0, -1], mass: m}]",
    ).replace("points: {top: [0, 0, 0]}", "points: {top: [0, 0, 0], end: [0, 0, -1]}")
    + """\
sections: {along: {body: bar, from: top, to: end, count: 5}}
"""
)
PATH = "joints.pivot.force"
TWO = HANGING.replace("{type: ball,", "{type: pin, axis: [0, 1, 0],") + "analysis: {duration: 0.1, samples: 3}\n"
TURNED = TWO + "forces: {f: {type: torque, joint: pivot, value: t}}\n"
PUSHED = TWO + "forces: {f: {type: actuator, from: {body: ground, at: [1, 0, 0]}, to: bar.top, value: t}}\n"
REFUSED = [
    ((PATH,), "no spec is given"),
    (("hanging.yaml",), "no quantity or kind of plot is given"),
    (("hanging.yaml", ""), "an empty argument"),
    (("", PATH), "no spec is given"),
    ((".", PATH), "this is a folder"),
    (("missing.yaml", PATH), "file not found"),
    (("hanging.yaml", "joints.pivo.force"), "did you mean pivot?"),
    (("hanging.yaml", "scen"), "did you mean scene?"),
    (("hanging.yaml", "model.freedoms"), "does not vary with time"),
    (("hanging.yaml", "bodies.bar.rotation"), "9 numbers"),
    (("hanging.yaml", "title"), "is text, not a number"),
    (("hanging.yaml", PATH, "scene"), "one kind of plot at a time"),
    (("hanging.yaml", "sweep.csv", PATH), "specs and sweeps cannot share one plot"),
    (("sectioned.yaml", "sections.along", PATH), "one kind of plot at a time"),
    (("sectioned.yaml", "sections.along.M1"), "5 numbers"),
    (("sectioned.yaml", "sections.along.deflection.w2"), "sections.along has no deflection.w2"),
    (("hanging.yaml", "energy.kinetic", "--axes", "to"), "--axes to has no effect on energy.kinetic"),
    (("swinging.yaml", "polar", "foundation", "--axes", "to"), "--axes to has no effect on foundation.force"),
    (("hanging.yaml", "modes", "--units", "mm"), "--units has no effect on mode shapes"),
    (("turned.yaml", "pushed.yaml", PATH, "--x", "forces.f.value"), "'moment' in turned, 'force' in pushed"),
    (("hanging.yaml", PATH, "--at", "0"), "--at has no effect on numbers over time"),
    (("sectioned.yaml", "sections.along", "--x", "time"), "--x has no effect on section diagrams"),
    (("hanging.yaml", PATH, "--tension-side"), "--tension-side has no effect"),
    (("hanging.yaml", PATH, "--case", "all"), "the spec has no load cases"),
    (("hanging.yaml", PATH, "--case", "cold"), "no load case 'cold'"),
    (("hanging.yaml", PATH, "--units", "furlong"), "not a unit"),
    (("hanging.yaml", PATH, "--x", "joints.pivot.forc"), "did you mean"),
    (("hanging.yaml", PATH, "--with", "bench.csv"), "expected FILE:X:Y"),
    (("hanging.yaml", PATH, "--with", "none.csv:t:F"), "it contains no row of numbers"),
    (("hanging.yaml", PATH, "--with", "gone.csv:t:F"), "file not found"),
    (("hanging.yaml", PATH, "--with", ".:t:F"), "this is a folder"),
    (("hanging.yaml", PATH, "--with", "bench.csv:t:G"), "there is no column 'G'"),
    (("hanging.yaml", PATH, "--with", "bench.csv:F:t"), "is a force, but the axis shows a time"),
    (("hanging.yaml", PATH, "--with", "bench.csv:t:w"), "'late' in column 3 is not a number"),
    (("hanging.yaml", PATH, "--with", "bench.csv:1:9"), "give a number from 1 to 3"),
]


@pytest.fixture
def files(folder: Path) -> Path:
    (folder / "sectioned.yaml").write_text(SECTIONED)
    (folder / "none.csv").write_text("t,F\n")
    (folder / "turned.yaml").write_text(TURNED)
    (folder / "pushed.yaml").write_text(PUSHED)
    (folder / "bench.csv").write_text("t [ms],F [kN],w\n0,1,2\n1,2,late\n")
    return folder


@pytest.mark.parametrize(("words", "said"), REFUSED)
def test_it_is_told_in_one_line_and_nothing_is_written(
    heun: Heun, files: Path, words: tuple[str, ...], said: str
) -> None:
    done = heun("plot", *words, "-o", "picture.svg")
    first, *more = done.stderr.splitlines()
    assert done.returncode == 2 and done.stdout == "" and not (files / "picture.svg").exists()
    assert said in done.stderr and first.endswith("]") and all(line.startswith("  hint: ") for line in more)


@pytest.mark.parametrize("name", ["x.bmp", "x", "", ".svg.gz"])
def test_other_forms_of_pictures_are_refused(heun: Heun, files: Path, name: str) -> None:
    done = heun("plot", "hanging.yaml", PATH, "-o", name)
    assert done.returncode == 2 and "accepted file extensions: .svg, .png, .pdf" in done.stderr


def test_without_matplotlib_it_is_said_how_to_install_it(
    heun: Heun, files: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing_files.importlib.util, "find_spec", lambda name: None)
    monkeypatch.setattr(drawing_files, "CONVERTERS", ())
    done = heun("plot", "hanging.yaml", PATH, "-o", "x.png")
    assert done.returncode == 2 and "heuncli[plot]" in done.stderr and not (files / "x.png").exists()


def test_a_width_is_of_letters(heun: Heun, files: Path) -> None:
    assert (
        "--width applies to text drawings" in heun("plot", "hanging.yaml", PATH, "--width", "90", "-o", "x.svg").stderr
    )
    assert "expected 40 to 400" in heun("plot", "hanging.yaml", PATH, "--width", "9").stderr


def test_a_spec_is_not_written_over(heun: Heun, files: Path) -> None:
    (files / "scene.svg").write_text((files / "hanging.yaml").read_text())
    done = heun("plot", "scene.svg", PATH, "-o", "scene.svg")
    assert done.returncode == 2 and (files / "scene.svg").read_text() == HANGING


def test_every_option_is_heeded_by_some_kind_of_picture() -> None:
    heeded = {field for kind in KINDS.values() for field in kind.options} | set(COMMON_OPTIONS)
    assert heeded == {field.name for field in list_fields(PlotRequest)}
