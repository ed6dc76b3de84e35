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
    """A picture, shown by notebooks. array: uint8 [row, column, RGBA], row 0 at the top, read-only.
    report: how it was drawn; taken: where its PNG comes from."""

    def __init__(self, taken: Any, report: Report):
        self._taken, self.array, self.report = taken, read_only(taken.array), report

    @property
    def png(self) -> bytes:
        """The file that save() writes."""
        with tempfile.TemporaryDirectory(prefix="supple-") as folder:
            path = os.path.join(folder, "picture.png")
            self.save(path)
            with open(path, "rb") as file:
                return file.read()

    def save(self, path: Union[str, os.PathLike], *, progress: Progress = None) -> None:
        """Writes the PNG of `supple render` to a path."""
        self._taken.save(os.fspath(path), progress)

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"Picture({self.array.shape[1]} x {self.array.shape[0]})"


class Renderer:
    """Pictures of one subject, one after the other: what rays read stays between them, and is made
    anew only where the subject has changed.

    subject: a Session, whose body is seen as it is at each picture; the path of a state; or a
    volume, which is seen through `warp`, a Warp of resample direction or the path of one. Raises
    InputError for what cannot be read.
    """

    def __init__(self, subject: Any, *, warp: Any = None, progress: Progress = None):
        if _is_state(subject):
            subject = Session(subject, progress=progress)
        self._subject, self._warp = subject, None
        if isinstance(subject, Session):
            if warp is not None:
                raise UsageError("warp: found one beside a body, expected it beside a volume")
            self._held = _supple.HeldPictures(subject._held)
            return
        self._subject = as_volume(subject)
        source = self._subject.source()
        if isinstance(warp, Warp):
            self._warp = tempfile.TemporaryDirectory(prefix="supple-")
            warp.save(os.path.join(self._warp.name, "warp.nrrd"), progress=progress)
            source["offsets"] = os.path.join(self._warp.name, "warp.nrrd")
        elif warp is not None:
            source["offsets"] = os.fspath(warp)
        self._held = _supple.HeldPictures({"volume": source})

    def render(self, *, amount: float = 1, progress: Progress = None, **view: Any) -> Picture:
        """The picture of the subject as it is now, that of a scene bit for bit. amount: part of a
        body's displacement that is shown, 0 at rest, 1 as it is. view: keys of a scene's [[view]]:
        preset, size=[w, h], camera={"view": "left"}, quality, slice={...}, clip=[{...}], overlay,
        ... (docs/pictures.md). Raises InputError for other keys."""
        if amount != 1 and not isinstance(self._subject, Session):
            raise UsageError("amount: found one of a volume, expected it with a Session or a state")
        drawn = self._held.draw({**view, "image": "picture.png"}, amount, progress)
        return Picture(drawn[0], Report(drawn[1]))


def _is_state(subject: Any) -> bool:
    return isinstance(subject, (str, os.PathLike)) and _supple.is_state(os.fspath(subject))


def show(subject: Any, *, warp: Any = None, progress: Progress = None, **view: Any) -> Picture:
    """One picture of a subject through `warp`, of the arguments of Renderer, and with those of its
    render() in `view`. A Session keeps its Renderer from the first one on."""
    if isinstance(subject, Session) and warp is None:
        subject._renderer = subject._renderer or Renderer(subject)
        return subject._renderer.render(progress=progress, **view)
    return Renderer(subject, warp=warp, progress=progress).render(progress=progress, **view)


def presets() -> List[str]:
    """Names of looks, for preset=... of a view."""
    return _supple.presets()


def materials() -> List[str]:
    """Names of materials: whole tables of a kind of picture first, then single tissues."""
    return _supple.materials()


def models() -> List[str]:
    """Names of what may move the body, for model=... of a step."""
    return _supple.models()
