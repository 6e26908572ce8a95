"""What a run is made of, counted: states answered, self-stresses looked for, cuts, evaluations; no times."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from heuncli.loads.redundancy import self_stress
from heuncli.motion.integration.evaluator import Evaluator
from heuncli.output.tables.page import TABLE_DEFAULT, make_page
from heuncli.scene.file_format.load import load
from heuncli.study.compose import section_blocks
from heuncli.study.model.options import Options
from heuncli.study.quantities.labels import make_labels
from heuncli.study.workflow import solve

Counts = Counter[str]


@contextmanager
def counted() -> Iterator[Counts]:
    """Count what is asked for meanwhile.

    answered: states whose accelerations and loads the kernel was asked for; each is a factorisation, or two where it
    has to be closed. looked: instants at which self-stresses were looked for. cuts: instants times cuts.
    """
    found: Counts = Counter()

    def counting(owner: Any, name: str, key: str, how_many: Callable[..., int], patch: pytest.MonkeyPatch) -> None:
        own = getattr(owner, name)

        def wrapped(*values: Any, **named: Any) -> Any:
            found[key] += how_many(*values)
            return own(*values, **named)

        patch.setattr(owner, name, wrapped)

    with pytest.MonkeyPatch.context() as patch:
        counting(Evaluator, "_recover", "answered", lambda _, arrays, *more: len(arrays["times"]), patch)
        counting(self_stress, "jacobian", "looked", lambda _, layout, times, *more: len(times), patch)
        counting(
            section_blocks,
            "make_section_block",
            "cuts",
            lambda cuts, states, *more: len(states.x) * cuts.points.shape[-2],
            patch,
        )
        yield found


def counts_of(text: str, *, table: bool = False) -> Counts:
    """Of one run, as JSON is made of it; table: and as its tables are, with the extremes searched."""
    spec = load("scene.yaml", text)
    with counted() as found:
        study = solve(spec, Options(requested_reports=TABLE_DEFAULT if table else None))
        if table:
            page = make_page(study.results, make_labels(study.spec), study.magnitudes)
            study.search_extremes(page.make_search(), TABLE_DEFAULT, whole=True)
    found["evaluations"] = study.results.work["evaluations"]
    found["steps"] = study.results.work["steps"]
    return found
