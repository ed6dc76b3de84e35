"""Errors of the library, one line each, and where its warnings and notes go."""
import builtins
import logging
import os
import sys
import warnings
from types import FrameType
from typing import Optional

_PACKAGE = os.path.dirname(__file__)
_LOG = logging.getLogger("supple")


class Error(RuntimeError):
    """Base of all errors of Supple; its text is the line that the program prints."""


class InputError(Error, ValueError):
    """A value or a file is unusable: line, "file: field: found X, expected Y"; its parts are
    attributes, too."""

    def __init__(self, line: str, file: str = "", field: str = "", found: str = "",
                 expected: str = ""):
        super().__init__(line)
        self.file, self.field, self.found, self.expected = file, field, found, expected


class UsageError(Error):
    """Arguments do not fit each other, or an output exists and may not be overwritten."""


class SystemError(Error, OSError):  # noqa: A001, the library's name of it
    """The system refuses: disk full, no permission, out of memory."""

    __str__ = builtins.RuntimeError.__str__


class Cancelled(Error):
    """A progress callback returned False."""


class SuppleWarning(UserWarning):
    """A result is valid, but something about it should be known."""


def tell(kind: str, line: str) -> None:
    """Puts a warning at the line of the program that called the package; logs anything else."""
    if kind != "warning":
        _LOG.log(logging.INFO if kind == "note" else logging.DEBUG, line)
        return
    warnings.warn(line, SuppleWarning, stacklevel=_frames_to_caller())


def _frames_to_caller() -> int:
    level = 1
    frame: Optional[FrameType] = sys._getframe(1)
    while frame is not None and os.path.dirname(frame.f_code.co_filename) == _PACKAGE:
        level, frame = level + 1, frame.f_back
    return level
