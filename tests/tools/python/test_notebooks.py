"""Notebooks of the documentation run, cell by cell, judged by their own asserts."""
import importlib.util
import json
import os
import tempfile
import unittest
from pathlib import Path

os.environ["MPLBACKEND"] = "agg"
FOLDER = Path(os.environ["SUPPLE_SOURCE_DIR"]) / "docs/notebooks"


class Notebooks(unittest.TestCase):
    def test_they_run_and_are_kept_without_outputs(self):
        for path in sorted(FOLDER.glob("*.ipynb")):
            with self.subTest(path.name), tempfile.TemporaryDirectory() as folder:
                cells = json.loads(path.read_text())["cells"]
                codes = [cell for cell in cells if cell["cell_type"] == "code"]
                self.assertFalse(any(cell["outputs"] or cell["execution_count"] for cell in codes))
                texts = ["".join(cell["source"]) for cell in codes]
                self.assertTrue(any("assert " in text for text in texts))
                if any("matplotlib" in text for text in texts):
                    if not importlib.util.find_spec("matplotlib"):
                        self.skipTest("python3-matplotlib is not installed")
                os.chdir(folder)
                names = {}
                for number, text in enumerate(texts):
                    exec(compile(text, f"{path.name}[{number}]", "exec"), names)  # noqa: S102
                os.chdir("/")


if __name__ == "__main__":
    unittest.main(warnings="ignore")
