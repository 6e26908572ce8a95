"""What others wrote (titles, file names, cases) stands in pictures as text and nothing else."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import pytest

from heuncli.base.text_safety import escape
from tests.shared.command import HANGING, Heun
from tests.shared.plotted import SVG

TITLES = [
    "<script>alert(1)</script>", "a & b &amp; c", "\"quoted\" 'twice'", "]]> <!-- x -->", "\u202eright to left\u2066",
    "🛠️ é µ 漢字", "tab\there, bell\a", "x" * 500, "<svg onload=alert(1)>", "${1} {{2}} %s",
]  # fmt: skip
SHAPES = {"svg", "title", "desc", "rect", "polyline", "polygon", "text", "circle"}
PATH = "joints.pivot.force"


def tags(root: ElementTree.Element) -> set[str]:
    return {shape.tag.removeprefix(SVG) for shape in root.iter()}


def harmless(root: ElementTree.Element) -> bool:
    """Whether there is nothing in it that acts or fetches."""
    names = {name for shape in root.iter() for name in shape.attrib}
    return tags(root) <= SHAPES and not any(name.startswith("on") or "href" in name for name in names)


@pytest.mark.parametrize("title", TITLES)
def test_titles(heun: Heun, folder: Path, title: str) -> None:
    escaped = "".join(c if " " <= c <= "~" and c not in '"\\' else f"\\U{ord(c):08x}" for c in title)
    (folder / "named.yaml").write_text(HANGING.replace("A bar hangs at rest", f'"{escaped}"'))
    done = heun("plot", "named.yaml", PATH, "-o", "x.svg")
    assert (done.returncode, done.stderr) == (0, "")
    root = ElementTree.fromstring((folder / "x.svg").read_bytes())
    assert harmless(root) and root.findtext(f"{SVG}title") == escape(title)
    letters = heun("plot", "named.yaml", PATH).stdout
    assert letters.split("\n", 1)[0].startswith(escape(title)[:20])
    assert all(c == "\n" or c.isprintable() for c in letters)


@pytest.mark.parametrize("name", ["<b>&.yaml", "a'b\"c.yaml", "🛠️ 漢字.yaml", "\u202eabc.yaml", "-x.yaml"])
def test_file_names(heun: Heun, folder: Path, name: str) -> None:
    (folder / name).write_text(HANGING)
    done = heun("plot", "-o", "x.svg", "--", name, "hanging.yaml", PATH)
    assert (done.returncode, done.stderr) == (0, "")
    root = ElementTree.fromstring((folder / "x.svg").read_bytes())
    assert harmless(root)
    assert escape(name[:-5]) in [shape.text for shape in root.iter(f"{SVG}text")]


def test_headings_of_measured_columns(heun: Heun, folder: Path) -> None:
    (folder / "a.csv").write_text("t,<i>F&\n0,1\n")
    done = heun("plot", "hanging.yaml", PATH, "--with", "a.csv:t:<i>F&", "-o", "x.svg")
    assert (done.returncode, done.stderr) == (0, "")
    assert harmless(ElementTree.fromstring((folder / "x.svg").read_bytes()))
