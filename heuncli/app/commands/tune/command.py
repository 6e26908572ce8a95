"""`heun tune`: the values of parameters for which a measure is best."""

from __future__ import annotations

from collections import Counter

from heuncli.analyses.tune.results import TuneResults
from heuncli.analyses.tune.study import Tuning
from heuncli.analyses.tune.trials import Trials
from heuncli.analyses.variants.asking import Asker, Recipe
from heuncli.app.cli import alarm
from heuncli.app.cli.entry import UsageError
from heuncli.app.cli.guard import require_other_file, same_file
from heuncli.app.cli.output import emit, save
from heuncli.app.cli.progress import progress
from heuncli.app.cli.solving import overrides, tolerance, warn
from heuncli.app.cli.target import format_of, require_room
from heuncli.app.cli.units import say_what_stays, units
from heuncli.app.commands.tune import page
from heuncli.app.commands.tune.answering import Answering
from heuncli.app.commands.tune.asked import AskedTuning, asked_by, task_of
from heuncli.app.commands.tune.history import to_csv
from heuncli.app.commands.tune.request import FORMATS, TuneRequest
from heuncli.app.commands.tune.told import TunedScene, block, line_to_paste
from heuncli.base.errors import LimitError, Problem, SolveError
from heuncli.base.files import STDOUT
from heuncli.output.tables.export import dump
from heuncli.scene.file_format.models import Spec
from heuncli.scene.file_format.source import text_in
from heuncli.study.model.options import Options

LIMIT_REACHED, NOT_GOOD = 4, 1


def main(request: TuneRequest) -> int:
    """Run the command; returns the exit code."""
    asked = asked_by(request)
    require_other_file(request.output, [asked.path])
    form = format_of(request.format, request.output, FORMATS)
    shown_in = units(request.units)
    require_sense(request, asked)
    asker = Asker(recipe_of(request, asked))
    require_other_file(request.output, [asked.path])
    if request.history is not None:
        require_other_file(request.history, [asked.path], "--history")
    tuning = searched(request, asked, asker)
    found = tuning.results()
    require_answer(found)
    spec = asker.spec
    scene = TunedScene(spec.title, spec.path, spec.sha256, line_to_paste(asked, asker.recipe, found))
    if request.history is not None:
        save(to_csv(found).encode(), request.history)
    text = dump(block(found, scene)) if form == "json" else page.write(found, scene, shown_in, request.output)
    emit(text, request.output, late=True)
    say_what_stays(request.units, form, request.quiet)
    return leave(request, found, spec)


def require_sense(request: TuneRequest, asked: AskedTuning) -> None:
    """Raise UsageError where options do not go together, or numbers mean nothing."""
    if request.jobs is not None and request.jobs < 1:
        raise UsageError(Problem("bad-option", f"--jobs {request.jobs}: expected 1 or more", hint="such as --jobs 2"))
    if request.history is None:
        return
    require_room(request.history, "--history")
    if same_file("/dev/stdout" if request.output in (None, STDOUT) else request.output, request.history):
        message = f"--history {request.history}: that is where the result goes"
        raise UsageError(Problem("bad-option", message, hint="name another file"))


def recipe_of(request: TuneRequest, asked: AskedTuning) -> Recipe:
    """What every variant is made of. Raises UsageError, SpecError."""
    options = Options(tolerance=tolerance(request.tolerance), reduce=not request.no_reduce)
    measures = asked.measures
    return Recipe(asked.path, text_in(asked.path), measures, options, overrides(request.set), request.case)


def searched(request: TuneRequest, asked: AskedTuning, asker: Asker) -> Tuning:
    """The search as far as it came. Raises UsageError, AxisError, SpecError; LimitError where nothing was solved."""
    task = task_of(request, asked, asker)
    answering = Answering(asker, request.jobs)
    with progress(request.quiet) as tell:
        own = answering.own()
        trials = Trials(task, answering, tell)
        tuning = Tuning(trials, own)
        try:
            tuning.run()
        except alarm.TimeUp:
            trials.time_is_up = True
        if trials.time_is_up:  # what was found is told, however long that takes
            alarm.disarm(late=True)
    if trials.time_is_up and trials.best() is None:
        message = "the time limit was reached before any variant was solved"
        raise LimitError(Problem("time-limit", message, hint="a longer --time-limit"))
    return tuning


def require_answer(found: TuneResults) -> None:
    """Raise SolveError where no variant could be solved."""
    if found.best is None:
        code, times = Counter(trial.failure[0] for trial in found.history).most_common(1)[0]
        reason = next(trial.failure[1] for trial in found.history if trial.failure[0] == code)
        message = f"none of {len(found.history)} variants could be solved; {times} of them as this one: {reason}"
        raise SolveError(Problem(code, message, hint="heun run --set with one of them tells more; or other bounds"))


def leave(request: TuneRequest, found: TuneResults, spec: Spec) -> int:
    """Tell the warnings of the best variant; returns the exit code."""
    assert found.best is not None
    read = {problem.message for problem in spec.warnings}
    warn(spec, None, request.quiet, later=[text for text in found.best.outcome.warnings if text not in read])
    if found.ending == "time":
        return LIMIT_REACHED
    return NOT_GOOD if request.strict and found.ending != "converged" else 0
