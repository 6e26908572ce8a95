"""Names that are words of the output: a section called s, a joint called force, a body called open."""

from __future__ import annotations

import csv
import io
import json

import pytest

from heuncli.app.cli.entry import enter

WORDS = ["s", "side", "open", "about", "force", "moment", "kind", "line", "stress", "point", "supports", "x", "total"]


def scene() -> str:
    lines = ["heun: 1", "gravity: [0, 0, -9.81]", "bodies:"]
    for k, word in enumerate(WORDS):
        rod = f"{{type: rod, from: [0, {k}, 0], to: [1, {k}, 0], mass: 1}}"
        lines.append(f"  {word}: {{shapes: [{rod}], points: {{{word}: [0, {k}, 0], end: [1, {k}, 0]}}}}")
    lines.append("joints:")
    for k, word in enumerate(WORDS):
        lines.append(f"  {word}: {{type: weld, from: {{body: ground, at: [0, {k}, 0]}}, to: {word}.{word}}}")
    lines.append("forces:")
    for word in WORDS:
        lines.append(f"  {word}: {{type: force, on: {word}.end, vector: [0, 0, 1]}}")
    lines.append("sections:")
    for k, word in enumerate(WORDS):
        plane = f"from: [0, {k}, 0], to: [1, {k}, 0], count: 3" if k % 2 else f"at: [0.5, {k}, 0], normal: [1, 0, 0]"
        lines.append(f"  {word}: {{body: {word}, {plane}}}")
    return "\n".join([*lines, "analysis: {type: state}", ""])


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> str:
    found = tmp_path_factory.mktemp("names") / "names.yaml"
    found.write_text(scene(), encoding="utf-8")
    return str(found)


@pytest.mark.heavy
def test_every_form_holds_them(path: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", path]) == 0
    tables = capsys.readouterr()
    assert tables.err == ""
    assert all(f"\nsupport {word} " in tables.out for word in WORDS)
    assert enter(["run", path, "--format", "json"]) == 0
    found = json.loads(capsys.readouterr().out)
    for kind in ("bodies", "joints", "forces", "sections"):
        assert list(found[kind]) == WORDS
    assert enter(["run", path, "--format", "csv"]) == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    for kind in ("bodies", "joints", "sections"):
        assert {row["name"] for row in rows if row["kind"] == kind} == set(WORDS)
    assert enter(["run", path, "--format", "markdown"]) == 0
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("word", WORDS)
def test_each_can_be_measured(word: str, path: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert enter(["run", path, "--measure", f"joints.{word}.force.z"]) == 0
    assert float(capsys.readouterr().out.split()[-1]) == pytest.approx(8.81)
