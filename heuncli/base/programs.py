"""Run other programs, such as a browser that draws a page or a program that encodes a film.

A program is found on PATH and runs in a folder of its own, with a time limit. It and all that it begins end together. A
browser resolves no names, so that a page reaches no network. Impure: starts and ends processes.
"""

from __future__ import annotations

import os
from contextlib import suppress

MAX_MESSAGE = 300  # characters of a program's message
BROWSERS = (
    "chromium", "chromium-browser", "chromium-headless-shell", "google-chrome", "google-chrome-stable", "chrome",
    "msedge", "microsoft-edge",
)  # fmt: skip
BROWSER_OPTIONS = (
    "--headless", "--disable-gpu", "--no-first-run", "--disable-extensions", "--disable-background-networking",
    "--disable-sync", "--disable-component-update", "--disable-dev-shm-usage", "--hide-scrollbars",
    "--host-resolver-rules=MAP * ~NOTFOUND", "--proxy-server=127.0.0.1:9", "--user-data-dir={folder}/profile",
)  # fmt: skip


def find_program(names: tuple[str, ...]) -> str | None:
    """Return the path of the first of these programs on PATH, or None."""
    import shutil  # 2 ms that few commands need

    return next((path for path in map(shutil.which, names) if path is not None), None)


def list_browser_options() -> tuple[str, ...]:
    """List the options of every browser; {folder} stands for its temporary folder. As root it has no sandbox."""
    is_root = hasattr(os, "geteuid") and os.geteuid() == 0
    return (*(("--no-sandbox",) if is_root else ()), *BROWSER_OPTIONS)


def run_program(command: list[str], folder: str, limit: float) -> tuple[bytes, str]:
    """Run a program for at most `limit` [s]; return its output, and why it failed, empty if it did not.

    The processes that it began end with it, also after success (on Windows only the program itself is ended).
    """
    import signal
    import subprocess
    import sys

    has_group = sys.platform != "win32"  # a new session: the program and all that it begins are one process group
    try:
        process = subprocess.Popen(
            command, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            env={**os.environ, "HOME": folder}, start_new_session=has_group,
        )  # fmt: skip
    except OSError as reason:
        return b"", str(reason)
    try:
        output, message = process.communicate(timeout=limit)
    except subprocess.TimeoutExpired:
        return b"", f"it took longer than {limit:.3g} s"
    finally:
        with suppress(ProcessLookupError, PermissionError):  # nobody is left; macOS refuses for a group of dead ones
            os.killpg(process.pid, signal.SIGKILL) if has_group else process.kill()
        process.communicate()
    if not process.returncode:
        return output, ""
    lines = message.decode("utf-8", "replace").strip().splitlines()
    return output, lines[-1][:MAX_MESSAGE] if lines else f"it ended with exit code {process.returncode}"
