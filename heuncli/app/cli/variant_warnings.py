"""What a command that solves many variants warns of: each sentence once, with how many of them it holds of."""

from __future__ import annotations

from heuncli.analyses.variants.once import AnswersOnce
from heuncli.app.cli.output import say
from heuncli.app.cli.solving import warn
from heuncli.scene.file_format.models import Spec


def warn_of_variants(spec: Spec, once: AnswersOnce, quiet: bool) -> None:
    """Tell what reading the spec and solving its variants warn of."""
    warn(spec, None, quiet)
    for text, variants in ({} if quiet else once.warnings()).items():
        say(f"warning: heun: {text} (in {variants} of {once.runs} variants)")
