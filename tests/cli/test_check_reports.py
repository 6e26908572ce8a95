"""What `heun check` tells a pipeline: JUnit, lines of a workflow, markdown; each read back by a reader of its own."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest
import xmlschema
from junitparser import Error, Failure, JUnitXml, Skipped

from heuncli.app.commands.check.junit import render_junit
from heuncli.app.commands.check.results import CheckResult
from heuncli.base.errors import Problem
from heuncli.output.snapshots.outcomes import MAX_OF_KIND, Annotation, Outcome, iter_lines
from tests.shared.command import HANGING, Heun

SCHEMA = xmlschema.XMLSchema(str(Path(__file__).with_name("junit.xsd")))
WILD = "50%, a::b,c:d\nx\r\ty \x1b[31m<&\"'> ü ￿\x00"  # what would end a message, steer a terminal, break XML
UNSOLVED = HANGING.replace("type: ball", "type: weld") + "expect:\n  - {of: joints.pivot.force.z, is: 1}\n"
LINE = re.compile(r"::(error|warning|notice)( [^:]*?)?::(.*)")  # a workflow command: its properties hold no colon


def parsed(line: str) -> tuple[str, dict[str, str], str]:
    """A workflow's line by its grammar: the kind, the properties, the message, decoded."""
    found = LINE.fullmatch(line)
    assert found is not None, line
    pairs = [pair.split("=", 1) for pair in (found[2] or "").strip().split(",") if pair]
    return found[1], {name: decoded(value) for name, value in pairs}, decoded(found[3])


def decoded(text: str) -> str:
    for code, letter in (("%2C", ","), ("%3A", ":"), ("%0A", "\n"), ("%0D", "\r"), ("%25", "%")):
        text = text.replace(code, letter)
    return text


def test_a_report_is_what_jenkins_and_gitlab_read(heun: Heun, folder: Path) -> None:
    """A suite a spec, the case that says it solves, one for each expectation; failure and error told apart."""
    done = heun("check", "expecting.yaml", "failing.yaml", "wrong.yaml", "--junit", "report.xml")
    assert done.returncode == 2
    SCHEMA.validate(str(folder / "report.xml"))
    suites = {suite.name: list(suite) for suite in JUnitXml.fromfile(str(folder / "report.xml"))}
    assert [*suites] == ["expecting.yaml", "failing.yaml", "wrong.yaml"]
    assert [case.name for case in suites["failing.yaml"]] == ["solves", "joints.pivot.force.z"]
    verdicts = {name: [[type(x) for x in case.result] for case in cases] for name, cases in suites.items()}
    assert verdicts == {"expecting.yaml": [[], []], "failing.yaml": [[], [Failure]], "wrong.yaml": [[Error]]}
    case = suites["failing.yaml"][1]
    assert (case._elem.get("file"), case._elem.get("line")) == ("failing.yaml", "11")
    assert "expected 9.7\nfound 9.81\nallowed 9.7e-09" in case.result[0].text


def test_what_was_not_solved_skips_its_expectations(heun: Heun, folder: Path) -> None:
    text = HANGING.replace("to: bar.top", "to: bar.top, initial: {angle: 1}").replace(
        "type: ball", "type: pin, axis: [1, 0, 0]"
    )
    (folder / "unclosed.yaml").write_text(
        text.replace("joints:\n", "joints:\n  other: {type: ball, from: {body: ground, at: [0, 0, 9]}, to: bar.top}\n")
        + "expect:\n  - {of: joints.pivot.force.z, is: 1}\n"
    )
    done = heun("check", "unclosed.yaml", "--junit", "report.xml")
    assert done.returncode == 3
    (suite,) = JUnitXml.fromfile(str(folder / "report.xml"))
    assert [[type(x) for x in case.result] for case in suite] == [[Error], [Skipped]]


def test_whatever_stands_in_names_and_words_stays_xml() -> None:
    outcomes = (Outcome("expect", WILD, WILD, expected_text=WILD), Outcome("golden", WILD, None))
    text = render_junit(
        [CheckResult(WILD, outcomes), CheckResult("b", problems=(Problem("bug", WILD),), error=70)], [WILD], True
    )
    SCHEMA.validate(text)
    first = next(iter(JUnitXml.fromstring(text.encode())))
    assert "\\x1b[31m<&\"'> ü" in [*first][1].name


@pytest.mark.parametrize("kind", ["error", "warning"])
def test_a_workflow_reads_back_what_was_said(kind: str) -> None:
    (line,) = iter_lines([Annotation(kind, WILD, WILD, "a,b:c%.yaml", 3, 5)])
    assert line.endswith("\n")
    found, properties, message = parsed(line[:-1])
    assert (found, properties["file"], properties["line"], properties["col"]) == (kind, "a,b:c%.yaml", "3", "5")
    visible = WILD.replace("\x1b", "\\u001b").replace("\x00", "\\u0000").replace("￿", "\\uffff").replace("\t", "\\t")
    assert (message, properties["title"]) == (visible, visible)


def test_a_step_shows_nine_of_a_kind_and_how_many_more_there_are() -> None:
    many = [Annotation(kind, "t", "m", "f") for kind in ("error", "warning") for _ in range(MAX_OF_KIND + 4)]
    made = [parsed(line.rstrip("\n")) for line in iter_lines(many)]
    for kind in ("error", "warning"):
        own = [message for found, _, message in made if found == kind]
        assert len(own) == MAX_OF_KIND + 1
        assert own[-1].startswith("4 more")


def test_failures_and_errors_as_lines_of_a_workflow(heun: Heun) -> None:
    done = heun("check", "expecting.yaml", "failing.yaml", "wrong.yaml", "--format", "github")
    made = [parsed(line) for line in done.stdout.splitlines()[:-1]]
    assert {(kind, properties["file"]) for kind, properties, _ in made} == {
        ("error", "failing.yaml"),
        ("error", "wrong.yaml"),
    }
    assert done.stdout.splitlines()[-1] == "3 specs, 1 check passed, 1 failed, 1 spec not solved"


def test_files_are_named_as_a_pipeline_finds_them(heun: Heun, folder: Path) -> None:
    (folder / "wrong.yaml").unlink()
    done = heun("check", ".", "--format", "github", "--junit", "report.xml", "-k", "failing")
    assert "::error file=failing.yaml,line=11" in done.stdout
    assert [suite.name for suite in JUnitXml.fromfile(str(folder / "report.xml"))] == ["failing.yaml"]


def test_markdown_for_the_summary_of_a_job(heun: Heun) -> None:
    done = heun("check", "expecting.yaml", "failing.yaml", "--format", "markdown")
    assert done.stdout.startswith("### heun check: failed\n\n2 specs, 1 check passed, 1 failed\n")
    assert "| failing.yaml:11 | joints.pivot.force.z |" in done.stdout


def test_what_is_written_whole_or_not_at_all(heun: Heun) -> None:
    done = heun("check", "expecting.yaml", "--junit", "nosuch/report.xml")
    assert (done.returncode, "[output-failed]" in done.stderr) == (5, True)


def test_json_has_every_case(heun: Heun) -> None:
    found = json.loads(heun("check", "expecting.yaml", "failing.yaml", "--format", "json").stdout)
    assert (found["passed"], found["failed"], len(found["cases"])) == (1, 1, 2)
