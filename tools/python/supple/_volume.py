"""Volumes: arrays [k, j, i] with their grid, from files, numpy and nibabel, and back."""
from __future__ import annotations

import builtins
import os
import tempfile
from typing import Any, Callable, Dict, Optional, Tuple, Union

import numpy as np

from . import _supple
from ._errors import InputError
from ._supple import Grid

Progress = Optional[Callable[[str, float], Any]]
RAS = np.diag([-1.0, -1.0, 1.0, 1.0])
_NRRD_TYPES = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"}


def read_only(array: np.ndarray) -> np.ndarray:
    array.flags.writeable = False
    return array


class Volume:
    """Scalar values [k, j, i] on a grid; from a file, values are read when first asked for.

    array: values [k, j, i], not copied. grid: their Grid. name: by which it is told apart. Whatever
    takes a path takes a volume: one that is no file shows itself as one in memory. facts: dict with
    format, type and labels. Raises InputError where array and grid do not fit.
    """

    def __init__(self, array: Any, grid: Grid, *, name: str = "array"):
        array = np.asarray(array)
        if array.shape != tuple(grid.shape):
            raise InputError(f"array: found shape {array.shape}, expected {tuple(grid.shape)} of "
                             "the grid, [k, j, i]", field="array")
        self._array: Optional[np.ndarray] = read_only(array.view())
        self._grid, self._name = grid, name
        self._path: Optional[str] = None
        self._read: Dict[str, Any] = {}
        self._memory: Optional[_MemoryFile] = None
        self.facts: Dict[str, Any] = {"format": "array", "type": str(array.dtype), "labels": {}}

    @classmethod
    def open(cls, path: Union[str, os.PathLike], **read: Any) -> "Volume":
        """Opens the file at a path, of any format of volumes; read: frame, channel, spacing (of i,
        j, k in mm), raw."""
        grid, facts = _supple.open_header(os.fspath(path), read)
        volume = cls.__new__(cls)
        volume._array, volume._memory = None, None
        volume._grid, volume.facts = grid, facts
        volume._path, volume._read = os.path.abspath(os.fspath(path)), read
        volume._name = os.path.basename(volume._path)
        return volume

    @classmethod
    def from_array(cls, array: Any, affine: Any, *, name: str = "array") -> "Volume":
        """Volume of an array [k, j, i], which is not copied, and the affine, 4 x 4, from
        (i, j, k, 1) to LPS mm; name: of its own."""
        array = np.asarray(array)
        if array.ndim != 3:
            raise InputError(f"array: found {array.ndim} dimensions, expected 3: [k, j, i]",
                             field="array")
        return cls(array, Grid(array.shape, affine), name=name)

    @classmethod
    def from_nibabel(cls, image: Any) -> "Volume":
        """Volume of an image of nibabel, whose data are [i, j, k] and whose affine is RAS mm."""
        data = np.asanyarray(image.dataobj)
        if data.ndim != 3:
            raise InputError(f"image: found {data.ndim} dimensions, expected 3", field="image")
        return cls.from_array(data.transpose(2, 1, 0), RAS @ image.affine, name="nibabel")

    def to_nibabel(self) -> Any:
        """Image of nibabel with data [i, j, k] and RAS affine."""
        import nibabel  # type: ignore[import]
        return nibabel.Nifti1Image(self.array.transpose(2, 1, 0), RAS @ self.affine)

    @property
    def array(self) -> np.ndarray:
        """Values [k, j, i], read-only; float32 where the file has slope and intercept."""
        if self._array is None:
            self._array = read_only(_supple.read_volume(self._path, self._read, None))
        return self._array

    def __array__(self, dtype: Any = None) -> np.ndarray:
        return self.array if dtype is None else self.array.astype(dtype)

    @property
    def grid(self) -> Grid:
        """The grid of the values."""
        return self._grid

    @property
    def shape(self) -> Tuple[int, int, int]:
        """Voxels along k, j and i."""
        return self._grid.shape

    @property
    def affine(self) -> np.ndarray:
        """4 x 4: (i, j, k, 1) to LPS mm."""
        return self._grid.affine

    @property
    def spacing(self) -> Tuple[float, float, float]:
        """Millimetres along i, j and k."""
        return self._grid.spacing

    def save(self, path: Union[str, os.PathLike], *, progress: Progress = None,
             **options: Any) -> None:
        """Writes the values in the format that the path names; options: compress, half, ..."""
        _supple.write_array(os.fspath(path), _known_type(self.array), self._grid, "", "", options,
                            progress)

    def show(self, **view: Any) -> Any:
        """Picture of the volume; view: the arguments of supple.show()."""
        from ._scene import show
        return show(self, **view)

    def _repr_png_(self) -> bytes:
        return self.show(size=[512, 512]).png

    def __repr__(self) -> str:
        return f"Volume({self._name!r}, {self.facts['type']}, {self._grid!r})"

    def __fspath__(self) -> str:
        if self._path is not None and not self._read:
            return self._path
        if self._memory is None:
            self._memory = _MemoryFile(_known_type(self.array), self._grid, self._name)
        return self._memory.path

    def source(self) -> Dict[str, Any]:
        """Keys of the table [volume] of a scene that reads it."""
        if self._path is not None:
            return {"path": self._path, **self._read}
        return {"path": os.fspath(self)}


def _known_type(array: np.ndarray) -> np.ndarray:
    if array.dtype == bool:
        array = array.astype(np.uint8)
    if array.dtype == np.float16:
        array = array.astype(np.float32)
    return array.astype(array.dtype.newbyteorder("="), copy=False)


class _MemoryFile:
    """An array as a file of NRRD in memory, or on disk where that is short, while it lives."""

    def __init__(self, array: np.ndarray, grid: Grid, name: str):
        kind = array.dtype.name
        if kind not in _NRRD_TYPES | {"float32", "float64"}:
            raise InputError(f"array: found values of type {kind}, expected whole numbers, float32 "
                             "or float64", field="array")
        affine = grid.affine
        axes = " ".join("({})".format(",".join(repr(float(x)) for x in affine[:3, a]))
                        for a in range(3))
        origin = ",".join(repr(float(x)) for x in affine[:3, 3])
        text = {"float32": "float", "float64": "double"}.get(kind, kind)
        header = (f"NRRD0004\ntype: {text}\ndimension: 3\nspace: left-posterior-superior\n"
                  f"sizes: {' '.join(str(n) for n in reversed(array.shape))}\n"
                  f"space directions: {axes}\nkinds: domain domain domain\nendian: little\n"
                  f"encoding: raw\nspace origin: ({origin})\n\n").encode()
        self._folder = tempfile.TemporaryDirectory(prefix="supple-", dir=_memory(array.nbytes))
        self.path = os.path.join(self._folder.name, os.path.splitext(name)[0] + ".nrrd")
        with builtins.open(self.path, "wb") as file:
            file.write(header)
            for plane in array:
                file.write(np.ascontiguousarray(plane).data)


def _memory(size: int) -> Optional[str]:
    """Folder of files in memory where there is room for another one; None: that of other files."""
    try:
        memory = os.statvfs("/dev/shm")
    except OSError:
        return None
    return "/dev/shm" if memory.f_bavail * memory.f_frsize > 2 * size else None


def as_volume(thing: Any) -> Volume:
    """The volume of a Volume, a path or an image of nibabel."""
    if isinstance(thing, Volume):
        return thing
    if hasattr(thing, "dataobj") and hasattr(thing, "affine"):
        return Volume.from_nibabel(thing)
    if isinstance(thing, (str, os.PathLike)):
        return Volume.open(thing)
    raise InputError(f"volume: found {type(thing).__name__}, expected a path, a Volume or an image "
                     "of nibabel (Volume.from_array gives an array its affine)", field="volume")


def as_grid(thing: Any) -> Grid:
    """The grid of a Grid, or of a volume or warp."""
    if isinstance(thing, Grid):
        return thing
    return thing.grid if hasattr(thing, "grid") else as_volume(thing).grid


def open(path: Union[str, os.PathLike], **read: Any) -> Volume:  # noqa: A001
    """Opens the volume at a path: NRRD, MetaImage, NIfTI, DICOM, HDF5, OpenVDB, TIFF, PNG, raw.

    read: frame, channel, spacing (of i, j, k in mm) or raw, as in a scene's [volume]. Raises
    InputError for what cannot be read.
    """
    return Volume.open(path, **read)
