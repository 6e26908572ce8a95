"""The scenes of the tests, for `python -m tests.compare record --scenes FILE`: a pytest plugin.

    HEUN_HARVEST=FILE.json.gz pytest -p tests.compare.harvest

Every text that a test loads from a string, once, with its overrides and the tables it reads; at most MOST, in turn from
each test. Not with several workers: each would write the file. Impure: replaces heuncli.scene.file_format.load.load,
writes FILE.
"""

from __future__ import annotations

import gzip
import hashlib
import json
import os
import re
from collections import defaultdict
from itertools import chain, islice, zip_longest
from pathlib import Path
from typing import Any

from heuncli.scene.file_format import load as module

MOST = 1500
LONGEST = 100_000  # characters
FILE = re.compile(r"\bfile['\"]?\s*:\s*['\"]?([^\s,}'\"]+)")
SCENES: dict[str, dict[str, dict[str, Any]]] = defaultdict(dict)
load = module.load


def remembered(path: Any, text: Any = None, *args: Any, **named: Any) -> Any:
    """`load`, keeping what it is given."""
    if isinstance(text, str) and len(text) < LONGEST:
        overrides = named.get("overrides") or (args[0] if args else None) or {}
        words = [word for key, value in dict(overrides).items() for word in ("--set", f"{key}={value}")]
        number = hashlib.sha256(json.dumps([text, words]).encode()).hexdigest()[:8]
        test = os.environ.get("PYTEST_CURRENT_TEST", "?").split(" ")[0]
        tables = {name: Path(path).parent / name for name in FILE.findall(text)}
        files = {name: file.read_text(encoding="utf-8") for name, file in tables.items() if file.is_file()}
        SCENES[test.split("[")[0]].setdefault(
            number, {"name": f"{test[:100]}#{number}", "text": text, "files": files, "words": words}
        )
    return load(path, text, *args, **named)


module.load = remembered  # type: ignore[assignment]


def pytest_unconfigure() -> None:
    """One scene of each test, then a second of each, ..."""
    turns = zip_longest(*(scenes.values() for scenes in SCENES.values()))
    chosen = list(islice((scene for scene in chain.from_iterable(turns) if scene is not None), MOST))
    chosen.sort(key=lambda scene: scene["name"])
    blob = json.dumps(chosen, ensure_ascii=False).encode()
    Path(os.environ["HEUN_HARVEST"]).write_bytes(gzip.compress(blob, 9, mtime=0))
