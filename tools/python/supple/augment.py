"""Random deformations for training loops, with their truth: `supple augment` as a callable.

    move = supple.augment.RandomDrag(material="ct-head", reach=8, seed=7)
    sample = move({"image": array, "labels": mask, "affine": affine}, number=3)

Where a number is left out, Python's `random` draws it, which PyTorch seeds anew in each worker.
"""
from __future__ import annotations

import hashlib
import os
import random
import threading
from collections import OrderedDict
from typing import Any, Dict, Optional, Sequence

import numpy as np

from . import _supple
from ._errors import InputError
from ._session import Report, Session
from ._volume import RAS, Progress, Volume, as_volume
from ._warp import Warp

__all__ = ["RandomDrag", "RandomJointMotion", "RandomMotion"]


_NAMES = ("image", "labels", "points", "affine")


def _is_volume(thing: Any) -> bool:
    """True for what has its own affine: a Volume, a path or an image of nibabel."""
    return isinstance(thing, (Volume, str, os.PathLike)) or hasattr(thing, "dataobj")


class _Case:
    """A volume that is open, at rest or at one of its samples."""

    def __init__(self, image: Volume, labels: Optional[Volume], material: Any,
                 body: Optional[Dict[str, Any]], progress: Progress):
        self.session = Session(image, material, labels=labels, progress=progress)
        if body:
            self.session.step(**body, progress=progress)
        self.labels = labels and _supple.StoredLabels(os.fspath(labels), progress)
        self.lock = threading.Lock()


class RandomMotion:
    """Deforms a dict of arrays, or a Volume, at random; drags where it is not of another kind.

    material: as Session has it. body: keys of a step that comes first, such as fix, rigid, cut.
    options: those of `supple augment` (docs/augment.md) by name. names: keys of the dict where they
    are not "image", "labels", "points" and "affine". frame: "lps", arrays [k, j, i] and affine and
    points in LPS mm, or "ras", arrays [i, j, k] and RAS mm, as nibabel, MONAI and TorchIO have
    them; a channel axis of one may come first. returns: what is added of "warp", "inverse" and
    "truth". cases: volumes that stay open between calls.
    """
    _motion = "drag"

    def __init__(self, material: Any = None, *, body: Optional[Dict[str, Any]] = None,
                 names: Optional[Dict[str, str]] = None, frame: str = "lps",
                 returns: Sequence[str] = ("warp", "inverse", "truth"), cases: int = 1,
                 **options: Any):
        self._keys: Dict[str, Any] = {"motion": self._motion, **options}
        _supple.check_augment(self._keys)
        if frame not in ("lps", "ras"):
            raise InputError(f"frame: found {frame!r}, expected 'lps' or 'ras'", field="frame")
        if set(returns) - {"warp", "inverse", "truth"}:
            raise InputError(f"returns: found {tuple(returns)}, expected of 'warp', 'inverse' and "
                             "'truth'", field="returns")
        self._material, self._body, self._is_ras = material, body, frame == "ras"
        self._names = dict(zip(_NAMES, _NAMES), **(names or {}))
        self._returns, self._most = tuple(returns), cases
        self._begin()

    def _begin(self) -> None:
        self._cases: OrderedDict = OrderedDict()
        self._lock = threading.Lock()

    def __getstate__(self) -> Dict[str, Any]:
        return {key: value for key, value in vars(self).items() if key not in ("_cases", "_lock")}

    def __setstate__(self, state: Dict[str, Any]) -> None:
        vars(self).update(state)
        self._begin()

    def __call__(self, data: Any, seed: Optional[int] = None, number: Optional[int] = None, *,
                 progress: Progress = None) -> Dict[str, Any]:
        """Sample `number` of `seed` of data: the dict with its image, labels and points (mm)
        deformed, with "warp" (resample direction), "inverse" (material direction) and "truth", a
        dict as `supple augment` writes it, with "point_kinds" as Points has them. Other keys stay.
        Raises InputError for what cannot be read, or in which nothing can move."""
        result = dict(data) if isinstance(data, dict) else {"image": data}
        image, labels = self._volume(result, "image"), self._volume(result, "labels")
        if image is None:
            raise InputError(f"{self._names['image']}: found none, expected a volume",
                             field="image")
        keys = self._keys if seed is None else {**self._keys, "seed": seed}
        if number is None:
            number = random.randrange(2 ** 31)
        if not isinstance(number, (int, np.integer)) or not 0 <= number < 2 ** 31:
            raise InputError(f"number: found {number!r}, expected 0 to {2 ** 31 - 1}",
                             field="number")
        points, flip = result.get(self._names["points"]), RAS.diagonal()[:3] ** self._is_ras
        if points is not None and np.shape(points)[1:] != (3,):
            raise InputError(f"{self._names['points']}: found shape {np.shape(points)}, expected "
                             "(n, 3) in mm", field="points")
        points = points if points is None else np.asarray(points, dtype=np.float64)
        case = self._case(image, labels, progress)
        with case.lock:
            held = case.session._held
            truth = Report(held.sample(keys, int(number), progress))
            self._put(result, "image", held.resample(image.grid, False, progress))
            if labels is not None:
                moved = held.move_labels(case.labels, False, image.grid, progress)
                self._put(result, "labels", moved)
            if points is not None:
                at, kinds = case.session.apply(points=points * flip, progress=progress)
                result[self._names["points"]], truth["point_kinds"] = at * flip, kinds
            if "warp" in self._returns:
                result["warp"] = case.session.offsets(progress=progress)
            if "inverse" in self._returns:
                result["inverse"] = case.session.displacement(progress=progress)
        if "truth" in self._returns:
            result["truth"] = truth
        return result

    def _array(self, values: Any) -> np.ndarray:
        """The view [k, j, i] of an array of the dict; of its own order again by the same."""
        array = np.asarray(values)
        if array.ndim == 4 and array.shape[0] == 1:
            array = array[0]
        return array.transpose() if self._is_ras and array.ndim == 3 else array

    def _volume(self, data: Dict[str, Any], which: str) -> Optional[Volume]:
        values = data.get(self._names[which])
        if values is None:
            return None
        if _is_volume(values):
            return as_volume(values)
        affine = data.get(self._names["affine"], getattr(values, "affine", None))
        if affine is None:
            raise InputError(f"{self._names['affine']}: found none, expected 4 x 4, from voxels to "
                             "mm", field="affine")
        affine = np.asarray(affine, dtype=np.float64)
        return Volume.from_array(self._array(values), RAS @ affine if self._is_ras else affine)

    def _put(self, data: Dict[str, Any], which: str, array: np.ndarray) -> None:
        """The deformed array in the shape and type, or as the Volume, that was given."""
        given = data[self._names[which]]
        if _is_volume(given):
            data[self._names[which]] = Volume(array, as_volume(given).grid, name=which)
            return
        given = np.asarray(given)
        array = (array.transpose() if self._is_ras else array).reshape(given.shape)
        data[self._names[which]] = array.astype(given.dtype, copy=False)

    def _case(self, image: Volume, labels: Optional[Volume], progress: Progress) -> _Case:
        digest = hashlib.sha1()
        for volume in (image, labels):
            if volume is not None:
                digest.update(f"{volume.array.dtype} {volume.shape} {volume.affine}".encode())
                digest.update(np.ascontiguousarray(volume.array).data)
        key = digest.digest()
        with self._lock:
            if key not in self._cases:
                while len(self._cases) >= self._most:
                    self._cases.popitem(last=False)
                self._cases[key] = _Case(image, labels, self._material, self._body, progress)
            self._cases.move_to_end(key)
            return self._cases[key]


class RandomDrag(RandomMotion):
    """Drags balls of soft tissue, each its own way. options: handles, reach and radius in mm,
    passes, least_det, seed; the other arguments are those of RandomMotion."""
    _motion = "drag"


class RandomJointMotion(RandomMotion):
    """Turns a rigid piece about its place nearest to another one. options: turn in degrees, passes,
    least_det, seed; the other arguments are those of RandomMotion."""
    _motion = "joint"
