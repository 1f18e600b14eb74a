"""Models → prints, figures, comparisons."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Callable, Optional, Union

from . import _pathwright
from ._models import AnyModel
from ._prints import Print
from ._tables import Rows
from ._tasks import Options, task

if TYPE_CHECKING:
    from typing_extensions import Unpack

#: Called with the layers that are done and all that there are. An exception that it raises ends the run.
Progress = Callable[[int, int], object]

STRATEGIES = ("as-sliced", "nearest", "greedy", "christofides", "christofides-open", "optimized")


def slice(
    models: Union[AnyModel, Sequence[AnyModel]],
    *,
    progress: Optional[Progress] = None,
    **options: Unpack[Options],
) -> Print:
    """Slices models onto one plate; the G-code is that of the program to the byte.

    ``models``: one or several paths, bytes, meshes (:class:`Mesh`, trimesh, numpy-stl), or :class:`Model`; or a project.
    ``progress`` is called in this thread with layers done and all layers, at most a hundred times a second. For the other
    arguments see :class:`Options`.

    Raises :class:`InputError`, :class:`SettingsError`, :class:`DoesNotFitError`, :class:`CheckError`.
    """
    job = task(models, options)
    return Print(job.slice(progress), job.warnings)


def compare(
    models: Union[AnyModel, Sequence[AnyModel]],
    *,
    strategies: Sequence[str] = STRATEGIES,
    progress: Optional[Progress] = None,
    **options: Unpack[Options],
) -> Rows:
    """Orders the layers of a plate, or of a G-code file, by each strategy: a row for each.

    Columns: ``strategy``, ``paths``, ``link_mm`` (straight lines between paths), ``bound_mm`` (no order is below it) and
    ``gap`` with ``certify=True``, ``travels``, ``travel_s``, ``took_s`` (processor time), and ``layers``, the same for each
    layer. What begins in mid-air does not count as an error. Lengths count, unless ``settings`` name an ``order.cost``; where
    times do, there are ``bound_s`` and ``gap_s``, too.

    Raises as :func:`slice`.
    """
    options.setdefault("allow_floating", True)
    options["settings"] = {"order.cost": "length", **options.get("settings", {})}
    job = task(models, options)
    return Rows(json.loads(job.compare(list(strategies), progress)))


def info(models: Union[AnyModel, Sequence[AnyModel]], **options: Unpack[Options]) -> list[dict[str, Any]]:
    """What is in each model (size, volume, repairs), and whether it fits, with the keys of ``pathwright info --json``.

    Raises :class:`InputError`, :class:`SettingsError`.
    """
    return [json.loads(one) for one in task(models, options).info()]


def key(
    models: Union[AnyModel, Sequence[AnyModel]], *, binary: bool = False, **options: Unpack[Options]
) -> str:
    """The hash under which G-code and summary may be kept, as ``pathwright key`` prints it.

    Raises :class:`InputError`, :class:`SettingsError`.
    """
    return task(models, options).key(binary)


def settings_schema() -> dict[str, dict[str, Any]]:
    """Every key of the settings with its meaning (``help``), ``kind``, ``unit``, ``min``, ``max``, ``choices``, ``default``."""
    schema: dict[str, dict[str, Any]] = json.loads(_pathwright.schema())
    return schema
