"""What the tests of the package share: a small head, the program, and readers of their own."""
import json
import os
import subprocess
import tempfile
import unittest

import numpy as np

import supple

BINARY = os.environ["SUPPLE_BINARY"]
AFFINE = np.array([[1.5, 0, 0, -20], [0, -1.25, 0, 14], [0, 0, 2, -9], [0, 0, 0, 1.0]])


def head():
    """A ball of tissue with a hard core, 24 x 22 x 20 voxels of int16."""
    k, j, i = np.indices((20, 22, 24))
    distance = np.sqrt((i - 11.5) ** 2 + (j - 10.5) ** 2 + (k - 9.5) ** 2)
    values = np.where(distance < 9, 120 - 4 * distance, 0)
    return np.where(distance < 3, 230, values).astype(np.int16)


def labels():
    k, j, i = np.indices((20, 22, 24))
    return (np.where(i > 11, 2, 1) * (head() > 0)).astype(np.uint8)


def run(*arguments, code=0):
    """Standard output of the program."""
    done = subprocess.run([BINARY, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}: {done.stderr}")
    return done.stdout if code == 0 else done.stderr


def run_json(*arguments):
    return json.loads(run(*arguments, "--json"))


def read_nrrd(path):
    """Values [k, j, i] or [k, j, i, 3] of a plain NRRD, without the package."""
    with open(path, "rb") as file:
        head_text, _, data = file.read().partition(b"\n\n")
    fields = dict(line.split(": ", 1) for line in head_text.decode().splitlines() if ": " in line)
    assert fields["encoding"] == "raw" and fields.get("endian", "little") == "little", fields
    names = {"float": "float32", "double": "float64", "short": "int16", "unsigned char": "uint8"}
    kind = names.get(fields["type"], fields["type"])
    sizes = [int(n) for n in fields["sizes"].split()]
    return np.frombuffer(data, kind).reshape(sizes[::-1])


def toml(value):
    """A dict as TOML, in line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml(item)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    return json.dumps(value) if isinstance(value, str) else repr(value)


class InFolder(unittest.TestCase):
    """A folder of its own with head.nrrd and labels.nrrd."""

    @classmethod
    def setUpClass(cls):
        cls._folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls._folder.cleanup)
        cls.head = cls.path("head.nrrd")
        supple.Volume.from_array(head(), AFFINE).save(cls.head)
        cls.labels = cls.path("labels.nrrd")
        supple.Volume.from_array(labels(), AFFINE).save(cls.labels)

    @classmethod
    def path(cls, name):
        return os.path.join(cls._folder.name, name)

    def assert_same(self, a, b):
        self.assertEqual((a.shape, a.dtype), (b.shape, b.dtype))
        self.assertTrue(np.array_equal(a, b))
