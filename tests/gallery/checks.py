"""What is wrong in a picture or on a page, found without eyes: a list of findings, each with its kind and its place.

`find_in_svg` reads the SVG of heun plot, whose text has no measured size: widths come from a table of letters. Chromium
measures what is on a page: `find_in_document` asks it for the boxes of all text and tables, and for the words that were
written on each canvas since it was last cleared.
"""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as tree
from collections.abc import Iterator, Sequence
from itertools import combinations, pairwise
from typing import NamedTuple

from heuncli.output.drawing.style import ENVELOPE_WIDTH, WIDTH
from tests.shared.chromium import Tab
from tests.shared.plotted import SVG, is_frame, points_of

WIDE, NARROW = "mwMWOQ%@─→", "iljtfrI.,:;|'!()[] "
SHARE = 0.12  # of the smaller one: what two boxes may share before it is seen
SHRUNK = 0.2  # of a box's height, on each side: a stroke beyond is a touch, not through the letters
FAINT = 0xD8  # each colour of a stroke that is paler is a grid line
SAMPLES = 60  # places along a side of a picture at which ink is looked for
PATH = re.compile(r"\b(?:joints|forces|coordinates|bodies|couplings|foundation|points|sections|energy|stops)\.\w+")
NOISE = re.compile(r"\d[eE][-−](?:[6-9]|\d\d)\b|\b0\.000\d+ (?!s\b)")
DIGITS = re.compile(r"(?<![\w.])[-−]?(\d+\.?\d*)(?:e[-−+]?\d+)?(?![\w.])")
LONG = re.compile(r"(?<![\w.])\d{6,}(?![\w.]*\.)")
FOLDER = re.compile(r"(?:^|\s)/[\w.-]+/[\w./-]+")
PREFIXES = {"k": 1e3, "M": 1e6}
CAPITALS, TEXT_WIDTH, LEAST_HEIGHT = 0.72, 178.0, 2.49  # of a face; of an A4 report [mm]; of letters on it [mm]
MOST_DIGITS = 5  # significant ones that a reader takes in


class Box(NamedTuple):
    """A rectangle with its words, in pixels."""

    left: float
    top: float
    right: float
    bottom: float
    words: str = ""
    has_halo: bool = False

    def shared(self, other: Box) -> float:
        """The share of the smaller of two boxes that lies in the other one."""
        across = min(self.right, other.right) - max(self.left, other.left)
        along = min(self.bottom, other.bottom) - max(self.top, other.top)
        if across <= 0.0 or along <= 0.0:
            return 0.0
        return across * along / max(min(self.size, other.size), 1e-9)

    @property
    def size(self) -> float:
        """Its area."""
        return (self.right - self.left) * (self.bottom - self.top)

    def shrunk(self) -> Box:
        """What of it the letters fill."""
        edge = SHRUNK * min(self.bottom - self.top, self.right - self.left)
        return Box(self.left + edge, self.top + edge, self.right - edge, self.bottom - edge, self.words)


class Finding(NamedTuple):
    """A fault: its kind, what it is, its place [pixels]."""

    kind: str
    what: str
    x: float
    y: float

    def __str__(self) -> str:
        """Return it as a line."""
        return f"{self.kind} at ({self.x:.0f}, {self.y:.0f}): {self.what}"


def find_in_svg(svg: str) -> list[Finding]:
    """Find all faults of a picture."""
    finders = (
        find_label_overlaps, find_struck_text, find_words_on_bands, find_text_outside, find_empty_thirds,
        find_unreadable_words, find_long_numbers, find_small_text,
    )  # fmt: skip
    return [finding for finder in finders for finding in finder(svg)]


def find_label_overlaps(svg: str) -> list[Finding]:
    """Find words that stand over words."""
    return list(_iter_overlaps(text_boxes(tree.fromstring(svg.encode()))))


def find_struck_text(svg: str) -> list[Finding]:
    """Find words through which a stroke goes: drawn after them, or before them where they have no halo.

    A sign (+, −) counts with a halo, too: on a line it is read as a part of that line.
    """
    root = tree.fromstring(svg.encode())
    strokes = [(k, points_of(e), e) for k, e in enumerate(root.iter()) if e.tag == f"{SVG}polyline" and is_dark(e)]
    order = {id(e): k for k, e in enumerate(root.iter())}
    found = []
    for element, box in zip(root.iter(f"{SVG}text"), text_boxes(root), strict=True):
        inner = box.shrunk()
        is_sign = box.words in ("+", "−", "-", "–")
        crossing = (
            k for k, points, _ in strokes
            if (k > order[id(element)] or not box.has_halo or is_sign)
            and any(crosses(inner, a, b) for a, b in pairwise(points.tolist()))
        )  # fmt: skip
        if next(crossing, None) is not None:
            found.append(Finding("struck", box.words, box.left, box.top))
    return found


def find_words_on_bands(svg: str) -> list[Finding]:
    """Find words that stand on the thin line of a band, with or without a halo: their letters cut the line."""
    root = tree.fromstring(svg.encode())
    lines = [points_of(e) for e in root.iter(f"{SVG}polyline") if float(e.get("stroke-width", 1)) == ENVELOPE_WIDTH]
    pieces = [(a, b) for points in lines for a, b in pairwise(points.tolist())]
    on_line = (box for box in text_boxes(root) if any(crosses(box.shrunk(), a, b) for a, b in pieces))
    return [Finding("band", box.words, box.left, box.top) for box in on_line]


def find_text_outside(svg: str) -> list[Finding]:
    """Find words that reach beyond the picture."""
    root = tree.fromstring(svg.encode())
    width, height = float(root.get("width", "nan")), float(root.get("height", "nan"))
    boxes = text_boxes(root)
    outside = (b for b in boxes if b.left < -1.0 or b.top < -1.0 or b.right > width + 1.0 or b.bottom > height + 1.0)
    return [Finding("outside", box.words, box.left, box.top) for box in outside]


def find_empty_thirds(svg: str) -> list[Finding]:
    """Find the thirds of a picture (left, middle, right; top to bottom) in which nothing is drawn or written."""
    root = tree.fromstring(svg.encode())
    width, height = float(root.get("width", "nan")), float(root.get("height", "nan"))
    places = list(_iter_ink(root))
    found = []
    for side, of, size in (("column", 0, width), ("row", 1, height)):
        for third in range(3):
            low, high = third * size / 3.0, (third + 1) * size / 3.0
            filled = {int(SAMPLES * (place[of] - low) / (high - low)) for place in places if low <= place[of] < high}
            if len(filled) < SAMPLES // 3:
                found.append(
                    Finding("empty", f"{side} {third + 1} of 3: ink in {len(filled)} of {SAMPLES} strips", low, 0)
                )
    return found


def find_unreadable_words(svg: str) -> list[Finding]:
    """Find paths in place of names, noise, numbers of too many digits, folders of a machine."""
    return [finding for box in text_boxes(tree.fromstring(svg.encode())) for finding in judge_words(box)]


def find_long_numbers(svg: str) -> list[Finding]:
    """Find numbers with more digits before the point than a reader takes in, as of 254256 N·mm."""
    boxes = text_boxes(tree.fromstring(svg.encode()))
    return [Finding("long", box.words, box.left, box.top) for box in boxes if LONG.search(box.words)]


def find_small_text(svg: str) -> list[Finding]:
    """Find letters that are lower than 2.5 mm on a sheet that is printed across its text."""
    root = tree.fromstring(svg.encode())
    sizes = [float(element.get("font-size", 0)) for element in root.iter(f"{SVG}text")]
    height = CAPITALS * TEXT_WIDTH / WIDTH
    boxes = zip(text_boxes(root), sizes, strict=True)
    return [Finding("small", box.words, box.left, box.top) for box, size in boxes if size * height < LEAST_HEIGHT]


def judge_words(box: Box) -> Iterator[Finding]:
    """Yield what is wrong in the words of a box."""
    numbers = (m[1] for m in DIGITS.finditer(box.words))
    long = [number for number in numbers if len(number.replace(".", "").lstrip("0")) > MOST_DIGITS and "." in number]
    kinds = {"path": PATH.search(box.words), "noise": NOISE.search(box.words), "folder": FOLDER.search(box.words)}
    for kind, is_found in {**kinds, "digits": bool(long)}.items():
        if is_found:
            yield Finding(kind, box.words, box.left, box.top)


def text_boxes(root: tree.Element) -> list[Box]:
    """The boxes of all text elements, in their order."""
    return [_text_box(element) for element in root.iter(f"{SVG}text")]


def text_width(words: str, size: float) -> float:
    """The width of words in a usual sans-serif face [pixels]."""
    return size * sum(0.85 if c in WIDE else 0.3 if c in NARROW else 0.54 for c in words)


def is_dark(element: tree.Element) -> bool:
    """Whether a stroke is seen: no grid line, no hair line, no frame."""
    colour = element.get("stroke", "#ffffff").lstrip("#")
    pale = all(int(colour[k : k + 2], 16) > FAINT for k in (0, 2, 4))
    return not pale and float(element.get("stroke-width", 1)) >= 0.5


def crosses(box: Box, a: Sequence[float], b: Sequence[float]) -> bool:
    """Whether a straight stroke meets a box: Liang and Barsky's clipping."""
    begin, end = 0.0, 1.0
    for start, step, low, high in ((a[0], b[0] - a[0], box.left, box.right), (a[1], b[1] - a[1], box.top, box.bottom)):
        if step == 0.0:
            if not low <= start <= high:
                return False
            continue
        near, far = sorted(((low - start) / step, (high - start) / step))
        begin, end = max(begin, near), min(end, far)
    return begin <= end


def _text_box(element: tree.Element) -> Box:
    """The box of a text element; a vertical one is read from below."""
    x, y, size = (float(element.get(name, 0)) for name in ("x", "y", "font-size"))
    words = "".join(element.itertext())
    width = text_width(words, size) * (1.08 if element.get("font-weight") else 1.0)
    begin = -{"start": 0.0, "middle": 0.5, "end": 1.0}[element.get("text-anchor", "start")] * width
    has_halo = element.get("paint-order") == "stroke"
    if "rotate" in element.get("transform", ""):
        return Box(x - 0.75 * size, y - begin - width, x + 0.2 * size, y - begin, words, has_halo)
    return Box(x + begin, y - 0.75 * size, x + begin + width, y + 0.2 * size, words, has_halo)


def _iter_overlaps(boxes: Sequence[Box]) -> Iterator[Finding]:
    """Yield the pairs of boxes of which one stands over the other."""
    for a, b in combinations(boxes, 2):
        if a.words and b.words and (share := a.shared(b)) > SHARE:
            yield Finding("overlap", f"{a.words!r} and {b.words!r}, {share:.0%}", b.left, b.top)


def _iter_ink(root: tree.Element) -> Iterator[tuple[float, float]]:
    """Yield places along all that is drawn, but for frames and grids."""
    for element in root.iter():
        if element.tag == f"{SVG}text":
            box = _text_box(element)
            yield from ((x, box.top) for x in _even(box.left, box.right))
            yield from ((box.left, y) for y in _even(box.top, box.bottom))
        elif element.tag == f"{SVG}polyline" and (not is_dark(element) or is_frame(points_of(element))):
            continue
        elif element.tag in (f"{SVG}polyline", f"{SVG}polygon"):
            for a, b in pairwise(points_of(element).tolist()):
                yield from zip(_even(a[0], b[0]), _even(a[1], b[1]), strict=True)


def _even(begin: float, end: float) -> list[float]:
    """Places along a line."""
    return [begin + (end - begin) * k / SAMPLES for k in range(SAMPLES + 1)]


# Before a page's own scripts: keep what is written on a canvas since it was cleared.
KEEP_WORDS = """(() => {
  const pen = CanvasRenderingContext2D.prototype, write = pen.fillText, clear = pen.clearRect;
  pen.clearRect = function (...box) { this.canvas.words = []; return clear.apply(this, box); };
  pen.fillText = function (words, x, y, ...more) {
    const size = this.measureText(words), m = this.getTransform();
    const left = x - size.actualBoundingBoxLeft, right = x + size.actualBoundingBoxRight;
    const top = y - size.actualBoundingBoxAscent, bottom = y + size.actualBoundingBoxDescent;
    const scale = devicePixelRatio;
    (this.canvas.words ??= []).push([(m.a * left + m.e) / scale, (m.d * top + m.f) / scale,
      (m.a * right + m.e) / scale, (m.d * bottom + m.f) / scale, String(words)]);
    return write.call(this, words, x, y, ...more);
  };
})()"""
CANVASES = """[...document.querySelectorAll("canvas")].filter(e => e.offsetParent).map(
  e => [e.id, e.clientWidth, e.clientHeight, e.words ?? []])"""
DOCUMENT = """(() => {
  const boxes = [], read = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node; (node = walker.nextNode());) {
    const home = node.parentElement;
    const hidden = "script, style, desc, title, code, details:not([open]) > :not(summary)";
    if (!node.data.trim() || home.closest(hidden)) continue;
    const range = document.createRange();
    range.selectNodeContents(node);
    let [low, high] = [-Infinity, Infinity];  // what is scrolled out of a part of the page is not seen
    for (let e = home; e && e !== document.body; e = e.parentElement)
      if (getComputedStyle(e).overflowY !== "visible")
        [low, high] = [Math.max(low, e.getBoundingClientRect().top), Math.min(high, e.getBoundingClientRect().bottom)];
    for (const b of range.getClientRects())
      if (b.width && b.height && b.bottom > low && b.top < high) {
        boxes.push([b.left, b.top + scrollY, b.right, b.bottom + scrollY, node.data.trim()]);
        if (!home.closest("#accuracy")) read.push(boxes.at(-1));  // that chapter of a report tells errors
      }
  }
  const tables = [...document.querySelectorAll("table")].filter(e => e.offsetParent).map(e => {
    const b = e.getBoundingClientRect(), home = e.parentElement.getBoundingClientRect();
    return [b.left, b.top + scrollY, b.width / home.width, e.rows.length];
  });
  return {boxes, read, tables, width: document.documentElement.scrollWidth, window: innerWidth};
})()"""
NARROW_TABLE, LONG_TABLE = 0.5, 8  # of the width of the sheet; rows


def keep_canvas_words(tab: Tab) -> None:
    """Let the pages that are opened in a tab from now on keep the words of their canvases."""
    tab.send("Page.addScriptToEvaluateOnNewDocument", source=KEEP_WORDS)


def find_in_document(tab: Tab) -> list[Finding]:
    """Find the faults of a page or report that is open: words over words, beyond the window, tables on half a sheet."""
    seen = tab.evaluate(DOCUMENT)
    boxes = [Box(*box) for box in seen["boxes"]]
    found = [finding for box in seen["read"] for finding in judge_words(Box(*box))]
    found += _iter_overlaps([box.shrunk() for box in boxes])
    if seen["width"] > seen["window"]:
        found.append(Finding("outside", f"the page is {seen['width']} wide, its window {seen['window']}", 0, 0))
    for left, top, share, rows in seen["tables"]:
        if share < NARROW_TABLE and rows > LONG_TABLE:
            found.append(Finding("narrow", f"a table of {rows} rows on {share:.0%} of the width", left, top))
    for name, width, height, words in tab.evaluate(CANVASES):
        labels = [Box(*box) for box in words]
        found += [f._replace(what=f"canvas {name}: {f.what}") for f in _iter_overlaps(labels)]
        beyond = (b for b in labels if b.left < -1 or b.top < -1 or b.right > width + 1 or b.bottom > height + 1)
        found += [Finding("outside", f"canvas {name}: {b.words}", b.left, b.top) for b in beyond]
    return found


def find_other_numbers(svg: str, extremes: Sequence[float]) -> list[Finding]:
    """Find the marked numbers of a history (`24.6 kN at 0.02 s`) that are none of its extremes (SI), as rounded."""
    found = []
    for box in text_boxes(tree.fromstring(svg.encode())):
        shown = re.match(r"([-−]?\d[\d.]*(?:e[-−]?\d+)?)(?: (\S+))? at ", box.words)
        if shown is None:
            continue
        unit = shown[2] or ""
        size = 1e-3 if unit.startswith("mm") else PREFIXES.get(unit[:1], 1.0)
        value, half = (size * number for number in read_rounded(shown[1]))
        if not any(math.isclose(value, extreme, rel_tol=0.0, abs_tol=1.01 * half) for extreme in extremes):
            found.append(Finding("number", f"{box.words}: none of {list(extremes)}", box.left, box.top))
    return found


def read_rounded(text: str) -> tuple[float, float]:
    """A number as it is written, and half a unit of its last digit."""
    digits, _, power = text.replace("−", "-").partition("e")
    return float(f"{digits}e{power or 0}"), 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2]))
