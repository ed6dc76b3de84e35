"""Arrays larger than memory: warps, resampling and measures as dask arrays, block by block.

A block, about 256 voxels wide and made of whole chunks of the result, reads the voxels that its own
vectors lead to. The kernel releases the GIL and uses one thread: dask chooses how many run.
store() writes runs of neighbouring blocks that share the chunks they decode, and goes on where an
earlier call ended.

    import supple.dask, supple.ome
    scan, field = supple.ome.open("scan.zarr"), supple.ome.read_field("warp.zarr")
    supple.dask.store(supple.dask.warp(scan, field), "warped.zarr", resume=True)

Volumes and fields are zarr, dask or numpy arrays, or whatever has shape, dtype and slices.
"""
from __future__ import annotations

import hashlib
import itertools
import json
import os
from operator import getitem
from time import perf_counter
from typing import Any, Dict, Iterator, List, Optional, Sequence, Tuple

import dask  # type: ignore[import]
import dask.array as da  # type: ignore[import]
import numpy as np
from dask.highlevelgraph import HighLevelGraph  # type: ignore[import]

from . import _supple
from ._chunks import (Box, Corner, Decoded, chunks_of, cut, each_block, formed, grown, moved,
                      read_box, shape_of, slices)
from ._errors import Cancelled, InputError, UsageError
from ._supple import Grid
from ._volume import _NRRD_TYPES, as_grid

__all__ = ["metrics", "resample", "store", "warp"]

_BLOCK, _RUN_BLOCKS, _LEAST_RUNS = 256, 16, 4
_TYPES = _NRRD_TYPES | {"float32", "float64"}


def warp(volume: Any, field: Any, *, affine: Any = None, field_affine: Any = None,
         grid: Any = None, box: Any = None, chunks: Optional[Sequence[int]] = None,
         interpolation: str = "linear", fill: float = 0) -> da.Array:
    """The volume through a field of resample direction, as a dask array [k, j, i] of its type.

    field: [k, j, i, 3] in mm LPS on a grid of its own, which may be coarser. affine, field_affine:
    4 x 4, from (i, j, k, 1) to LPS mm, where these do not bring their own. grid: of the result, by
    default the volume's. box: three slices, or numbers, of that grid. chunks: of the result when it
    is stored, by default the volume's. fill: the value of places outside of the volume or the
    field. interpolation: "linear" or, for labels, "nearest". Raises InputError for what does not
    fit.
    """
    return _blocks(volume, affine, field, field_affine, grid, box, chunks, interpolation, fill)


def resample(volume: Any, grid: Any, *, affine: Any = None, box: Any = None,
             chunks: Optional[Sequence[int]] = None, interpolation: str = "linear",
             fill: float = 0) -> da.Array:
    """The volume on another grid, a Grid or that of a volume, as a dask array [k, j, i].

    affine, box, chunks, interpolation and fill are those of warp(). Raises InputError likewise.
    """
    return _blocks(volume, affine, None, None, grid, box, chunks, interpolation, fill)


def metrics(field: Any, *, affine: Any = None, direction: str = "resample",
            block: int = 128) -> Dict[str, da.Array]:
    """Maps of supple.metrics() of a field [k, j, i, 3] in mm LPS, as dask arrays by name.

    Blocks of `block` voxels along each axis have a halo of two, which makes them those of the whole
    field. affine: 4 x 4, from (i, j, k, 1) to LPS mm, where the field does not bring its own.
    direction: "resample" or "material". Raises InputError for what is no field.
    """
    vectors, affine = _with_affine(field, affine, "field_affine", 4)
    name = "supple-metrics-" + _digest("metrics", _identity(vectors), affine, direction, block)
    layers: Dict[str, Any] = {name: {name: _Measure(vectors, affine, direction)}}
    needs: Dict[str, set] = {name: set()}
    sizes = [cut(n, block) for n in vectors.shape[:3]]
    for place, box in each_block(sizes):
        layers[name][(name, *place)] = (_called, name, box)
    result = {}
    for key, kind in (("jacobian", "f4"), ("length_mm", "f4"), ("bending_per_mm2", "f4"),
                      ("folded", "u1")):
        of_key = f"{name}-{key}"
        layers[of_key] = {(of_key, *place): (getitem, (name, *place), key)
                          for place, _ in each_block(sizes)}
        needs[of_key] = {name}
        result[key] = of_key, kind
    graph = HighLevelGraph(layers, needs)
    return {key: da.Array(graph, of_key, sizes, np.dtype(kind))
            for key, (of_key, kind) in result.items()}


def store(array: da.Array, path: Any, *, chunks: Optional[Sequence[int]] = None,
          compressor: Any = "default", resume: bool = False, memory: float = 1.6e8,
          compute: bool = True) -> Any:
    """Writes a dask array to a zarr array (version 2) at a path, by the scheduler that dask has.

    compressor: of numcodecs; by default blosc with lz4, None: none.
    resume: chunks that an earlier call of the same task has written stay, and only blocks that lack
    one are computed. memory: bytes of the volume that a run of warp() or resample() may keep from
    block to block; more means fewer chunks that are decoded twice. compute: False gives the Delayed
    of the report.
    Returns a dict: "blocks" written and "kept", chunks "decoded" of the "chunks" of the volume,
    seconds of workers that "reading", "warping" and "writing" took. Raises UsageError where
    something else is in the way, Cancelled where another process interrupted the call.
    """
    import zarr  # type: ignore[import]
    path = os.fspath(path)
    task = dict(array.dask.layers.get(array.name, {})).get(array.name)
    if chunks is None:
        chunks = task.chunks if isinstance(task, _Warp) else [int(c) for c in array.chunksize]
    if len(chunks) != array.ndim:
        raise InputError(f"chunks: found {chunks}, expected {array.ndim} numbers", field="chunks")
    if any(edge % c for ends, c in zip(array.chunks, chunks) for edge in np.cumsum(ends)[:-1]):
        array, task = array.rechunk(tuple(_block_of(c) for c in chunks)), None
    key = _digest(array.name, array.shape, str(array.dtype), list(chunks))
    if os.path.exists(path):
        found = zarr.open_array(path, mode="r").attrs.get("supple") if resume else None
        if found != key:
            raise UsageError(f"{path}: found another array, expected none, or with resume=True "
                             "that of the same task")
        out = zarr.open_array(path, mode="r+")
    else:
        out = zarr.create(array.shape, chunks=chunks, dtype=array.dtype, compressor=compressor,
                          store=zarr.DirectoryStore(path, dimension_separator="/"))
        out.attrs["supple"] = key
    stop = os.path.join(path, ".stopped")
    if os.path.exists(stop):
        os.remove(stop)
    blocks = [(place, box) for place, box in each_block(array.chunks) if not _is_there(out, box)]
    if isinstance(task, _Warp):
        runs = _runs(blocks, array, task, memory)
        parts = [dask.delayed(_write_run)(dask.delayed(task, name=array.name), run, out, stop,
                                          dask_key_name=f"supple-run-{key}-{n}")
                 for n, run in enumerate(runs)]
    else:
        parts = [dask.delayed(_write_block)(array.blocks[place], box, out, stop)
                 for place, box in blocks]
    kept = int(np.prod(array.numblocks)) - len(blocks)
    report = dask.delayed(_sum)(parts, {"kept": kept, "chunks": getattr(task, "source_chunks", 0)})
    if not compute:
        return report
    try:
        return report.compute()
    except BaseException:
        with open(stop, "w"):  # runs that still go on look for it before each block
            raise


class _Warp:
    """The task that makes a box of the result; it goes to workers once."""

    def __init__(self, volume: Any, field: Any, grids: Sequence[Any], first: Corner, chunks: Corner,
                 interpolation: str, fill: float):
        self.volume, self.field, self.chunks = volume, field, chunks
        self._grids, self._first = grids, first
        self._interpolation, self._fill = interpolation, fill
        self._kernel: Any = None

    def __getstate__(self) -> Dict[str, Any]:
        return {**vars(self), "_kernel": None}

    @property
    def kernel(self) -> Any:
        if self._kernel is None:
            self._kernel = _supple.Blocks(*(grid and Grid(*grid) for grid in self._grids))
        return self._kernel

    @property
    def source_chunks(self) -> int:
        return int(np.prod([-(-n // c) for n, c in zip(self.volume.shape, chunks_of(self.volume))]))

    def of_target(self, box: Box) -> Box:
        """The box of the target's grid."""
        return moved(box[0], self._first), moved(box[1], self._first)

    def vectors(self, box: Box) -> Tuple[np.ndarray, Corner]:
        if self.field is None:
            return np.empty((0, 0, 0, 3), np.float32), (0, 0, 0)
        lo, hi = self.kernel.nodes_of(box)
        return np.asarray(read_box(self.field, (*lo, 0), (*hi, 3)), np.float32), lo

    def each_vectors(self, boxes: Sequence[Box]) -> Iterator[Tuple[np.ndarray, Corner]]:
        """vectors() of boxes that follow one another."""
        if self.field is None:
            yield from (self.vectors(box) for box in boxes)
            return
        nodes = [self.kernel.nodes_of(box) for box in boxes]
        decoded = Decoded(self.field, [((*lo, 0), (*hi, 3)) for lo, hi in nodes])
        yield from ((np.asarray(decoded.read(n), np.float32), lo)
                    for n, (lo, _) in enumerate(nodes))

    def warped(self, box: Box, vectors: Tuple, source: np.ndarray, first: Corner,
               out: np.ndarray) -> np.ndarray:
        self.kernel.resample(box, *vectors, source, first, self._interpolation, self._fill, out)
        return out

    def __call__(self, box: Box) -> np.ndarray:
        box = self.of_target(box)
        vectors = self.vectors(box)
        lo, hi = self.kernel.voxels_of(box, *vectors)
        source = read_box(self.volume, lo, hi)
        return self.warped(box, vectors, source, lo,
                           np.empty(shape_of(box), source.dtype.newbyteorder("=")))


class _Measure:
    def __init__(self, vectors: Any, affine: np.ndarray, direction: str):
        self._vectors, self._affine, self._direction = vectors, affine, direction

    def __call__(self, box: Box, halo: int = 2) -> Dict[str, np.ndarray]:
        lo = [max(n - halo, 0) for n in box[0]]
        hi = [min(n + halo, end) for n, end in zip(box[1], self._vectors.shape)]
        part = np.asarray(read_box(self._vectors, (*lo, 0), (*hi, 3)), np.float32)
        maps = _supple.measure(part, Grid(part.shape[:3], self._affine), self._direction, True,
                               None)[1]
        inner = tuple(slice(a - n, b - n) for a, b, n in zip(*box, lo))
        return {name: values[inner] for name, values in maps.items()}


def _blocks(volume: Any, affine: Any, field: Any, field_affine: Any, grid: Any, box: Any,
            chunks: Optional[Sequence[int]], interpolation: str, fill: float) -> da.Array:
    volume, affine = _with_affine(volume, affine, "affine", 3)
    source = Grid(volume.shape, affine)
    target = source if grid is None else as_grid(grid)
    grids = [(source.shape, source.affine), (target.shape, target.affine), None]
    if getattr(field, "direction", "resample") != "resample":
        raise InputError("field: found direction material, expected resample", field="field")
    if field is not None:
        field, field_affine = _with_affine(field, field_affine, "field_affine", 4)
        grids[2] = field.shape[:3], field_affine
    if interpolation not in ("linear", "nearest"):
        raise InputError(f"interpolation: found {interpolation!r}, expected 'linear' or 'nearest'",
                         field="interpolation")
    first, shape = _box_in(target.shape, box)
    chunks = tuple(min(int(c), max(n, 1)) for c, n in zip(chunks or chunks_of(volume), shape))
    if len(chunks) != 3 or min(chunks) < 1:
        raise InputError(f"chunks: found {chunks}, expected three numbers of voxels along k, j "
                         "and i", field="chunks")
    task = _Warp(volume, field, grids, first, chunks, interpolation, float(fill))
    task.kernel  # finds what is wrong with the grids now
    name = "supple-warp-" + _digest(_identity(volume), _identity(field), grids, first, shape,
                                    chunks, interpolation, fill, _supple.version)
    sizes = [cut(n, _block_of(c)) for n, c in zip(shape, chunks)]
    layer: Dict[Any, Any] = {name: task}
    layer.update(((name, *place), (_called, name, of)) for place, of in each_block(sizes))
    return da.Array(HighLevelGraph.from_collections(name, layer), name, sizes,
                    np.dtype(volume.dtype).newbyteorder("="))


def _with_affine(thing: Any, affine: Any, name: str, dimensions: int) -> Tuple[Any, np.ndarray]:
    array = getattr(thing, "stored", getattr(thing, "array", thing))
    affine = getattr(thing, "affine", None) if affine is None else affine
    what = "volume" if dimensions == 3 else "field"
    if isinstance(array, (str, os.PathLike)) or not hasattr(array, "shape"):
        raise InputError(f"{what}: found {type(thing).__name__}, expected an array of zarr, dask "
                         "or numpy", field=what)
    if len(array.shape) != dimensions or (dimensions == 4 and array.shape[3] != 3):
        raise InputError(f"{what}: found shape {tuple(array.shape)}, expected "
                         f"{'[k, j, i]' if dimensions == 3 else '[k, j, i, 3] in mm LPS'}",
                         field=what)
    if affine is None or np.shape(affine) != (4, 4):
        found = "none" if affine is None else np.shape(affine)
        raise InputError(f"{name}: found {found}, expected 4 x 4, from (i, j, k, 1) to LPS "
                         "mm", field=name)
    if dimensions == 3 and np.dtype(array.dtype).name not in _TYPES:
        raise InputError(f"volume: found values of type {array.dtype}, expected whole numbers, "
                         "float32 or float64", field="volume")
    return array, np.asarray(affine, np.float64)


def _box_in(shape: Corner, box: Any) -> Tuple[Corner, Corner]:
    """First voxel and shape of three slices or numbers; None: of all."""
    parts: List[Any] = [slice(None)] * 3 if box is None else list(box)
    if len(parts) != 3:
        raise InputError(f"box: found {len(parts)} parts, expected three slices", field="box")
    ranges = []
    for part, n in zip(parts, shape):
        part = part if isinstance(part, slice) else slice(int(part), int(part) + 1)
        span = range(*part.indices(n))
        if span.step != 1 or not span:
            raise InputError(f"box: found {part} of {n} voxels, expected some of them, by ones",
                             field="box")
        ranges.append(span)
    return tuple(r.start for r in ranges), tuple(len(r) for r in ranges)


def _block_of(chunk: int) -> int:
    return chunk * max(round(_BLOCK / chunk), 1)


def _called(task: Any, box: Box) -> Any:
    return task(box)


def _runs(blocks: List[Tuple[Corner, Box]], array: da.Array, task: _Warp,
          memory: float) -> List[List[Box]]:
    """Blocks in groups that share chunks. A group grows across one axis, along which its blocks
    follow one another, until what they hold takes the memory that there is."""
    size, counts, chunk = array.chunksize, array.numblocks, chunks_of(task.volume)
    sweep = max(range(3), key=lambda a: (chunk[a] / size[a], counts[a]))
    width = [1, 1, 1]
    others = [a for a in range(3) if a != sweep]
    while True:
        grown = [a for a in others if width[a] < counts[a]]
        if not grown:
            break
        axis = min(grown, key=lambda a: width[a] * size[a] / chunk[a])
        area = np.prod([(width[a] + (a == axis)) * size[a] for a in others])
        if area * chunk[sweep] * array.dtype.itemsize > memory:
            break
        width[axis] += 1
    across = int(np.prod([-(-counts[a] // width[a]) for a in others]))
    width[sweep] = min(_RUN_BLOCKS, -(-counts[sweep] // -(-_LEAST_RUNS // across)))
    width = [-(-n // -(-n // w)) for n, w in zip(counts, width)]  # of equal widths
    runs: Dict[Corner, List[Tuple[Any, Box]]] = {}
    for place, box in blocks:
        run = tuple(p // w for p, w in zip(place, width))
        runs.setdefault(run, []).append(((place[sweep], *place), box))
    return [[box for _, box in sorted(run)] for run in runs.values()]


def _write_run(task: _Warp, boxes: List[Box], out: Any, stop: str) -> Dict[str, float]:
    times, took = [perf_counter()], {"reading": 0.0, "warping": 0.0, "writing": 0.0}

    def took_until_now(name: str) -> None:
        times.append(perf_counter())
        took[name] += times[-1] - times[-2]

    of_target = [task.of_target(box) for box in boxes]
    sources = [task.kernel.voxels_of(box, *vectors)
               for box, vectors in zip(of_target, task.each_vectors(of_target))]
    decoded = Decoded(task.volume, sources)
    room = chunk_room = np.empty(0, out.dtype)
    for n, vectors in enumerate(task.each_vectors(of_target)):
        if os.path.exists(stop):
            raise Cancelled(f"{stop}: the task was interrupted")
        source = decoded.read(n)
        took_until_now("reading")
        room = grown(room, shape_of(boxes[n]))
        values = task.warped(of_target[n], vectors, source, sources[n][0],
                             formed(room, shape_of(boxes[n])))
        took_until_now("warping")
        for box in _chunks_in(out, boxes[n]):
            chunk_room = grown(chunk_room, shape_of(box))
            chunk = formed(chunk_room, shape_of(box))
            chunk[...] = values[slices(*box, boxes[n][0])]
            out[slices(*box)] = chunk
        took_until_now("writing")
    return {"blocks": len(boxes), "decoded": decoded.count, **took}


def _write_block(values: np.ndarray, box: Box, out: Any, stop: str) -> Dict[str, float]:
    if os.path.exists(stop):
        raise Cancelled(f"{stop}: the task was interrupted")
    out[slices(*box)] = values
    return {"blocks": 1}


def _sum(parts: List[Dict[str, float]], told: Dict[str, float]) -> Dict[str, float]:
    names = ("blocks", "decoded", "reading", "warping", "writing")
    return {**{name: sum(part.get(name, 0) for part in parts) for name in names}, **told}


def _chunks_in(out: Any, box: Box) -> Iterator[Box]:
    """Boxes of the chunks of a box that begins at one."""
    ranges = (range(lo, hi, c) for lo, hi, c in zip(*box, out.chunks))
    for lo in itertools.product(*ranges):
        yield lo, tuple(min(a + c, b) for a, c, b in zip(lo, out.chunks, box[1]))


def _is_there(out: Any, box: Box) -> bool:
    keys = (out._chunk_key([a // c for a, c in zip(lo, out.chunks)])
            for lo, _ in _chunks_in(out, box))
    return all(key in out.chunk_store for key in keys)


def _identity(array: Any) -> str:
    """Text that changes with the values of an array: for a folder of zarr its path and when chunks
    were last put into it, without reading any."""
    folder = getattr(array, "folder", getattr(getattr(array, "store", None), "path", None))
    if folder is None or not os.path.isdir(folder):
        return str(dask.base.tokenize(array))
    folder = os.path.abspath(os.path.join(folder, getattr(array, "path", "")))
    times = [(at, os.stat(at).st_mtime_ns) for at, _, _ in sorted(os.walk(folder))]
    return _digest(folder, array.shape, str(array.dtype), times)


def _digest(*things: Any) -> str:
    text = json.dumps(things, default=lambda thing: np.asarray(thing).tolist())
    return hashlib.sha256(text.encode()).hexdigest()[:32]
