"""`heuncli.report` writes the file of `heun report`, and refuses what that refuses."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import pytest

import heuncli
from tests.shared.command import HANGING, SPEC_TEXTS, Heun
from tests.shared.folders import SPECS

CRANE = SPECS / "crane.yaml"
SVG = '<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><rect width="4" height="4"/></svg>'
CASES = HANGING + "cases: {light: {set: {m: 1}}, heavy: {set: {m: 5}}}\n"


def report(*arguments: Any, **options: Any) -> bool:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", heuncli.HeunWarning)
        return heuncli.report(*arguments, **options)


@pytest.mark.parametrize(
    ("name", "options", "words"),
    [
        ("x.html", {}, []),
        (
            "x.md",
            {"chapters": ["spec", "loads"], "decimal_comma": True},
            ["--chapters", "spec,loads", "--decimal-comma"],
        ),
        (
            "x.txt",
            {"format": "html", "paper": "letter", "landscape": True, "units": "kN,mm", "title": "Other", "date": "May"},
            ["--format", "html", "--paper", "letter", "--landscape", "--units", "kN,mm", "--title", "Other", "--date",
             "May"],
        ),
        (
            "x.html",
            {"set": {"gravity": "[0, 0, -1.6]"}, "tolerance": 1e-7, "reduce": False, "least_norm": True,
             "company": "A", "project": "B", "part": "C", "revision": "D", "author": "E"},
            ["--set", "gravity=[0, 0, -1.6]", "--tolerance", "1e-7", "--no-reduce", "--least-norm", "--company", "A",
             "--project", "B", "--part", "C", "--revision", "D", "--author", "E"],
        ),
    ],
)  # fmt: skip
@pytest.mark.third
def test_the_file_is_that_of_the_command(
    name: str, options: dict[str, Any], words: list[str], heun: Heun, tmp_path: Path
) -> None:
    own, theirs = tmp_path / name, tmp_path / f"command_{name}"
    if "set" in options:  # a list in Python, its text at the command line
        options = options | {"set": {"gravity": [0, 0, -1.6]}}
    done = heun("report", str(CRANE), "-o", str(theirs), *words, "-q")
    assert report(CRANE, own, **options) is (done.returncode == 0), done.stderr
    assert own.read_bytes() == theirs.read_bytes() != b""


def test_cases_labels_and_logo(heun: Heun, tmp_path: Path) -> None:
    spec, logo = tmp_path / "a.yaml", tmp_path / "logo.svg"
    spec.write_text(CASES)
    logo.write_text(SVG)
    words = ("--case", "heavy,light", "--label", "joints.pivot=The pivot", "--logo", str(logo))
    center = ("--set", "bodies.bar.center=[0, 0, -1]")
    done = heun("report", str(spec), "-o", str(tmp_path / "b.html"), *words, *center)
    assert done.returncode == 0, done.stderr
    options = {"labels": {"joints.pivot": "The pivot"}, "logo": logo, "set": {"bodies.bar.center": [0, 0, -1]}}
    for case in ("heavy,light", ["heavy", "light"]):
        report(spec, tmp_path / "a.html", case=case, **options)
        assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()
    assert "The pivot" in (tmp_path / "a.html").read_text()


def test_it_tells_whether_expectations_are_met(tmp_path: Path) -> None:
    for name, is_met in (("expecting", True), ("failing", False)):
        assert report(None, tmp_path / "x.md", text=SPEC_TEXTS[name]) is is_met
        assert (tmp_path / "x.md").exists()


def test_warnings_are_those_of_solving(tmp_path: Path) -> None:
    with pytest.warns(heuncli.HeunWarning) as solving:
        heuncli.solve(text=SPEC_TEXTS["unsound"], only="joints")
    with pytest.warns(heuncli.HeunWarning) as reporting:
        heuncli.report(None, tmp_path / "x.md", text=SPEC_TEXTS["unsound"])
    assert [str(each.message) for each in solving] == [str(each.message) for each in reporting]
    assert {each.filename for each in reporting} == {__file__}


@pytest.mark.parametrize(
    ("output", "options", "message"),
    [
        ("x.doc", {}, "unknown file extension"),
        ("-", {}, "expected a file name"),
        ("x.html", {"format": "rtf"}, "--format rtf"),
        ("x.html", {"paper": "a3"}, "paper a3: expected a4, letter"),
        ("x.html", {"chapters": "load"}, "there is no such chapter"),
        ("x.html", {"case": "full"}, "there is no such load case"),
        ("x.html", {"units": "furlong"}, "furlong"),
        ("x.html", {"time_limit": -1.0}, "time_limit"),
        ("x.html", {"logo": "none.svg"}, "logo"),
        ("x.html", {"chapter": "loads"}, "did you mean the option chapters"),
    ],
)
def test_what_the_command_refuses_is_refused(
    output: str, options: dict[str, Any], message: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(heuncli.HeunError) as caught:
        report(None, output, text=HANGING, **options)
    assert message in "\n".join(f"{each.message} {each.hint}" for each in caught.value.problems)
    assert not [*tmp_path.iterdir()]


def test_nothing_overwrites_the_spec(tmp_path: Path) -> None:
    spec = tmp_path / "spec.md"
    spec.write_text(HANGING)
    with pytest.raises(heuncli.UsageError, match="would overwrite the spec itself"):
        report(spec, spec)
    assert spec.read_text() == HANGING


def test_a_mapping_has_no_text_to_print(tmp_path: Path) -> None:
    with pytest.raises(heuncli.UsageError, match="prints the text of its spec"):
        report({"heun": 1}, tmp_path / "x.html")
