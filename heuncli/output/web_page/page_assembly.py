"""Assemble one page from the files in this folder: template, style, scripts, and the data, encoded so that no name in a
spec can end the data block.

The scripts are browser modules. Here they are bundled into one script: each becomes a function that returns what it
exports, after those that it imports from. The page's security policy permits only this style and this script, by their
digests.
"""

from __future__ import annotations

import base64
import hashlib
import html
import re
from functools import cache
from pathlib import Path
from typing import Any

from heuncli.base.text_safety import escape
from heuncli.output.web_page.packing import encode_data

FOLDER = Path(__file__).parent
STYLE = "style.css"
TEMPLATES = {"main": "machine.html", "film": "film.html"}  # main script -> its page
MAIN_SCRIPT, FILM_SCRIPT = TEMPLATES
IMPORT = re.compile(r'^import (\{[^}]*\}) from "\./(\w+)\.js";$', re.MULTILINE)
EXPORT = re.compile(r"^export ((?:function|class|const) (\w+))", re.MULTILINE)
PLACEHOLDER = re.compile(r"\{\{(\w+)\}\}")
COMMENT = re.compile(r"^ */\*\*.*?\*/\n", re.MULTILINE | re.DOTALL)  # those of the scripts stay in their files
INDENT = re.compile(r"^ +", re.MULTILINE)


def assemble_page(title: str, data: dict[str, Any], main_script: str = MAIN_SCRIPT) -> str:
    """Assemble the page of a main script as text. Raises ValueError if the data hold nan or infinity."""
    parts = {
        "title": html.escape(escape(title)),
        "style": read_page_file(STYLE),
        "script": bundle_scripts(main_script),
        "data": encode_data(data),
        "policy": make_security_policy(main_script),
    }
    return PLACEHOLDER.sub(lambda place: parts[place[1]], read_page_file(TEMPLATES[main_script]))


@cache
def make_security_policy(main_script: str = MAIN_SCRIPT) -> str:
    """Make the page's content security policy: only its own style and script are permitted, by their digests."""
    return (
        f"default-src 'none'; script-src '{_compute_digest(bundle_scripts(main_script))}'; style-src "
        f"'{_compute_digest(read_page_file(STYLE))}'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )


def _compute_digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode("ascii")


@cache
def bundle_scripts(main_script: str = MAIN_SCRIPT) -> str:
    """Bundle a main script and all that it needs into one, inside a function, so that none of their names is global."""
    return '(() => {\n"use strict";\n' + "".join(map(_wrap_module, sort_scripts(main_script))) + "})();\n"


def _wrap_module(name: str) -> str:
    """Wrap one script in a function that returns what the script exports."""
    text = read_page_file(f"{name}.js")
    exported = ", ".join(found[2] for found in EXPORT.finditer(text))
    body = INDENT.sub("", COMMENT.sub("", EXPORT.sub(r"\1", IMPORT.sub(r"const \1 = \2_js;", text))))
    return f"const {name}_js = (() => {{\n{body}return {{ {exported} }};\n}})();\n"


def sort_scripts(main_script: str = MAIN_SCRIPT) -> list[str]:
    """Sort the names of a main script and all that it needs so that each follows those that it imports from."""
    found: dict[str, None] = {}

    def add(name: str) -> None:
        for needed in IMPORT.finditer(read_page_file(f"{name}.js")):
            if needed[2] not in found:
                add(needed[2])
        found[name] = None

    add(main_script)
    return list(found)


@cache
def read_page_file(name: str) -> str:
    """Read one of the files in this folder, as text."""
    return (FOLDER / name).read_text(encoding="utf-8")
