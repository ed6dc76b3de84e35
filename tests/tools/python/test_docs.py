"""Blocks of Python in the documentation run, one after the other for each page."""
import contextlib
import importlib.util
import inspect
import io
import os
import re
import shutil
import subprocess
import tempfile
import unittest

import numpy as np

import supple
from cases import AFFINE, head

ROOT = os.environ["SUPPLE_SOURCE_DIR"]
PAGES = ["README.md", "docs/python.md"]
MODULES = [(supple, ""), (supple.augment, "augment."), (supple.live, "live.")]
if importlib.util.find_spec("dask") and importlib.util.find_spec("zarr"):
    PAGES.append("docs/big_arrays.md")
    import supple.dask
    import supple.ome
    MODULES += [(supple.dask, "dask."), (supple.ome, "ome.")]
if importlib.util.find_spec("pydicom"):
    import supple.dicom
    MODULES.append((supple.dicom, "dicom."))


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

    def test_every_public_name_and_parameter_is_documented(self):
        found = dict(public_names())
        self.assertGreater(len(found), 80)
        for name, thing in found.items():
            text = inspect.getdoc(thing) or ""
            self.assertGreater(len(text), 20, f"{name} has no docstring")
            own = thing if not isinstance(thing, type) else vars(thing).get("__init__")
            for parameter in parameters_of(own):
                with self.subTest(f"{name}, {parameter}"):
                    self.assertRegex(text, rf"\b{parameter}\b")

    @unittest.skipUnless(shutil.which("sphinx-build"), "python3-sphinx is not installed")
    def test_the_reference_has_all_of_them(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["sphinx-build", "-q", "-W", "-b", "html", f"{ROOT}/docs/api", folder],
                           check=True)
            with open(os.path.join(folder, "index.html"), encoding="utf-8") as file:
                anchors = set(re.findall(r'id="supple\.([\w.]+)"', file.read()))
        self.assertEqual({name for name, _ in public_names()} - anchors, set())


def public_names():
    """Names below supple, with what they stand for; of classes the members, too."""
    for module, prefix in MODULES:
        for name in module.__all__:
            thing = getattr(module, name)
            if inspect.ismodule(thing):
                continue
            yield prefix + name, thing
            if isinstance(thing, type):
                for member, value in vars(thing).items():
                    if not member.startswith("_") or member == "__call__":
                        value = getattr(value, "__func__", value)
                        if callable(value) or isinstance(value, property):
                            yield f"{prefix}{name}.{member}", value


def parameters_of(function):
    """Those that a call gives, but for progress, which the package's docstring describes."""
    if not inspect.isfunction(function):
        return []
    return set(inspect.signature(function).parameters) - {"self", "cls", "progress"}


if __name__ == "__main__":
    unittest.main(warnings="ignore")
