"""The wheel of this build, installed elsewhere: it needs no library of this machine and computes
the same."""
import base64
import hashlib
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import zipfile
from pathlib import Path

import supple
from cases import AFFINE, head, run_json

ROOT = os.environ["SUPPLE_SOURCE_DIR"]
USE = r"""
import sys, supple
from cases import toml
session = supple.Session(sys.argv[1], {"preset": "soft-tissue"})
session.drag([12, 10, 14], [1.2, 0.8, 2.5])
with open(sys.argv[2] + "/journal.toml", "w") as file:
    file.writelines(f"{key} = {toml(value)}\n" for key, value in session.journal().items())
print(supple.__file__, supple.__version__, session.hash)
print(*(line.split()[-1] for line in open("/proc/self/maps") if "openvdb" in line))
"""
EVERYWHERE = re.compile(r"(ld-linux-x86-64|lib(c|m|dl|rt|pthread|stdc\+\+|gcc_s))\.so\.\d+")


def told(*command, code=0, **variables):
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    done = subprocess.run([str(word) for word in command], cwd="/", text=True, capture_output=True,
                          env={**environment, "PIP_DISABLE_PIP_VERSION_CHECK": "1", **variables})
    if done.returncode != code:
        raise AssertionError(f"{command}: exit code {done.returncode}: {done.stdout}{done.stderr}")
    return done.stdout if code == 0 else done.stderr


@unittest.skipUnless(shutil.which("patchelf") and importlib.util.find_spec("pip"),
                     "patchelf or python3-pip is not installed")
class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = Path(folder.name)
        build = Path(supple.__file__).parents[2]
        told(sys.executable, "-m", "pip", "wheel", ROOT, "--no-deps", "--no-build-isolation",
             "--no-index", "-w", cls.folder, SUPPLE_BUILD_DIR=str(build))
        cls.wheel, = cls.folder.glob("*.whl")
        cls.env = cls.folder / "env"
        told(sys.executable, "-m", "venv", "--without-pip", "--system-site-packages", cls.env)
        told(sys.executable, "-m", "pip", "--python", cls.env / "bin/python", "install",
             "--no-index", cls.wheel)
        cls.package, = cls.env.glob("lib/python*/site-packages/supple")
        cls.head = cls.folder / "head.nrrd"
        supple.Volume.from_array(head(), AFFINE).save(cls.head)

    def test_a_drag_is_that_of_the_program(self):
        used, mapped = told(self.env / "bin/python", "-c", USE, self.head, self.folder,
                            PYTHONPATH=str(Path(__file__).parent)).splitlines()
        file, version, digest = used.split()
        self.assertEqual((Path(file).parent, version), (self.package, supple.__version__))
        self.assertEqual({Path(path).parent for path in mapped.split()}, {self.package / "_native"})
        journal = self.folder / "journal.toml"
        self.assertEqual(run_json("replay", journal, "--quiet")["state"], digest)

    def test_every_library_that_it_needs_is_in_it(self):
        native = self.package / "_native"
        files = [*self.package.glob("_supple.*.so"), *native.rglob("lib*.so*"), native / "supple"]
        self.assertGreater(len(files), 15)
        for file in files:
            for needed in told("patchelf", "--print-needed", file).split():
                self.assertTrue((native / needed).exists() or EVERYWHERE.fullmatch(needed),
                                f"{file} needs {needed}")
        for file in [*files, *native.glob("supple_*.so")]:
            rpath = told("patchelf", "--print-rpath", file).strip()
            self.assertEqual((file.parent / rpath.replace("$ORIGIN", ".")).resolve(), native, file)

    def test_licences_come_with_the_libraries(self):
        licences = {path.stem for path in self.package.parent.glob("supple-*.dist-info/licenses/*")}
        for name in ("supple", "libopenvdb10.0", "libtbb12", "libembree3-3", "zlib1g"):
            self.assertIn(name, licences)
        self.assertNotIn("libjbig0", licences)  # under the GPL
        self.assertLess((self.package / "_native/libjbig.so.0").stat().st_size, 20000)

    def test_the_record_holds_for_all_files(self):
        with zipfile.ZipFile(self.wheel) as archive:
            record, = (name for name in archive.namelist() if name.endswith("/RECORD"))
            lines = dict(line.split(",", 1) for line in archive.read(record).decode().splitlines())
            self.assertEqual(set(lines), set(archive.namelist()))
            for name in set(lines) - {record}:
                content = archive.read(name)
                digest = base64.urlsafe_b64encode(hashlib.sha256(content).digest())
                self.assertEqual(lines[name],
                                 f"sha256={digest.decode().rstrip('=')},{len(content)}")

    def test_the_program_and_its_plugins_come_with_it(self):
        program = self.env / "bin/supple"
        self.assertIn(f"supple {supple.__version__}", told(program, "--version"))
        told(program, "convert", self.head, self.folder / "head.h5")
        self.assertTrue((self.folder / "head.h5").stat().st_size)

    def test_a_plugin_without_its_libraries_is_one_line(self):
        spoilt = self.folder / "spoilt"
        spoilt.mkdir()
        shutil.copy(self.package / "_native/supple_hdf5.so", spoilt)
        library, = (name for name in told("patchelf", "--print-needed",
                                          spoilt / "supple_hdf5.so").split() if "hdf5" in name)
        told("patchelf", "--replace-needed", library, "libnowhere.so", spoilt / "supple_hdf5.so")
        line = told(self.env / "bin/supple", "convert", self.head, self.folder / "no.h5", code=4,
                    SUPPLE_PLUGIN_PATH=str(spoilt))
        self.assertIn("supple_hdf5.so: libnowhere.so: cannot open", line)
        self.assertEqual(line.count("\n"), 1)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
