"""Finished G-code of any slicer."""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Optional, Union

from . import _files, _pathwright
from ._errors import InputError
from ._models import AnyModel
from ._slicing import Progress
from ._tasks import Options, task

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: The path of a file, or its contents; text or binary.
AnyGcode = Union[str, "os.PathLike[str]", bytes]


@dataclass(frozen=True, repr=False)
class Reordered:
    """G-code in another order."""

    #: As text; as it was, where nothing is gained.
    gcode: bytes
    #: The figures before and after, with the keys of ``pathwright reorder --json``.
    report: dict[str, Any]

    def write(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the G-code, whole or not at all. Raises :class:`OutputError`."""
        _files.write(os.fspath(path), self.gcode)

    def __repr__(self) -> str:
        before, after = (self.report[when]["travel_mm"] for when in ("before", "after"))
        return f"<G-code with {after:.0f} mm of travel instead of {before:.0f} mm>"


def reorder(
    gcode: AnyGcode,
    *,
    keep_direction: bool = False,
    progress: Optional[Progress] = None,
    **options: Unpack[Options],
) -> Reordered:
    """Puts G-code in an order with less travel that prints the same, and proves it. ``keep_direction``: no open path is
    drawn backwards. Lengths count, unless ``settings`` name an ``order.cost``.

    Raises :class:`InputError`, :class:`SettingsError`, :class:`CheckError` (the result would not print the same).
    """
    contents = _contents(gcode)
    settings = options.get("settings", {})
    more_retractions = "order.cost" in settings
    options["settings"] = {"order.cost": "length", **settings}
    job = task([], options)
    changed, report = _pathwright.reorder(contents, job, keep_direction, more_retractions, progress)
    return Reordered(contents if changed is None else changed, json.loads(report))


def check(
    gcode: AnyGcode, models: Union[AnyModel, Sequence[AnyModel]] = (), **options: Unpack[Options]
) -> dict[str, Any]:
    """The faults of G-code for a printer, and, with models, whether it prints them; keys of ``pathwright check --json``.

    Raises :class:`InputError`, :class:`SettingsError`. Faults are no exceptions: they are the result.
    """
    contents = _contents(gcode)
    report: dict[str, Any] = json.loads(_pathwright.check(contents, task(models, options)))
    return report


def time(gcode: AnyGcode, **options: Unpack[Options]) -> dict[str, Any]:
    """How long G-code takes on the machine of the settings, by layer and role, with the keys of ``pathwright time --json``.

    Raises :class:`InputError`, :class:`SettingsError`.
    """
    contents = _contents(gcode)
    report: dict[str, Any] = json.loads(_pathwright.time(contents, task([], options)))
    return report


def _contents(gcode: AnyGcode) -> bytes:
    if isinstance(gcode, (bytes, bytearray)):
        return bytes(gcode)
    name = os.fspath(gcode)
    try:
        with open(name, "rb") as file:
            return file.read()
    except OSError as error:
        raise InputError(f"{name}: cannot be read: {error.strerror}", file=name) from error
