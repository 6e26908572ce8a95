"""A headless Chromium as a person would use it: pages opened, keys and the mouse, what is to be seen and read.

Spoken to by its DevTools protocol over two pipes: no port, no driver, no package. Impure throughout.
"""

from __future__ import annotations

import base64
import fcntl
import json
import os
import select
import shutil
import signal
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

NAMES = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--remote-debugging-pipe", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-extensions",
    "--disable-dev-shm-usage", "--disable-smooth-scrolling", "--hide-scrollbars", "--mute-audio",
    "--force-color-profile=srgb", "about:blank",
)  # fmt: skip
PATIENCE = 60.0  # seconds for an answer: not how fast it is, but whether one comes
OWN = ("file:", "data:", "blob:", "about:")  # addresses that need no network
KEYS = {
    "ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Home": 36, "End": 35, "PageUp": 33,
    "PageDown": 34, "Enter": 13, "Escape": 27, "Tab": 9, " ": 32,
}  # fmt: skip

# Runs in a blank page of its own: the pixels of a screenshot, against the colour that most of them have.
SEEN = """async (png) => {
  const picture = await createImageBitmap(await (await fetch("data:image/png;base64," + png)).blob());
  const canvas = new OffscreenCanvas(picture.width, picture.height), pen = canvas.getContext("2d");
  pen.drawImage(picture, 0, 0);
  const pixels = new Uint32Array(pen.getImageData(0, 0, canvas.width, canvas.height).data.buffer);
  const counts = new Map();
  for (const pixel of pixels) counts.set(pixel, (counts.get(pixel) ?? 0) + 1);
  const [ground] = [...counts].reduce((most, found) => (found[1] > most[1] ? found : most));
  let left = canvas.width, right = -1, top = canvas.height, bottom = -1, marked = 0;
  pixels.forEach((pixel, k) => {
    if (pixel === ground) return;
    const x = k % canvas.width, y = (k - x) / canvas.width;
    left = Math.min(left, x), right = Math.max(right, x), top = Math.min(top, y), bottom = Math.max(bottom, y);
    marked += 1;
  });
  return {colours: counts.size, box: [left, top, right + 1, bottom + 1], marked, size: [canvas.width, canvas.height],
    ground: [ground & 255, ground >> 8 & 255, ground >> 16 & 255]};
}"""


def found() -> str | None:
    """The path of a Chromium on this machine."""
    return next((path for path in map(shutil.which, NAMES) if path is not None), None)


class Seen(NamedTuple):
    """A screenshot: how many colours, the commonest, the box [left, top, right, bottom] and number of other pixels."""

    colours: int
    box: list[int]
    marked: int
    size: list[int]
    ground: list[int]
    png: bytes


class Control(NamedTuple):
    """What the accessibility tree tells of an element: its role and name."""

    role: str
    name: str


class Chromium:
    """A browser in a process and a folder of its own; `close` ends it."""

    def __init__(self, path: str) -> None:
        self.folder = tempfile.mkdtemp(prefix="chromium-")
        to_read, self._write = (_high(end) for end in os.pipe())
        self._read, to_write = (_high(end) for end in os.pipe())
        words = [path, *FLAGS[:-1], f"--user-data-dir={self.folder}", FLAGS[-1]]
        ends = [(os.POSIX_SPAWN_DUP2, to_read, 3), (os.POSIX_SPAWN_DUP2, to_write, 4)]  # where it looks for its pipes
        quiet = [(os.POSIX_SPAWN_OPEN, at, os.devnull, os.O_RDWR, 0) for at in (0, 1, 2)]
        self._process = os.posix_spawn(path, words, dict(os.environ), file_actions=[*ends, *quiet], setpgroup=0)
        for end in (to_read, to_write):
            os.close(end)
        self._heard, self._number = b"", 0
        self._tabs: dict[str, Tab] = {}
        self._answers: dict[int, dict[str, Any]] = {}
        (first,) = (told for told in self.send("Target.getTargets")["targetInfos"] if told["type"] == "page")
        self._blank = self._attached(first["targetId"])

    def _attached(self, target: str) -> Tab:
        """A page that is there."""
        session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        return self._tabs.setdefault(session, Tab(self, target, session))

    def tab(self, width: int = 1000, height: int = 700, dark: bool = False) -> Tab:
        """A new empty page, before all others: those behind it draw nothing."""
        found = self._attached(self.send("Target.createTarget", url="about:blank")["targetId"])
        for domain in ("Page", "Runtime", "Log", "Network"):
            found.send(f"{domain}.enable")
        found.send("Emulation.setFocusEmulationEnabled", enabled=True)
        found.sized(width, height)
        scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
        found.send("Emulation.setEmulatedMedia", features=[scheme])
        return found

    @contextmanager
    def open(self, path: Path, **options: Any) -> Iterator[Tab]:
        """A file opened as a page, closed again."""
        tab = self.tab(**options)
        tab.go(path.resolve().as_uri())
        yield tab
        self.send("Target.closeTarget", targetId=tab.target)

    def seen(self, png: bytes) -> Seen:
        """What is on a screenshot."""
        told = self._blank.evaluate(f"({SEEN})({json.dumps(base64.b64encode(png).decode())})")
        return Seen(told["colours"], told["box"], told["marked"], told["size"], told["ground"], png)

    def send(self, method: str, session: str | None = None, **params: Any) -> dict[str, Any]:
        """The result of a command. Raises RuntimeError where the browser refuses it, TimeoutError."""
        self._number += 1
        number = self._number
        message = {"id": number, "method": method, "params": params} | ({"sessionId": session} if session else {})
        left = memoryview(json.dumps(message).encode() + b"\0")
        while left:
            left = left[os.write(self._write, left) :]
        deadline = time.monotonic() + PATIENCE
        while number not in self._answers:
            self.listen(deadline)
        answer = self._answers.pop(number)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error'].get('message')}")
        result: dict[str, Any] = answer["result"]
        return result

    def listen(self, deadline: float) -> None:
        """Take in what the browser says next. Raises TimeoutError where it says nothing before the deadline."""
        ready, _, _ = select.select([self._read], [], [], max(0.0, deadline - time.monotonic()))
        heard = os.read(self._read, 1 << 20) if ready else b""
        if not heard:
            raise TimeoutError("the browser says nothing" if not ready else "the browser has ended")
        *messages, self._heard = (self._heard + heard).split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self._answers[message["id"]] = message
            elif message.get("sessionId") in self._tabs:
                self._tabs[message["sessionId"]].happened(message["method"], message["params"])

    def close(self) -> None:
        """End the browser and all that it began; remove its folder."""
        os.killpg(self._process, signal.SIGKILL)
        os.waitpid(self._process, 0)
        for end in (self._read, self._write):
            os.close(end)
        shutil.rmtree(self.folder, ignore_errors=True)


class Tab:
    """A page; faults: errors on its console and what it asked the network for, one sentence each."""

    def __init__(self, browser: Chromium, target: str, session: str) -> None:
        self.browser, self.target, self._session = browser, target, session
        self.faults: list[str] = []
        self._loaded = False

    def send(self, method: str, **params: Any) -> dict[str, Any]:
        """The result of a command to this page."""
        return self.browser.send(method, self._session, **params)

    def happened(self, method: str, told: dict[str, Any]) -> None:
        """Keep of an event what is asked for later."""
        if method == "Page.loadEventFired":
            self._loaded = True
        elif method == "Runtime.exceptionThrown":
            details = told["exceptionDetails"]
            self.faults.append(f"thrown: {details.get('exception', {}).get('description', details['text'])}")
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.faults.append(f"console: {[part.get('value', part.get('description')) for part in told['args']]}")
        elif method == "Log.entryAdded" and told["entry"]["level"] in ("error", "warning"):
            self.faults.append(f"log: {told['entry']['text']}")
        elif method == "Network.requestWillBeSent" and not told["request"]["url"].startswith(OWN):
            self.faults.append(f"asked for: {told['request']['url']}")
        elif method == "Page.javascriptDialogOpening":
            self.faults.append(f"dialog: {told['message']}")

    def go(self, address: str, scripts: bool = True) -> None:
        """Open an address and wait until all of it is loaded and drawn; scripts: whether the page may run its own."""
        self._loaded = False
        self.send("Emulation.setScriptExecutionDisabled", value=not scripts)
        self.send("Page.navigate", url=address)
        deadline = time.monotonic() + PATIENCE
        while not self._loaded:
            self.browser.listen(deadline)
        if scripts:
            self.drawn()

    def sized(self, width: int, height: int) -> None:
        """Give the page a window of a size [pixels], at one device pixel each."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.send("Emulation.setDeviceMetricsOverride", **size)

    def evaluate(self, script: str) -> Any:
        """The value of an expression in the page, awaited. Raises RuntimeError with what the script threw."""
        how = {"returnByValue": True, "awaitPromise": True, "userGesture": True, "allowUnsafeEvalBlockedByCSP": False}
        told = self.send("Runtime.evaluate", expression=script, **how)
        if "exceptionDetails" in told:
            details = told["exceptionDetails"]
            raise RuntimeError(details.get("exception", {}).get("description", details["text"]))
        return told["result"].get("value")

    def drawn(self) -> None:
        """Wait until the page has drawn two more frames: what was asked for before is on it."""
        self.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))")

    def until(self, condition: str) -> None:
        """Wait until an expression is true. Raises TimeoutError."""
        deadline = time.monotonic() + PATIENCE
        while not self.evaluate(f"Boolean({condition})"):
            if time.monotonic() > deadline:
                raise TimeoutError(f"never: {condition}")
            self.drawn()

    def box(self, selector: str) -> tuple[float, float, float, float]:
        """Left, top, width and height of an element in the window [pixels], scrolled to where it is seen."""
        element = f"document.querySelector({json.dumps(selector)})"
        self.evaluate(f"{element}.scrollIntoView({{block: 'nearest'}})")
        left, top, width, height = self.evaluate(
            f"(b => [b.left, b.top, b.width, b.height])({element}.getBoundingClientRect())"
        )
        return left, top, width, height

    def press(self, key: str, shift: bool = False) -> None:
        """Press a key and let it go."""
        text = {"text": "\r" if key == "Enter" else key} if len(key) == 1 or key == "Enter" else {}
        code = KEYS.get(key, ord(key.upper()[0]))
        told = {"key": key, "windowsVirtualKeyCode": code, "modifiers": 8 * shift}
        self.send("Input.dispatchKeyEvent", type="keyDown", **told, **text)
        self.send("Input.dispatchKeyEvent", type="keyUp", **told)
        self.drawn()

    def click(self, selector: str) -> None:
        """Click on the middle of an element."""
        left, top, width, height = self.box(selector)
        self.drag((left + width / 2, top + height / 2))

    def drag(self, *places: tuple[float, float], shift: bool = False) -> None:
        """Hold the mouse down at the first place [pixels of the window], move over the others, let go at the last."""
        over = [("mouseMoved", place, 1) for place in places[1:]]
        begun, ended = [("mouseMoved", places[0], 0), ("mousePressed", places[0], 1)], ("mouseReleased", places[-1], 0)
        for kind, (x, y), held in (*begun, *over, ended):
            button = {"button": "left", "clickCount": 1} if held or kind == "mouseReleased" else {}
            self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, buttons=held, modifiers=8 * shift, **button)
        self.drawn()

    def scroll(self, selector: str, turned: float) -> None:
        """Turn the mouse's wheel over an element, by so many pixels."""
        left, top, width, height = self.box(selector)
        at = {"x": left + width / 2, "y": top + height / 2}
        self.send("Input.dispatchMouseEvent", type="mouseWheel", deltaX=0, deltaY=turned, **at)
        self.drawn()

    def seen(self, selector: str | None = None) -> Seen:
        """What is to be seen in the window, or of an element."""
        clip = {}
        if selector is not None:
            left, top, width, height = self.box(selector)
            x, y = self.evaluate("[scrollX, scrollY]")  # a part is told by its place on the whole page
            clip = {"clip": {"x": left + x, "y": top + y, "width": width, "height": height, "scale": 1}}
        self.drawn()
        png = base64.b64decode(self.send("Page.captureScreenshot", format="png", **clip)["data"])
        return self.browser.seen(png)

    def controls(self) -> list[Control]:
        """What a person can operate, as it is told to those who do not see it."""
        self.send("Accessibility.enable")
        nodes = self.send("Accessibility.getFullAXTree")["nodes"]
        self.send("Accessibility.disable")
        return [
            Control(node["role"]["value"], str(node.get("name", {}).get("value", "")).strip())
            for node in nodes
            if not node["ignored"] and any(p["name"] == "focusable" and p["value"]["value"] for p in node["properties"])
        ]

    def pdf(self) -> bytes:
        """The page printed, on A4 unless it says otherwise."""
        paper = {"paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": True}
        return base64.b64decode(self.send("Page.printToPDF", printBackground=True, **paper)["data"])


def _high(end: int) -> int:
    """An end of a pipe by a number that is not among those a new process has from the start; it keeps it not."""
    moved = fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10)
    os.close(end)
    return moved
