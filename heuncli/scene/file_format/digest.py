"""Digest of a text, by which results name the spec they belong to.

Imports SHA-256 from Python's own C module, as `random` does, because hashlib loads OpenSSL first, which takes 3 ms.
"""

from __future__ import annotations

try:
    from _sha2 import sha256  # type: ignore[import-not-found]
except ImportError:
    try:
        from _sha256 import sha256  # type: ignore[import-not-found] # before Python 3.12
    except ImportError:  # Python built without it
        from hashlib import sha256


def digest(content: bytes | bytearray) -> str:
    """Return the SHA-256 digest in hexadecimal digits."""
    digits: str = sha256(content).hexdigest()
    return digits
