"""Types of the package: without faults of their own, as they are at run time, and of use."""
import importlib.util
import os
import subprocess
import sys
import tempfile
import unittest

import supple

USE = '''
import supple
head = supple.open("head.nrrd")
session = supple.Session(head, material="ct-head")
reveal_type(session.step(grab=[1, 2, 3], by=[0, 0, 1.0]))
reveal_type(session.resample())
reveal_type(supple.fit([[0, 0, 0]], [[1, 0, 0]], head.grid).direction)
reveal_type(head.grid.shape)
reveal_type(supple.augment.RandomDrag(reach=3)(head, number=1))
supple.read_warp("w.nrrd", direction=3)
'''


@unittest.skipUnless(importlib.util.find_spec("mypy"), "mypy is not installed")
class Types(unittest.TestCase):
    def mypy(self, module, *arguments, code=0):
        with tempfile.TemporaryDirectory() as folder:
            for name, text in (("use.py", USE), ("metaclass", "supple._supple.Grid\n")):
                with open(os.path.join(folder, name), "w") as file:
                    file.write(text)
            package = os.path.dirname(os.path.dirname(supple.__file__))
            done = subprocess.run([sys.executable, "-m", module, *arguments], cwd=folder, text=True,
                                  capture_output=True, env={**os.environ, "MYPYPATH": package})
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    def test_the_package_has_no_fault(self):
        self.mypy("mypy", "-p", "supple")

    def test_stubs_are_as_the_package_is(self):
        # Others than Grid are private; its metaclass is that of pybind11.
        self.mypy("mypy.stubtest", "supple._supple", "--ignore-missing-stub", "--allowlist",
                  "metaclass")

    def test_users_see_them(self):
        told = self.mypy("mypy", "use.py", code=1)
        for kind in ("Report", "Volume", '"builtins.str"', "Tuple[builtins.int", "dict[builtins.s",
                     '"int"; expected "Optional[str]"', "Found 1 error"):
            self.assertIn(kind, told)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
