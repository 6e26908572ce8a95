"""What a moving page shows at an instant, and what of the JSON of heun run stands under the same path."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from heuncli.results.results import Array
from tests.shared.chromium import Tab
from tests.shared.moving_pages import decoded, unpacked

HELD = re.compile(r'<script type="application/octet-stream" id="data">(.*?)</script>', re.DOTALL)
CELLS = """[...document.querySelectorAll("#numbers td[data-path]")].map(
  cell => [cell.dataset.path, cell.textContent, cell.dataset.value, cell.parentNode.lastChild.textContent])"""
FRAME = "Number(document.documentElement.dataset.frame)"
DEGREE = np.pi / 180.0
SIZES = {
    "kN": 1e3, "MN": 1e6, "kN·m": 1e3, "kN·mm": 1.0, "N·mm": 1e-3, "MN·m": 1e6, "kPa": 1e3, "MPa": 1e6, "mm": 1e-3,
    "mm/s": 1e-3, "mm/s²": 1e-3, "kW": 1e3, "kJ": 1e3, "MW": 1e6, "MJ": 1e6, "rpm": np.pi / 30.0, "deg": DEGREE,
    "deg/s": DEGREE, "deg/s²": DEGREE,
}  # in SI; all others are 1  # fmt: skip


class ShownNumber(NamedTuple):
    """A number of a page: its text, its value in SI, None where it is none, its unit."""

    text: str
    value: float | None
    unit: str

    def read(self) -> tuple[float, float]:
        """The number that the text shows, and half a unit of its last digit, in SI."""
        digits, _, power = self.text.replace("−", "-").partition("e")
        decimals, size = len(digits.partition(".")[2]), SIZES.get(self.unit, 1.0)
        return float(f"{digits}e{power or 0}") * size, 0.5 * 10.0 ** (int(power or 0) - decimals) * size


def numbers(tab: Tab) -> dict[str, ShownNumber]:
    """All numbers of the table of a page by their paths."""
    cells = tab.evaluate(CELLS)
    return {path: ShownNumber(text, float(value) if value else None, unit) for path, text, value, unit in cells}


def frames(page: Path) -> Array:
    """The instants of a page's frames, (n,) [s]."""
    held = HELD.search(page.read_text(encoding="utf-8"))
    assert held is not None
    data = decoded(held[1])
    return unpacked(data["time"], data["count"])


def to_frame(tab: Tab, frame: int) -> None:
    """Bring a page to a frame by its slider."""
    change = f"(slider.value = '{frame}', slider.dispatchEvent(new Event('input', {{bubbles: true}})))"
    tab.evaluate(f"(slider => {change})(document.querySelector('#time'))")  # at once: a page that plays moves it, too
    tab.drawn()
    assert tab.evaluate(FRAME) == frame


def of_run(results: dict[str, Any], path: str, k: int) -> float:
    """The number under a path of a page at the instant of a number: a component, a magnitude, one cut of many."""
    *keys, last = path.split(".")
    found: Any = results
    for key in keys:
        found = found[int(key)] if isinstance(found, list) else found[key]
    part = "" if isinstance(found, dict) else last  # else the last word is a component of what stands there, or a cut
    block = found if part else found[last]
    number = np.array(block if keys[0] == "impulses" else block[k], dtype=np.float64)
    if not part:
        return float(np.linalg.norm(number)) if number.ndim else float(number)
    return float(number["xyz".index(part)] if part in "xyz" else number[int(part)])


def largest_of_run(results: dict[str, Any], path: str) -> float:
    """The largest magnitude of a column over the run, with all of its components and cuts."""
    *keys, last = path.split(".")
    found: Any = results
    for key in keys:
        found = found[int(key)] if isinstance(found, list) else found[key]
    block = found[last] if isinstance(found, dict) else found
    return float(np.nanmax(np.abs(np.array(block, dtype=np.float64)), initial=0.0))


def choose(tab: Tab, name: str, option: str) -> None:
    """Choose an option of a list by its words."""
    tab.evaluate(f"""(list => {{
      list.value = [...list.options].find(option => option.textContent === "{option}").value;
      list.dispatchEvent(new Event("change", {{bubbles: true}}));
    }})(document.getElementById("{name}"))""")
    tab.drawn()


MOST_BYTES = 300_000
SUMMARY = """[...document.querySelectorAll("#summary tbody tr")].map(
  row => [...row.cells].map(cell => cell.textContent))"""
