"""One page out of the files beside this: template, style, scripts and the data, which no name in a spec can leave.

The scripts are modules of a browser, as they stand; here they become one: each a function that hands on what it
exports, after those that it imports from. The page tells by their digests which style and script it runs: nothing else
in it is ever run.
"""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from functools import cache
from pathlib import Path
from typing import Any

from heuncli.base.foreign_text import shown

FOLDER = Path(__file__).parent
TEMPLATE, STYLE, FIRST = "machine.html", "style.css", "main"
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./(\w+)\.js";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:function|class|const) (\w+))", re.MULTILINE)
PLACE = re.compile(r"\{\{(\w+)\}\}")
# What could end the data, or be read as anything but data, as JSON itself escapes it.
UNSAFE = {"<": "\\u003c", ">": "\\u003e", "&": "\\u0026"}


def whole_page(title: str, data: dict[str, Any]) -> str:
    """The page as text. The data hold neither nan nor infinity: ValueError."""
    parts = {
        "title": html.escape(shown(title)),
        "style": text_of(STYLE),
        "script": script(),
        "data": embedded(data),
        "policy": policy(),
    }
    return PLACE.sub(lambda place: parts[place[1]], text_of(TEMPLATE))


def embedded(data: dict[str, Any]) -> str:
    """The data as JSON in ASCII, in which no mark of HTML stands."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return "".join(UNSAFE.get(letter, letter) for letter in text) if set(text) & UNSAFE.keys() else text


@cache
def policy() -> str:
    """What the page may load and run: its own style and script, by their digests."""
    return (
        f"default-src 'none'; script-src '{_digest(script())}'; style-src '{_digest(text_of(STYLE))}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


@cache
def script() -> str:
    """All scripts as one, in a function of its own: none of their names is the page's."""
    return '(() => {\n"use strict";\n' + "".join(map(_module, in_order())) + "})();\n"


def _module(name: str) -> str:
    """One of the scripts as a function that returns what it exports."""
    text = text_of(f"{name}.js")
    exported = ", ".join(found[2] for found in EXPORT.finditer(text))
    body = EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = \2_js;", text))
    return f"const {name}_js = (() => {{\n{body}return {{ {exported} }};\n}})();\n"


def in_order() -> list[str]:
    """The names of the scripts, each after those that it imports from."""
    found: dict[str, None] = {}

    def add(name: str) -> None:
        for needed in IMPORT.finditer(text_of(f"{name}.js")):
            if needed[2] not in found:
                add(needed[2])
        found[name] = None

    add(FIRST)
    return list(found)


@cache
def text_of(name: str) -> str:
    """The text of one of the files."""
    return (FOLDER / name).read_text(encoding="utf-8")
