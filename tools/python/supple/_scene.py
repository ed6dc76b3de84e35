"""Scenes as dicts or files, pictures, and the names of presets, materials and models."""
from __future__ import annotations

import os
import tempfile
from typing import Any, Dict, List, Union

import numpy as np

from . import _supple
from ._errors import UsageError
from ._session import Report, Session
from ._volume import Progress, as_volume, read_only
from ._warp import Warp


class Scene:
    """A whole run as a file or a dict of the same keys (docs/scenes.md).

    source: the path of a file or a dict. Volumes may stand wherever a path may. Paths of a dict are
    relative to the present folder. Raises InputError for what no scene says.
    """

    def __init__(self, source: Union[str, os.PathLike, Dict[str, Any]]):
        self.source = source if isinstance(source, dict) else os.fspath(source)

    def plan(self, folder: Union[str, os.PathLike] = "", *, progress: Progress = None) -> Report:
        """What it will hold and compute, and why, and its files below `folder`; nothing is
        written."""
        return Report(_supple.plan_scene(self.source, os.fspath(folder), progress))

    def run(self, folder: Union[str, os.PathLike] = "", *, overwrite: bool = False,
            progress: Progress = None) -> Report:
        """Solves, draws and writes everything below `folder`; the report of `supple run --json`.
        Raises UsageError where a file exists, unless `overwrite`; a failure leaves nothing."""
        return Report(_supple.run_scene(self.source, os.fspath(folder), overwrite, progress))


class Picture:
    """PNG of `supple render`, shown by notebooks. png: its bytes. array: uint8 [row, column, RGBA],
    row 0 at the top, read-only. report: how it was drawn."""

    def __init__(self, png: bytes, array: np.ndarray, report: Report):
        self.png, self.array, self.report = png, read_only(array), report

    def save(self, path: Union[str, os.PathLike]) -> None:
        """Writes the PNG to a path."""
        with open(path, "wb") as file:
            file.write(self.png)

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"Picture({self.array.shape[1]} x {self.array.shape[0]})"


def show(subject: Any, *, warp: Any = None, amount: float = 1, progress: Progress = None,
         **view: Any) -> Picture:
    """Picture of a subject: a Session, a volume, also through a warp (resample direction), or the
    path of a state. amount: part of a Session's displacement that is shown, 0 at rest, 1 as it is.
    view: keys of a scene's [[view]]: preset, size=[w, h], camera={"view": "left"}, quality,
    slice={...}, clip=[{...}], overlay, ... (docs/pictures.md). Raises InputError for other keys."""
    if amount != 1 and not isinstance(subject, Session):
        raise UsageError("show: found an amount, expected it with a Session")
    with tempfile.TemporaryDirectory(prefix="supple-") as folder:
        image = os.path.join(folder, "picture.png")
        keys = {**view, "image": image}
        if isinstance(subject, Session):
            report = subject._held.draw(keys, amount, progress)
        else:
            is_path = isinstance(subject, (str, os.PathLike))
            source = {"path": os.fspath(subject)} if is_path else as_volume(subject).source()
            if isinstance(warp, Warp):
                warp.save(os.path.join(folder, "warp.nrrd"))
                source["offsets"] = os.path.join(folder, "warp.nrrd")
            elif warp is not None:
                source["offsets"] = os.fspath(warp)
            report = _supple.run_scene({"volume": source, "view": [keys]}, "", False, progress)
        with open(image, "rb") as file:
            return Picture(file.read(), _supple.pixels_of(image), Report(report))


def presets() -> List[str]:
    """Names of looks, for preset=... of a view."""
    return _supple.presets()


def materials() -> List[str]:
    """Names of materials: whole tables of a kind of picture first, then single tissues."""
    return _supple.materials()


def models() -> List[str]:
    """Names of what may move the body, for model=... of a step."""
    return _supple.models()
