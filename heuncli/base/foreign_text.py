"""Text that others wrote (titles, keys, file names, words of the command line), as it may stand on a terminal.

What would steer a terminal, end a line or hide is written as JSON escapes it: a title cannot forge an error, nor a
right-to-left mark turn a number round. The same notation serves JSON, where it means the character itself.
"""

from __future__ import annotations

# Controls, line and paragraph separators, marks without width or that turn the direction of reading, halves of pairs
# (bytes of a file name that are not UTF-8), tags, and what is no character.
UNSEEN = (
    "[\x00-\x1f\x7f-\x9f\u00ad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ud800-\udfff\ufeff\ufff9-\ufffb\ufffe"
    "\uffff\U000e0000-\U000e007f]"
)
SHORT = {"\n": "\\n", "\r": "\\r", "\t": "\\t", "\b": "\\b", "\f": "\\f"}


def shown(text: str) -> str:
    """The text on one line, with what is unseen escaped."""
    if text.isprintable():
        return text
    import re  # nearly all text is printable, and most commands begin without

    return re.sub(UNSEEN, lambda found: escaped(found[0]), text)


def shown_lines(text: str) -> str:
    """A foreign text of several lines as `shown` shows each of them."""
    return "\n".join(map(shown, text.split("\n")))


def escaped(text: str) -> str:
    """Every character as JSON escapes it."""
    return "".join(SHORT.get(letter) or _by_number(ord(letter)) for letter in text)


def _by_number(code: int) -> str:
    if code < 0x10000:
        return f"\\u{code:04x}"
    high, low = divmod(code - 0x10000, 0x400)
    return f"\\u{0xD800 + high:04x}\\u{0xDC00 + low:04x}"
