"""Boxes of chunked arrays of zarr, dask and numpy: corners, and each chunk decoded once."""
from __future__ import annotations

import itertools
from typing import Any, Dict, Iterator, List, Sequence, Tuple

import numpy as np

Corner = Tuple[int, ...]
Box = Tuple[Corner, Corner]  # the second past the end


class Decoded:
    """Boxes of a chunked array that are read one after the other: every chunk is decoded once, and
    what later boxes read of it is kept as long. Memory is used again, since fresh pages cost as
    much as decoding."""

    def __init__(self, array: Any, boxes: Sequence[Box]):
        self._array, self._boxes, self._size = array, boxes, chunks_of(array)
        self._held: Dict[Corner, Tuple[Corner, np.ndarray, np.ndarray]] = {}
        self._free: Dict[int, List[np.ndarray]] = {}
        self._room = np.empty(0, array.dtype)
        self._uses: Dict[Corner, List[int]] = {}
        for n, box in enumerate(boxes):
            for chunk in self._around(box):
                self._uses.setdefault(chunk, []).append(n)
        self.count = len(self._uses)

    def _around(self, box: Box) -> Iterator[Corner]:
        return itertools.product(*(range(lo // n, -(-hi // n)) for lo, hi, n in
                                   zip(*box, self._size)))

    def read(self, n: int) -> np.ndarray:
        """The values of box n, which are valid until the next one is read."""
        lo, hi = self._boxes[n]
        self._room = grown(self._room, shape_of((lo, hi)))
        out = formed(self._room, shape_of((lo, hi)))
        for chunk in self._around((lo, hi)):
            held = self._held.pop(chunk) if chunk in self._held else self._decode(chunk)
            first, values, buffer = held
            begin, end = common_box((lo, hi), (first, moved(first, values.shape)))
            out[slices(begin, end, lo)] = values[slices(begin, end, first)]
            uses = self._uses[chunk] = self._uses[chunk][1:]
            if uses:
                begin, end = common_box(hull_of([self._boxes[m] for m in uses]),
                                     (first, moved(first, values.shape)))
                part = values[slices(begin, end, first)]
                if part.size > 0.8 * values.size:
                    self._held[chunk] = begin, part, buffer
                    continue
                kept = self._take(part.size)
                self._held[chunk] = begin, formed(kept, part.shape), kept
                self._held[chunk][1][...] = part
            self._free.setdefault(buffer.size, []).append(buffer)
        return out

    def _take(self, size: int) -> np.ndarray:
        size = 1 << (size - 1).bit_length()
        free = self._free.get(size)
        return free.pop() if free else np.empty(size, self._array.dtype)

    def _decode(self, chunk: Corner) -> Tuple[Corner, np.ndarray, np.ndarray]:
        first = tuple(c * n for c, n in zip(chunk, self._size))
        end = tuple(min(a + n, m) for a, n, m in zip(first, self._size, self._array.shape))
        shape = shape_of((first, end))
        buffer = self._take(int(np.prod(shape)))
        values = formed(buffer, shape)
        if hasattr(self._array, "get_basic_selection"):
            self._array.get_basic_selection(slices(first, end), out=values)
        else:
            values[...] = read_box(self._array, first, end)
        return first, values, buffer


def read_box(array: Any, lo: Sequence[int], hi: Sequence[int]) -> np.ndarray:
    part = array[slices(lo, hi)]
    return np.asarray(part.compute(scheduler="synchronous") if hasattr(part, "dask") else part)


def slices(lo: Sequence[int], hi: Sequence[int], of: Sequence[int] = ()) -> Tuple[slice, ...]:
    return tuple(slice(a - n, b - n) for a, b, n in itertools.zip_longest(lo, hi, of, fillvalue=0))


def shape_of(box: Box) -> Corner:
    return tuple(b - a for a, b in zip(*box))


def hull_of(boxes: Sequence[Box]) -> Box:
    return (tuple(map(min, zip(*(box[0] for box in boxes)))),
            tuple(map(max, zip(*(box[1] for box in boxes)))))


def grown(buffer: np.ndarray, shape: Corner) -> np.ndarray:
    """The buffer, or a longer one where it is too short."""
    size = int(np.prod(shape))
    return buffer if buffer.size >= size else np.empty(size, buffer.dtype)


def formed(buffer: np.ndarray, shape: Corner) -> np.ndarray:
    return buffer[:int(np.prod(shape))].reshape(shape)


def moved(corner: Sequence[int], by: Sequence[int]) -> Corner:
    return tuple(a + b for a, b in zip(corner, by))


def common_box(a: Box, b: Box) -> Box:
    return tuple(map(max, a[0], b[0])), tuple(map(min, a[1], b[1]))


def chunks_of(array: Any) -> Corner:
    """Chunks of zarr and h5py, the largest ones of dask; of others a block."""
    chunks = getattr(array, "chunksize", getattr(array, "chunks", None))
    return tuple(int(c) for c in chunks or [min(n, 256) for n in array.shape])


def cut(length: int, size: int) -> Tuple[int, ...]:
    return tuple(min(size, length - n) for n in range(0, length, size))


def each_block(sizes: Sequence[Sequence[int]]) -> Iterator[Tuple[Corner, Box]]:
    ends = [np.cumsum(s).tolist() for s in sizes]
    for place in itertools.product(*(range(len(s)) for s in sizes)):
        hi = tuple(e[n] for e, n in zip(ends, place))
        yield place, (tuple(h - s[n] for h, s, n in zip(hi, sizes, place)), hi)
