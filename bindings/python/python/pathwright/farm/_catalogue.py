"""Catalogues: what is to be done, row by row."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable
from dataclasses import asdict, dataclass, field
from typing import Any, Optional

import fsspec
import pyarrow.csv
import pyarrow.parquet

from .. import __version__

#: What a folder is searched for.
ENDINGS = (".stl", ".3mf", ".obj")
COLUMNS = ("model", "printer", "print", "filament", "profiles", "settings")


class CatalogueError(Exception):
    """A catalogue cannot be read; the text names the row."""


@dataclass(frozen=True)
class Row:
    """A model, and how it is printed."""

    #: Path or URL.
    model: str
    printer: Optional[str] = None
    print: Optional[str] = None
    filament: Optional[str] = None
    profiles: tuple[str, ...] = ()
    settings: dict[str, str] = field(default_factory=dict)

    def columns(self) -> dict[str, Any]:
        """As the table of results has it."""
        columns = asdict(self)
        columns["profiles"] = ";".join(self.profiles)
        columns["settings"] = json.dumps(self.settings, sort_keys=True) if self.settings else ""
        return columns


def read(catalogue: str) -> list[Row]:
    """The rows of a CSV or Parquet file, or a row for each model in a folder.

    Columns: ``model`` (relative to the catalogue), ``printer``, ``print``, ``filament``, ``profiles`` (``a;b``), ``settings``
    (JSON, or ``key=value;key=value``), and any key of a setting.
    """
    fs, path = fsspec.core.url_to_fs(catalogue)
    try:
        if fs.isdir(path):
            found = sorted(name for name in fs.find(path) if name.lower().endswith(ENDINGS))
            return [Row(model=_url(fs, name)) for name in found]
        with fs.open(path, "rb") as file:
            is_parquet = path.lower().endswith((".parquet", ".pq"))
            table = pyarrow.parquet.read_table(file) if is_parquet else _csv(file)
    except (OSError, pyarrow.ArrowInvalid) as error:
        raise CatalogueError(f"{catalogue}: cannot be read: {error}") from error
    unknown = [name for name in table.column_names if name not in COLUMNS and "." not in name]
    if "model" not in table.column_names or unknown:
        problem = f"unknown columns {', '.join(unknown)}" if unknown else "no column `model`"
        known = ", ".join(COLUMNS)
        raise CatalogueError(f"{catalogue}: {problem}; there are: {known}, and keys of settings")
    folder = _url(fs, fs._parent(path))
    return [_row(catalogue, number, cells, folder) for number, cells in enumerate(table.to_pylist(), start=1)]


def _csv(file: Any) -> Any:
    # Everything is text: `15%`, `0.20`.
    names = file.readline().decode("utf-8-sig").strip("\r\n")
    file.seek(0)
    columns = [name.strip('"') for name in names.split(",")]
    types = {name: pyarrow.string() for name in columns}
    return pyarrow.csv.read_csv(file, convert_options=pyarrow.csv.ConvertOptions(column_types=types))


def _row(catalogue: str, number: int, cells: dict[str, Any], folder: str) -> Row:
    text = {name: str(cell) for name, cell in cells.items() if cell is not None and cell != ""}
    model = text.pop("model", "")
    if not model:
        raise CatalogueError(f"{catalogue}: row {number}: it names no model")
    settings: dict[str, str] = {}
    given = text.pop("settings", "")
    try:
        if given.startswith("{"):
            settings |= {key: _typed(value) for key, value in json.loads(given).items()}
        else:
            pairs = (pair.split("=", 1) for pair in given.split(";") if pair.strip())
            settings |= {key.strip(): value.strip() for key, value in pairs}
    except ValueError as error:
        message = f"settings are JSON or key=value;key=value, not `{given}`"
        raise CatalogueError(f"{catalogue}: row {number}: {message}") from error
    settings |= {key: text.pop(key) for key in list(text) if "." in key}
    profiles = tuple(name.strip() for name in text.pop("profiles", "").split(";") if name.strip())
    is_whole = "://" in model or os.path.isabs(model)
    return Row(model if is_whole else f"{folder.rstrip('/')}/{model}", profiles=profiles, settings=settings, **text)


def _typed(value: Any) -> str:
    return value if isinstance(value, str) else json.dumps(value)


def _url(fs: Any, path: str) -> str:
    return path if "file" in fs.protocol else str(fs.unstrip_protocol(path))


def identified(rows: Iterable[Row], about: dict[str, Any]) -> dict[str, Row]:
    """Each row once, by a name that changes when its model, its settings or the version of this package do; ``about``: what
    is done with all of them. Large models come first, so that none is left alone at the end."""
    versions = _Versions()
    named: dict[str, Row] = {}
    for row in sorted(rows, key=lambda row: -versions.size(row.model)):
        files = [versions.of(profile) for profile in row.profiles if profile.endswith(".toml")]
        told = [__version__, about, row.columns(), versions.of(row.model), files]
        name = hashlib.sha256(json.dumps(told, sort_keys=True).encode()).hexdigest()[:32]
        named.setdefault(name, row)
    return named


class _Versions:
    """What tells that a file has changed, a folder at a time."""

    def __init__(self) -> None:
        self._folders: dict[str, dict[str, Any]] = {}
        self._entries: dict[str, Optional[dict[str, Any]]] = {}

    def of(self, url: str) -> Optional[list[str]]:
        entry = self._entry(url)
        if entry is None:
            return None
        told = [entry.get(name) for name in ("size", "ETag", "mtime", "LastModified", "last_modified")]
        return [str(one) for one in told if one is not None]

    def size(self, url: str) -> int:
        """Bytes, 0 where that is not told."""
        return int((self._entry(url) or {}).get("size") or 0)

    def _entry(self, url: str) -> Optional[dict[str, Any]]:
        if url not in self._entries:
            self._entries[url] = self._found(url)
        return self._entries[url]

    def _found(self, url: str) -> Optional[dict[str, Any]]:
        fs, path = fsspec.core.url_to_fs(url)
        folder = fs._parent(path)
        if folder not in self._folders:
            try:
                self._folders[folder] = {entry["name"]: entry for entry in fs.ls(folder, detail=True)}
            except (OSError, NotImplementedError):
                self._folders[folder] = {}
        return self._folders[folder].get(path)
