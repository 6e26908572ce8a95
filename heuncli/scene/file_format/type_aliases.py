"""Common words for types of joints and loads, accepted in place of heun's own words.

`replace_type_aliases` puts heun's words in their place before anything else reads the data. So results, messages and
all later code know one word for each type.
"""

from __future__ import annotations

from typing import Any

TYPE_ALIASES: dict[str, dict[str, str]] = {  # by block: the accepted word, heun's word
    "joints": {"hinge": "pin", "revolute": "pin", "prismatic": "slide", "spherical": "ball", "fixed": "weld"},
    "forces": {"torsion_spring": "turn_spring"},
}


def replace_type_aliases(data: dict[str, Any]) -> dict[str, Any]:
    """Return the data with heun's words as types. What does not change is shared with the given data."""
    changed_blocks = {
        block: _replace_in_block(data[block], aliases)
        for block, aliases in TYPE_ALIASES.items()
        if any(_find_type(entry, aliases) for entry in _list_entries(data.get(block)))
    }
    return {**data, **changed_blocks} if changed_blocks else data


def list_aliases(block: str, type_name: str) -> list[str]:
    """List the words that are accepted for a type of a block."""
    return [alias for alias, name in TYPE_ALIASES.get(block, {}).items() if name == type_name]


def _list_entries(block: Any) -> list[Any]:
    return list(block.values()) if type(block) is dict else []


def _find_type(entry: Any, aliases: dict[str, str]) -> str | None:
    """Return heun's word for the type of an entry, if the entry has another one."""
    word = entry.get("type") if type(entry) is dict else None
    return aliases.get(word) if type(word) is str else None


def _replace_in_block(entries: dict[str, Any], aliases: dict[str, str]) -> dict[str, Any]:
    found = {name: _find_type(entry, aliases) for name, entry in entries.items()}
    return {name: {**entry, "type": found[name]} if found[name] else entry for name, entry in entries.items()}
