"""A session in a notebook: the viewer of the program in a frame, or a page of pictures."""
import base64
import json
import os
import re
import subprocess
import sys
import unittest
import urllib.error
import urllib.request
from unittest import mock

import numpy as np

import supple
from cases import BINARY, InFolder, run

LOOK = {"preset": "MR-Default", "size": [90, 80], "quality": "draft"}
FAKE = """#!/bin/sh
echo "$@" > {0}/arguments
echo "http://127.0.0.1:8080/#key"
exec sleep 60
"""


class View(InFolder):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.session = supple.Session(cls.head, {"preset": "soft-tissue"})
        cls.session.drag([12, 10, 14], [1.2, 0.8, 2.5])

    def served(self, address):
        with urllib.request.urlopen(address.partition("#")[0], timeout=30) as answer:
            return answer.headers, answer.read()

    def test_pictures_go_from_rest_to_the_body_in_equal_parts(self):
        page = supple.view(self.session, live=False, steps=2, **LOOK).page
        pictures, = re.findall(r"const pictures = (\[.*?\])", page)
        pngs = [base64.b64decode(text) for text in json.loads(pictures)]
        self.assertEqual(len(pngs), 3)
        rest = self.session.show(deformed=False, **LOOK)
        self.assert_same(self.session.show(amount=0, **LOOK).array, rest.array)
        self.assertEqual(pngs[0], self.session.show(amount=0, **LOOK).png)
        self.assertEqual(pngs[2], self.session.show(**LOOK).png)
        half = supple.Warp(self.session.displacement().array * np.float32(0.5), self.session.grid,
                           direction="material")
        pull = supple.invert(half, direction="resample", void="nearest")
        self.assertEqual(pngs[1], self.session.show(amount=0.5, **LOOK).png)
        self.assert_same(supple.show(self.head, warp=pull, **LOOK).array,
                         self.session.show(amount=0.5, **LOOK).array)

    def test_a_page_of_pictures_needs_nothing_else(self):
        with mock.patch("supple._view._program", return_value=None):
            shown = supple.view(self.session, steps=1, **LOOK)
            with self.assertRaisesRegex(supple.SystemError, "found no program"):
                supple.view(self.session, live=True)
        self.assertIsNone(shown.address)
        self.assertNotRegex(shown.page, "http|src=\"(?!data:)|@import|url\\(")
        frame, = re.findall('^<iframe srcdoc="([^"]*)" sandbox="allow-scripts"',
                            shown._repr_html_())
        self.assertIn("const pictures", frame)
        shown.stop()

    def test_the_viewer_shows_the_session_until_it_is_stopped(self):
        sys.path.append(os.path.join(os.environ["SUPPLE_SOURCE_DIR"], "tests/tools/viewer"))
        from page import Page
        shown = supple.view(self.session, origins=())
        address = re.search('src="(http://[^"]*)"', shown._repr_html_())[1]
        self.assertEqual(address, shown.address)
        self.assertIn(b"<html", self.served(address)[1])
        port, token = re.fullmatch(r"http://127.0.0.1:(\d+)/#(\w+)", address).groups()
        page = Page(int(port), token)
        page.until(lambda: page.scene)
        self.assertEqual(page.scene["volume"]["elements"], self.session.elements)
        handle, = page.scene["handles"]
        moved, = self.session.apply(points=[handle["rest_lps"]]).at
        self.assertLess(np.abs(moved - handle["lps"]).max(), 1e-3)
        page.socket.close()
        shown.stop()
        with self.assertRaises(urllib.error.URLError):
            self.served(address)

    def test_it_is_shown_below_the_path_of_a_proxy(self):
        shown = supple.view(self.session, origins=(), base_url="/user/me/proxy/{port}/")
        self.addCleanup(shown.stop)
        src = re.search('src="([^"]*)"', shown._repr_html_())[1]
        port, = re.findall(r"^/user/me/proxy/(\d+)/#\w{20,}$", src)
        self.assertIn(b"<html", self.served(f"http://127.0.0.1:{port}{src}")[1])

    def test_it_ends_with_the_interpreter(self):
        code = ("import supple, sys\nshown = supple.view(supple.Session(sys.argv[1], "
                "{'preset': 'soft-tissue'}), origins=())\nprint(shown.address)")
        address = subprocess.run([sys.executable, "-c", code, self.head], check=True, text=True,
                                 capture_output=True).stdout.strip()
        self.assertTrue(address.startswith("http://127.0.0.1:"))
        with self.assertRaises(urllib.error.URLError):
            self.served(address)

    def test_what_the_program_is_asked_for(self):
        fake = self.path("fake")
        with open(fake, "w") as file:
            file.write(FAKE.format(os.path.dirname(fake)))
        os.chmod(fake, 0o755)
        with mock.patch("supple._view._program", return_value=fake):
            shown = supple.view(self.session, preset="Skin", origins=["https://hub.example"],
                                base_url="/proxy/{port}/")
        shown.stop()
        with open(self.path("arguments")) as file:
            self.assertRegex(file.read(), r"^view /\S+\.vdb --no-browser --no-journal --grace 600 "
                             r"--preset Skin --embed https://hub.example --port (\d+) --base-path "
                             r"/proxy/\1/ --origin https://hub.example$")

    def test_a_viewer_that_fails_says_why(self):
        with self.assertRaisesRegex(supple.Error, "No such preset"):
            supple.view(self.session, preset="No such preset", origins=())

    @unittest.skipUnless("--embed" in run("view", "--help"), f"{BINARY} cannot be embedded")
    def test_the_notebook_may_frame_it(self):
        shown = supple.view(self.session, origins=["http://localhost:8888"])
        self.addCleanup(shown.stop)
        headers, _ = self.served(shown.address)
        self.assertRegex(headers["Content-Security-Policy"],
                         "frame-ancestors[^;]* http://localhost:8888")
        self.assertIsNone(headers["X-Frame-Options"])


if __name__ == "__main__":
    unittest.main(warnings="ignore")
