"""Split the text of an expression into tokens, read them from left to right, and report those that are not expected.

Tokens are numbers, names and marks; each error has a hint.
"""

from __future__ import annotations

import re
from functools import lru_cache

from heuncli.base.errors import Finding
from heuncli.base.units import unit_place_hint
from heuncli.scene.expressions.scope import WORDS, Scope

TOKEN = re.compile(
    r"\s*+(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)|(?P<name>[^\W\d]\w*)|(?P<mark>\*\*|[<>=!]=|//|&&|\|\||\S))"
)
MAX_CACHED_TEXTS = 1024  # size of the cache: variants of a spec parse the same texts again
END_PADDING = ("",) * 4  # the parser looks ahead this far


@lru_cache(maxsize=MAX_CACHED_TEXTS)
def tokenize(text: str) -> tuple[tuple[tuple[str, str, int], ...], tuple[str, ...], tuple[str, ...]]:
    """Split a text into tokens: kind, word and end of each; then kinds and words alone, padded after the last."""
    found = tuple((one.lastgroup or "", one[one.lastgroup or 0], one.end()) for one in TOKEN.finditer(text))
    return found, tuple(kind for kind, _, _ in found) + END_PADDING, tuple(word for _, word, _ in found) + END_PADDING


class TokenReader:
    """The tokens of a text and the position among them; a parser of the grammar derives from it."""

    def __init__(self, text: str, scope: Scope) -> None:
        self.text, self.scope = text, scope
        self.tokens, self.kinds, self.words = tokenize(text)
        self.position = 0

    @property
    def token(self) -> str:
        """The next token; empty at the end."""
        return self.words[self.position]

    @property
    def kind(self) -> str:
        return self.kinds[self.position]

    def take_token(self, token: str) -> bool:
        if self.words[self.position] == token:
            self.position += 1
            return True
        return False

    def expect_token(self, token: str, purpose: str) -> None:
        if not self.take_token(token):
            found = f", found '{self.token}'" if self.token else ""
            hint = f"put '{token}' before it" if found else "inside { } and [ ] an expression with a comma needs quotes"
            raise self.syntax_error(f"expected '{token}' {purpose}{found}", hint)

    def syntax_error(self, message: str, hint: str) -> Finding:
        place = (
            self.tokens[self.position][2] - len(self.token) + 1
            if self.position < len(self.tokens)
            else len(self.text) + 1
        )
        return Finding("expression-syntax", f"'{self.text.strip()}' at character {place}: {message}", hint)

    def unexpected_token_error(self) -> Finding:
        """Make the error of a token that does not belong here, with a hint for what was probably meant."""
        hints = {
            "^": "write ** for a power", "%": "write x - n*y; there is no remainder operator", "//": "write /",
            "&&": "write and", "||": "write or", "&": "write and", "|": "write or", "!": "write not",
            "=": "compare with > or <, or with == in a choice",
            ":": "for cases write a if c else b", "?": "for cases write a if c else b",
            "×": "write *", "·": "write *", "÷": "write /", "−": "write a plain minus sign -",
        }  # fmt: skip
        if not self.token:
            return self.syntax_error("it ends too early", "a value is missing, e.g. 2*L or 5*sin(t)")
        hint = hints.get(self.token)
        if self.token == "%" and self.position == len(self.tokens) - 1:
            hint = "write 0.5 for 50 %"
        if hint is None and self.kind == "name" and self.position and self.tokens[self.position - 1][0] != "number":
            hint = self.suggest_product()
        if (
            hint is None
            and self.token not in WORDS
            and self.kind in ("name", "number")
            and self.position
            and self.tokens[self.position - 1][0] in ("name", "number")
        ):
            before = self.tokens[self.position - 1][1]
            hint = f"for a product write {before}*{self.token}"
        if hint is None:
            hint = self.suggest_product() if self.position else None
        if hint is None and self.token == ",":
            hint = self.suggest_decimal_point(self.position)
        if hint is None and self.token == "if":
            hint = "for cases write a if c else b"
        if hint is None and self.token == "[":
            hint = "put points in a table: tables: {NAME: {x: [0, 1], y: [5, 7]}}, and write table(NAME, x) here"
        if hint is None and self.token == "." and self.position and self.tokens[self.position - 1][1] == ")":
            hint = "only joints have coordinates: shaft.angle, guide.travel"
        plain = "an expression consists of numbers, names, + - * / ** and ( )"
        return self.syntax_error(f"'{self.token}' is not expected here", hint or plain)

    def suggest_product(self) -> str | None:
        """Make a hint for 2(t + 1), and for a unit after an expression."""
        kind, before, _ = self.tokens[self.position - 1]
        if self.token == "(" and (kind == "number" or before == ")"):
            return f"for a product write {before}*("
        if before in (")", "t") and self.kind == "name":
            return unit_place_hint(self.token)
        return None

    def suggest_decimal_point(self, comma: int) -> str | None:
        """Make a hint for 1,5: the comma stands right between two numbers."""
        around = self.tokens[max(comma - 1, 0) : comma + 2]
        if [kind for kind, _, _ in around] != ["number", "mark", "number"]:
            return None
        (_, whole, _), (_, _, end), (_, part, last) = around
        if last - len(part) != end or not part.isdigit():
            return None
        return f"use a decimal point: {whole}.{part}"

    def text_since(self, begin: int) -> str:
        """Return the text from token number `begin` to the last one taken."""
        first = self.tokens[begin]
        return self.text[first[2] - len(first[1]) : self.tokens[self.position - 1][2]]
