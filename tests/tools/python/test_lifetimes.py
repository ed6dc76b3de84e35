"""Arrays stay valid without their owners, are read-only, and are shared where that is promised."""
import gc
import os
import threading
import unittest
import warnings

import numpy as np

import supple
from cases import AFFINE, InFolder, head


def owned(array):
    """A copy of what an array shows once everything that is not held is gone."""
    gc.collect()
    spoilt = [np.full_like(array, 77) for _ in range(8)]  # where freed memory would be
    del spoilt
    return np.array(array)


class Lifetimes(InFolder):
    def session(self):
        session = supple.Session(self.head, {"preset": "soft-tissue"})
        session.drag([12, 10, 14], [1.2, 0.8, 2.5])
        return session

    def check_outlives(self, make):
        owner = make()
        expected = [np.array(array) for array in owner[1:]]
        arrays = owner[1:]
        del owner
        for array, before in zip(arrays, expected):
            self.assert_same(owned(array), before)
            self.assertFalse(array.flags.writeable)
            with self.assertRaises(ValueError):
                array[0] = 1

    def test_arrays_of_a_session_outlive_it(self):
        def make():
            session = self.session()
            measured = session.metrics()
            return [session, session.displacement().array, session.offsets().array,
                    session.resample().array, *measured.maps.values()]
        self.check_outlives(make)

    def test_arrays_of_a_session_do_not_change_with_it(self):
        session = self.session()
        before = session.displacement().array
        copy = np.array(before)
        session.drag([12, 10, 14], [0, 0, 1])
        self.assert_same(before, copy)
        self.assertFalse(np.array_equal(session.displacement().array, copy))

    def test_pixels_outlive_the_picture(self):
        def make():
            picture = supple.show(self.head, size=[40, 30], preset="MR-Default")
            return [picture, picture.array]
        self.check_outlives(make)

    def test_values_of_files_outlive_the_volume_and_the_file(self):
        path = self.path("gone.nrrd")
        supple.Volume.from_array(head(), AFFINE).save(path)
        volume = supple.open(path)
        array = volume.array
        os.remove(path)
        self.assertIs(volume.array, array)
        del volume
        self.assert_same(owned(array), head())
        self.assertFalse(array.flags.writeable)

    def test_arrays_are_shared_and_stay_the_callers(self):
        array = head()
        volume = supple.Volume.from_array(array, AFFINE)
        self.assertTrue(np.shares_memory(volume.array, array))
        self.assertTrue(array.flags.writeable)
        vectors = np.zeros(array.shape + (3,), np.float32)
        warp = supple.Warp.from_array(vectors, AFFINE, direction="resample")
        self.assertTrue(np.shares_memory(warp.array, vectors))
        self.assertTrue(vectors.flags.writeable)
        del array, vectors
        self.assert_same(owned(volume.array), head())
        self.assertEqual(owned(warp.array).max(), 0)

    def test_files_in_memory_live_as_long_as_what_reads_them(self):
        volume = supple.Volume.from_array(head(), AFFINE)
        path = os.fspath(volume)
        session = supple.Session(volume, {"preset": "soft-tissue"})
        del volume
        gc.collect()
        self.assertTrue(os.path.exists(path))
        session.step(remove=[{"grab_density": [200, 255]}])  # reads the volume again
        self.assertGreater(session.elements, 0)
        del session
        gc.collect()
        self.assertFalse(os.path.exists(path))

    def test_arrays_of_any_layout_are_read_as_they_are_indexed(self):
        for array in (np.asfortranarray(head()), head()[::-1, :, ::2], head().astype(">i2"),
                      head().astype(np.float64)):
            volume = supple.Volume.from_array(array, AFFINE)
            again = supple.open(os.fspath(volume))
            self.assertTrue(np.array_equal(again.array, array))
            self.assertEqual(again.grid, volume.grid)

    def test_nibabel_images_keep_their_places(self):
        try:
            import nibabel
        except ImportError:
            self.skipTest("python3-nibabel is not installed")
        volume = supple.Volume.from_array(head(), AFFINE)
        image = volume.to_nibabel()
        self.assertEqual(image.shape, (24, 22, 20))
        self.assertTrue(np.allclose(image.affine[:3, 3], [20, -14, -9]))
        self.assertEqual(int(image.dataobj[12, 10, 9]), int(head()[9, 10, 12]))
        nibabel.save(image, self.path("head.nii.gz"))
        for again in (supple.open(self.path("head.nii.gz")), supple.Volume.from_nibabel(image)):
            self.assert_same(np.array(again.array), head())
            self.assertTrue(np.allclose(again.affine, AFFINE, atol=1e-5))
        session = supple.Session(image, {"preset": "soft-tissue"})
        plain = supple.Session(self.head, {"preset": "soft-tissue"})
        for each in (session, plain):
            each.drag([12, 10, 14], [1.2, 0.8, 2.5])
        self.assertEqual(session.hash, plain.hash)

    def test_sessions_and_warps_leave_no_memory_behind(self):
        def rss():
            with open("/proc/self/statm") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
        def work(times):
            for _ in range(times):
                session = self.session()
                supple.invert(session.displacement())
                session.metrics()
            gc.collect()
        work(10)
        before = rss()
        work(40)
        self.assertLess(rss() - before, 25)  # MB; an array of each would be 40

    def test_undo_and_redo_are_exact(self):
        session = supple.Session(self.head, {"preset": "soft-tissue"})
        hashes = [session.hash]
        for k in (14, 12, 15):
            session.drag([12, 10, k], [0.3, 0.2, 0.5])
            hashes.append(session.hash)
        for expected in hashes[-2::-1]:
            self.assertTrue(session.undo())
            self.assertEqual(session.hash, expected)
        self.assertFalse(session.undo())
        for expected in hashes[1:]:
            self.assertTrue(session.redo())
            self.assertEqual(session.hash, expected)
        self.assertFalse(session.redo())

    def test_threads_share_a_session(self):
        session = supple.Session(self.head, {"preset": "soft-tissue"})
        faults = []
        def drag():
            try:
                for _ in range(5):
                    session.drag([12, 10, 14], [0.1, 0, 0.1])
                    self.assertEqual(session.offsets().array.shape, head().shape + (3,))
            except Exception as fault:  # noqa: BLE001, of another thread
                faults.append(fault)
        threads = [threading.Thread(target=drag) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(faults, [])
        alone = supple.Session(self.head, {"preset": "soft-tissue"})
        for _ in range(20):
            alone.drag([12, 10, 14], [0.1, 0, 0.1])
        self.assertEqual(session.hash, alone.hash)


class Warnings(InFolder):
    def test_a_warning_names_the_line_of_the_caller(self):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            supple.Session(self.head)
        self.assertIn("no material given", str(told[0].message))
        self.assertIs(told[0].category, supple.SuppleWarning)
        self.assertEqual(told[0].filename, __file__)

    def test_a_warning_may_be_an_error(self):
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            with self.assertRaises(supple.SuppleWarning):
                supple.Session(self.head)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
