"""The title block, the paper and the chapters: from options, else from the spec; and decimal commas everywhere."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from heuncli.output.documents.document import OutputDocument, use_decimal_comma, write_decimal_comma
from tests.shared.command import Heun
from tests.shared.folders import SPECS
from tests.shared.page_reader import PageReader

LOGO = '<svg xmlns="http://www.w3.org/2000/svg" width="4" height="4"><rect width="4" height="4"/></svg>'
SETTINGS = """
report: {company: Muster & Sons, project: Car 12, author: E. X. Ample, revision: B.2, part: 4711-02, logo: logo.svg,
  chapters: [loads, accuracy]}
"""
POINT = re.compile(r"(?<![\w.])\d+\.\d+(?![\w.])")


def test_the_spec_fills_the_title_block_and_options_go_first(heun: Heun, folder: Path) -> None:
    (folder / "logo.svg").write_text(LOGO)
    (folder / "own.yaml").write_text((folder / "hanging.yaml").read_text() + SETTINGS)
    read = PageReader(heun("report", "own.yaml", "-o", "-").stdout)
    assert read.by_tag["span"] == ["Muster & Sons", "Car 12"]
    assert {"4711-02", "B.2", "E. X. Ample", "own.yaml"} <= set(read.by_tag["dd"])
    assert [link for link in read.links if link.startswith("data:image/svg+xml;base64,")]
    assert [text.partition("\u2002")[2] for text in read.by_tag["h2"]] == ["Loads", "Accuracy of the results"]
    other = PageReader(heun("report", "own.yaml", "-o", "-", "--revision", "C", "--chapters", "model").stdout)
    assert "C" in other.by_tag["dd"] and "B.2" not in other.by_tag["dd"]
    assert [text.partition("\u2002")[2] for text in other.by_tag["h2"]] == ["The model"]


@pytest.mark.parametrize(
    ("words", "size"),
    [
        ((), "A4 portrait"),
        (("--paper", "letter"), "letter portrait"),
        (("--landscape",), "A4 landscape"),
        (("--paper", "letter", "--landscape"), "letter landscape"),
    ],
)
def test_the_paper(words: tuple[str, ...], size: str, heun: Heun) -> None:
    assert f"size: {size};" in heun("report", "hanging.yaml", "-o", "-", *words).stdout


@pytest.mark.parametrize("form", ["html", "md"])
@pytest.mark.third
def test_decimal_commas_in_text_tables_and_figures(form: str, heun: Heun) -> None:
    words = ("report", str(SPECS / "jib.yaml"), "-o", "-", "--format", form, "-q", "--author", "Part 1.5")
    plain, comma = heun(*words).stdout, heun(*words, "--decimal-comma").stdout
    if form == "html":
        read, other = PageReader(comma), PageReader(plain)
        assert read.rows != other.rows
        assert [[use_decimal_comma(cell) for cell in row] for row in other.rows] == read.rows
        assert not [text for text in read.by_tag["text"] if POINT.search(text)]
        assert len([text for text in other.by_tag["text"] if POINT.search(text)]) > 3
        assert "Part 1.5" in read.by_tag["dd"]  # what the user says stays
    else:
        assert len(POINT.findall(comma)) < 0.05 * len(POINT.findall(plain))
    assert "jib.yaml" in comma


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("−33.04 kN at 0.0188 s", "−33,04 kN at 0,0188 s"),
        ("(0.1, 0, -2.5) mm", "(0,1; 0; -2,5) mm"),
        ("NumPy 2.4.6, 29.11.2026, part1.5x, x.1.yaml", "NumPy 2.4.6, 29.11.2026, part1.5x, x.1.yaml"),
        ("1.5e-9", "1,5e-9"),
    ],
)
def test_which_points_are_decimal(text: str, expected: str) -> None:
    assert use_decimal_comma(text) == expected


@pytest.mark.heavy
@pytest.mark.parametrize("spec", ["engine", "axle_loads", "press"])
@pytest.mark.third
def test_every_cell_of_the_summary_is_measured(spec: str, heun: Heun) -> None:
    """The greatest load is what --measure finds, to the digits shown."""
    path = str(SPECS / f"{spec}.yaml")
    read = PageReader(heun("report", path, "-o", "-", "-q").stdout)
    head = next(k for k, row in enumerate(read.rows) if row[:2] == ["", "greatest"])
    heads = read.rows[head]
    checked = 0
    for row in read.rows[head + 1 :]:
        if len(row) != len(heads):
            break
        cells = dict(zip([*heads[:2], "unit", *heads[3:]], row, strict=True))
        name = row[0].removeprefix("joint ").replace(" ", "_")
        quantity = "foundation.force" if name == "foundation" else f"joints.{name}.force"
        if name not in ("foundation", *joints_of(heun, path)):
            continue
        case = ("--case", cells["case"].replace(" ", "_")) if cells.get("case", "base model") != "base model" else ()
        told = json.loads(
            heun("run", path, *case, "-q", "--format", "json", "--measure", f"max {quantity}").stdout
        )  # fmt: skip
        factor = {"N": 1.0, "kN": 1e-3, "MN": 1e-6}[cells["unit"]]
        assert close(cells["greatest"], factor * told["value"]), row
        assert told.get("at") is None or close(cells["at [s]"], told["at"]) if "at [s]" in cells else True
        checked += 1
    assert checked >= 2


def joints_of(heun: Heun, path: str) -> set[str]:
    """The names of the joints of a spec."""
    told = json.loads(heun("model", path, "--format", "json").stdout)
    return set(told["names"]["joints"])


def close(text: str, number: float) -> bool:
    """Whether a number is written so, rounded to the digits that are written."""
    digits = len(text.partition(".")[2])
    return abs(float(text.replace("−", "-")) - number) <= 0.5000001 * 10.0**-digits


def test_facts_have_decimal_commas() -> None:
    assert write_decimal_comma(OutputDocument(facts=[("mass", "1.5 kg")])).facts == [("mass", "1,5 kg")]
