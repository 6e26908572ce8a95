"""Tables and CSV of loads by cause: columns add up to the total, extremes say who is responsible, digits are honest."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest

from heuncli.app.cli.entry import enter
from heuncli.output.documents.document import NumberCell, OutputTable, format_cell
from heuncli.output.tables.export import to_csv
from heuncli.output.tables.page import Page, make_page
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.queries.study import Study
from heuncli.study.workflow import solve
from tests.shared.folders import SPECS

WANTED = frozenset({"foundation", "joints", "sections", "shares"})


def study_of(name: str) -> tuple[Study, Page]:
    spec = load(str(SPECS / f"{name}.yaml"))
    made = solve(spec, Options(requested_reports=WANTED))
    return made, make_page(made.results, make_labels(spec), made.magnitudes)


def by_cause(tables: list[OutputTable]) -> list[OutputTable]:
    return [table for table in tables if "BY CAUSE" in table.heading]


def rows_of(table: OutputTable) -> list[dict[str, str]]:
    """The cells of every line as they are printed, by the heads of their columns."""
    heads = ["label", "unit", *(column.head for column in table.columns[2:])]
    rows = (row for row in table.rows if not isinstance(row, str))
    return [dict(zip(heads, map(format_cell, row), strict=True)) for row in rows]


@pytest.mark.heavy
def test_extremes_say_who_is_responsible() -> None:
    """The shares at the instant of each extreme add up to it, in every row but for the last digit of each."""
    made, page = study_of("crane_load")
    extremes = made.search_extremes(page.make_search(), WANTED - {"shares"}, whole=True)
    tables = page.make_tables_of_extremes(extremes, made)
    found = by_cause(tables)
    assert [table.heading.split(" BY CAUSE")[0] for table in found] == [
        "FOUNDATION",
        "JOINTS",
        "SECTION along, body jib",
    ]
    for table in found:
        causes = [c.head for c in table.columns[3:-2]]
        assert causes == ["gravity", "wind", "drives", "motion"]
        for row in rows_of(table):
            decimals = max(len(row[c].partition(".")[2]) for c in [*causes, "total"])
            assert float(row["sum"]) == float(row["total"])
            off = abs(sum(float(row[c]) for c in causes) - float(row["total"]))
            assert off <= (len(causes) + 1) * 0.5 * 10.0**-decimals * (1.0 + 1e-9), row
    plain_tables = page.make_tables_of_extremes(extremes)
    assert by_cause(plain_tables) == []
    (joints,) = (table for table in plain_tables if table.heading.startswith("JOINTS"))
    assert {row[0] for row in joints.rows if not isinstance(row, str)} >= {"tension", "|F|"}  # and no shares among them


def test_one_instant_has_a_line_a_number_with_what_is_direct() -> None:
    made, page = study_of("door")
    found = by_cause(page.make_tables_at_instants(made.results, shares=made))
    base = {row["label"]: row for row in reversed(rows_of(found[0]))}  # the total stands before the supports
    assert float(base["Fz"]["gravity"]) == float(base["Fz direct"]["gravity"]) == -49.05
    assert base["Fz direct"]["total"] == ""
    for table in found:  # the numbers in the cells have all digits: shares add up to what is shared
        for row in (row for row in table.rows if not isinstance(row, str) and "direct" not in str(row[0])):
            *shares, total, whole = (cell.value for cell in row if isinstance(cell, NumberCell))
            assert sum(shares) == pytest.approx(total, rel=1e-12)
            assert total == pytest.approx(whole, rel=1e-9)
    assert [row["label"] for row in rows_of(found[1])] == ["Fx", "Fx"]
    assert [row.strip() for row in found[1].rows if isinstance(row, str) and "open" in row] == ["open: Fz, |F|"] * 2


@pytest.mark.heavy
def test_csv_has_a_column_cause_where_shares_are_told() -> None:
    made, _ = study_of("double")
    spec = made.spec
    rows = list(csv.DictReader(io.StringIO(to_csv(made.results, make_labels(spec)))))
    own = [row for row in rows if (row["kind"], row["name"], row["quantity"], row["component"]) ==
           ("joints", "elbow", "force", "z") and row["time"] == "0.5"]  # fmt: skip
    assert [row["cause"] for row in own] == ["", "gravity", "drives", "motion"]
    whole, *shares = (float(row["value"]) for row in own)
    assert sum(shares) == pytest.approx(whole, rel=1e-12)
    without = solve(spec, Options(requested_reports=WANTED - {"shares"})).results
    assert to_csv(without, make_labels(spec)).splitlines()[0] == "time,kind,name,quantity,component,unit,value"


def test_many_causes_are_told_together(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The smallest of more than nine share a column."""
    forces = "\n".join(f"  f{n}: {{type: force, on: bar.end, vector: [{n + 1}, 0, 0]}}" for n in range(12))
    path = tmp_path / "many.yaml"
    path.write_text(
        "heun: 1\nground: {points: {O: [0, 0, 0]}}\nbodies:\n  bar:\n    mass: 1\n    center: [0.5, 0, 0]\n"
        "    inertia: [0.1, 0.2, 0.2]\n    points: {end: [1, 0, 0], root: [0, 0, 0]}\n"
        f"joints: {{fast: {{type: weld, from: ground.O, to: bar.root}}}}\nforces:\n{forces}\n"
    )
    assert enter(["run", str(path), "--only", "joints", "--by-cause"]) == 0
    printed = capsys.readouterr().out
    (head,) = (line for line in printed.splitlines() if "others" in line)
    assert head.split() == ["f4", "f5", "f6", "f7", "f8", "f9", "f10", "f11", "7", "others", "sum", "total"]
    (line,) = (line for line in printed[printed.index("BY CAUSE") :].splitlines() if line.split()[:2] == ["Fx", "N"])
    assert [float(x) for x in line.split()[2:]] == [*(-float(n + 1) for n in range(4, 12)), -10.0, -78.0, -78.0]


def test_shares_alone_are_told_beside_all_three(capsys: pytest.CaptureFixture[str]) -> None:
    """--only shares; --only with one of them; nothing of it without being asked."""
    path = str(SPECS / "chimney.yaml")
    for words, blocks in ((["--only", "shares"], {"foundation", "joints", "sections"}),
                          (["--only", "joints,shares"], {"joints"}), (["--only", "joints", "--by-cause"], {"joints"}),
                          (["--only", "joints"], set())):  # fmt: skip
        assert enter(["run", path, "--format", "csv", *words]) == 0
        rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
        assert {row["kind"] for row in rows if row.get("cause")} == blocks


@pytest.mark.heavy
def test_a_share_can_be_measured_and_its_extremes_are_searched(capsys: pytest.CaptureFixture[str]) -> None:
    path = str(SPECS / "crane_load.yaml")
    answers = []
    for what in ("at 0 joints.rope.shares.motion.tension", "max joints.rope.shares.motion.tension",
                 "max abs sections.along.shares.gravity.M1", "max foundation.shares.wind.direct_force.x"):  # fmt: skip
        assert enter(["run", path, "--measure", what]) == 0
        answers.append(float(capsys.readouterr().out))
    assert answers[0] == pytest.approx(3000 * 12 * 0.15**2, rel=1e-9)
    assert answers[1] > answers[0]
    assert answers[2] == pytest.approx(4000 * 9.81 * 15 + 3400 * 9.81 * 15.8, rel=1e-9)  # where the load is plumb
    assert answers[3] == pytest.approx(900.0, rel=1e-12)


@pytest.mark.heavy
def test_shares_have_errors_of_their_own() -> None:
    made, page = study_of("crane_load")
    for kind in ("reactions", "foundation", "sections"):
        for unit in ("N", "N·m"):
            assert (f"{kind} by cause", unit) in made.magnitudes.errors
            assert np.isfinite(page.stated_errors.error_of(f"{kind} by cause", unit))


def test_couplings_are_told_by_cause(capsys: pytest.CaptureFixture[str]) -> None:
    """The fan's braking torque of up to 30 N m at its radius of 0.1 m; the driven acceleration does the rest."""
    assert enter(["run", str(SPECS / "belt_drive.yaml"), "--by-cause", "--only", "joints"]) == 0
    table = capsys.readouterr().out.partition("COUPLINGS BY CAUSE")[2]
    (line,) = (line for line in table.splitlines() if "force max" in line)
    assert line.split()[-4:] == ["300.000", "60.328", "360.328", "360.328"]
