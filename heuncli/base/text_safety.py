"""Make text that others wrote (titles, keys, file names, command-line words) safe to print on a terminal.

Characters that would steer a terminal, end a line or be invisible are escaped as in JSON: a title cannot forge an
error, and a right-to-left mark cannot turn a number round. The same notation serves JSON, where it means the character
itself.
"""

from __future__ import annotations

# Controls, line and paragraph separators, marks without width or that turn the direction of reading, halves of pairs
# (bytes of a file name that are not UTF-8), tags, and what is no character.
UNSAFE = (
    "[\x00-\x1f\x7f-\x9f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb\ufffe"
    "\uffff\U000e0000-\U000e007f]"
)
SHORT_ESCAPES = {"\n": "\\n", "\r": "\\r", "\t": "\\t", "\b": "\\b", "\f": "\\f"}


def escape(text: str) -> str:
    """Return the text on one line, with unsafe and invisible characters escaped."""
    if text.isprintable():
        return text
    import re  # nearly all text is printable, and most commands begin without

    return re.sub(UNSAFE, lambda found: escape_all(found[0]), text)


def escape_lines(text: str) -> str:
    """Escape each line of a text of several lines."""
    return "\n".join(map(escape, text.split("\n")))


def escape_all(text: str) -> str:
    """Escape every character of a text as JSON does."""
    return "".join(SHORT_ESCAPES.get(letter) or _unicode_escape(ord(letter)) for letter in text)


def _unicode_escape(code: int) -> str:
    """Escape a character as in JSON."""
    if code < 0x10000:
        return f"\\u{code:04x}"
    high, low = divmod(code - 0x10000, 0x400)
    return f"\\u{0xD800 + high:04x}\\u{0xDC00 + low:04x}"
