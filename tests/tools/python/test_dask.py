"""Arrays larger than memory: blocks give what the whole gives, read no more than they say, and go
on where they were killed."""
import importlib.util
import os
import shutil
import signal
import subprocess
import sys
import time
import unittest
import unittest.mock

import numpy as np

import supple
from cases import InFolder

HAS_DASK = all(importlib.util.find_spec(name) for name in ("dask", "distributed", "zarr"))
if HAS_DASK:
    import dask
    import zarr

    import supple.dask

SHAPE = (70, 90, 83)
CHUNKS = (16, 16, 16), (32, 32, 32), (64, 16, 16)
AFFINE = np.array([[1.5, 0, 0, -20], [0, -1.25, 0, 14], [0, 0, 2, -9], [0, 0, 0, 1.0]])
TURN = np.array([[0.8, -0.6, 0, 3], [0.6, 0.8, 0, -2], [0, 0, 1, 1], [0, 0, 0, 1.0]])
SLOW = '''
import sys, time, zarr, supple.dask
from test_dask import *
supple.dask._BLOCK = 16
class Slow(supple.dask._Warp):
    def warped(self, *arguments):
        time.sleep(0.02)
        return super().warped(*arguments)
supple.dask._Warp = Slow
supple.dask.store(warped(zarr.open(sys.argv[1], mode="r")), sys.argv[2], resume=True)
'''


def volume(kind=np.uint16):
    """Waves and noise; NaN and infinity among floats."""
    k, j, i = np.indices(SHAPE)
    noise = np.random.default_rng(1).integers(0, 200, SHAPE)
    values = (300 + 200 * np.sin(k / 5) * np.cos(j / 7 + i / 9) + noise).astype(kind)
    if np.issubdtype(kind, np.floating):
        values[20:22, 30, 40:50], values[5, 5, 5] = np.nan, np.inf
    return values


def field(step=4, affine=AFFINE):
    """A warp of waves, one node to `step` voxels, which leaves the volume at some of its border."""
    shape = [-(-(n - 1) // step) + 1 for n in SHAPE]
    k, j, i = np.indices(shape) * step
    mm = np.stack([4 * np.sin(k / 11) + 2, 5 * np.cos(i / 13) - 1, 7 * np.sin((i + j) / 15)], -1)
    return supple.Warp.from_array(mm, affine @ np.diag([step, step, step, 1.0]),
                                  direction="resample")


def warped(values, **options):
    return supple.dask.warp(values, field(), affine=AFFINE, **options)


def whole(kind=np.uint16):
    return supple.resample(supple.Volume.from_array(volume(kind), AFFINE), warp=field()).array


@unittest.skipUnless(HAS_DASK, "python3-dask, python3-distributed or python3-zarr is not installed")
class Blocks(InFolder):
    def setUp(self):
        patch = unittest.mock.patch("supple.dask._BLOCK", 32)
        patch.start()
        self.addCleanup(patch.stop)

    def fresh(self, name):
        shutil.rmtree(self.path(name), ignore_errors=True)
        return self.path(name)

    def stored(self, chunks=(16, 16, 16), values=None, name="volume"):
        values = volume() if values is None else values
        made = zarr.open(self.fresh(name), mode="w", shape=values.shape, chunks=chunks,
                         dtype=values.dtype)
        made[:] = values
        return made

    def test_values_are_those_of_the_whole_whatever_the_type(self):
        for kind in (np.int8, np.uint8, np.int16, np.uint16, np.int32, np.float32):
            with self.subTest(kind):
                values = volume(kind)
                least = float(values[np.isfinite(values)].min())
                found, expected = warped(values, fill=least).compute(), whole(kind)
                if kind is np.int32:  # the whole is rounded to float32 before
                    self.assertLess((found != expected).mean(), 1e-3)
                    expected = np.where(abs(found - expected) > 1, expected, found)
                self.assert_same(found, expected)
        self.assertEqual(warped(volume(">i2")).compute().dtype, np.int16)
        big = volume(np.int64) + 2 ** 40
        at_rest = supple.dask.warp(big, np.zeros_like(field().array), affine=AFFINE,
                                   field_affine=field().affine).compute()
        self.assert_same(at_rest[:69, :89, :81], big[:69, :89, :81])

    def test_values_are_those_of_the_whole_whatever_the_chunks_and_workers(self):
        expected = whole()
        for chunks in CHUNKS:
            array = warped(self.stored(chunks), fill=100)
            with self.subTest(chunks):
                self.assert_same(array.compute(num_workers=2), expected)
            for workers in (1, 2, 4):
                with self.subTest(chunks, workers=workers), dask.config.set(
                        scheduler="threads", num_workers=workers):
                    told = supple.dask.store(array, self.fresh("out"))
                    self.assert_same(zarr.open(self.path("out"))[:], expected)
                    self.assertEqual(told["blocks"], np.prod(array.numblocks))

    def test_values_are_those_of_the_whole_on_processes(self):
        from distributed import Client, LocalCluster
        with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster, \
                Client(cluster):
            supple.dask.store(warped(self.stored(), fill=100), self.fresh("out"))
            self.assert_same(zarr.open(self.path("out"))[:], whole())

    def test_other_grids_are_those_of_the_whole(self):
        shape, affine = (40, 50, 44), TURN @ AFFINE @ np.diag([2, 1.7, 1.6, 1])
        grid, held = supple.Grid(shape, affine), supple.Volume.from_array(volume(), AFFINE)
        for interpolation in ("linear", "nearest"):
            expected = supple.resample(held, grid=grid, interpolation=interpolation).array
            found = supple.dask.resample(volume(), grid, affine=AFFINE, fill=int(volume().min()),
                                         interpolation=interpolation).compute()
            self.assertEqual(found.dtype, expected.dtype)
            self.assertLess((found != expected).mean(), 1e-3)  # exact halves, summed otherwise
            self.assertLess(np.abs(found.astype(int) - expected).max(), 2)
        turned = field(affine=TURN @ AFFINE)
        expected = supple.resample(held, warp=turned).array
        found = supple.dask.warp(volume(), turned, affine=AFFINE, fill=int(volume().min()))
        self.assert_same(found.compute(), expected)

    def test_what_a_block_does_not_declare_it_does_not_read(self):
        clean, outside = volume(np.float32), 0
        array = warped(clean, chunks=(16, 16, 16))
        task = dict(array.dask.layers[array.name])[array.name]
        for place, box in supple.dask.each_block(array.chunks):
            vectors, first = task.vectors(box)
            lo, hi = task.kernel.voxels_of(box, vectors, first)
            inside = supple.dask.slices(lo, hi)
            poisoned = np.full_like(clean, 3e38)
            poisoned[inside] = clean[inside]
            nodes = supple.dask.slices(first, np.add(first, vectors.shape[:3]))
            spoilt = np.full_like(field().array, 1e30)
            spoilt[nodes] = vectors
            found = supple.dask.warp(poisoned, spoilt, affine=AFFINE, chunks=(16, 16, 16),
                                     field_affine=field().affine)
            self.assert_same(found.blocks[place].compute(scheduler="synchronous"),
                             array.blocks[place].compute(scheduler="synchronous"))
            outside += clean.size - clean[inside].size
            # The offsets of the block itself decide, so that no box is much wider than its block.
            grown = np.subtract(hi, lo) - np.subtract(box[1], box[0])
            self.assertLess(max(grown), 2 * 7 / 1.25 + 3)
            for axis in range(3):  # and no voxel less would do
                less = list(inside)
                less[axis] = slice(inside[axis].start + 9, inside[axis].stop)
                with self.assertRaisesRegex(supple.InputError, "source: found a part"):
                    task.warped(box, (vectors, first), clean[tuple(less)],
                                [s.start for s in less], np.empty(supple.dask.shape_of(box), "f4"))
        self.assertGreater(outside, 20 * clean.size)

    def test_chunks_are_decoded_about_once(self):
        source = self.stored((8, 8, 8))
        with unittest.mock.patch("supple.dask._LEAST_RUNS", 1):
            told = supple.dask.store(warped(source, fill=100), self.fresh("out"), memory=1e9)
            self.assertLessEqual(told["decoded"], told["chunks"])
        read = []
        task = dict(warped(source).dask)[warped(source).name]
        class Counted:
            shape, dtype, chunks, ndim = source.shape, source.dtype, source.chunks, 3
            def __getitem__(self, box):
                read.append(box)
                return source[box]
        task.volume = Counted()
        slow = supple.dask.store(warped(source, fill=100), self.fresh("out"), memory=1e5)
        self.assertLess(slow["decoded"], 2.5 * slow["chunks"])
        supple.dask._write_run(task, [((0, 0, 0), (32, 32, 32)), ((0, 0, 32), (32, 32, 64))],
                               zarr.open(self.path("out")), "")
        self.assertEqual(len(read), len(set(map(str, read))))

    def test_a_slice_decodes_only_what_it_shows(self):
        source, expected = self.stored((8, 8, 8)), whole()
        with unittest.mock.patch("supple.dask.read_box", wraps=supple.dask.read_box) as read:
            found = warped(source, fill=100, box=(40, slice(None), slice(8, 60))).compute()
            for call in read.call_args_list:
                if call.args[0] is source:
                    self.assertLess(call.args[2][0] - call.args[1][0], 12)
        self.assert_same(found[0], expected[40, :, 8:60])
        self.assert_same(warped(source, fill=100)[40, 3].compute(), expected[40, 3])

    def test_a_kill_and_a_resume_give_the_same_store(self):
        source = self.stored()
        supple.dask.store(warped(source), self.fresh("whole"))
        self.fresh("out")
        done = 0
        for sent in (signal.SIGKILL, signal.SIGINT):
            run = subprocess.Popen([sys.executable, "-c", SLOW, source.store.path,
                                    self.path("out")], cwd=os.path.dirname(__file__),
                                   stderr=subprocess.DEVNULL)
            self.addCleanup(run.wait)
            end = time.monotonic() + 60
            count = done
            while count < done + 20 and time.monotonic() < end and run.poll() is None:
                time.sleep(0.02)
                count = sum(len(names) for _, _, names in os.walk(self.path("out")))
            self.assertIsNone(run.poll())
            run.send_signal(sent)
            self.assertNotEqual(run.wait(20), 0)
            done = sum(len(names) for _, _, names in os.walk(self.path("out")))
        with unittest.mock.patch("supple.dask._BLOCK", 16):
            told = supple.dask.store(warped(source), self.path("out"), resume=True)
        self.assertGreater(told["kept"], 20)
        self.assertGreater(told["blocks"], 0)
        self.assert_same(zarr.open(self.path("out"))[:], zarr.open(self.path("whole"))[:])
        with unittest.mock.patch("supple.dask._BLOCK", 16):
            self.assertEqual(supple.dask.store(warped(source), self.path("out"),
                                               resume=True)["blocks"], 0)

    def test_the_result_of_another_task_is_not_gone_on_with(self):
        source = self.stored()
        supple.dask.store(warped(source), self.fresh("out"))
        for array in (warped(source, fill=3), warped(source, interpolation="nearest")):
            with self.assertRaisesRegex(supple.UsageError, "out: found another array"):
                supple.dask.store(array, self.path("out"), resume=True)
        time.sleep(0.01)
        source[:8] = 0  # other values at the same place
        with self.assertRaisesRegex(supple.UsageError, "another array"):
            supple.dask.store(warped(source), self.path("out"), resume=True)
        with self.assertRaisesRegex(supple.UsageError, "found another array, expected none"):
            supple.dask.store(warped(source), self.path("out"))

    def test_other_dask_arrays_are_stored_and_warped_too(self):
        lazy = dask.array.from_array(volume(), chunks=(30, 31, 32))
        self.assert_same(warped(lazy, fill=100).compute(), whole())
        supple.dask.store(warped(lazy, fill=100), self.fresh("out"), chunks=(20, 20, 20))
        self.assert_same(zarr.open(self.path("out"))[:], whole())
        supple.dask.store(lazy + 1, self.fresh("other"), chunks=(16, 16, 16))
        self.assert_same(zarr.open(self.path("other"))[:], volume() + 1)

    def test_metrics_are_those_of_the_whole_field(self):
        dense = field(1)
        expected = supple.metrics(dense).maps
        for name, found in supple.dask.metrics(dense, block=40).items():
            self.assert_same(found.compute(), expected[name])

    def test_bad_arguments_are_told_in_one_line(self):
        good = {"affine": AFFINE, "field_affine": field().affine}
        vectors, values = field().array, volume()
        cases = [
            (lambda: supple.dask.warp(values, vectors), "affine: found none, expected 4 x 4"),
            (lambda: supple.dask.warp("a.zarr", vectors, **good), "volume: found str, expected"),
            (lambda: supple.dask.warp(values[0], vectors, **good), "found shape (90, 83)"),
            (lambda: supple.dask.warp(values, vectors[..., :2], **good), "[k, j, i, 3] in mm"),
            (lambda: supple.dask.warp(values > 3, vectors, **good), "values of type bool"),
            (lambda: warped(values, interpolation="cubic"), "'linear' or 'nearest'"),
            (lambda: warped(values, chunks=(0, 8, 8)), "chunks: found (0, 8, 8)"),
            (lambda: warped(values, box=(3, 4)), "box: found 2 parts"),
            (lambda: warped(values, box=(99, 4, 5)), "box: found slice(99, 100, None)"),
            (lambda: warped(values, grid=5), "found int, expected a path"),
            (lambda: supple.dask.warp(values, vectors, affine=np.zeros((4, 4)),
                                      field_affine=AFFINE), "axes"),
            (lambda: supple.dask.warp(values, supple.Warp(vectors, field().grid,
                                                          direction="material"), affine=AFFINE),
             "found direction material, expected resample"),
            (lambda: supple.dask.store(warped(values), self.fresh("out"), chunks=(8, 8)),
             "chunks: found (8, 8), expected 3 numbers")]
        for call, words in cases:
            with self.subTest(words), self.assertRaises((supple.InputError)) as raised:
                call()
            self.assertIn(words, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


if __name__ == "__main__":
    unittest.main(warnings="ignore")
