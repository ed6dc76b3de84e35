#!/usr/bin/env python3
"""The study docs/studies/craniotomy on coarse voxels comes near the cells of the thesis' table 6.3 that it
is calibrated to, and its labels lie where they should. Skipped without Debian's mricron-data."""
import csv
import os
import re
import subprocess
import sys
import tempfile
import tomllib
import unittest

BINARY = os.environ.get("SUPPLE_BINARY", "")
FOLDER = os.path.join(os.environ.get("SUPPLE_SOURCE_DIR", os.path.join(os.path.dirname(__file__), "../..")),
                      "docs/studies/craniotomy")
TEMPLATES = "/usr/share/mricron/templates"
sys.path.insert(0, FOLDER)


def supple(*args):
    subprocess.run([BINARY, *args, "--quiet"], check=True, stdout=subprocess.DEVNULL)


@unittest.skipUnless(BINARY and os.path.exists(f"{TEMPLATES}/ch2bet.nii.gz"), "mricron-data is not installed")
class Craniotomy(unittest.TestCase):
    def make_brain(self, folder):
        """The files of make.py on voxels of 3 mm, and the scene that reads them."""
        at = lambda name: os.path.join(folder, name)
        supple("threshold", f"{TEMPLATES}/ch2bet.nii.gz", "--keep", "1,255", "--mask", "--spacing", "1.005,1.005,1.005",
               "-o", at("fine.nrrd"))
        supple("smooth", at("fine.nrrd"), "--sigma", "8", "-o", at("envelope.nrrd"))
        supple("mesh", at("envelope.nrrd"), "--elements", "34000", "-o", at("brain.vtu"))
        supple("resample", at("envelope.nrrd"), "--spacing", "3,3,3", "--interpolation", "nearest", "-o", at("brain.nrrd"))
        with open(os.path.join(FOLDER, "craniotomy.toml"), encoding="utf-8") as file:
            scene = file.read().split("[[view]]")[0]
        scene = re.sub(r"path *=.*", 'path = "brain.nrrd"', scene)
        scene = re.sub(r"spacing *=.*", "", scene)
        scene = re.sub(r"mesh *=.*", 'mesh = "brain.vtu"', scene)
        with open(at("scene.toml"), "w", encoding="utf-8") as file:
            file.write(scene)

    def test_cells_of_table_6_3(self):
        import make
        with open(os.path.join(FOLDER, "thesis_tables.toml"), "rb") as file:
            thesis = tomllib.load(file)["table_6_3"]
        dura = make.sheets(make.sheet("opening"))
        cells = [("lateral", "", thesis["lateral"][1][3]), ("lateral", dura, thesis["lateral"][1][1]),
                 ("bi-frontal", "", thesis["bi_frontal"][1][3])]
        cases = [{**make.opening_keys(name), "step.tets.sheets": sheets, "step.tets.swellings": make.swellings(40)}
                 for name, sheets, _ in cells]
        with tempfile.TemporaryDirectory() as folder:
            self.make_brain(folder)
            with open(os.path.join(folder, "cases.csv"), "w", newline="", encoding="utf-8") as file:
                writer = csv.DictWriter(file, cases[0])
                writer.writeheader()
                writer.writerows(cases)
            table = os.path.join(folder, "table.csv")
            supple("sweep", os.path.join(folder, "scene.toml"), "--cases", os.path.join(folder, "cases.csv"),
                   "--collect=volume_change_ml", "--collect=mesh_ml", "-o", table)
            with open(table, newline="", encoding="utf-8") as file:
                rows = list(csv.DictReader(file))
        for (name, sheets, printed), row in zip(cells, rows):
            percent = 100 * float(row["volume_change_ml"]) / float(row["mesh_ml"])
            self.assertLess(abs(percent / printed - 1), 0.04, (name, sheets, printed, percent))

    def test_labels_lie_on_the_head(self):
        try:
            import nibabel
            import numpy
        except ImportError:
            self.skipTest("python3-nibabel is not installed")
        import brain_labels as of
        with tempfile.TemporaryDirectory() as folder:
            mask, out = os.path.join(folder, "mask.nii.gz"), os.path.join(folder, "labels.nii.gz")
            supple("threshold", f"{TEMPLATES}/ch2bet.nii.gz", "--keep", "1,255", "--mask", "-o", mask)
            of.main(TEMPLATES, mask, out)
            labels = numpy.asarray(nibabel.load(out).dataobj)
            head = nibabel.load(f"{TEMPLATES}/ch2.nii.gz")
            density = numpy.asarray(head.dataobj)
            self.assertGreater((labels > 0).sum(), 0.99 * (numpy.asarray(nibabel.load(mask).dataobj) > 0).sum())
            middle = lambda label: head.affine[:3, :3] @ numpy.argwhere(labels == label).mean(axis=0) + head.affine[:3, 3]
            self.assertLess(middle(of.LEFT)[0], -10)      # RAS
            self.assertGreater(middle(of.RIGHT)[0], 10)
            self.assertLess(middle(of.CEREBELLUM)[2], middle(of.CORE)[2])
            self.assertLess(middle(of.TEMPORAL)[2], middle(of.BANK)[2])
            mean = lambda label: density[labels == label].mean()
            self.assertLess(mean(of.VENTRICLES), 0.75 * mean(of.CORE))


if __name__ == "__main__":
    unittest.main()
