#!/usr/bin/env python3
"""The list of skipped tests names each with its reason, and a missing judge is an error."""
import contextlib
import io
import os
import tempfile
import unittest

import skipped_tests

LOG = """3/61 Testing: volumes_io.unit
3/61 Test: volumes_io.unit
Output:
----------------------------------------------------------
/somewhere/tests/volumes/io/test_sparse.cpp:226: Skipped
head.nhdr is not there
[  SKIPPED ] 1 test.
4/61 Testing: interop.round_trips
4/61 Test: interop.round_trips
compared: 3 files
"""
JUDGE = "skipped: nifti: python3-nibabel is not installed\n"


class Lists(unittest.TestCase):
    def run_on(self, log, *options):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "LastTest.log")
            with open(path, "w", encoding="utf-8") as file:
                file.write(log)
            out = io.StringIO()
            with contextlib.redirect_stdout(out):
                code = skipped_tests.main([*options, path])
        return code, out.getvalue().splitlines()

    def test_every_skip_is_named_with_its_reason(self):
        first = "  volumes_io.unit: head.nhdr is not there (tests/volumes/io/test_sparse.cpp:226)"
        self.assertEqual(self.run_on(LOG), (0, ["skipped: 1", first]))
        self.assertEqual(self.run_on(LOG + JUDGE),
                         (0, ["skipped: 2", first,
                              "  interop.round_trips: nifti: python3-nibabel is not installed"]))
        self.assertEqual(self.run_on(""), (0, ["skipped: nothing"]))

    def test_a_missing_judge_is_an_error_where_judges_are_needed(self):
        self.assertEqual(self.run_on(LOG, "--need-judges")[0], 0)
        code, lines = self.run_on(LOG + JUDGE, "--need-judges")
        self.assertEqual(code, 1)
        self.assertTrue(lines[-1].startswith("error: 1 skipped"), lines)


if __name__ == "__main__":
    unittest.main()
