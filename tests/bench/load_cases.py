"""What the load cases of a body take beyond the run whose they are: processor time, the least of several."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from heuncli.analyses.load_cases.assembly import assemble_load_cases
from heuncli.output.fe_decks.decks import DECKS, DeckNames
from heuncli.scene.file_format.load import load
from heuncli.study.model.options import Options
from heuncli.study.queries.at_option import parse
from heuncli.study.workflow import solve

SPECS = Path(__file__).parents[2] / "specs"
CASES = (
    ("conrod", "rod", "0.0031,first,last"),
    ("conrod", "rod", "peak:sections.rod.M2"),
    ("engine", "rod", "0.01,last"),
    ("engine", "rod", "peak:joints.main.force"),
    ("crane", "jib", "first,last"),
)
TIMES = 7
NAMES = DeckNames(1001, "BODY")


def load_cases() -> None:
    """Print them."""
    for name, body, at in CASES:
        spec = load(SPECS / f"{name}.yaml")
        run = least_ms(lambda spec=spec: solve(spec, Options(requested_reports=frozenset({"joints", "sections"}))))  # type: ignore[misc]
        asked = parse(at)
        took = min(_export(spec, body, asked) for _ in range(TIMES))
        print(f"export loads {name:8} {at:28} run {run:6.1f} ms, cases and all decks {took:5.1f} ms more")


def _export(spec: Any, body: str, asked: Any) -> float:
    """The cases of a run that is fresh, and a deck of each form that needs no mesh [ms]."""
    study = solve(spec, Options(requested_reports=frozenset({"joints", "sections"})))

    def written() -> None:
        cases = assemble_load_cases(study, body, asked)
        for form in ("csv", "nastran", "ansys", "abaqus"):
            "".join(DECKS[form].iter_text(cases, NAMES))

    return once_ms(written)


def least_ms(call: Callable[[], Any]) -> float:
    """The least of several calls [ms]."""
    return min(once_ms(call) for _ in range(TIMES))


def once_ms(call: Callable[[], Any]) -> float:
    """Processor time of a call [ms]."""
    begun = time.process_time()
    call()
    return 1e3 * (time.process_time() - begun)
