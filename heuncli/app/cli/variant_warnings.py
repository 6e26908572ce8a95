"""Print the warnings of a command that solves many variants: each sentence once, with the number of variants it holds
for.
"""

from __future__ import annotations

from heuncli.analyses.variants.evaluation import CachedEvaluator
from heuncli.app.cli.output import print_stderr
from heuncli.app.cli.solving import print_warnings
from heuncli.scene.file_format.models import Spec


def print_variant_warnings(spec: Spec, evaluator: CachedEvaluator, quiet: bool) -> None:
    """Print the warnings of reading the spec and of solving its variants."""
    print_warnings(spec, None, quiet)
    for text, variants in ({} if quiet else evaluator.count_warnings()).items():
        print_stderr(f"warning: heun: {text} (in {variants} of {evaluator.runs} variants)")
