"""Warps: vectors [k, j, i, 3] in mm LPS with a direction, and what is done with deformations."""
from __future__ import annotations

import json
import os
from typing import Any, List, NamedTuple, Optional, Sequence, Union

import numpy as np

from . import _supple
from ._errors import InputError, UsageError
from ._supple import Grid
from ._volume import Progress, Volume, as_grid, as_volume, read_only


class Warp:
    """Dense field of a deformation.

    array: float32 [k, j, i, 3], mm along LPS, read-only. grid: its Grid. direction: "resample",
    content at x came from x + o(x), or "material", voxel X is now at X + u(X). certificate: dict of
    the inversion that gave it, or None. report: dict of fit() or straighten(), or None.
    """
    report: Optional[dict] = None

    def __init__(self, array: Any, grid: Grid, *, direction: str,
                 certificate: Optional[dict] = None):
        array = np.asarray(array, dtype=np.float32)
        if array.shape != tuple(grid.shape) + (3,):
            raise InputError(f"warp: found shape {array.shape}, expected {tuple(grid.shape) + (3,)}"
                             ", [k, j, i, 3]", field="warp")
        if direction not in ("resample", "material"):
            raise InputError(f'direction: found {direction!r}, expected "resample" or "material"',
                             field="direction")
        self.array = read_only(array.view())
        self.grid, self.direction, self.certificate = grid, direction, certificate

    @classmethod
    def from_array(cls, array: Any, affine: Any, *, direction: str) -> "Warp":
        """Warp of an array of vectors [k, j, i, 3] in mm LPS; the affine, 4 x 4, takes (i, j, k, 1)
        to LPS mm. direction: as Warp has it."""
        return cls(array, Grid(np.shape(array)[:3], affine), direction=direction)

    @property
    def affine(self) -> np.ndarray:
        """4 x 4: (i, j, k, 1) to LPS mm."""
        return self.grid.affine

    def __array__(self, dtype: Any = None) -> np.ndarray:
        return self.array if dtype is None else self.array.astype(dtype)

    def save(self, path: Union[str, os.PathLike], *, progress: Progress = None,
             **options: Any) -> None:
        """Writes NRRD, MetaImage, NIfTI, .h5 or OpenVDB, as the path ends; options: compress,
        ras_vectors, ..."""
        certificate = json.dumps(self.certificate) if self.certificate else ""
        _supple.write_array(os.fspath(path), self.array, self.grid, self.direction, certificate,
                            options, progress)

    def __repr__(self) -> str:
        return f"Warp(direction={self.direction!r}, {self.grid!r})"


def read_warp(path: Union[str, os.PathLike], *, direction: Optional[str] = None,
              grid: Any = None, progress: Progress = None) -> Warp:
    """Reads the warp at a path, or a transform of ITK, ANTs or elastix.

    direction: needed where the file does not record it. grid: where a transform that names none is
    evaluated.
    """
    array, own, recorded = _supple.read_warp(os.fspath(path), grid and as_grid(grid), progress)
    if recorded is None and direction is None:
        raise InputError(f'{os.fspath(path)}: direction: found none in the file, expected '
                         'direction="resample" or "material"', os.fspath(path), "direction")
    if recorded is not None and direction not in (None, recorded):
        raise InputError(f"{os.fspath(path)}: direction: found {recorded} in the file, expected "
                         f"{direction}", os.fspath(path), "direction", recorded, str(direction))
    return Warp(array, own, direction=str(recorded or direction))


def as_warp(thing: Any, direction: Optional[str] = None) -> Warp:
    return thing if isinstance(thing, Warp) else read_warp(thing, direction=direction)


def invert(warp: Any, *, direction: Optional[str] = None, void: str = "extend", grid: Any = None,
           progress: Progress = None) -> Warp:
    """Inverse of a warp of any program, with certificate.

    direction: that of the result; by default the warp's own, which then is the inverse
    deformation, while the other one is the same deformation, written the other way. void: what
    places hold that nothing reaches: "extend", "outside" or "nearest" (0). grid: Grid or volume on
    which it is, by default the warp's. Raises InputError for
    vectors that are not finite.
    """
    warp = as_warp(warp)
    array, on, certificate = _supple.invert(warp.array, warp.grid, warp.direction, void,
                                            grid and as_grid(grid), progress)
    return Warp(array, on, direction=direction or warp.direction, certificate=certificate)


def fit(from_points: Any, to_points: Any, grid: Any, *, direction: str = "resample",
        labels: Any = None, rigid: Sequence[int] = (), progress: Progress = None,
        **settings: Any) -> Warp:
    """Warp through landmarks, `supple fit` (docs/landmarks.md): a thin-plate spline.

    from_points, to_points: (n, 3) in LPS mm, pair by pair. grid: Grid, or a volume that has it.
    direction: "resample", what is now at `to` came from `from`, or "material". labels, rigid:
    volume and numbers of its labels that move as rigid bodies. settings: stiffness in mm, no_folds,
    rigid_width in mm. The result's `report` has misfits in mm and folded cells. Raises InputError
    for points that coincide, or that are not pairs.
    """
    keys = {"direction": direction, **settings}
    if labels is not None:
        keys["labels"] = os.fspath(labels := as_volume(labels))
    pairs = [np.asarray(points, dtype=np.float64) for points in (from_points, to_points)]
    array, report = _supple.fit(*pairs, as_grid(grid), keys, list(rigid), progress)
    warp = Warp(array, as_grid(grid), direction=direction)
    warp.report = report
    return warp


class Straight(NamedTuple):
    """Straight box around a curve. volume: as it shows there. warp: of resample direction, from the
    box to the curve; its `report` has lengths in mm and folded cells."""
    volume: Volume
    warp: Warp


def straighten(volume: Any, along: Any, *, interpolation: str = "linear",
               progress: Progress = None, **settings: Any) -> Straight:
    """Straightens a volume along a curve, `supple straighten` (docs/straighten.md): i along it, k
    up.

    along: points of the curve in order, (n, 3) in LPS mm. interpolation: "linear" or "nearest"
    (labels). settings: radius, height and spacing in mm, up (LPS), no_folds. invert() with
    grid=volume and void="outside" makes the warp that bends straight things along the curve.
    Raises InputError for points that are no curve.
    """
    source = as_volume(volume)
    keys = source.source()
    array, vectors, grid, report = _supple.straighten(
        keys.pop("path"), keys, np.asarray(along, dtype=np.float64), settings, interpolation,
        progress)
    warp = Warp(vectors, grid, direction="resample")
    warp.report = report
    return Straight(Volume(array, grid, name="straight"), warp)


def compose(*transforms: Any, grid: Any = None, progress: Progress = None) -> Warp:
    """Several warps of resample direction, or paths of transforms, as one; points go through the
    last first, as with ANTs' -t. grid: of the result, by default that of the last with one."""
    chain: List[Any] = []
    for transform in transforms:
        if not isinstance(transform, Warp):
            chain.append(os.fspath(transform))
        elif transform.direction == "material":
            raise InputError("warp: found direction material, expected resample (invert() with "
                             'direction="resample" makes it)', field="direction")
        else:
            chain.append((transform.array, transform.grid))
    array, on = _supple.compose(chain, grid and as_grid(grid), progress)
    return Warp(array, on, direction="resample")


class Points(NamedTuple):
    """Points after a motion. at: (n, 3) in LPS mm. kinds: for each "inside", "outside", "folded",
    "torn" or "unresolved"."""
    at: np.ndarray
    kinds: List[str]


def apply(deformation: Any, *, points: Any = None, labels: Any = None, back: bool = False,
          grid: Any = None, direction: Optional[str] = None,
          progress: Progress = None) -> Any:
    """Points (returned as Points) or labels (as a Volume) follow a Session, a Warp, or the path of
    a state or warp.

    points: (n, 3) in LPS mm. labels: volume of whole numbers; each voxel takes the nearest label of
    the place that its content came from, so that no new one appears. back: from the deformed place
    to rest. grid: of the labels, by default the deformation's. direction: of a warp's file that
    does not record it.
    """
    if (points is None) == (labels is None):
        raise UsageError("apply: expected points or labels, one of both")
    body = as_deformation(deformation, direction)
    if points is not None:
        at = np.ascontiguousarray(points, dtype=np.float64)
        return Points(*body.move_points(at, back, progress))
    source = as_volume(labels)
    on = as_grid(grid) if grid is not None else body.grid
    stored = _supple.StoredLabels(os.fspath(source), progress)
    return Volume(body.move_labels(stored, back, on, progress), on, name="labels")


def metrics(deformation: Any, *, maps: bool = True, direction: Optional[str] = None,
            progress: Progress = None) -> Any:
    """Displacement in mm, det F, folds, change of volume and bending of a deformation: a Session, a
    Warp, or the path of a state or warp; see Metrics. maps: False leaves the arrays out. direction:
    of a warp's file that does not record it. Raises InputError for what cannot be read."""
    from ._session import Metrics
    summary, arrays = as_deformation(deformation, direction).measure(maps, progress)
    return Metrics(summary, {name: read_only(array) for name, array in arrays.items()})


def resample(volume: Any, *, warp: Any = None, grid: Any = None, spacing: Any = None,
             interpolation: str = "linear", progress: Progress = None) -> Volume:
    """A volume through a warp of resample direction, on another grid, or with another spacing.

    grid: Grid, or a volume that has it. spacing: mm along i, j, k. interpolation: "linear",
    "nearest" (labels) or, with spacing, "cubic"; through a warp linear. Type and rounding are the
    volume's own. Void reads the smallest value.
    """
    source = as_volume(volume)
    if warp is None and (grid is None) == (spacing is None):
        raise UsageError("resample: expected warp, grid or spacing, the last two not both")
    if warp is not None:
        field = as_warp(warp)
        if spacing is not None or interpolation != "linear":
            raise UsageError("resample: found spacing or interpolation with a warp, expected grid")
        if field.direction != "resample":
            raise InputError("warp: found direction material, expected resample", field="direction")
        on = as_grid(grid) if grid is not None else source.grid
        return Volume(_supple.warp_volume(field.array, field.grid, os.fspath(source), on, progress),
                      on, name="resampled")
    keys = source.source()
    path = keys.pop("path")
    array, on = _supple.resample(path, keys, None if grid is None else as_grid(grid), spacing,
                                 interpolation, progress)
    return Volume(array, on, name="resampled")


class _WarpBody:
    """A warp behind the calls that a held session has, too."""

    def __init__(self, warp: Warp):
        self._vectors, self.grid = (warp.array, warp.grid, warp.direction), warp.grid

    def move_points(self, *arguments: Any) -> tuple:
        return _supple.move_points(*self._vectors, *arguments)

    def move_labels(self, *arguments: Any) -> np.ndarray:
        return _supple.warp_labels(*self._vectors, *arguments)

    def measure(self, *arguments: Any) -> tuple:
        return _supple.measure(*self._vectors, *arguments)


def as_deformation(thing: Any, direction: Optional[str] = None) -> Any:
    from ._session import Session
    if not isinstance(thing, (Session, Warp)) and _supple.is_state(os.fspath(thing)):
        thing = Session(thing)
    if isinstance(thing, Session):
        return thing._held
    return _WarpBody(as_warp(thing, direction))
