"""`heun import` as a command: what it writes where, with which exit code, and what it leaves alone."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.shared.folders import ROOT

ARM = (ROOT / "specs" / "arm.urdf").read_text()
RUBBED = ARM.replace('damping="0.8"', 'damping="0.8" friction="0.1"')


@pytest.fixture
def arm(folder: Path) -> Path:
    """A robot in the folder of the command."""
    for name, text in {"arm": ARM, "rubbed": RUBBED, "wrong": ARM.replace('link="base"', 'link="bas"')}.items():
        (folder / f"{name}.urdf").write_text(text)
    return folder / "arm.urdf"


@pytest.mark.usefixtures("arm")
def test_a_pipe_runs_what_is_imported(heun):
    made = heun("import", "arm.urdf")
    assert made.returncode == 0 and not made.stderr
    assert made.stdout.startswith("# heun run arm.yaml\n")
    told = heun("run", "-", "--measure", "max joints.elbow.drive", "--set", "elbow=60 deg", text=made.stdout)
    # (1.9 * 0.15 + 2 * 0.08 * 0.35) * g * cos(60 deg), about -y
    assert float(told.stdout) == pytest.approx(-(1.9 * 0.15 + 2 * 0.08 * 0.35) * 9.81 / 2, rel=1e-13)


def test_the_first_line_runs_what_was_written(heun, arm):
    done = heun("import", "arm.urdf", "-o", "robots of mine.yaml")
    assert done.returncode == 0 and not done.stdout
    assert "heun: robots of mine.yaml written" in done.stderr
    first = arm.with_name("robots of mine.yaml").read_text().splitlines()[0]
    assert first == "# heun run 'robots of mine.yaml'"
    assert heun("run", "robots of mine.yaml").returncode == 0


def test_standard_input_is_read(heun):
    made = heun("import", "-", text=ARM)
    assert made.stdout.startswith("# heun run robot.yaml\n") and "from standard input, URDF" in made.stdout


@pytest.mark.usefixtures("arm")
def test_the_model_is_not_written_over(heun, arm):
    done = heun("import", "arm.urdf", "-o", "arm.urdf")
    assert done.returncode == 2 and "would overwrite the model itself" in done.stderr
    assert arm.read_text() == ARM


@pytest.mark.usefixtures("arm")
def test_strict_writes_nothing_where_something_is_left_out(heun, folder):
    easy = heun("import", "rubbed.urdf")
    assert easy.returncode == 0 and 'friction="0.1" is left out [import-left-out]' in easy.stderr
    assert '# Left out:\n# - joint shoulder: friction="0.1" is left out\n' in easy.stdout
    assert not heun("import", "rubbed.urdf", "--quiet").stderr
    strict = heun("import", "rubbed.urdf", "--strict", "-o", "r.yaml")
    assert strict.returncode == 1 and not strict.stdout and not (folder / "r.yaml").exists()


@pytest.mark.usefixtures("arm")
def test_what_is_wrong_leaves_with_2_and_writes_nothing(heun, folder):
    done = heun("import", "wrong.urdf", "-o", "w.yaml")
    assert done.returncode == 2 and not done.stdout and not (folder / "w.yaml").exists()
    assert "wrong.urdf:38:3: joint shoulder: its parent 'bas' is not a link [import-tree]" in done.stderr
    assert "did you mean base?" in done.stderr


@pytest.mark.usefixtures("arm")
@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("--base", "fix"), "accepted: fixed, free"),
        (("--limits",), "cannot reach a stop"),
        (("--density", "heavy"), "--density"),
        (("--density", "7 kN"), "--density"),
        (("--density", "-1"), "more than 0"),
        (("--density", "0"), "more than 0"),
        (("--repair", "triangel"), "did you mean triangle?"),
        (("--repair", ""), "accepted: massless, negative"),
    ],
)
def test_options_that_mean_nothing_are_refused(heun, words, told):
    done = heun("import", "arm.urdf", *words)
    assert done.returncode == 2 and told in done.stderr and not done.stdout


def test_files_that_are_not_there(heun):
    assert heun("import", "none.urdf").returncode == 2
    assert heun("import", ".").returncode == 2


@pytest.mark.usefixtures("arm")
def test_a_density_has_a_unit(heun, folder):
    text = ARM.replace(
        '<link name="flange"/>',
        '<link name="flange"><visual><geometry><sphere radius="0.02"/></geometry></visual></link>',
    )
    (folder / "ball.urdf").write_text(text)
    made = heun("import", "ball.urdf", "--density", "2.7 g/cm^3")
    assert "{type: sphere, center: [0, 0, 0], radius: 0.02, density: 2700}" in made.stdout


def test_products_beyond_what_is_computed_with_are_told(heun):
    far = ARM.replace('<mass value="4"/>', '<mass value="1e40"/>').replace(
        '<origin xyz="0 0 0.1"/>', '<origin xyz="0 0 1e20"/>'
    )
    done = heun("import", "-", "--repair", "zero", text=far)
    assert done.returncode == 2 and "[magnitude]" in done.stderr
