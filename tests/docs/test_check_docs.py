#!/usr/bin/env python3
"""Every check of check_docs.py finds what it is for, and says nothing of a page that is right."""
import os
import subprocess
import sys
import tempfile
import unittest

import check_docs

BINARY = os.environ.get("SUPPLE_BINARY", "")


class Checks(unittest.TestCase):
    def findings(self, text, binary="", files=None):
        with tempfile.TemporaryDirectory() as root:
            os.makedirs(os.path.join(root, "docs"))
            os.makedirs(os.path.join(root, "lib", "body"))
            open(os.path.join(root, "lib", "body", "body.h"), "w").close()
            with open(os.path.join(root, "docs", "page.md"), "w", encoding="utf-8") as page:
                page.write(text)
            for name, content in (files or {}).items():
                os.makedirs(os.path.dirname(os.path.join(root, name)))
                with open(os.path.join(root, name), "wb") as file:
                    file.write(content)
            return check_docs.check(root, binary)

    def expect(self, text, start, binary="", files=None):
        lines = self.findings(text, binary, files)
        self.assertEqual(len(lines), 1, lines)
        self.assertTrue(lines[0].startswith(start), lines[0])

    def test_links(self):
        self.assertEqual(self.findings("# A b: c, d\n[up](../lib) [here](#a-b-c-d) [w](https://x.y)\n"
                                       "`[code](nowhere.md)`\n"), [])
        self.expect("one\n[gone](gone.md)\n", "docs/page.md:2: found link gone.md, expected")
        self.expect("# A\n[gone](page.md#b)\n", "docs/page.md:2: found link page.md#b, expected")
        self.expect("# A\n```sh\n# B\n```\n[gone](#b)\n", "docs/page.md:5: found link #b, expected")

    def test_paths(self):
        self.assertEqual(self.findings("`lib/body`, `lib/body/body`, `lib/*/body.h`, `lib/NEW/new.h`"),
                         [])
        self.expect("`lib/body/gone.h`", "docs/page.md:1: found `lib/body/gone.h`, expected")

    def test_functions(self):
        files = {"lib/ecm/ecm.cpp": b"void Ecm::drag(int by) {}\n"}
        self.assertEqual(self.findings("`lib/ecm/ecm.cpp`, `Ecm::drag`; `lib/ecm/ecm.cpp`, `drag()`",
                                       files=files), [])
        self.expect("| 1 | `lib/ecm/ecm.cpp`, `Ecm::dra` |",
                    "docs/page.md:1: found `lib/ecm/ecm.cpp`, `dra`, expected", files=files)

    @unittest.skipUnless(BINARY, "SUPPLE_BINARY is not set")
    def test_commands(self):
        right = ("```sh\nsupple deform a.nrrd --grab 1,2,3 \\\n  --by -1,0,0 -o b.vdb  # --none\n"
                 "X=1 supple --json info \"$(supple presets --quiet)\" | grep --none a > b; true\n```\n")
        self.assertEqual(self.findings(right, BINARY), [])
        self.expect("```sh\nls\nsupple bend a\n```", "docs/page.md:3: found supple bend", BINARY)
        for line in ("supple info --none a", "true | supple info a --none=1",
                     "echo \"$(supple info --none a)\"", "supple info \\\n --none a",
                     "supple --none info a"):
            self.expect("```sh\n" + line + "\n```", "docs/page.md:2: found option --none", BINARY)
        self.expect("```sh\nsupple info 'a\n```", "docs/page.md:2: found quotes", BINARY)

    @unittest.skipUnless(BINARY, "SUPPLE_BINARY is not set")
    def test_keys(self):
        table = subprocess.run([BINARY, "keys", "relax", "--markdown"], stdout=subprocess.PIPE,
                               universal_newlines=True, check=True).stdout
        self.assertEqual(self.findings("<!-- keys: relax -->\n" + table + "\nmore\n", BINARY), [])
        self.expect("one\n<!-- keys: relax -->\n" + table.replace("passes", "times"),
                    "docs/page.md:2: found another table", BINARY)

    @unittest.skipUnless(BINARY, "SUPPLE_BINARY is not set")
    def test_the_matrix_of_extremes(self):
        table = subprocess.run([BINARY, "stress", "--markdown", "extremes"], stdout=subprocess.PIPE,
                               universal_newlines=True, check=True).stdout
        self.assertEqual(self.findings("<!-- stress: extremes -->\n" + table + "\nmore\n", BINARY), [])
        lines = table.splitlines(keepends=True)
        self.expect("one\n<!-- stress: extremes -->\n" + "".join(lines[:5] + lines[6:]),
                    "docs/page.md:2: found another table", BINARY)

    @unittest.skipUnless(BINARY, "SUPPLE_BINARY is not set")
    def test_runs(self):
        block = "<!-- run -->\n```sh\n%s\n```\n"
        self.assertEqual(self.findings(block % "supple presets > a\ntest -s a", BINARY), [])
        self.assertEqual(self.findings(block % "supple info build/data/none.nrrd", BINARY), [])
        self.expect(block % "supple info none.nrrd", "docs/page.md:3: found exit code 3", BINARY)
        self.assertEqual(self.findings("```sh\nsupple info none.nrrd\n```\n", BINARY), [])

    @unittest.skipUnless(BINARY, "SUPPLE_BINARY is not set")
    def test_pictures(self):
        make = "mkdir -p out; supple-examples phantom %s body.png; supple render body.png --size 64,64 -o %s"
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.dirname(BINARY) + os.pathsep + os.environ["PATH"]
            subprocess.run(make % ("t-shape", "shown.png"), shell=True, check=True, cwd=folder,
                           env={**os.environ, "PATH": path}, stderr=subprocess.DEVNULL)
            with open(os.path.join(folder, "shown.png"), "rb") as file:
                shown = {"docs/a/shown.png": file.read()}
        block = "<!-- pictures%s -->\n```sh\n" + make + "\n```\n"
        here = block % ("", "t-shape", "docs/a/shown.png")
        there = block % (": out docs/a", "t-shape", "out/shown.png")
        self.assertEqual(self.findings(here, BINARY, shown), [])
        self.assertEqual(self.findings(there, BINARY, shown), [])
        for text, found in ((block % ("", "gradient", "docs/a/shown.png"), "another docs/a/shown.png"),
                            (block % ("", "t-shape", "docs/a/other.png"), "a command for docs/a/other.png"),
                            (block % (": out docs/a", "t-shape", "docs/a/shown.png"), "no picture"),
                            (block % ("", "none", "docs/a/shown.png"), "exit code")):
            self.expect(text, "docs/page.md:3: found " + found, BINARY, shown)


if __name__ == "__main__":
    sys.dont_write_bytecode = True
    unittest.main()
