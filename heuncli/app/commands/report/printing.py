"""Print a page of HTML as PDF with the first program found: Chromium or Chrome, WeasyPrint, wkhtmltopdf.

The program gets a file in a temporary folder and no network: Chromium resolves no names, and the page itself forbids
all sources (Content-Security-Policy). Impure: runs a program, writes.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

from heuncli.app.cli import timeout
from heuncli.base import files
from heuncli.base.errors import OutputError, Problem
from heuncli.base.named_tuples import NamedTuple

MAX_SECONDS = 90.0  # of a program, unless --time-limit leaves less
MAX_MESSAGE = 300  # characters of what a program says
BROWSER_OPTIONS = (
    "--headless", "--disable-gpu", "--no-first-run", "--disable-extensions", "--disable-background-networking",
    "--disable-sync", "--disable-component-update", "--disable-dev-shm-usage", "--no-pdf-header-footer",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9", "--user-data-dir={folder}",
    "--print-to-pdf={pdf}", "{page}",
)  # fmt: skip
BROWSERS = (
    "chromium", "chromium-browser", "chromium-headless-shell", "google-chrome", "google-chrome-stable", "chrome",
    "msedge", "microsoft-edge",
)  # fmt: skip
OTHERS = {
    "weasyprint": ("{page}", "{pdf}"),
    "wkhtmltopdf": ("--quiet", "--disable-javascript", "--enable-local-file-access", "{page}", "{pdf}"),
}
HINT = (
    "install Chromium or Chrome, WeasyPrint (pip install weasyprint) or wkhtmltopdf, and have it on PATH; or write "
    "-o report.html, open it in a browser and print it: it is laid out for paper"
)


class Printer(NamedTuple):
    """A program that prints PDF: its path, and the patterns of its options."""

    path: str
    options: tuple[str, ...]


def find_printer() -> Printer:
    """Find a program that prints PDF. Raises OutputError."""
    rows = [*((name, BROWSER_OPTIONS) for name in BROWSERS), *OTHERS.items()]
    for name, options in rows:
        path = shutil.which(name)
        if path is not None:
            is_root = options is BROWSER_OPTIONS and hasattr(os, "geteuid") and os.geteuid() == 0
            return Printer(path, (("--no-sandbox",) if is_root else ()) + options)
    raise OutputError(Problem("no-pdf-printer", "no program that writes PDF was found on PATH", hint=HINT))


def write_pdf(page: str, printer: Printer, output: str) -> None:
    """Print a page to a file, which is written whole or not at all. Raises OutputError."""
    with tempfile.TemporaryDirectory(prefix="heun-", ignore_cleanup_errors=True) as folder:
        source, target = Path(folder, "report.html"), Path(folder, "report.pdf")
        source.write_text(page, encoding="utf-8")
        places = {"folder": str(Path(folder, "profile")), "pdf": str(target), "page": source.as_uri()}
        message = _run_program([printer.path, *(option.format(**places) for option in printer.options)], folder)
        content = target.read_bytes() if target.is_file() else b""
    if not content.startswith(b"%PDF"):
        text = f"{printer.path} has written no PDF{f': {message}' if message else ''}"
        raise OutputError(Problem("no-pdf-printer", text, hint=HINT))
    timeout.disarm()
    files.write([content], output)


def _run_program(command: list[str], folder: str) -> str:
    """Run the program to its end, or end it with all that it began; returns what it says at last."""
    remaining = timeout.remaining_time()
    limit = MAX_SECONDS if remaining is None else min(MAX_SECONDS, remaining)
    has_group = sys.platform != "win32"
    try:
        process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
            env={**os.environ, "HOME": folder}, start_new_session=has_group,
        )  # fmt: skip
    except OSError as reason:
        return str(reason)
    try:
        _, said = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        return f"it took longer than {limit:.3g} s"
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL) if has_group else process.kill()
            process.communicate()
    lines = said.decode("utf-8", "replace").strip().splitlines() if process.returncode else []
    return lines[-1][:MAX_MESSAGE] if lines else ""
