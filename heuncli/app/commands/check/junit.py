"""Render a JUnit report for Jenkins and GitLab: a suite per spec, a case per expectation, and one case for solving
it.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import PurePath

from heuncli.app.commands.check.results import CheckResult, format_failure
from heuncli.output.snapshots.outcomes import Outcome

FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # what XML 1.0 cannot hold


def render_junit(results: Sequence[CheckResult], orphans: Sequence[str], strict: bool) -> str:
    """Render the report as XML."""
    suites = ET.Element("testsuites", {"name": "heun check"})
    for result in results:
        suites.append(_make_suite(result))
    if orphans:
        suites.append(_make_orphan_suite(orphans, strict))
    totals = {key: sum(int(suite.get(key, "0")) for suite in suites) for key in ("tests", "failures", "errors")}
    for key, total in totals.items():
        suites.set(key, str(total))
    suites.set("time", f"{sum(result.seconds for result in results):.3f}")
    ET.indent(suites, " ")
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(suites, encoding="unicode") + "\n"


def _make_suite(result: CheckResult) -> ET.Element:
    """Make the suite of a spec: that it was solved, and each of its outcomes."""
    name = PurePath(result.path).with_suffix("").as_posix()
    cases = [_make_solve_case(result, name), *(_make_case(result, name, outcome) for outcome in result.outcomes)]
    return _make_counted_suite(
        {"name": _format_path(result.path), "file": _format_path(result.path), "time": f"{result.seconds:.3f}"}, cases
    )


def _make_counted_suite(attributes: dict[str, str], cases: Sequence[ET.Element]) -> ET.Element:
    """Make a suite of cases, with the numbers of failures, errors and skipped cases."""
    suite = ET.Element("testsuite", attributes | {"tests": str(len(cases))})
    for key, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(key, str(sum(case.find(tag) is not None for case in cases)))
    suite.extend(cases)
    return suite


def _make_solve_case(result: CheckResult, name: str) -> ET.Element:
    """Make the case that says whether the spec could be solved."""
    line = next((problem.location.line for problem in result.problems if problem.location is not None), 1)
    case = _make_element(name, "solves", result.path, line, result.seconds)
    if result.error:
        text = "\n".join(map(str, result.problems))
        message = result.problems[0].message if result.problems else "not solved"
        ET.SubElement(case, "error", {"type": result.problems[0].code if result.problems else "error",
                                      "message": escape_forbidden(message)}).text = escape_forbidden(text)  # fmt: skip
    return case


def _make_case(result: CheckResult, name: str, outcome: Outcome) -> ET.Element:
    """Make the test case of an outcome."""
    case = _make_element(name, outcome.name, result.path, outcome.line, 0.0)
    if outcome.is_skipped:
        ET.SubElement(case, "skipped", {"message": escape_forbidden(outcome.failure or "")})
    elif outcome.failure is not None and not outcome.is_warning:
        failure = ET.SubElement(case, "failure", {"type": outcome.kind, "message": escape_forbidden(outcome.failure)})
        failure.text = escape_forbidden(format_failure(outcome))
    elif outcome.failure is not None:
        ET.SubElement(case, "system-out").text = escape_forbidden(format_failure(outcome))
    return case


def _make_orphan_suite(orphans: Sequence[str], strict: bool) -> ET.Element:
    """Make the suite of the golden files without a spec: failures with --strict, else skipped."""
    cases = []
    for path in orphans:
        case = _make_element("golden", path, path, 1, 0.0)
        message = "a golden file without a spec"
        if strict:
            ET.SubElement(case, "failure", {"type": "golden", "message": message}).text = message
        else:
            ET.SubElement(case, "skipped", {"message": message})
        cases.append(case)
    return _make_counted_suite({"name": "golden files without a spec", "time": "0.000"}, cases)


def _make_element(classname: str, name: str, file: str, line: int, seconds: float) -> ET.Element:
    """Make a test case, still without result."""
    attributes = {
        "classname": escape_forbidden(classname),
        "name": escape_forbidden(name),
        "file": _format_path(file),
        "line": str(line),
    }
    return ET.Element("testcase", attributes | {"time": f"{seconds:.3f}"})


def _format_path(path: str) -> str:
    """Format a path for a report, without a leading ./."""
    return escape_forbidden(PurePath(path).as_posix())


def escape_forbidden(text: str) -> str:
    """Escape characters that XML cannot hold, as Python does."""
    return FORBIDDEN.sub(lambda found: f"\\x{ord(found[0]):02x}", text)
