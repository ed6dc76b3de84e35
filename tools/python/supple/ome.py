"""OME-Zarr in and out: images of version 0.4, displacement fields of version 0.6.

Axes of space are z, y, x with a scale and a translation in a unit of length (none: millimetres),
which become an affine to LPS millimetres: x, y and z count as L, P and S, or as `axes` says, such
as "RAS". In a field, which is an image whose first axis has the type "displacement", components are
in the order of the axes, z first, too.

    scan = supple.ome.open("scan.zarr", level=1)     # scan.array: a dask array; scan.affine
    supple.ome.write("warped.zarr", supple.dask.warp(scan, field), scan.affine, resume=True)
"""
from __future__ import annotations

import builtins
import gzip
import itertools
import json
import os
from typing import Any, Dict, List, Optional, Sequence, Tuple

import dask.array as da  # type: ignore[import]
import numcodecs  # type: ignore[import]
import numpy as np
import zarr  # type: ignore[import]

from ._chunks import slices
from ._errors import InputError, UsageError
from .dask import _with_affine, store

__all__ = ["Level", "open", "read_field", "write", "write_field"]

_MM = {"angstrom": 1e-7, "nanometer": 1e-6, "micrometer": 1e-3, "millimeter": 1.0,
       "centimeter": 10.0, "decimeter": 100.0, "meter": 1000.0, "inch": 25.4, None: 1.0}
_SPACE = [{"name": name, "type": "space", "unit": "millimeter"} for name in "zyx"]


class Level:
    """A level of an image: `stored` chunks, and the affine from (i, j, k, 1) to LPS mm."""

    def __init__(self, stored: Any, affine: np.ndarray):
        self.stored, self.affine = stored, affine

    @property
    def array(self) -> da.Array:
        """The values as a dask array: [k, j, i], or [k, j, i, 3] in mm LPS."""
        return self.stored if isinstance(self.stored, da.Array) else da.from_array(self.stored)

    def __repr__(self) -> str:
        return f"Level({self.stored.shape}, {self.stored.dtype})"


def open(path: Any, level: int = 0, *, axes: str = "LPS",  # noqa: A001
         index: Sequence[int] = ()) -> Level:
    """A level of the image of version 0.4 at a path. axes: what x, y and z are, such as "RAS".
    index: frame and channel of an image that has such axes. Raises InputError for what is none."""
    path = os.fspath(path)
    about = _json(os.path.join(path, ".zattrs")).get("multiscales", [{}])[0]
    if "datasets" not in about or "axes" not in about:
        raise InputError(f"{path}: multiscales: found none with axes and datasets, expected those "
                         "of OME-Zarr 0.4", path, "multiscales")
    units = _units(path, about["axes"], len(about["axes"]) - 3)
    if not 0 <= level < len(about["datasets"]):
        raise InputError(f"{path}: level: found {level}, expected 0 to "
                         f"{len(about['datasets']) - 1}", path, "level")
    told = about["datasets"][level]
    steps = told.get("coordinateTransformations", []) + about.get("coordinateTransformations", [])
    affine = _affine_of(path, steps, len(about["axes"]), units, axes)
    stored = zarr.open_array(os.path.join(path, told["path"]), mode="r")
    if len(index) != stored.ndim - 3:
        raise InputError(f"{path}: index: found {len(index)} numbers, expected {stored.ndim - 3}, "
                         "of the axes before z", path, "index")
    return Level(da.from_array(stored)[tuple(index)] if index else stored, affine)


def write(path: Any, array: Any, affine: Any = None, *, levels: Optional[int] = None,
          labels: bool = False, axes: str = "LPS", name: str = "", **options: Any) -> Dict:
    """Writes an array [k, j, i] to a path as an image of version 0.4, by a name, with coarser
    levels, each half of the one before: means, or with `labels` every second voxel.

    axes: what x, y and z are to be; affine: as of supple.dask.warp(). levels: by default until none
    is over 128 voxels wide. options: those of supple.dask.store(), whose report of the first level
    is returned. Raises InputError for an affine whose axes are not those of the image.
    """
    array, affine = _with_affine(array, affine, "affine", 3)
    scale, origin = _scale_of(affine, axes)
    path, shape, datasets = os.fspath(path), array.shape, []
    os.makedirs(path, exist_ok=True)
    _put(os.path.join(path, ".zgroup"), {"zarr_format": 2})
    if levels is None:
        levels = 1 + max(int(np.ceil(np.log2(max(shape) / 128))), 0)
    of_level = array if isinstance(array, da.Array) else da.from_array(array)
    report: Dict = {}
    for level in range(levels):
        at = os.path.join(path, str(level))
        done = store(of_level, at, **options)
        report = report or done
        datasets.append({"path": str(level), "coordinateTransformations": [
            {"type": "scale", "scale": scale[::-1].tolist()},
            {"type": "translation", "translation": origin[::-1].tolist()}]})
        stored = zarr.open_array(at, mode="r")
        options["chunks"], options["compressor"] = stored.chunks, stored.compressor
        whole = da.from_array(stored, chunks=[2 * c for c in stored.chunks])
        steps = [1 if n == 1 else 2 for n in stored.shape]
        if labels:
            of_level = whole[tuple(slice(None, n // s * s, s) for n, s in zip(stored.shape, steps))]
        else:
            of_level = da.coarsen(np.mean, whole, dict(enumerate(steps)), trim_excess=True)
            if np.issubdtype(stored.dtype, np.integer):
                of_level = da.rint(of_level)
            of_level = of_level.astype(stored.dtype)
            origin = origin + scale * (np.array(steps[::-1]) - 1) / 2
        scale = scale * steps[::-1]
    _put(os.path.join(path, ".zattrs"), {"multiscales": [{
        "version": "0.4", "name": name, "axes": _SPACE, "datasets": datasets,
        "type": "nearest" if labels else "mean"}]})
    return report


def read_field(path: Any, *, axes: str = "LPS") -> Level:
    """The displacement field of version 0.6 at a path, [k, j, i, 3] in mm LPS, chunk by chunk as it
    is read. axes: what x, y and z are. Raises InputError for what is none."""
    path = os.fspath(path)
    about = _json(os.path.join(path, "zarr.json")).get("attributes", {}).get("ome", {})
    about = about.get("multiscales", [{}])[0]
    systems = about.get("coordinateSystems") or [{}]
    its_axes = systems[0].get("axes", [{}])
    if its_axes[0].get("type") != "displacement":
        raise InputError(f"{path}: axes: found none of type displacement first, expected a field "
                         "of OME-Zarr 0.6", path, "axes")
    units = _units(path, its_axes, 1)
    told = about["datasets"][0]
    affine = _affine_of(path, told.get("coordinateTransformations", []), 4, units, axes)
    stored = _Chunks3(os.path.join(path, told["path"]))
    if len(stored.stored_shape) != 4 or stored.stored_shape[0] != 3:
        raise InputError(f"{path}: shape: found {stored.stored_shape}, expected (3, z, y, x)", path,
                         "shape")
    stored.factors = np.array(_signs(axes)) * units[::-1]
    return Level(stored, affine)


def write_field(path: Any, field: Any, affine: Any = None, *, axes: str = "LPS",
                chunk: int = 64, codec: str = "zstd") -> None:
    """Writes a field [k, j, i, 3] in mm LPS, or a Warp, to a path as a displacement field of 0.6.

    affine, axes: as of write(). chunk: voxels along each axis of a chunk. codec: "zstd", "gzip" or
    "none". Raises InputError for an affine whose axes are not those of the image, UsageError where
    something is in the way.
    """
    field, affine = _with_affine(field, affine, "affine", 4)
    scale, origin = _scale_of(affine, axes)
    codecs: Dict[str, List] = {"none": [], "gzip": [{"level": 5}],
                               "zstd": [{"level": 3, "checksum": False}]}
    if codec not in codecs:
        raise InputError(f'codec: found {codec!r}, expected "zstd", "gzip" or "none"',
                         field="codec")
    path, shape = os.fspath(path), (3, *field.shape[:3])
    if os.path.exists(path):
        raise UsageError(f"{path}: found something, expected no file or folder")
    sizes = [3] + [min(chunk, n) for n in shape[1:]]
    system = {"name": "physical", "axes": [
        {"name": "d", "type": "displacement", "discrete": True}, *_SPACE]}
    steps = [{"type": "scale", "scale": [1.0, *scale[::-1]]},
             {"type": "translation", "translation": [0.0, *origin[::-1]]}]
    of_level = {"type": "sequence", "input": {"path": "0"}, "output": {"name": "physical"},
                "transformations": steps}
    os.makedirs(os.path.join(path, "0"))
    _put(os.path.join(path, "0", "zarr.json"), {
        "zarr_format": 3, "node_type": "array", "shape": shape, "data_type": "float32",
        "chunk_grid": {"name": "regular", "configuration": {"chunk_shape": sizes}},
        "chunk_key_encoding": {"name": "default", "configuration": {"separator": "/"}},
        "fill_value": 0.0, "attributes": {}, "dimension_names": ["d", "z", "y", "x"],
        "codecs": [{"name": "bytes", "configuration": {"endian": "little"}},
                   *({"name": codec, "configuration": of} for of in codecs[codec])]})
    signs = _signs(axes)
    for place in itertools.product(*(range(-(-n // c)) for n, c in zip(shape[1:], sizes[1:]))):
        lo = [p * c for p, c in zip(place, sizes[1:])]
        part = np.asarray(field[slices([*lo, 0], [*(a + c for a, c in zip(lo, sizes[1:])), 3])])
        whole = np.zeros((3, *sizes[1:]), "<f4")
        stored = np.moveaxis((part * signs)[..., ::-1], -1, 0)
        whole[(slice(None), *(slice(n) for n in stored.shape[1:]))] = stored
        data = whole.tobytes()
        if codec != "none":
            data = gzip.compress(data, 5) if codec == "gzip" else numcodecs.Zstd(3).encode(data)
        at = os.path.join(path, "0", "c", "0", *map(str, place))
        os.makedirs(os.path.dirname(at), exist_ok=True)
        with builtins.open(at, "wb") as file:
            file.write(data)
    _put(os.path.join(path, "zarr.json"), {
        "zarr_format": 3, "node_type": "group", "attributes": {"ome": {
            "version": "0.6", "multiscales": [{
                "name": "displacement", "coordinateSystems": [system], "datasets": [
                    {"path": "0", "coordinateTransformations": [of_level]}]}]}}})


class _Chunks3:
    """An array of zarr version 3, (3, z, y, x), read as [k, j, i, 3] in mm LPS."""

    def __init__(self, folder: str):
        self.folder = folder
        about = _json(os.path.join(folder, "zarr.json"))
        kind = about.get("data_type")
        codecs = [codec["name"] for codec in about.get("codecs", [])]
        if kind not in ("float32", "float64") or codecs[:1] != ["bytes"] or \
                codecs[1:] not in ([], ["gzip"], ["zstd"], ["blosc"]):
            raise InputError(f"{folder}: zarr.json: found {kind} in {codecs}, expected floats as "
                             "bytes, compressed by gzip, zstd, blosc or none", folder, "codecs")
        endian = about["codecs"][0].get("configuration", {}).get("endian", "little")
        self._stored_dtype = np.dtype(kind).newbyteorder("<" if endian == "little" else ">")
        self._codec, self._fill = (codecs + [""])[1], about.get("fill_value", 0)
        encoding = about.get("chunk_key_encoding", {})
        self._first = ["c"] if encoding.get("name", "default") == "default" else []
        self._join = encoding.get("configuration", {}).get("separator",
                                                           "/" if self._first else ".")
        self.stored_shape = tuple(about["shape"])
        self._size = tuple(about["chunk_grid"]["configuration"]["chunk_shape"])
        self.shape = (*self.stored_shape[1:], *self.stored_shape[:1])
        self.chunks = (*self._size[1:], 3)
        self.dtype, self.ndim = np.dtype(np.float32), 4
        self.factors = np.ones(3)

    def __getitem__(self, box: Tuple[slice, ...]) -> np.ndarray:
        ranges = [range(*part.indices(n)) for part, n in zip(box, self.shape)]
        lo, hi = [0, *(r.start for r in ranges[:3])], [3, *(r.stop for r in ranges[:3])]
        out = np.empty([b - a for a, b in zip(lo, hi)], self._stored_dtype)
        for place in itertools.product(*(range(a // n, -(-b // n)) for a, b, n in
                                         zip(lo, hi, self._size))):
            first = [p * n for p, n in zip(place, self._size)]
            begin = [max(a, b) for a, b in zip(lo, first)]
            end = [min(a, b + n) for a, b, n in zip(hi, first, self._size)]
            out[slices(begin, end, lo)] = self._chunk(place)[slices(begin, end, first)]
        vectors = np.moveaxis(out, 0, -1)[..., ::-1] * self.factors
        return vectors.astype(np.float32)[..., ranges[3].start:ranges[3].stop]

    def _chunk(self, place: Sequence[int]) -> np.ndarray:
        at = os.path.join(self.folder, self._join.join([*self._first, *map(str, place)]))
        if not os.path.exists(at):
            return np.full(self._size, self._fill, self._stored_dtype)
        with builtins.open(at, "rb") as file:
            data = file.read()
        if self._codec:
            data = numcodecs.get_codec({"id": self._codec}).decode(data)
        values = np.frombuffer(data, self._stored_dtype)
        if values.size != np.prod(self._size):
            raise InputError(f"{at}: found {values.size} values, expected {np.prod(self._size)}",
                             at)
        return values.reshape(self._size)


def _json(path: str) -> Dict:
    try:
        with builtins.open(path, encoding="utf-8") as file:
            return json.load(file)
    except (OSError, ValueError) as error:
        raise InputError(f"{path}: found {error}, expected a file of JSON", path) from error


def _put(path: str, value: Any) -> None:
    with builtins.open(path, "w", encoding="utf-8") as file:
        json.dump(value, file, indent=1)


def _signs(axes: str) -> List[float]:
    pairs = ("LR", "PA", "SI")
    if len(axes) != 3 or any(letter not in pair for letter, pair in zip(axes, pairs)):
        raise InputError(f'axes: found {axes!r}, expected L or R, P or A, and S or I, as "LPS"',
                         field="axes")
    return [1.0 if letter == pair[0] else -1.0 for letter, pair in zip(axes, pairs)]


def _units(path: str, axes: Sequence[Dict], before: int) -> np.ndarray:
    """Millimetres in the units of the axes z, y, x, which come after `before` others."""
    names = [axis.get("name") for axis in axes[max(before, 0):]]
    units = [axis.get("unit") for axis in axes[max(before, 0):]]
    if names != ["z", "y", "x"] or any(unit not in _MM for unit in units):
        raise InputError(f"{path}: axes: found {names} in {units}, expected z, y, x in units of "
                         "length", path, "axes")
    return np.array([_MM[unit] for unit in units])


def _affine_of(path: str, steps: Sequence[Dict], count: int, units: np.ndarray,
               axes: str) -> np.ndarray:
    """The affine from (i, j, k, 1) to LPS mm."""
    scale, origin = np.ones(count), np.zeros(count)
    steps = list(steps)
    while steps:
        step = steps.pop(0)
        kind = step.get("type")
        if kind == "sequence":
            steps = list(step["transformations"]) + steps
        elif kind == "scale" and "scale" in step:
            scale, origin = scale * step["scale"], origin * step["scale"]
        elif kind == "translation" and "translation" in step:
            origin = origin + step["translation"]
        elif kind != "identity":
            raise InputError(f"{path}: coordinateTransformations: found {kind}, expected scale and "
                             "translation", path, "coordinateTransformations")
    affine = np.eye(4)
    signs = np.array(_signs(axes))
    affine[:3, :3] = np.diag((scale[-3:] * units)[::-1] * signs)
    affine[:3, 3] = (origin[-3:] * units)[::-1] * signs
    return affine


def _scale_of(affine: np.ndarray, axes: str) -> Tuple[np.ndarray, np.ndarray]:
    """Scale and translation of x, y, z in mm."""
    own = np.diag([*_signs(axes), 1.0]) @ affine
    scale = own.diagonal()[:3]
    if min(scale) <= 0 or not np.allclose(own[:3, :3], np.diag(scale), atol=1e-9 * max(scale)):
        raise InputError(f"affine: found axes other than {axes}, expected voxels along them, which "
                         "OME-Zarr 0.4 can say", field="affine")
    return scale, own[:3, 3]
