"""Deformable spatial registration objects: written, judged by dciodvfy, read back by the formula of
the standard and by supple.dicom."""
import os
import shutil
import subprocess
import unittest

import numpy as np
import supple
from cases import InFolder

try:
    import pydicom
    from pydicom.dataset import Dataset, FileMetaDataset
    from pydicom.uid import CTImageStorage, ExplicitVRLittleEndian, generate_uid
    import supple.dicom
except ImportError:
    pydicom = None


def turned(flips=False):
    """A turned grid of 0.8 x 1.1 x 2 mm, right- or left-handed."""
    angle = 0.4
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    affine = np.eye(4)
    affine[:3, :3] = turn @ np.diag([0.8, 1.1, -2.0 if flips else 2.0])
    affine[:3, 3] = [-20.5, 31.25, 4]
    return affine


def vectors():
    return np.random.default_rng(7).normal(size=(4, 5, 6, 3)).astype(np.float32)


def by_standard(item):
    """Places of the nodes [n, 3], and where C.20.3.1.1 takes them."""
    grid = item.DeformableRegistrationGridSequence[0]
    x, y, z = (int(n) for n in grid.GridDimensions)
    way = np.asarray(grid.ImageOrientationPatient, float)
    ways = way[:3], way[3:], np.cross(way[:3], way[3:])
    step = np.asarray(grid.GridResolution, float)
    numbers = np.frombuffer(grid.VectorGridData, "<f4").astype(float)
    places, taken = [], []
    before, after = (np.asarray(item[name][0].FrameOfReferenceTransformationMatrix, float).reshape(4, 4)
                     for name in ("PreDeformationMatrixRegistrationSequence",
                                  "PostDeformationMatrixRegistrationSequence"))
    for n in range(x * y * z):
        i, j, k = n % x, n // x % y, n // (x * y)
        place = np.asarray(grid.ImagePositionPatient, float) + sum(
            w * s * at for w, s, at in zip(ways, step, (i, j, k)))
        there = before @ [*place, 1] + [*numbers[3 * n:3 * n + 3], 0]
        places.append(place)
        taken.append((after @ there)[:3])
    return np.array(places), np.array(taken)


def nodes_of(warp):
    """Places of the nodes of a warp, and where it takes them, in an order of their own."""
    k, j, i = np.indices(warp.array.shape[:3])
    at = np.stack([i, j, k, np.ones_like(i)], -1).reshape(-1, 4) @ warp.affine.T
    return at[:, :3], at[:, :3] + warp.array.reshape(-1, 3)


@unittest.skipIf(pydicom is None, "skipped: python3-pydicom is not installed")
class Registrations(InFolder):
    def image(self, name, study=None, **values):
        image = Dataset()
        image.file_meta = FileMetaDataset()
        image.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
        image.is_little_endian, image.is_implicit_VR = True, False
        image.SOPClassUID, image.SOPInstanceUID = CTImageStorage, generate_uid()
        image.file_meta.MediaStorageSOPClassUID = image.SOPClassUID
        image.file_meta.MediaStorageSOPInstanceUID = image.SOPInstanceUID
        image.PatientName, image.PatientID, image.PatientBirthDate, image.PatientSex = "A^B", "7", "", "O"
        image.StudyInstanceUID, image.SeriesInstanceUID = study or generate_uid(), generate_uid()
        image.StudyDate, image.StudyTime, image.StudyID, image.AccessionNumber = "20260102", "101112", "1", ""
        image.ReferringPhysicianName, image.FrameOfReferenceUID = "", generate_uid()
        for key, value in values.items():
            setattr(image, key, value)
        image.save_as(self.path(name), write_like_original=False)
        return image

    def assert_alike(self, a, b):
        order = [np.lexsort(np.round(places, 3).T) for places, _ in (a, b)]
        for one, other in zip(a, b):
            self.assertLess(np.abs(one[order[0]] - other[order[1]]).max(), 1e-5)

    def test_objects_are_valid_and_lead_where_the_warp_does(self):
        fixed = self.image("fixed.dcm")
        moving = self.image("moving.dcm")
        for flips in (False, True):
            warp = supple.Warp.from_array(vectors(), turned(flips), direction="resample")
            supple.dicom.write(self.path("reg.dcm"), warp, fixed=self.path("fixed.dcm"),
                               moving=self.path("moving.dcm"))
            self.assertEqual(supple.dicom.frames(self.path("reg.dcm")), [moving.FrameOfReferenceUID])
            about = pydicom.dcmread(self.path("reg.dcm"))
            self.assertEqual((about.FrameOfReferenceUID, about.StudyInstanceUID, about.PatientID),
                             (fixed.FrameOfReferenceUID, fixed.StudyInstanceUID, "7"))
            self.assert_alike(by_standard(about.DeformableRegistrationSequence[0]), nodes_of(warp))
            self.assert_alike(nodes_of(supple.dicom.read(self.path("reg.dcm"))), nodes_of(warp))
            self.judge(self.path("reg.dcm"))
        self.assertFalse([name for name in os.listdir(self.path("")) if name.endswith(".part")])

    def judge(self, path):
        if shutil.which("dciodvfy") is None:
            self.skipTest("skipped: dicom3tools is not installed")
        done = subprocess.run(["dciodvfy", path], capture_output=True, text=True, check=False)
        self.assertEqual([line for line in done.stderr.splitlines() if line.startswith("Error")], [])
        self.assertIn("DeformableSpatialRegistration", done.stderr)

    def test_matrices_before_and_after_are_part_of_what_is_read(self):
        self.image("image.dcm")
        warp = supple.Warp.from_array(vectors(), turned(), direction="resample")
        supple.dicom.write(self.path("reg.dcm"), warp, fixed=self.path("image.dcm"))
        about = pydicom.dcmread(self.path("reg.dcm"))
        item = about.DeformableRegistrationSequence[0]
        for name, shift in (("PreDeformationMatrixRegistrationSequence", 3.0),
                            ("PostDeformationMatrixRegistrationSequence", -5.0)):
            matrix = turned() @ np.diag([1.1, 1, 1, 1])
            matrix[:3, 3] = [shift, 1, 2]
            item[name][0].FrameOfReferenceTransformationMatrix = list(matrix.ravel())
        about.save_as(self.path("moved.dcm"))
        self.assert_alike(by_standard(item), nodes_of(supple.dicom.read(self.path("moved.dcm"))))

    def test_what_is_none_is_told_in_a_line(self):
        self.image("image.dcm")
        self.image("no_frame.dcm", FrameOfReferenceUID="")
        warp = supple.Warp.from_array(vectors(), turned(), direction="resample")
        out = self.path("refused.dcm")
        sheared = turned()
        sheared[0, 1] += 0.3
        cases = [(lambda: supple.dicom.write(out, supple.Warp.from_array(vectors(), turned(), direction="material"),
                                             fixed=self.path("image.dcm")), 'expected "resample"'),
                 (lambda: supple.dicom.write(out, supple.Warp.from_array(vectors(), sheared, direction="resample"),
                                             fixed=self.path("image.dcm")), "perpendicular"),
                 (lambda: supple.dicom.write(out, warp, fixed=self.path("no_frame.dcm")), "FrameOfReferenceUID"),
                 (lambda: supple.dicom.write(out, warp, fixed=self.path("none.dcm")), "none.dcm: file: found none"),
                 (lambda: supple.dicom.write(out, warp, fixed=self.path("image.dcm"), label="warp"), "expected capitals"),
                 (lambda: supple.dicom.read(self.path("image.dcm")), "deformable spatial registration"),
                 (lambda: supple.dicom.read(__file__), "found no DICOM")]
        for act, words in cases:
            with self.assertRaises(supple.InputError) as refused:
                act()
            self.assertIn(words, str(refused.exception))
            self.assertNotIn("\n", str(refused.exception))
        self.assertFalse(os.path.exists(out))
        supple.dicom.write(out, warp, fixed=self.path("image.dcm"))
        about = pydicom.dcmread(out)
        grid = about.DeformableRegistrationSequence[0].DeformableRegistrationGridSequence[0]
        whole = grid.VectorGridData
        for spoiled, words in ((whole[:-12], "found 357 numbers"), (b"\0\0\xc0\x7f" + whole[4:], "undefined")):
            grid.VectorGridData = spoiled
            about.save_as(out)
            with self.assertRaises(supple.InputError) as refused:
                supple.dicom.read(out)
            self.assertIn(words, str(refused.exception))
        with self.assertRaises(supple.InputError):
            supple.dicom.read(out, 1)


if __name__ == "__main__":
    unittest.main()
