"""What a scene's motion comes near to, of what methods cannot bear; with a verdict.

Impure: integrating looks at the clock.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from heuncli.analyses.probing.conditions import conditions_of, singular_events
from heuncli.analyses.probing.growth import across_plane, growing
from heuncli.analyses.probing.instants import SearchedMotion, attitudes, dead_centres, distinct_events
from heuncli.analyses.probing.results import Event, Probe
from heuncli.analyses.probing.stiffness import stiffness_of
from heuncli.analyses.probing.verdict import others, trouble
from heuncli.base.records import replace
from heuncli.scene.file_format.models import Spec
from heuncli.study.model.error_places import placed
from heuncli.study.model.options import Options
from heuncli.study.workflow import solve

MOST_EVENTS = 100  # that are listed of one kind and place


def probe(spec: Spec, options: Options) -> Probe:
    """Probe the motion of a spec, or its state. Raises what solving it raises."""
    with placed(spec):
        return probed(spec, options)


def probed(spec: Spec, options: Options) -> Probe:
    """The probe of a spec. Errors name bodies, joints and sections, but not where these stand in the file."""
    study = solve(spec, replace(options, wanted=frozenset({"motion"})))
    along = SearchedMotion(study)
    turns, turned = attitudes(along)
    centres, left = dead_centres(along)
    mass, closure, why = conditions_of(along)
    stiffness, no_stiffness = stiffness_of(along)
    growth, no_growth = growing(along)
    across, no_across = across_plane(along)
    listed, more = most_of(distinct_events([*turns, *centres, *singular_events(along)], along.span))
    checked, results = study.history.checked, study.results
    reasons = {
        "stiffness": no_stiffness, "growth_rate": no_growth, "condition": why, "out_of_plane": no_across,
        "dead centres": "; ".join(left),
    }  # fmt: skip
    found = Probe(
        title=spec.title,
        duration=along.span,
        model=dict(results.model),
        run_horizon=checked.horizon if checked is not None else None,
        error=float(study.history.estimate["motion"]),
        status=str(results.status["message"]) if results.status["code"] != "completed" else "",
        events=tuple(listed),
        attitudes=tuple(turned),
        mass=mass,
        closure=closure,
        stiffness=stiffness,
        growth=growth,
        across=across,
        reasons={key: text for key, text in reasons.items() if text},
        more=tuple(more),
    )
    return replace(found, trouble=tuple(trouble(found)), others=tuple(others(found)))


def most_of(events: Sequence[Event]) -> tuple[list[Event], list[tuple[str, str, int]]]:
    """The first so many events of each kind and place; how many more there are."""
    seen: Counter[tuple[str, str]] = Counter()
    listed = []
    for event in events:
        seen[event.kind, event.where] += 1
        if seen[event.kind, event.where] <= MOST_EVENTS:
            listed.append(event)
    return listed, [(*key, count - MOST_EVENTS) for key, count in seen.items() if count > MOST_EVENTS]
