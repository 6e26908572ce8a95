"""Connect to a Dask cluster, or say why that fails.

Only this module imports `distributed`, and only if a cluster is requested. Impure: the network; silences the log and
the warnings of `distributed`.
"""

from __future__ import annotations

import logging
import socket
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any
from urllib.parse import urlsplit

from heuncli.app.cli.entry import UsageError
from heuncli.base.errors import LimitError, Problem

PATIENCE = 10.0  # seconds for an answer of the scheduler
SCHEMES = ("tcp", "tls")
EXAMPLE = "for example --dask tcp://127.0.0.1:8786; `dask scheduler` prints its address at start"
INSTALL = 'pip install "heuncli[dask]"'
TLS = "tls:// takes certificates: DASK_DISTRIBUTED__COMM__TLS__CA_FILE and the other keys of distributed.comm.tls"
# Hints for addresses with another scheme.
SCHEME_HINTS = {
    "http": "this is the dashboard; the scheduler has another port: --dask tcp://HOST:8786",
    "https": "this is the dashboard; the scheduler has another port: --dask tcp://HOST:8786",
    "inproc": "a cluster inside another process cannot be reached; use LocalCluster(processes=True)",
}
LOGGERS = ("distributed", "distributed.client", "distributed.core", "tornado", "tornado.application", "asyncio")
IGNORED_WARNINGS = ("Sending large graph", "\\n?Mismatched versions")  # the beginnings of warnings


class ClusterGone(LimitError):
    """The cluster went away during the work; earlier results remain in the store, if there is one."""

    def __init__(self, address: str, why: str) -> None:
        hint = "--store FILE keeps solved variants; the same command continues from there"
        super().__init__(Problem("cluster-gone", f"--dask {address}: {why}", hint=hint))


@contextmanager
def connect(address: str) -> Iterator[Any]:
    """Provide a client of the scheduler at an address. Raises UsageError: bad-option, missing-extra, no-cluster."""
    host, port = parse_address(address)
    distributed = _import_distributed()
    _require_listener(address, host, port)
    try:
        client = distributed.Client(address, timeout=PATIENCE, set_as_default=False, name="heun-sweep")
    except Exception as error:
        hint = TLS if address.startswith("tls:") else "is it a Dask scheduler, of the same version of distributed?"
        raise _make_no_cluster_error(
            address, f"no scheduler answers: {str(error) or type(error).__name__}", hint
        ) from None
    try:
        yield client
    finally:
        with suppress(Exception):
            client.close(timeout=PATIENCE / 5)


def parse_address(address: str) -> tuple[str, int]:
    """Return host and port of an address. Raises UsageError."""
    scheme, separator, rest = address.partition("://")
    if not separator:
        raise UsageError(Problem("bad-option", f"--dask {address}: expected tcp://HOST:PORT", hint=EXAMPLE))
    if scheme not in SCHEMES:
        message = f"--dask {address}: no address of a scheduler begins with {scheme}://; accepted: tcp://, tls://"
        raise UsageError(Problem("bad-option", message, hint=SCHEME_HINTS.get(scheme, EXAMPLE)))
    try:
        parts = urlsplit(f"//{rest}")
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if not host or not port or rest != parts.netloc:
        raise UsageError(Problem("bad-option", f"--dask {address}: expected {scheme}://HOST:PORT", hint=EXAMPLE))
    return host, port


def _require_listener(address: str, host: str, port: int) -> None:
    """Raise UsageError if nothing listens: `distributed` would try again until its timeout."""
    try:
        socket.create_connection((host, port), timeout=PATIENCE).close()
    except socket.gaierror:
        raise _make_no_cluster_error(address, f"unknown host '{host}'", EXAMPLE) from None
    except (OSError, UnicodeError) as error:
        is_refused = isinstance(error, ConnectionRefusedError)
        is_timeout = isinstance(error, TimeoutError)
        why = (
            "nothing listens there" if is_refused else f"no answer within {PATIENCE:g} s" if is_timeout else str(error)
        )
        raise _make_no_cluster_error(
            address, why, "is the scheduler running? `dask scheduler` prints its address"
        ) from None


def _make_no_cluster_error(address: str, why: str, hint: str) -> UsageError:
    """Make the error of a scheduler that cannot be used."""
    return UsageError(Problem("no-cluster", f"--dask {address}: {why}", hint=hint))


def _import_distributed() -> Any:
    """Import the package and silence it. Raises UsageError."""
    for beginning in IGNORED_WARNINGS:
        warnings.filterwarnings("ignore", message=beginning)
    try:
        import distributed
    except ImportError as error:
        is_missing = isinstance(error, ModuleNotFoundError) and error.name == "distributed"
        why = "" if is_missing else f" ({error})"
        raise UsageError(
            Problem("missing-extra", f"--dask: the package distributed is not installed{why}", hint=INSTALL)
        ) from None
    for name in LOGGERS:
        logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    return distributed
