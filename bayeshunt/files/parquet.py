"""Parquet files that notice damage: a record and a digest of every row group, checked on reading.

A file holds one table and one record (a JSON object: what made the table). Parquet itself does not
notice a flipped bit; here every page carries a checksum, the record carries a SHA-256 of itself and
of the content of each row group. Files without a record or without digests, made by other programs,
are read as they are.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from bayeshunt.core.errors import DataError
from bayeshunt.files.atomic import replace_atomically
from bayeshunt.files.records import digest as checksum

__all__ = [
    "KEY",
    "PROVENANCE_KEY",
    "ROW_GROUP",
    "Reader",
    "digest",
    "read",
    "seal",
    "storable",
    "unseal",
    "write",
    "write_groups",
]

#: Key of the record in the Parquet file's metadata.
KEY = b"bayeshunt"
#: The same for people: the key of a table's record in ``frame.attrs``.
PROVENANCE_KEY = KEY.decode()
#: Rows of a row group: what is held in memory at a time when a file is streamed.
ROW_GROUP = 100_000

#: Where the record keeps its checksums.
_SEAL = "seal"


def storable(table: Any) -> Any:
    """Return an Arrow table as it comes back from a Parquet file, which keeps no dictionaries but those of text.

    Raises ArrowException for a column that Parquet cannot hold, before anything is written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq
    import pyarrow.types as types

    for place, field in enumerate(table.schema):
        values = field.type.value_type if types.is_dictionary(field.type) else None
        if values is not None and not (types.is_string(values) or types.is_large_string(values)):
            table = table.set_column(place, field.name, table.column(place).cast(values))
    pq.ParquetWriter(pa.BufferOutputStream(), table.schema).close()
    return table


def write(table: Any, record: dict[str, Any], path: str | os.PathLike[str]) -> None:
    """Write an Arrow table and its record as one Parquet file, replaced atomically."""
    groups = [table.slice(start, ROW_GROUP) for start in range(0, table.num_rows, ROW_GROUP)] or [table]
    write_groups(table.schema, iter(groups), [digest(group) for group in groups], record, path)


def write_groups(
    schema: Any, groups: Iterator[Any], digests: list[str], record: dict[str, Any], path: str | os.PathLike[str]
) -> None:
    """Write Arrow tables, one per row group, as one Parquet file, replaced atomically.

    Only one group is in memory at a time; ``digests`` holds the :func:`digest` of each, in order.
    """
    import pyarrow.parquet as pq

    schema = schema.with_metadata({KEY: seal(record, digests)})
    with (
        replace_atomically(path) as temporary,
        pq.ParquetWriter(temporary, schema, compression="zstd", write_page_checksum=True) as writer,
    ):
        for group in groups:
            writer.write_table(group.replace_schema_metadata(schema.metadata), row_group_size=ROW_GROUP)


def read(path: str | os.PathLike[str], *, what: str, fix: str) -> tuple[Any, dict[str, Any] | None]:
    """Return the whole Arrow table and its record (None if it has none).

    what: what the file should be, for the error. fix: what to do if it is not.
    Raises DataError in one line if the file cannot be read or is damaged.
    """
    import pyarrow as pa

    reader = Reader(path, what=what, fix=fix)
    tables = list(reader)
    return pa.concat_tables(tables) if tables else reader.schema.empty_table(), reader.record


class Reader:
    """A Parquet file read a row group at a time, with every digest checked on the way.

    record: the record, None if the file has none. digests: of its row groups, None if it has none.
    rows: number of rows. schema: Arrow's.
    """

    def __init__(self, path: str | os.PathLike[str], *, what: str, fix: str) -> None:
        self._name, self._what, self._fix = os.fspath(path), what, fix
        if not Path(path).is_file():
            raise DataError(f"{self._name}: no such file; {fix}")
        with self._reporting():
            import pyarrow.parquet as pq

            self._file = pq.ParquetFile(path, memory_map=False, page_checksum_verification=True)
            self.schema = self._file.schema_arrow.remove_metadata()
            self.rows = int(self._file.metadata.num_rows)
            stored = (self._file.metadata.metadata or {}).get(KEY)
            # Arrow keeps a second copy inside its own schema: damage to one shows in the other.
            if stored != (self._file.schema_arrow.metadata or {}).get(KEY):
                raise ValueError("two copies of its record differ")
            self.record: dict[str, Any] | None = None
            self.digests: list[str] | None = None
            if stored is not None:
                self.record, self.digests = unseal(stored)
            if self.digests is not None and len(self.digests) != max(self._file.num_row_groups, 1):
                raise ValueError("row groups are missing")

    def __iter__(self) -> Iterator[Any]:
        """Yield Arrow tables of at most ROW_GROUP rows; DataError where one is damaged."""
        with self._reporting():
            yield from self._plain() if self.digests is None else self._checked(self.digests)

    def _checked(self, digests: list[str]) -> Iterator[Any]:
        for index in range(self._file.num_row_groups):
            table = self._file.read_row_group(index).replace_schema_metadata(None)
            if digest(table) != digests[index]:
                raise ValueError(f"row group {index} does not match its checksum")
            yield table

    def _plain(self) -> Iterator[Any]:
        import pyarrow as pa

        for batch in self._file.iter_batches(batch_size=ROW_GROUP):
            yield pa.Table.from_batches([batch]).replace_schema_metadata(None)

    def _reporting(self) -> _Reporting:
        return _Reporting(f"{self._name}: cannot be read as {self._what}", self._fix)


class _Reporting:
    """Turn whatever a damaged file provokes into one DataError."""

    def __init__(self, problem: str, fix: str) -> None:
        self.problem, self.fix = problem, fix

    def __enter__(self) -> None:
        return None

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        import pyarrow as pa

        expected = (pa.ArrowException, OSError, ValueError, KeyError, TypeError, OverflowError, MemoryError)
        if isinstance(error, expected) and not isinstance(error, DataError):
            reason = (str(error).splitlines() or [""])[0][:120] or type(error).__name__
            raise DataError(f"{self.problem} ({reason}); {self.fix}") from None


def digest(table: Any) -> str:
    """Return the SHA-256 of an Arrow table's names, kinds and values, whatever its memory layout."""
    total = hashlib.sha256()
    for name in table.column_names:
        kind, parts = _plain_values(table.column(name))
        total.update(json.dumps([name, kind, table.num_rows]).encode())
        for part in parts:
            total.update(part)
    return total.hexdigest()


def _plain_values(column: Any) -> tuple[str, list[Any]]:
    """Return the kind of a column and its values as bytes."""
    import pyarrow.types as types

    kind = column.type
    if (types.is_integer(kind) or types.is_floating(kind) or types.is_boolean(kind)) and not column.null_count:
        values = np.ascontiguousarray(column.to_numpy())
        return values.dtype.str, [values.data if values.dtype != bool else values.tobytes()]
    if types.is_dictionary(kind):
        column = column.cast(kind.value_type)
    elif not (types.is_string(kind) or types.is_large_string(kind)):
        return "other", [repr(column.to_pylist()).encode()]
    # Codes in the order of first appearance: a function of the values alone.
    encoded = column.combine_chunks().dictionary_encode()
    codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False).astype(np.int32)
    return "text", [json.dumps(encoded.dictionary.to_pylist()).encode(), codes.data]


def seal(record: dict[str, Any], digests: list[str]) -> bytes:
    """Return the record as JSON with the digests and a checksum of everything inside."""
    body = {**record, _SEAL: {"groups": digests}}
    body[_SEAL]["checksum"] = checksum(body)
    return json.dumps(body, sort_keys=True).encode()


def unseal(text: bytes) -> tuple[dict[str, Any], list[str] | None]:
    """Return the record and the digests (None if it holds none); ValueError if it was altered."""
    body = json.loads(text)
    if not isinstance(body, dict):
        raise ValueError("its record is not an object")
    facts = body.get(_SEAL)
    if facts is None:
        return body, None
    if not isinstance(facts, dict) or not isinstance(facts.get("groups"), list):
        raise ValueError("its record has no checksums that can be read")
    stated = facts.pop("checksum", None)
    if stated != checksum(body):
        raise ValueError("its record does not match its checksum")
    del body[_SEAL]
    return body, facts["groups"]
