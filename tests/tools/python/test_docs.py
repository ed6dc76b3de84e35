"""Blocks of Python in the documentation run, one after the other for each page."""
import contextlib
import importlib.util
import io
import os
import re
import tempfile
import unittest

import numpy as np

import supple
from cases import AFFINE, head

ROOT = os.environ["SUPPLE_SOURCE_DIR"]
PAGES = ["README.md", "docs/python.md"]
if importlib.util.find_spec("dask") and importlib.util.find_spec("zarr"):
    PAGES.append("docs/big_arrays.md")


class Pages(unittest.TestCase):
    def test_blocks_of_python_run(self):
        for page in PAGES:
            with self.subTest(page), tempfile.TemporaryDirectory() as folder:
                hounsfield = np.select([head() == 0, head() == 230], [-1000, 1000], head())
                supple.Volume.from_array(hounsfield.astype(np.int16), AFFINE).save(
                    os.path.join(folder, "head.nii.gz"))
                self.run_page(page, folder)

    def run_page(self, page, folder):
        with open(os.path.join(ROOT, page), encoding="utf-8") as file:
            blocks = re.findall(r"^```python\n(.*?)^```$", file.read(), re.M | re.S)
        self.assertGreater(len(blocks), 0)
        before = os.getcwd()
        os.chdir(folder)
        try:
            names = {}
            for block in blocks:
                with contextlib.redirect_stdout(io.StringIO()) as told:
                    exec(compile(block, page, "exec"), names)  # noqa: S102
                print(told.getvalue(), end="")
        finally:
            os.chdir(before)

    def test_every_public_name_is_documented(self):
        def check(thing, name):
            self.assertTrue(thing.__doc__, f"{name} has no docstring")
        for name in supple.__all__:
            thing = getattr(supple, name)
            check(thing, name)
            if isinstance(thing, type) and thing.__module__.startswith("supple."):
                for member, value in vars(thing).items():
                    if not member.startswith("_") and (callable(value) or isinstance(
                            value, (property, classmethod))):
                        check(value, f"{name}.{member}")


if __name__ == "__main__":
    unittest.main(warnings="ignore")
