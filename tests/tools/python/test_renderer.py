"""Pictures of a Renderer are those of scenes, whatever it has shown before; and live sessions."""
import os
import signal
import struct
import threading
import time
import unittest

import numpy as np

import supple
from cases import AFFINE, InFolder, head, run, toml

MATERIAL = {"preset": "soft-tissue"}
STEPS = [
    {"grab": [12, 10, 14], "by": [1.2, 0.8, 2.5]},
    {"grab": [5, 10, 10], "by": [-0.6, 0.2, 0.0]},
    {"relax": {"passes": 3}},
    {"cut": [{"plane": {"corner": [11.5, 0, 9], "edge1": [0, 21, 0], "edge2": [0, 0, 11],
                        "frame": "voxel"}}]},
    {"grab": [14, 10, 15], "by": [2.0, 0, 1.0]},
    {"remove": [{"grab_density": [225, 255]}]},
    {"grab": [12, 12, 15], "by": [0.0, 0.5, 0.5]},
]
CUT = 4  # number of steps after which a cut may have opened
VIEWS = {
    "plain": {"preset": "MR-Default"},
    "from the left": {"camera": {"view": "left"}, "zoom": 1.5, "quality": "draft"},
    "what is seen fills it": {"fit": "visible", "annotate": ["letters", "scale"]},
    "at rest": {"deformed": False},
    "half offsets": {"half_offsets": True},
    "without inverse": {"inverse": False},
    "cubic": {"sampling": "cubic"},
    "shadows": {"shadows": True},
    "clipped": {"clip": [{"box": [0, 0, 0, 11, 21, 19], "space": "deformed"}]},
    "displacement": {"overlay": "displacement"},
    "arrows": {"arrows": 4.0},
    "outline": {"outline": True},
    "stereo": {"stereo": "side-by-side"},
    "along a path": {"path": [{"function": "twist", "angle": 20.0}]},
    "slices": {"slice": {"plane": "axial"}},
}


class Pictures(InFolder):
    def scene_pictures(self, views, folder):
        """Pixels of views, of which each says after which step, by the program."""
        scene = {"volume": {"path": self.head}, "labels": {"path": self.labels},
                 "material": MATERIAL, "step": STEPS,
                 "view": [{**view, "image": f"{n}.png"} for n, view in enumerate(views)]}
        file = self.path(folder + ".toml")
        with open(file, "w") as text:
            text.write("".join(f"{key} = {toml(value)}\n" for key, value in scene.items()))
        run("run", file, "-o", self.path(folder), "--quiet")
        return [supple._supple.pixels_of(self.path(f"{folder}/{n}.png"))
                for n in range(len(views))]

    def test_a_renderer_follows_a_session_through_its_steps(self):
        wanted = [(step, name) for step in range(len(STEPS) + 1) for name in VIEWS
                  if not (step == 0 and name in ("displacement", "arrows"))
                  and not (step >= CUT and name == "without inverse")]
        views = [{**VIEWS[name], "after_step": step} for step, name in wanted]
        for view in views:
            view.update({} if "slice" in view else {"size": [40, 30]})
        expected = dict(zip(wanted, self.scene_pictures(views, "run")))
        session = supple.Session(self.head, MATERIAL, labels=self.labels)
        shared = supple.Renderer(session)
        own = {name: supple.Renderer(session) for name in VIEWS}
        def check(step):
            for (after, name), view in zip(wanted, views):
                if after == step:
                    view = {key: value for key, value in view.items() if key != "after_step"}
                    with self.subTest(step=step, view=name):
                        self.assert_same(own[name].render(**view).array, expected[after, name])
                        self.assert_same(shared.render(**view).array, expected[after, name])
        check(0)
        for number, step in enumerate(STEPS, 1):
            session.step(**step)
            check(number)
        for number in reversed(range(CUT, len(STEPS))):
            session.undo()
        check(CUT)

    def test_only_what_may_have_changed_is_marched(self):
        session = supple.Session(self.head, MATERIAL)
        renderer = supple.Renderer(session)
        view = {"size": [64, 48], "preset": "MR-Default"}
        self.assertEqual(renderer.render(**view).report.rays, 64 * 48)
        self.assertEqual(renderer.render(**view).report.rays, 0)
        session.drag([12, 10, 18], [0.3, 0, 0])
        self.assertTrue(0 < renderer.render(**view).report.rays < 0.8 * 64 * 48)
        self.assertEqual(renderer.render(**view, zoom=1.1).report.rays, 64 * 48)

    def test_volumes_and_warps(self):
        session = supple.Session(self.head, MATERIAL)
        session.drag([12, 10, 14], [1.2, 0.8, 2.5])
        warp = session.offsets()
        views = [{"size": [64, 48], "preset": "MR-Default"}, {"size": [64, 48], "deformed": False},
                 {"size": [60, 50], "lattice": True}, {"slice": {"plane": "coronal"}},
                 {"size": [64, 48], "sampling": "cubic"},
                 {"size": [64, 48], "path": [{"function": "twist", "angle": 20.0}]}]
        for given in (None, warp):
            renderer = supple.Renderer(self.head, warp=given)
            for view in 2 * views:
                with self.subTest(warp=given, view=view):
                    if given is not None and view.get("lattice"):
                        with self.assertRaises(supple.InputError):
                            renderer.render(**view)
                        continue
                    scene = {"volume": {"path": self.head},
                             "view": [{**view, "image": "view.png"}]}
                    if given is not None:
                        warp.save(self.path("warp.nrrd"))
                        scene["volume"]["offsets"] = self.path("warp.nrrd")
                    supple.Scene(scene).run(self.path("volume"), overwrite=True)
                    self.assert_same(renderer.render(**view).array,
                                     supple._supple.pixels_of(self.path("volume/view.png")))
        session.save(self.path("state.vdb"))
        view = {"size": [64, 48], "camera": {"view": "left"}}
        self.assert_same(supple.Renderer(self.path("state.vdb")).render(**view).array,
                         supple.Renderer(session).render(**view).array)

    def test_files_are_those_of_the_program(self):
        session = supple.Session(self.head, MATERIAL)
        session.drag([12, 10, 14], [1.2, 0.8, 2.5])
        session.save(self.path("file.vdb"))
        for bits in (8, 16):
            run("render", self.path("file.vdb"), "--size", "40,30", "--bits", str(bits), "-o",
                self.path("file.png"), "--force", "--quiet")
            picture = session.show(size=[40, 30], bits=bits)
            with open(self.path("file.png"), "rb") as file:
                written = file.read()
            self.assertEqual(struct.unpack(">IIB", picture.png[16:25]), (40, 30, bits))
            self.assertEqual(picture._repr_png_(), written)
            picture.save(self.path("saved.png"))
            self.assert_same(supple._supple.pixels_of(self.path("saved.png")), picture.array)

    def test_mesh_bodies_are_seen_beside_the_voxels(self):
        mesh = self.path("patch.stl")
        corners = np.array([[-15, -8, 24], [15, -8, 24], [0, 12, 24]], np.float32)
        with open(mesh, "wb") as file:
            file.write(bytes(80) + struct.pack("<I", 1) + struct.pack("<12f", 0, 0, 1,
                                                                      *corners.ravel()) + bytes(2))
        bodies = [{"name": "patch", "path": mesh}]
        view = {"size": [64, 48], "preset": "MR-Default"}
        supple.Scene({"volume": {"path": self.head}, "material": MATERIAL, "body": bodies,
                      "view": [{**view, "image": "view.png"}]}).run(self.path("mesh"))
        session = supple.Session(self.head, MATERIAL, body=bodies)
        self.assert_same(session.show(**view).array,
                         supple._supple.pixels_of(self.path("mesh/view.png")))
        bare = supple.Session(self.head, MATERIAL).show(**view)
        self.assertFalse(np.array_equal(session.show(**view).array, bare.array))

    def test_it_keeps_what_it_shows(self):
        session = supple.Session(self.head, MATERIAL)
        renderer = supple.Renderer(session)
        picture = renderer.render(size=[40, 30])
        before = np.array(picture.array)
        session.drag([12, 10, 14], [1.2, 0.8, 2.5])
        del session
        after = renderer.render(size=[40, 30])
        self.assert_same(picture.array, before)
        self.assertFalse(np.array_equal(after.array, before))
        self.assertFalse(after.array.flags.writeable)
        self.assertEqual((after.array.dtype, after.array.shape), (np.uint8, (30, 40, 4)))

    def test_what_is_refused(self):
        session = supple.Session(self.head, MATERIAL)
        renderer = supple.Renderer(session)
        before = renderer.render(size=[40, 30])
        for kind, words, call in (
                (supple.InputError, "did you mean 'size'", lambda: renderer.render(sise=[3, 3])),
                (supple.InputError, "picture", lambda: renderer.render(turntable=4)),
                (supple.InputError, "Bone", lambda: renderer.render(preset="Bonee")),
                (supple.InputError, "inverse",
                 lambda: supple.Renderer(self.head).render(inverse=False)),
                (supple.UsageError, "amount", lambda: supple.Renderer(self.head).render(amount=0)),
                (supple.UsageError, "warp", lambda: supple.Renderer(session, warp=self.head)),
                (supple.InputError, "/no/head", lambda: supple.Renderer("/no/head.nrrd").render())):
            with self.subTest(words), self.assertRaisesRegex(kind, words):
                call()
        self.assert_same(renderer.render(size=[40, 30]).array, before.array)

    def test_threads_may_share_it(self):
        session = supple.Session(self.head, MATERIAL)
        renderer, failures = supple.Renderer(session), []
        def draw():
            try:
                for _ in range(10):
                    renderer.render(size=[40, 30])
            except Exception as error:  # noqa: BLE001
                failures.append(error)
        threads = [threading.Thread(target=draw) for _ in range(3)]
        for thread in threads:
            thread.start()
        for n in range(8):
            session.drag([12, 10, 14], [0, 0, 0.2 if n % 2 == 0 else -0.2])
        for thread in threads:
            thread.join()
        self.assertEqual(failures, [])
        self.assert_same(renderer.render(size=[40, 30]).array,
                         supple.Renderer(session).render(size=[40, 30]).array)


class Ended(InFolder):
    """Pictures that would take long, ended; the next one is whole."""

    LONG = {"size": [3000, 3000], "quality": "accurate", "shadows": True, "ambient_occlusion": 20.0}

    def setUp(self):
        k, j, i = np.indices((96, 96, 96))
        ball = np.where((i - 48) ** 2 + (j - 48) ** 2 + (k - 48) ** 2 < 44 ** 2, 120, 0)
        self.session = supple.Session(supple.Volume.from_array(ball.astype(np.uint8), np.eye(4)),
                                      MATERIAL)
        self.session.drag([48, 48, 80], [3, 2, 6])
        self.renderer = supple.Renderer(self.session)

    def whole(self):
        view = {"size": [40, 30]}
        self.assert_same(self.renderer.render(**view).array,
                         supple.Renderer(self.session).render(**view).array)

    def test_control_c_ends_it(self):
        for wait in (0.02, 0.6):
            sent = []
            def interrupt():
                sent.append(time.monotonic())
                os.kill(os.getpid(), signal.SIGINT)
            threading.Timer(wait, interrupt).start()
            with self.assertRaises(KeyboardInterrupt):
                self.renderer.render(**self.LONG)
            print(f"render: {1000 * (time.monotonic() - sent[0]):.0f} ms after the signal")
            self.whole()

    def test_a_callback_hears_and_ends_it(self):
        heard = []
        def listen(stage, fraction):
            heard.append(stage)
            return stage != "rendering" or fraction == 0
        with self.assertRaises(supple.Cancelled):
            self.renderer.render(progress=listen, **self.LONG)
        self.assertEqual(heard[-1], "rendering")
        self.whole()


if __name__ == "__main__":
    unittest.main(warnings="ignore")
