"""The rows of a sweep as Parquet, by pyarrow, which is an extra of its own (heuncli[parquet]): the columns of the CSV.

Numbers are doubles, the variant's own number is a 64-bit integer; what is not known is null. The file's metadata holds
title, version and the spec's digest under `heun`, as JSON.
"""

from __future__ import annotations

import importlib.util
import io
import json
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from heuncli.analyses.sweep_store.columns import SweepColumns, columns_of
from heuncli.analyses.sweep_store.rows import SweepHead, SweptRow
from heuncli.base.errors import Problem, SpecError

GROUP = 50_000  # rows that are written together
INSTALL = 'pip install "heuncli[parquet]"; or -o sweep.csv, which needs nothing'


class WrittenPart(io.RawIOBase):
    """Takes what is written and hands it on; knows how much there was, which is all that a Parquet file asks of it."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._written = 0

    def writable(self) -> bool:
        """It is."""
        return True

    def write(self, part: Any) -> int:
        """Take a part."""
        self._parts.append(bytes(part))
        self._written += len(self._parts[-1])
        return len(self._parts[-1])

    def tell(self) -> int:
        """How much was written."""
        return self._written

    def handed_on(self) -> bytes:
        """What was written since the last time."""
        parts, self._parts = self._parts, []
        return b"".join(parts)


def require_parquet() -> None:
    """Say before the work that pyarrow is missing. Raises SpecError."""
    if importlib.util.find_spec("pyarrow") is None:
        raise SpecError(Problem("missing-extra", "Parquet is written by pyarrow, which is not installed", hint=INSTALL))


def parquet_pieces(head: SweepHead, rows: Iterable[SweptRow]) -> Iterator[bytes]:
    """The file in pieces."""
    require_parquet()
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = columns_of(head)
    fields = list(zip(columns.heads, _types(pa, columns), strict=True))
    schema = pa.schema(fields, metadata={"heun": json.dumps(_metadata(head))})
    sink, left = WrittenPart(), iter(rows)
    with pq.ParquetWriter(sink, schema) as writer:
        while (group := _group(pa, schema, columns, left)).num_rows:
            writer.write_table(group)
            yield sink.handed_on()
    yield sink.handed_on()


def _group(pa: Any, schema: Any, columns: SweepColumns, rows: Iterator[SweptRow]) -> Any:
    """The next rows as a table; empty at their end."""
    cells = [columns.cells(row) for row in islice(rows, GROUP)]
    by_column = zip(*cells, strict=True) if cells else [()] * len(schema.types)
    arrays = [pa.array(own, kind) for own, kind in zip(by_column, schema.types, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)


def _types(pa: Any, columns: SweepColumns) -> list[Any]:
    """The types of the columns, in their order."""
    of_parameters = [pa.string() if one.unit is None else pa.float64() for one in columns.parameters]
    of_measures = [pa.float64()] * (3 * len(columns.measures))
    return [pa.int64(), *of_parameters, *of_measures, pa.string(), pa.string()]


def _metadata(head: SweepHead) -> dict[str, str]:
    return {"version": head.version, "title": head.title, "spec": head.path, "sha256": head.sha256}
