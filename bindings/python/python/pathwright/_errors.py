"""What can go wrong, by kind."""

from __future__ import annotations

from typing import ClassVar, Optional


class Error(Exception):
    """Why there is no result; the text says what is wrong, where, and what to do."""

    kind: ClassVar[str] = "error"
    #: The file that is at fault, where it is one.
    file: Optional[str]
    #: Where in it: ``line 12``, ``facet 3``, a profile, a layer.
    place: Optional[str]
    #: The object on the plate that is at fault, where it is one.
    object: Optional[str]
    #: The key of the setting that is at fault, where it is one.
    key: Optional[str]

    def __init__(
        self,
        message: str,
        file: Optional[str] = None,
        place: Optional[str] = None,
        object: Optional[str] = None,
        key: Optional[str] = None,
    ) -> None:
        super().__init__(message)
        self.file = file
        self.place = place
        self.object = object
        self.key = key

    def __reduce__(self) -> tuple[type[Error], tuple[Optional[str], ...]]:
        return type(self), (str(self), self.file, self.place, self.object, self.key)


class InputError(Error, ValueError):
    """A model or G-code cannot be read, or there is nothing to print."""

    kind = "input"


class SettingsError(Error, ValueError):
    """Settings, profiles, presets or a script are wrong; every problem is a line of the text."""

    kind = "settings"


class DoesNotFitError(Error, ValueError):
    """The models do not fit the printer."""

    kind = "does_not_fit"


class OutputError(Error, OSError):
    """The result cannot be written."""

    kind = "output"


class CheckError(Error):
    """The result failed a check of its own: something begins in mid-air, or G-code in another order differs."""

    kind = "check"


class CancelledError(Error):
    """The run was cancelled."""

    kind = "cancelled"
