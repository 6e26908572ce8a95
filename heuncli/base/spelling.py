"""Words of messages: hints for unknown words, lists and counts of things, lines of a width.

A search among all names of a large scene takes time proportional to its size; a search for each of thousands of unknown
words takes the square of it. So only the first dozens of unknown words in a file get suggestions.

"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from itertools import chain, islice
from typing import Any

MAX_LISTED = 20
# characters of a word for which another one is suggested: comparing goes by the square of the length
MAX_WORD_LENGTH = 60
# pairs of characters compared for a file, a quarter of a second: 40 words among 5,000 names of 5
MAX_EFFORT = 16_000_000

UNORDERED = (set, frozenset)  # their order changes from run to run
WORD_OVERHEAD = 4  # characters that a name costs by itself


class _EffortBudget:
    """The effort left for the present file. State of the module: hints are made in forty places."""

    remaining = MAX_EFFORT


def reset_effort() -> None:
    """Restore the full effort at the beginning of another file."""
    _EffortBudget.remaining = MAX_EFFORT


def spend_effort(effort: int) -> bool:
    """Return whether the effort left for this file suffices for a search; if so, subtract it."""
    if effort > _EffortBudget.remaining:
        _EffortBudget.remaining = 0  # from here on none: not one here and one there
        return False
    _EffortBudget.remaining -= effort
    return True


def remaining_effort() -> int:
    """Return the effort left for this file."""
    return _EffortBudget.remaining


def restore_effort(effort: int) -> None:
    """Give back the effort spent since it was this: what it was spent on is done again."""
    _EffortBudget.remaining = effort


def find_similar(word: str, *candidates: Collection[str]) -> str | None:
    """Return the known word most similar to `word`; None if none is similar or the effort is used up."""
    if len(word) > MAX_WORD_LENGTH or not spend_effort(sum(map(len, candidates)) * (len(word) + WORD_OVERHEAD) ** 2):
        return None
    return _most_similar(
        word, chain.from_iterable(sorted(words) if isinstance(words, UNORDERED) else words for words in candidates)
    )


def _most_similar(word: str, candidates: Iterable[str]) -> str | None:
    """Return the candidate most similar to a word, in any case; None if none is close."""
    import difflib  # only on the way to an error

    comparable = [name for name in candidates if len(name) <= MAX_WORD_LENGTH]
    for name in comparable:
        if name.lower() == word.lower():
            return name
    matches = difflib.get_close_matches(word, comparable, 1, 0.65)
    return matches[0] if matches else None


def match_misspelt_keys(data: Mapping[str, Any], known_keys: Collection[str]) -> dict[str, Any]:
    """Return the values under unknown keys, by the known key that each resembles, so that a misspelt key is not
    reported as missing.
    """
    # whatever was suggested before: what else is wrong with an entry does not depend on that
    unknown = {key: value for key, value in data.items() if key not in known_keys and len(key) <= MAX_WORD_LENGTH}
    by_known_key = {word: value for key, value in unknown.items() if (word := _most_similar(key, known_keys))}
    return {word: value for word, value in by_known_key.items() if word not in data}


def suggest(word: str, candidates: Collection[str], kind: str) -> str:
    """Return 'did you mean x?', or the list of known words, or that there are none."""
    similar = find_similar(word, candidates)
    if similar is not None:
        return f"did you mean {similar}?"
    if not candidates:
        return f"no {kind} are defined"
    return f"known {kind}: {list_words(candidates)}"


def list_words(candidates: Collection[str]) -> str:
    """Return the first words as a comma-separated list; a set is sorted alphabetically, for it has no order."""
    candidates = sorted(candidates) if isinstance(candidates, UNORDERED) else candidates
    return ", ".join(islice(candidates, MAX_LISTED)) + (", ..." if len(candidates) > MAX_LISTED else "")


CONTINUATION_INDENT = 4  # additional indent of the continuation lines of a long heading, title or note


def wrap_text(text: str, width: int | None, extra_indent: int = CONTINUATION_INDENT) -> list[str]:
    """Wrap a text to lines of at most `width`; `textwrap` would have to be imported, and ignores clauses."""
    lines = [text]
    while width is not None and len(lines[-1]) > width:
        line, start = lines[-1], len(lines[-1]) - len(lines[-1].lstrip())
        cut = _find_break(line, start, width)
        if cut < 0:
            break  # one long word
        lead = " " * (start if len(lines) > 1 else start + extra_indent)
        lines[-1:] = [line[:cut].rstrip(), lead + line[cut:].lstrip()]
    return lines


def _find_break(line: str, start: int, width: int) -> int:
    """Return the blank at which to break a line: after a clause that ends in its last third and not within brackets, or
    else the last.
    """
    blanks = [i for i in range(start + 1, min(width + 1, len(line))) if line[i] == " "]
    late_clauses = [i for i in blanks if line[i - 1] in ",;" and 3 * i > 2 * width]
    clause_ends = [i for i in late_clauses if line.count("(", 0, i) == line.count(")", 0, i)]
    return max(clause_ends or blanks, default=line.find(" ", max(width, start + 1)))


MAX_NAMES = 5  # listed in a sentence


def format_count(n: int, one: str, many: str | None = None) -> str:
    """Format a number of things; many: the plural, if it is not the singular with an s."""
    return f"{n:,} {one if n == 1 else many or one + 's'}"


def list_some(names: Sequence[str]) -> str:
    """List the first names, and how many more there are."""
    more = len(names) - MAX_NAMES
    return ", ".join(names[:MAX_NAMES]) + (f" and {more} more" if more > 0 else "")


MAX_JOINED_NAMES = 6  # in a sentence


def join_names(names: Sequence[str]) -> str:
    """Join names as in a sentence, only the first of many."""
    if len(names) > MAX_JOINED_NAMES:
        return f"{', '.join(names[:MAX_JOINED_NAMES])} and {len(names) - MAX_JOINED_NAMES} more"
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def choose_verb_form(names: Sequence[str], one: str, several: str) -> str:
    """Return the form of a verb that fits so many names."""
    return one if len(names) == 1 else several
