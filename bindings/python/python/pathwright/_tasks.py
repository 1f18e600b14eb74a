"""Keyword arguments that most functions share, and the job that they come to."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, TypedDict, Union, cast

from . import _pathwright
from ._models import AnyModel, HasFaces, HasVectors, Triple, Value, given, typed

AnyPath = Union[str, "os.PathLike[str]"]


class Options(TypedDict, total=False):
    """How models are printed. All may be left out; each lies on top of those before it."""

    #: Printer preset of another slicer, by name, or a file that holds all of its settings.
    printer: str
    #: Print preset; by default the printer's.
    print: str
    #: Filament preset; by default the printer's.
    filament: str
    #: Files and folders of presets; those of slicers on this machine are found without.
    presets: Sequence[AnyPath]
    #: Names of built-in profiles and files, the later ones on top.
    profiles: Sequence[AnyPath]
    #: Settings by key, on top of everything else: ``{"infill.density": "15%", "walls.count": 3}``.
    settings: Mapping[str, Value]
    #: Moves the plate away from where it would be placed, mm; a negative Z cuts off the bottom.
    translate: Triple
    #: Shrink what is larger than the bed.
    scale_to_fit: bool
    #: Layers (``"12"``) or heights (``"12.4mm"``) at which the print stops.
    pauses: Sequence[str]
    #: The same for filament of another color.
    color_changes: Sequence[str]
    #: Print also what begins in mid-air.
    allow_floating: bool
    #: Prove how near to the shortest possible the order is.
    certify: bool
    #: Threads; 0: as many as there are cores. The result is the same.
    threads: int


_DEFAULTS: Options = {
    "presets": (),
    "profiles": (),
    "settings": {},
    "translate": (0.0, 0.0, 0.0),
    "scale_to_fit": False,
    "pauses": (),
    "color_changes": (),
    "allow_floating": False,
    "certify": False,
    "threads": 0,
}


def task(models: Union[AnyModel, Sequence[AnyModel]], options: Options) -> _pathwright.Task:
    """The job of these models and options."""
    unknown = options.keys() - Options.__annotations__.keys()
    if unknown:
        known = ", ".join(Options.__annotations__)
        raise TypeError(f"there is no option {', '.join(sorted(unknown))}; there are: {known}")
    all_options = cast("dict[str, Any]", {**_DEFAULTS, **options})
    date = os.environ.get("SOURCE_DATE_EPOCH", "")
    return _pathwright.task(
        [given(model) for model in listed(models)],
        SimpleNamespace(
            printer=all_options.get("printer"),
            print=all_options.get("print"),
            filament=all_options.get("filament"),
            presets=paths(all_options["presets"]),
            profiles=paths(all_options["profiles"]),
            settings=typed(all_options["settings"]),
            translate_mm=tuple(all_options["translate"]),
            scale_to_fit=all_options["scale_to_fit"],
            pauses=[str(at) for at in all_options["pauses"]],
            color_changes=[str(at) for at in all_options["color_changes"]],
            allow_floating=all_options["allow_floating"],
            certify=all_options["certify"],
            dated=int(date) if date.isdigit() else None,
            threads=all_options["threads"],
        ),
    )


def paths(given: Union[AnyPath, Sequence[AnyPath]]) -> list[str]:
    """One or several paths, or names."""
    if isinstance(given, (str, os.PathLike)):
        given = [given]
    return [os.fspath(path) for path in given]


def listed(models: Union[AnyModel, Sequence[AnyModel]]) -> list[AnyModel]:
    """One or several models."""
    if isinstance(models, Sequence) and not isinstance(models, (str, bytes, HasFaces, HasVectors)):
        return list(models)
    return [models]
