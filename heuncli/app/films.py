"""Draw pictures and films of the moving page: Chromium or Chrome draws it, ffmpeg makes a video of its frames.

The programs get a temporary folder and no network. They are found on PATH when they are needed. Impure: runs programs.
"""

from __future__ import annotations

import base64
import binascii
import re
import tempfile
from pathlib import Path, PurePath

from heuncli.app.cli import timeout
from heuncli.base.errors import OutputError, Problem
from heuncli.base.named_tuples import NamedTuple
from heuncli.base.programs import BROWSERS, find_program, list_browser_options, run_program
from heuncli.output.web_page.moving_page import Film

MAX_SECONDS = 300.0  # of a program, unless --time-limit leaves less
DRAW_BUDGET = 600_000  # ms of the browser's own time until it must have drawn all pictures
DRAWING_OPTIONS = (  # of the browser
    "--force-color-profile=srgb", f"--virtual-time-budget={DRAW_BUDGET}", "--blink-settings=preferredColorScheme=1",
)  # fmt: skip
ENCODER_OPTIONS = ("-y", "-loglevel", "error", "-i", "%05d.png", "-pix_fmt", "yuv420p", "-movflags", "+faststart")
HINT = "install Chromium or Chrome, and have it on PATH; or write -o machine.html, which needs no program"
ENCODER_HINT = "install ffmpeg, and have it on PATH; or write -o machine.gif, which needs Chromium or Chrome alone"
DRAWN = re.compile(rb'<pre id="film">([A-Za-z0-9+/= ]+)</pre>')


class FilmFormat(NamedTuple):
    """A kind of file: what the page draws for it, pictures a second, and whether a video program makes it of them.

    width, height: [pixels]
    scale: pixels of the picture for each of these
    """

    kind: str
    rate: float
    is_encoded: bool
    width: int = 1000
    height: int = 700
    scale: int = 1


FILM_FORMATS = {
    ".png": FilmFormat("png", 1.0, is_encoded=False, scale=2),
    ".gif": FilmFormat("gif", 20.0, is_encoded=False, width=800, height=560),
    ".mp4": FilmFormat("frames", 25.0, is_encoded=True),
}


class FilmPrograms(NamedTuple):
    """The paths of the browser and, for a video, of ffmpeg."""

    browser: str
    encoder: str = ""


def find_format(output: str | None) -> FilmFormat | None:
    """Return the format of a picture or film by the file's ending, None of a page."""
    return FILM_FORMATS.get(PurePath(output or "").suffix.lower())


def find_programs(form: FilmFormat) -> FilmPrograms:
    """Find the programs that a format needs. Raises OutputError."""
    browser = find_program(BROWSERS)
    if browser is None:
        raise OutputError(Problem("no-film-program", "no Chromium or Chrome was found on PATH", hint=HINT))
    encoder = find_program(("ffmpeg",)) if form.is_encoded else ""
    if encoder is None:
        raise OutputError(Problem("no-film-program", "no ffmpeg was found on PATH", hint=ENCODER_HINT))
    return FilmPrograms(browser, encoder)


def make_film(form: FilmFormat, instant: float | None) -> Film:
    """Make what the page is told to draw."""
    return Film(form.kind, form.width, form.height, form.rate, instant)  # type: ignore[arg-type]


def draw_film(page: str, form: FilmFormat, programs: FilmPrograms, ending: str) -> bytes:
    """Draw the pictures of a page, and make the file of them. Raises OutputError."""
    with tempfile.TemporaryDirectory(prefix="heun-", ignore_cleanup_errors=True) as name:
        folder = Path(name)
        pictures = _draw_pictures(page, form, programs.browser, folder)
        if not form.is_encoded:
            return pictures[0]
        for number, picture in enumerate(pictures):
            (folder / f"{number:05d}.png").write_bytes(picture)
        target = folder / f"film{ending}"
        words = [programs.encoder, "-framerate", f"{form.rate:g}", *ENCODER_OPTIONS, str(target)]
        _, message = run_program(words, name, timeout.limit_seconds(MAX_SECONDS))
        if not target.is_file() or not target.stat().st_size:
            raise OutputError(
                Problem("no-film-program", f"{programs.encoder} has written no video: {message}", hint=ENCODER_HINT)
            )
        return target.read_bytes()


def _draw_pictures(page: str, form: FilmFormat, browser: str, folder: Path) -> list[bytes]:
    """Let the browser draw, and read the pictures from the document that it prints."""
    source = folder / "film.html"
    source.write_text(page, encoding="utf-8")
    words = [
        browser, *(option.format(folder=folder) for option in list_browser_options()), *DRAWING_OPTIONS,
        f"--force-device-scale-factor={form.scale}", f"--window-size={form.width + 100},{form.height + 100}",
        "--dump-dom", source.as_uri(),
    ]  # fmt: skip
    printed, message = run_program(words, str(folder), timeout.limit_seconds(MAX_SECONDS))
    found = DRAWN.search(printed)
    try:
        pictures = [base64.b64decode(word, validate=True) for word in found[1].split()] if found else []
    except binascii.Error:
        pictures = []
    if not pictures:
        text = f"{browser} has drawn nothing{f': {message}' if message else ''}"
        raise OutputError(Problem("no-film-program", text, hint=HINT))
    return pictures
