"""OME-Zarr: images of 0.4 and fields of 0.6 come back, and are what the specifications say."""
import gzip
import importlib.util
import json
import os
import shutil
import unittest

import numpy as np

import supple
from cases import InFolder

HAS_ZARR = all(importlib.util.find_spec(name) for name in ("dask", "zarr"))
if HAS_ZARR:
    import numcodecs
    import zarr

    import supple.dask
    import supple.ome

SCALE, ORIGIN = np.array([0.5, 0.75, 2.0]), np.array([10.0, -20.0, 30.0])  # x, y, z
AFFINE = np.diag([*SCALE, 1.0])
AFFINE[:3, 3] = ORIGIN
SHAPE = (20, 33, 41)


def values():
    return np.random.default_rng(2).integers(0, 4000, SHAPE).astype(np.uint16)


def vectors():
    return np.random.default_rng(3).normal(0, 3, (7, 10, 12, 3)).astype(np.float32)


@unittest.skipUnless(HAS_ZARR, "python3-dask or python3-zarr is not installed")
class Ome(InFolder):
    def fresh(self, name):
        shutil.rmtree(self.path(name), ignore_errors=True)
        return self.path(name)

    def read(self, *names):
        with open(self.path(os.path.join(*names))) as file:
            return json.load(file)

    def test_images_come_back_with_their_places(self):
        for axes, affine in (("LPS", AFFINE), ("RAS", np.diag([-1.0, -1, 1, 1]) @ AFFINE)):
            path = self.fresh("image")
            supple.ome.write(path, values(), affine, levels=3, chunks=(16, 16, 16), axes=axes)
            for level in range(3):
                found = supple.ome.open(path, level, axes=axes)
                centre = found.affine @ [*(np.array(found.stored.shape[::-1]) - 1) / 2, 1]
                # Levels cover the same place, but for voxels that make no pair.
                expected = affine @ [*(np.array(SHAPE[::-1]) - 1) / 2, 1]
                self.assertLess(np.abs((centre - expected)[:3] / SCALE).max(), 1.6)
                if level == 0:
                    self.assertTrue(np.array_equal(found.array.compute(), values()))
                    self.assertTrue(np.allclose(found.affine, affine))
        even = values()[:, :32, :40].astype(float).reshape(10, 2, 16, 2, 20, 2).mean((1, 3, 5))
        coarse = supple.ome.open(path, 1).stored[:]
        self.assertEqual(coarse.dtype, np.uint16)
        self.assertLessEqual(np.abs(coarse - even).max(), 0.5)

    def test_what_is_written_is_version_0_4(self):
        supple.ome.write(self.fresh("image"), values(), AFFINE, levels=2, chunks=(16, 16, 16))
        about = self.read("image", ".zattrs")["multiscales"][0]
        self.assertEqual(about["version"], "0.4")
        self.assertEqual([(a["name"], a["type"], a["unit"]) for a in about["axes"]],
                         [(name, "space", "millimeter") for name in "zyx"])
        self.assertEqual(about["datasets"][0]["coordinateTransformations"],
                         [{"type": "scale", "scale": [2.0, 0.75, 0.5]},
                          {"type": "translation", "translation": [30.0, -20.0, 10.0]}])
        self.assertEqual(about["datasets"][1]["coordinateTransformations"],
                         [{"type": "scale", "scale": [4.0, 1.5, 1.0]},
                          {"type": "translation", "translation": [31.0, -19.625, 10.25]}])
        self.assertEqual(self.read("image", "0", ".zarray")["dimension_separator"], "/")

    def test_labels_stay_labels(self):
        supple.ome.write(self.fresh("image"), values(), AFFINE, levels=2, labels=True)
        self.assert_same(supple.ome.open(self.path("image"), 1).stored[:],
                         values()[:20:2, :32:2, :40:2])

    def test_units_axes_and_levels_of_others_are_read(self):
        path = self.fresh("other")
        group = zarr.open_group(path, mode="w")
        five = np.arange(2 * 3 * 4 * 5 * 6, dtype=">i2").reshape(2, 3, 4, 5, 6)
        group.create_dataset("s0", data=five, chunks=(1, 1, 2, 3, 4))
        group.attrs["multiscales"] = [{
            "version": "0.4", "axes": [
                {"name": "t", "type": "time"}, {"name": "c", "type": "channel"},
                *({"name": name, "type": "space", "unit": "micrometer"} for name in "zyx")],
            "datasets": [{"path": "s0", "coordinateTransformations": [
                {"type": "scale", "scale": [1, 1, 3, 2, 1.5]},
                {"type": "translation", "translation": [0, 0, 100, 200, 300]}]}],
            "coordinateTransformations": [{"type": "scale", "scale": [1, 1, 2, 2, 2]}]}]
        found = supple.ome.open(path, index=(1, 2))
        self.assertTrue(np.array_equal(found.array.compute(), five[1, 2]))
        self.assertTrue(np.allclose(found.affine, [[3e-3, 0, 0, 0.6], [0, 4e-3, 0, 0.4],
                                                   [0, 0, 6e-3, 0.2], [0, 0, 0, 1]]))
        moved = supple.dask.warp(found, np.zeros((4, 5, 6, 3)), field_affine=found.affine)
        self.assertTrue(np.array_equal(moved.compute(), five[1, 2]))

    def test_fields_come_back_and_are_version_0_6(self):
        warp = supple.Warp.from_array(vectors(), AFFINE, direction="resample")
        for codec, decode in (("none", bytes), ("gzip", gzip.decompress),
                              ("zstd", lambda data: numcodecs.Zstd().decode(data))):
            for axes, turn in (("LPS", [1.0, 1, 1]), ("RAS", [-1.0, -1, 1])):
                path = self.fresh("field")
                turned = np.diag([*turn, 1.0]) @ AFFINE
                supple.ome.write_field(path, vectors(), turned, codec=codec, chunk=5, axes=axes)
                found = supple.ome.read_field(path, axes=axes)
                self.assertTrue(np.allclose(found.affine, turned))
                self.assertTrue(np.array_equal(found.array.compute(), vectors()))
                part = found.stored[2:6, 3:9, 4:5, :]
                self.assertTrue(np.array_equal(part, vectors()[2:6, 3:9, 4:5]))
            # The bytes, read without the package: components and axes z, y, x.
            about = self.read("field", "0", "zarr.json")
            self.assertEqual((about["zarr_format"], about["shape"]), (3, [3, 7, 10, 12]))
            with open(os.path.join(path, "0", "c", "0", "1", "1", "2"), "rb") as file:
                chunk = np.frombuffer(decode(file.read()), "<f4").reshape(3, 5, 5, 5)
            for component, (axis, sign) in enumerate(((2, 1), (1, -1), (0, -1))):
                self.assertTrue(np.array_equal(chunk[component, :2, :, :2],
                                               sign * vectors()[5:7, 5:10, 10:12, axis]))
            ome = self.read("field", "zarr.json")["attributes"]["ome"]
            self.assertEqual(ome["version"], "0.6")
            its = ome["multiscales"][0]["coordinateSystems"][0]["axes"]
            self.assertEqual([a["type"] for a in its], ["displacement", "space", "space", "space"])
        supple.ome.write_field(self.fresh("field"), warp)
        volume = np.random.default_rng(1).normal(0, 1, (7, 10, 12))
        through = [supple.dask.warp(volume, field, affine=AFFINE).compute()
                   for field in (warp, supple.ome.read_field(self.path("field")))]
        self.assert_same(*through)
        supple.dask.store(supple.dask.warp(volume, supple.ome.read_field(self.path("field")),
                                           affine=AFFINE), self.fresh("out"))
        self.assert_same(zarr.open(self.path("out"))[:], through[0])

    def test_fields_of_others_are_read(self):
        path = self.fresh("field")
        supple.ome.write_field(path, vectors(), AFFINE, codec="gzip")
        os.remove(os.path.join(path, "0", "c", "0", "0", "0", "0"))  # a chunk of nothing but 0
        about = self.read("field", "zarr.json")
        of = about["attributes"]["ome"]["multiscales"][0]
        for axis in of["coordinateSystems"][0]["axes"][1:]:
            axis["unit"] = "micrometer"
        with open(os.path.join(path, "zarr.json"), "w") as file:
            json.dump(about, file)
        found = supple.ome.read_field(path)
        self.assertFalse(found.array.compute().any())
        self.assertTrue(np.allclose(found.affine[:3], AFFINE[:3] / 1000))

    def test_bad_input_is_told_in_one_line(self):
        supple.ome.write(self.fresh("image"), values(), AFFINE, levels=1)
        supple.ome.write_field(self.fresh("field"), vectors(), AFFINE)
        os.makedirs(self.fresh("none"))
        turned = AFFINE.copy()
        turned[0, 1] = 0.1
        cases = [(lambda: supple.ome.open(self.path("none")), "none"),
                 (lambda: supple.ome.open(self.path("image"), 4), "level: found 4, expected 0"),
                 (lambda: supple.ome.open(self.path("image"), index=(0,)), "index: found 1"),
                 (lambda: supple.ome.open(self.path("image"), axes="LAX"), "axes: found 'LAX'"),
                 (lambda: supple.ome.write(self.fresh("new"), values(), turned),
                  "affine: found axes other than LPS"),
                 (lambda: supple.ome.write(self.fresh("new"), values()), "affine: found none"),
                 (lambda: supple.ome.read_field(self.path("image")), "zarr.json: found"),
                 (lambda: supple.ome.write_field(self.fresh("new"), vectors(), AFFINE, codec="lz"),
                  "codec: found 'lz'"),
                 (lambda: supple.ome.write_field(self.path("field"), vectors(), AFFINE),
                  "found something")]
        for call, words in cases:
            with self.subTest(words), self.assertRaises(supple.Error) as raised:
                call()
            self.assertIn(words, str(raised.exception))
            self.assertNotIn("\n", str(raised.exception))


if __name__ == "__main__":
    unittest.main(warnings="ignore")
