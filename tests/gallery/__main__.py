"""`python -m tests.gallery OUT [--only KIND,...]`: all that a client sees, drawn into a folder, with an index.html.

OUT gets pictures as SVG and PNG, moving pages as HTML and PNG, reports as HTML, PDF and one long PNG;
findings.txt lists what tests/gallery/checks.py finds in them. Kinds: those of tests/gallery/contents.py (scene,
history, sections, polar, modes, balance, sweep, chart), page, report. PNG, PDF and findings of pages need a Chromium.
"""

from __future__ import annotations

import argparse
import html
import io
import shlex
import sys
import time
from contextlib import redirect_stdout
from pathlib import Path
from typing import NamedTuple

from heuncli.app.cli.entry import enter
from tests.gallery.checks import Finding, find_in_document, find_in_svg, keep_canvas_words
from tests.gallery.contents import PAGES, PICTURES, REPORTS, Page, Picture, Report, find_spec
from tests.shared.chromium import Chromium, Tab, found

SHEET = (794, 1123)  # A4 at 96 pixels an inch
LONGEST = 16_000  # pixels of a screenshot


class Drawn(NamedTuple):
    """What was made of a row: its files by their endings, its seconds and bytes, what is wrong in it."""

    name: str
    kind: str
    files: tuple[Path, ...]
    seconds: float
    size: int
    findings: list[Finding]


def draw_picture(row: Picture, folder: Path, browser: Chromium | None) -> Drawn:
    """Draw a picture as SVG and PNG."""
    target = folder / f"{row.name}.svg"
    spec = str(find_spec(row.spec))
    if row.before:
        target.with_suffix(".sqlite").unlink(missing_ok=True)
        run(row.before.format(spec=spec, target=target.with_suffix("")))
        spec = str(target.with_suffix(".sqlite"))
    option = "-o" if row.command == "plot" else "--save"
    seconds = run(f"{row.command} {spec} {row.words} {option} {target}")
    files = (target, *(shoot_svg(browser, target) if browser else ()))
    return Drawn(row.name, row.kind, files, seconds, target.stat().st_size, find_in_svg(target.read_text()))


def draw_page(row: Page, folder: Path, browser: Chromium | None) -> Drawn:
    """Write a moving page, and photograph it in its window at one of its frames."""
    target = folder / f"{row.name}.html"
    seconds = run(f"show {find_spec(row.spec)} {row.words} -q -o {target}")
    findings, files = [], [target]
    if browser:
        tab = browser.tab(width=row.width, height=row.height, dark=row.dark)
        keep_canvas_words(tab)
        tab.go(target.resolve().as_uri())
        tab.evaluate(f"(e => (e.value = Math.round({row.frame}*e.max), e.dispatchEvent(new Event('input'))))(time)")
        files.append(photograph(tab, target.with_suffix(".png"), row.width, row.height))
        findings = find_in_document(tab)
        browser.send("Target.closeTarget", targetId=tab.target)
    return Drawn(row.name, "page", tuple(files), seconds, target.stat().st_size, findings)


def draw_report(row: Report, folder: Path, browser: Chromium | None) -> Drawn:
    """Write a report, print it, and photograph it as wide as a sheet."""
    target = folder / f"{row.name}.html"
    seconds = run(f"report {find_spec(row.spec)} {row.words} -q -o {target}")
    findings, files = [], [target]
    if browser:
        with browser.open(target, width=SHEET[0], height=SHEET[1]) as tab:
            findings = find_in_document(tab)
            files.append(target.with_suffix(".pdf"))
            files[-1].write_bytes(tab.pdf())
            height = min(int(tab.evaluate("document.documentElement.scrollHeight")), LONGEST)
            files.append(photograph(tab, target.with_suffix(".png"), SHEET[0], height))
    return Drawn(row.name, "report", tuple(files), seconds, target.stat().st_size, findings)


def run(words: str) -> float:
    """Run a command in this process; returns its seconds. Raises RuntimeError where it fails."""
    begun = time.perf_counter()
    with redirect_stdout(io.TextIOWrapper(io.BytesIO())):
        code = enter(tuple(shlex.split(words)))
    if code:
        raise RuntimeError(f"heun {words}: exit code {code}")
    return time.perf_counter() - begun


def shoot_svg(browser: Chromium, svg: Path) -> tuple[Path]:
    """Photograph a picture at its own size."""
    with browser.open(svg, width=1000, height=700) as tab:
        width, height = tab.evaluate("(b => [b.width, b.height])(document.documentElement.getBoundingClientRect())")
        return (photograph(tab, svg.with_suffix(".png"), round(width), round(height)),)


def photograph(tab: Tab, target: Path, width: int, height: int) -> Path:
    """Write a PNG of a window of a size."""
    tab.sized(width, height)
    target.write_bytes(tab.seen().png)
    return target


def write_index(folder: Path, drawn: list[Drawn]) -> None:
    """Write index.html and findings.txt."""
    items, lines = [], []
    for row in drawn:
        links = " ".join(f'<a href="{file.name}">{file.suffix[1:]}</a>' for file in row.files)
        shown = next((file.name for file in row.files if file.suffix == ".png"), row.files[0].name)
        found_here = "".join(f"<li>{html.escape(str(finding))}</li>" for finding in row.findings)
        items.append(
            f"<h2>{html.escape(row.name)}</h2><p>{links} {row.seconds:.2f} s, {row.size / 1e3:.0f} kB, "
            f'{len(row.findings)} findings</p><img src="{shown}" loading="lazy"><ul>{found_here}</ul>'
        )
        lines += [f"{row.name}: {finding}" for finding in row.findings]
    style = "<style>body{font:14px sans-serif;margin:2em}img{max-width:100%;border:1px solid #ccc}</style>"
    head = f'<!doctype html><meta charset="utf-8"><title>Gallery</title>{style}'
    (folder / "index.html").write_text(head + "".join(items))
    (folder / "findings.txt").write_text("".join(f"{line}\n" for line in lines))


def main(words: list[str]) -> int:
    """Draw the gallery."""
    parser = argparse.ArgumentParser(prog="python -m tests.gallery", description="All that a client sees, in a folder.")
    parser.add_argument("out", type=Path)
    parser.add_argument("--only", default="", help="kinds, separated by commas")
    asked = parser.parse_args(words)
    kinds = set(filter(None, asked.only.split(",")))
    asked.out.mkdir(parents=True, exist_ok=True)
    path = found()
    browser = Chromium(path) if path else None
    makers = {Picture: draw_picture, Page: draw_page, Report: draw_report}
    drawn = []
    for row in (*PICTURES, *PAGES, *REPORTS):
        kind = getattr(row, "kind", type(row).__name__.lower())
        if not kinds or kind in kinds:
            drawn.append(makers[type(row)](row, asked.out, browser))  # type: ignore[operator]
            print(f"{row.name}: {drawn[-1].seconds:.2f} s, {len(drawn[-1].findings)} findings", flush=True)
    write_index(asked.out, drawn)
    if browser:
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
