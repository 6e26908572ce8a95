"""A moving page in a headless Chromium: frames a second while it plays, and how long the script of a frame takes.

Twenty bars with shapes, all of their forces as arrows; then worked examples. Drawn by the processor, without a graphics
card: on a desk it is faster. What else the machine does lengthens the frames, not the script's time.
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path

from heuncli.app.cli.entry import enter
from tests.bench.generated import chain
from tests.shared.chromium import Chromium, Tab, found
from tests.shared.folders import SPECS

BODIES, FRAMES = 20, 180
SHAPE = "shapes: [{type: cylinder, from: [0, 0, 0], to: [0, 0, -1], radius: 0.04, mass: 1}]"
# Before the page's own script: each callback of a frame is timed.
TIMED = """window.spent = [], window.began = [];
const asked = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (call) => asked((now) => {
  const begun = performance.now();
  call(now);
  if (window.began.at(-1) === now) window.spent[window.spent.length - 1] += performance.now() - begun;
  else window.began.push(now), window.spent.push(performance.now() - begun);
});"""


def pages() -> None:
    """Print a line for each page: its size, what it takes to make, frames a second, the script's time of a frame."""
    path = found()
    if path is None:
        print("pages: no Chromium on this machine")
        return
    chromium = Chromium(path)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bars = folder / "bars.yaml"
        mass = "mass: 1.0, center: [0, 0, -0.5], inertia: [0.0842, 0.0850, 0.0017]"
        text = chain(BODIES, 2.0).replace(mass, SHAPE).replace("samples: 3", "samples: 201")
        bars.write_text(text)
        for spec in (bars, SPECS / "double.yaml", SPECS / "engine.yaml", SPECS / "crane.yaml"):
            page = folder / f"{spec.stem}.html"
            begun = time.process_time()
            if enter(("show", str(spec), "-o", str(page), "-q")):
                continue
            made = time.process_time() - begun
            rate, script = played(chromium.tab(1200, 900), page)
            size = page.stat().st_size / 1e3
            print(
                f"{spec.stem:8} {size:6.0f} kB, made in {1e3 * made:5.0f} ms; {rate:5.1f} frames/s, "
                f"script of a frame {statistics.median(script):5.2f} ms, of the slowest in twenty "
                f"{sorted(script)[int(0.95 * len(script))]:5.2f} ms"
            )
    chromium.close()


def played(tab: Tab, page: Path) -> tuple[float, list[float]]:
    """Frames a second of a page that plays, and the script's time [ms] of each."""
    tab.send("Page.addScriptToEvaluateOnNewDocument", source=TIMED)
    tab.go(page.resolve().as_uri())
    tab.evaluate("document.querySelector('#play').click()")
    tab.until("window.spent.length > 20")
    tab.evaluate("window.spent.length = window.began.length = 0")
    tab.until(f"window.spent.length > {FRAMES}")
    script, began = tab.evaluate("[window.spent, window.began]")
    return 1e3 * (len(began) - 1) / (began[-1] - began[0]), script
