"""Mutations of a file that know nothing of it: bits, bytes, lines, indentations, ends, splices with another file."""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from tests.faults import sources

INSERTED = (
    b"\0", b"\x07", b"\x1b[2J", b"\r", b"\r\n", b"\n", b"\t", b" ", b"\x7f", b"\x80", b"\xff", b"\xfe\xff",
    b"\xef\xbb\xbf",
    b"\xc2\x85", b"\xe2\x80\xa8", b"\xe2\x80\xae", b"\xe2\x80\x8b", b"\xed\xa0\x80", b"\xf0\x9f\x98\x80", b"\xc2\xa0",
    b"\xc2\xb2",
    b"&a ", b"*a", b"!!python/object:os.system ", b"!x ", b"<<: ", b"? ", b": ", b"- ", b"---\n", b"...\n",
    b"%YAML 1.1\n", b"#",
    b" #", b"|\n", b">\n", b"{", b"}", b"[", b"]", b",", b"'", b'"', b"\\", b"@", b"`", b"{{{{{{{{", b"[" * 2000,
    b"- " * 2000,
    b"9" * 3000, b"a" * 70000, b"1e", b"=", b"~", b"null", b"0x", b"0o", b".inf", b".nan", b"e400", b"**", b"t", b"-",
)  # fmt: skip


def mutated(random: Random) -> tuple[str, bytes]:
    """Some file's name, and its bytes changed one to five times."""
    name = random.choice(list(sources.texts()))
    content = sources.texts()[name]
    for _ in range(random.choice((1, 1, 2, 3, 5))):
        content = random.choice(MUTATIONS)(random, content)
    return name, content


def flipped(random: Random, content: bytes) -> bytes:
    """One bit."""
    if not content:
        return content
    i = random.randrange(len(content))
    return content[:i] + bytes([content[i] ^ 1 << random.randrange(8)]) + content[i + 1 :]


def cut(random: Random, content: bytes) -> bytes:
    """The end, the start or a stretch is missing."""
    i, j = sorted((random.randrange(len(content) + 1), random.randrange(len(content) + 1)))
    return random.choice((content[:i], content[j:], content[:i] + content[min(j, i + 20) :]))


def inserted(random: Random, content: bytes) -> bytes:
    """What YAML, a terminal or a decoder may stumble over."""
    i = random.randrange(len(content) + 1)
    return content[:i] + random.choice(INSERTED) + content[i:]


def spliced(random: Random, content: bytes) -> bytes:
    """The start of one file and the end of another."""
    other = random.choice(list(sources.texts().values()))
    return content[: random.randrange(len(content) + 1)] + other[random.randrange(len(other) + 1) :]


def in_lines(random: Random, content: bytes) -> bytes:
    """A line twice, missing, exchanged, or indented otherwise."""
    lines = content.split(b"\n")
    i, j = random.randrange(len(lines)), random.randrange(len(lines))
    match random.randrange(5):
        case 0:
            lines.insert(j, lines[i])
        case 1:
            del lines[i]
        case 2:
            lines[i], lines[j] = lines[j], lines[i]
        case 3:
            lines[i] = b" " * random.choice((1, 2, 4)) + lines[i]
        case _:
            lines[i] = lines[i][random.choice((1, 2)) :]
    return b"\n".join(lines)


def repeated(random: Random, content: bytes) -> bytes:
    """The whole file several times, or a stretch of it many times."""
    i = random.randrange(len(content) + 1)
    part = content[i : i + random.choice((1, 5, 40))]
    return random.choice((content * 2, content[:i] + part * random.choice((2, 50, 3000)) + content[i:]))


def encoded(random: Random, content: bytes) -> bytes:
    """Another encoding, or other ends of lines."""
    text = content.decode("utf-8", "replace")
    way = random.choice(("utf-16", "utf-32", "utf-8-sig", "latin-1", "cr", "crlf"))
    if way in ("cr", "crlf"):
        return content.replace(b"\n", b"\r" if way == "cr" else b"\r\n")
    return text.encode(way, "replace")


MUTATIONS: tuple[Callable[[Random, bytes], bytes], ...] = (
    flipped, flipped, cut, inserted, inserted, inserted, spliced, in_lines, in_lines, in_lines, repeated, encoded,
)  # fmt: skip
