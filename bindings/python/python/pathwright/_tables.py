"""Figures as tables."""

from __future__ import annotations

from html import escape
from typing import Any


class Rows(list[dict[str, Any]]):
    """Rows with the same keys, which ``pandas.DataFrame`` takes as they are. Jupyter shows them as a table."""

    def _repr_html_(self) -> str:
        columns = [key for key in self[0] if not isinstance(self[0][key], (list, dict))] if self else []
        return table([[row[key] for key in columns] for row in self], columns)


def table(rows: list[list[Any]], headings: list[str]) -> str:
    """A table as HTML."""
    head = "".join(f"<th>{escape(heading)}</th>" for heading in headings)
    body = "".join("<tr>" + "".join(f"<td>{escape(shown(cell))}</td>" for cell in row) + "</tr>" for row in rows)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def shown(value: Any) -> str:
    """A figure for people."""
    if value is None:
        return "–"
    return f"{value:,.3f}".rstrip("0").rstrip(".") if isinstance(value, float) else str(value)


def duration(seconds: float) -> str:
    """``1 h 02 min 03 s``."""
    whole = round(seconds)
    hours, minutes, rest = whole // 3600, whole // 60 % 60, whole % 60
    if hours:
        return f"{hours} h {minutes:02} min {rest:02} s"
    return f"{minutes} min {rest:02} s" if minutes else f"{rest} s"
