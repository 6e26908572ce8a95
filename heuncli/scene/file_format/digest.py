"""The digest of a text, by which results name the spec that they are of.

Of hashlib's own part alone, as Python's `random` takes it: hashlib itself loads OpenSSL first, 3 ms.
"""

from __future__ import annotations

try:
    from _sha2 import sha256  # type: ignore[import-not-found]
except ImportError:
    try:
        from _sha256 import sha256  # type: ignore[import-not-found] # before Python 3.12
    except ImportError:  # built without
        from hashlib import sha256


def digest(content: bytes | bytearray) -> str:
    """SHA-256, in hexadecimal digits."""
    found: str = sha256(content).hexdigest()
    return found
