"""A JUnit report, as Jenkins and GitLab read it: a suite a spec, a case an expectation, and one that says it solves."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import PurePath

from heuncli.app.commands.check.checked import Checked
from heuncli.app.commands.check.told import words
from heuncli.output.snapshots.outcomes import Outcome

FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # what XML 1.0 cannot hold


def junit_text(checked: Sequence[Checked], orphans: Sequence[str], strict: bool) -> str:
    """The report."""
    suites = ET.Element("testsuites", {"name": "heun check"})
    for one in checked:
        suites.append(_suite(one))
    if orphans:
        suites.append(_of_orphans(orphans, strict))
    totals = {key: sum(int(suite.get(key, "0")) for suite in suites) for key in ("tests", "failures", "errors")}
    for key, total in totals.items():
        suites.set(key, str(total))
    suites.set("time", f"{sum(one.seconds for one in checked):.3f}")
    ET.indent(suites, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(suites, encoding="unicode") + "\n"


def _suite(one: Checked) -> ET.Element:
    name = PurePath(one.path).with_suffix("").as_posix()
    cases = [_solves(one, name), *(_case(one, name, outcome) for outcome in one.outcomes)]
    return _counted({"name": _place(one.path), "file": _place(one.path), "time": f"{one.seconds:.3f}"}, cases)


def _counted(given: dict[str, str], cases: Sequence[ET.Element]) -> ET.Element:
    """A suite of cases, with how many of them failed."""
    suite = ET.Element("testsuite", given | {"tests": str(len(cases))})
    for key, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(key, str(sum(case.find(tag) is not None for case in cases)))
    suite.extend(cases)
    return suite


def _solves(one: Checked, name: str) -> ET.Element:
    """The case that says whether it could be solved."""
    line = next((problem.location.line for problem in one.problems if problem.location is not None), 1)
    case = _element(name, "solves", one.path, line, one.seconds)
    if one.error:
        told = "\n".join(map(str, one.problems))
        message = one.problems[0].message if one.problems else "not solved"
        ET.SubElement(case, "error", {"type": one.problems[0].code if one.problems else "error",
                                      "message": legible(message)}).text = legible(told)  # fmt: skip
    return case


def _case(one: Checked, name: str, outcome: Outcome) -> ET.Element:
    case = _element(name, outcome.name, one.path, outcome.line, 0.0)
    if outcome.skipped:
        ET.SubElement(case, "skipped", {"message": legible(outcome.failure or "")})
    elif outcome.failure is not None and not outcome.warned:
        found = ET.SubElement(case, "failure", {"type": outcome.kind, "message": legible(outcome.failure)})
        found.text = legible(words(outcome))
    elif outcome.failure is not None:
        ET.SubElement(case, "system-out").text = legible(words(outcome))
    return case


def _of_orphans(orphans: Sequence[str], strict: bool) -> ET.Element:
    cases = []
    for path in orphans:
        case = _element("golden", path, path, 1, 0.0)
        told = "a golden file without a spec"
        if strict:
            ET.SubElement(case, "failure", {"type": "golden", "message": told}).text = told
        else:
            ET.SubElement(case, "skipped", {"message": told})
        cases.append(case)
    return _counted({"name": "golden files without a spec", "time": "0.000"}, cases)


def _element(classname: str, name: str, file: str, line: int, seconds: float) -> ET.Element:
    given = {"classname": legible(classname), "name": legible(name), "file": _place(file), "line": str(line)}
    return ET.Element("testcase", given | {"time": f"{seconds:.3f}"})


def _place(path: str) -> str:
    """A path as those who read a report look for it: without a ./ before it."""
    return legible(PurePath(path).as_posix())


def legible(text: str) -> str:
    """The text with what XML cannot hold written as it is in Python."""
    return FORBIDDEN.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
