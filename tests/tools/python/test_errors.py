"""Bad input gives typed errors with the line of the program; Ctrl-C and callbacks end calls."""
import os
import signal
import threading
import time
import unittest

import numpy as np

import supple
from cases import AFFINE, InFolder, head, run

MATERIAL = {"preset": "soft-tissue"}


class Refused(InFolder):
    def refused(self, call, *words, kind=supple.InputError):
        with self.assertRaises(kind) as raised:
            call()
        line = str(raised.exception)
        self.assertNotIn("\n", line)
        for word in words:
            self.assertIn(word, line)
        return raised.exception

    def test_what_is_no_volume(self):
        error = self.refused(lambda: supple.open("/no/such/file.nrrd"), "no such file")
        self.assertEqual(error.file, "/no/such/file.nrrd")
        self.assertEqual(error.expected, "a readable file")
        self.assertEqual("supple: error: " + str(error) + "\n",
                         run("info", "/no/such/file.nrrd", code=3))
        self.refused(lambda: supple.open(__file__), "unknown content")
        self.refused(lambda: supple.open(self._folder.name), self._folder.name)
        self.refused(lambda: supple.Session(head()), "ndarray", "from_array")
        self.refused(lambda: supple.Session(3.5), "float", "a path")

    def test_errors_are_of_the_kinds_that_python_knows(self):
        for kind in (supple.Error, ValueError, RuntimeError):
            with self.assertRaises(kind):
                supple.open("/no/such/file.nrrd")
        self.assertTrue(issubclass(supple.SystemError, OSError))

    def test_arrays_that_do_not_fit(self):
        self.refused(lambda: supple.Volume.from_array(head()[0], AFFINE), "2 dimensions")
        self.refused(lambda: supple.Volume.from_array(head(), np.eye(3)), "affine", "4 x 4")
        self.refused(lambda: supple.Volume.from_array(head(), np.zeros((4, 4))), "axes")
        self.refused(lambda: supple.Volume.from_array(head(), AFFINE * np.nan))
        self.refused(lambda: os.fspath(supple.Volume.from_array(head() * 1j, AFFINE)), "complex")
        self.refused(lambda: supple.Grid((1, 2), AFFINE), "(k, j, i)")
        vectors = np.zeros(head().shape + (3,), np.float32)
        self.refused(lambda: supple.Warp.from_array(vectors, AFFINE, direction="pull"),
                     "direction", "resample")
        with self.assertRaises(TypeError):  # never guessed
            supple.Warp.from_array(vectors, AFFINE)
        self.refused(lambda: supple.Warp.from_array(vectors[..., :2], AFFINE, direction="material"),
                     "[k, j, i, 3]")
        vectors[3, 4, 5] = np.nan
        self.refused(lambda: supple.invert(supple.Warp.from_array(vectors, AFFINE,
                                                                  direction="resample")), "finite")

    def test_directions_that_nobody_names(self):
        path = self.path("scalars.nrrd")
        supple.Volume.from_array(head(), AFFINE).save(path)
        self.refused(lambda: supple.read_warp(path), path)
        vectors = supple.Warp.from_array(np.zeros(head().shape + (3,), np.float32), AFFINE,
                                         direction="material")
        vectors.save(self.path("push.nrrd"))
        self.refused(lambda: supple.read_warp(self.path("push.nrrd"), direction="resample"),
                     "material")
        self.refused(lambda: supple.resample(self.head, warp=vectors), "material", "resample")
        self.refused(lambda: supple.compose(vectors), "material", "invert()")

    def test_steps_that_are_none(self):
        session = supple.Session(self.head, MATERIAL)
        before = session.hash
        error = self.refused(lambda: session.step(grabb=[1, 2, 3]), "did you mean 'grab'")
        self.assertEqual(error.field, "grabb")
        self.refused(lambda: session.step(), "a step that does nothing")
        self.refused(lambda: session.drag([12, 10, 300], [1, 0, 0]), "a voxel of the volume")
        self.refused(lambda: supple.Session(self.head).drag([0, 0, 0], [1, 0, 0]),
                     "a voxel of the body")
        self.refused(lambda: session.drag([12, 10], [1, 0, 0]), "three numbers")
        self.refused(lambda: session.relax(passes=-1), "passes")
        self.refused(lambda: session.fem({"accuracy": "wild"}), "accuracy")
        self.refused(lambda: session.event("drug"), "kind")
        self.refused(lambda: session.cut(mesh="/no/knife.stl"), "knife.stl")
        with self.assertRaises(TypeError) as raised:
            session.step(grab=object())
        self.assertIn("grab: found object", str(raised.exception))
        self.refused(lambda: session.resample(interpolation="nearest"), "interpolation")
        self.refused(lambda: session.offsets(void="vacuum"), "void", "nearest")
        self.refused(lambda: session.show(preset="Bonee"), "Bone")
        self.assertEqual((session.hash, session.history), (before, ([], [])))
        session.drag([12, 10, 14], [1, 0, 0])  # and goes on
        self.assertNotEqual(session.hash, before)

    def test_landmarks_that_are_none(self):
        at = np.eye(4, 3) * 9
        self.refused(lambda: supple.fit(at, at[:3], self.head), "4 and 3", "pairs")
        self.refused(lambda: supple.fit(at[:, :2], at[:, :2], self.head), "(n, 3)")
        self.refused(lambda: supple.fit(at[:0], at[:0], self.head), "one or more")
        self.refused(lambda: supple.fit(at * np.nan, at, self.head), "finite")
        self.refused(lambda: supple.fit(at[:3], at[[0, 0, 1]], self.head), "points")
        self.refused(lambda: supple.fit(at, at, self.head, stifness=1), "did you mean 'stiffness'")
        self.refused(lambda: supple.fit(at, at, self.head, direction="pull"), "direction")
        self.refused(lambda: supple.fit(at, at, self.head, rigid=[1]), "rigid and labels",
                     kind=supple.UsageError)
        self.refused(lambda: supple.fit(at, at, self.head, rigid=[9], labels=self.head), "label 9")

    def test_curves_that_are_none(self):
        at = np.eye(4, 3) * 9
        self.refused(lambda: supple.straighten(self.head, at[:1]), "1 point", "two or more")
        self.refused(lambda: supple.straighten(self.head, at[[0, 0, 1]]), "numbers 1 and 2")
        self.refused(lambda: supple.straighten(self.head, at[:, :2]), "(n, 3)")
        self.refused(lambda: supple.straighten(self.head, at * np.nan), "points")
        self.refused(lambda: supple.straighten(self.head, at, radius=-1), "radius")
        self.refused(lambda: supple.straighten(self.head, at, raduis=1), "did you mean 'radius'")
        self.refused(lambda: supple.straighten(self.head, at + 900), "out of the volume")

    def test_motions_that_are_none(self):
        kind = supple.augment.RandomDrag
        self.refused(lambda: kind(reech=3), "did you mean 'reach'")
        self.refused(lambda: kind(reach=-3), "reach")
        self.refused(lambda: kind(frame="nifti"), "frame", "ras")
        self.refused(lambda: kind(returns=["warps"]), "returns", "inverse")
        move = kind(MATERIAL)
        self.refused(lambda: move({"image": head()}), "affine")
        self.refused(lambda: move({"ct": head(), "affine": AFFINE}), "image")
        self.refused(lambda: move({"image": head()[0], "affine": AFFINE}), "2 dimensions")
        self.refused(lambda: move("/no/head.nrrd"), "/no/head.nrrd")
        case = {"image": head(), "labels": head()[1:], "affine": AFFINE}
        self.refused(lambda: move(case), "grid")
        for number in (-1, 2 ** 31, "1"):
            self.refused(lambda: move(self.head, number=number), "number", "2147483647")
        self.refused(lambda: move({"image": self.head, "points": np.zeros((3, 2))}), "(3, 2)")
        self.refused(lambda: supple.augment.RandomJointMotion(MATERIAL)(self.head), "rigid pieces")
        self.assertEqual(move(self.head, number=1)["truth"].sample, 1)  # and goes on

    def test_calls_that_do_not_fit_together(self):
        self.refused(lambda: supple.apply(self.head), "points or labels", kind=supple.UsageError)
        self.refused(lambda: supple.resample(self.head), "grid or spacing", kind=supple.UsageError)
        scene = supple.Scene({"volume": {"path": self.head}, "output": {"state": "a.vdb"},
                              "material": MATERIAL})
        scene.run(self.path("run"))
        self.refused(lambda: scene.run(self.path("run")), "exists", kind=supple.UsageError)
        scene.run(self.path("run"), overwrite=True)
        self.refused(lambda: supple.Scene({"volume": {"path": self.head}, "stepp": []}).plan(),
                     "did you mean 'step'")
        self.assertTrue(supple.Scene({"volume": {"path": self.head}}).plan().seconds >= 0)


class Ended(InFolder):
    """Calls that would take minutes, ended."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        k, j, i = np.indices((96, 96, 96))
        ball = np.where((i - 48) ** 2 + (j - 48) ** 2 + (k - 48) ** 2 < 44 ** 2, 120, 0)
        cls.large = supple.Volume.from_array(ball.astype(np.uint8), np.eye(4))
        cls.session = supple.Session(cls.large, MATERIAL)
        cls.session.drag([48, 48, 80], [3, 2, 6])
        cls.before = cls.session.hash

    def relax(self, **more):
        self.session.relax(passes=1000000, tolerance=0, **more)

    def fem(self, **more):
        self.session.fem({"tolerance": 1e-12}, handles=[{"grab": [48, 48, 80], "by": [3, 2, 6]}],
                         fix=[[30, 30, 4, 60, 60, 8]], **more)

    def augment(self, **more):
        supple.augment.RandomDrag(MATERIAL, passes=1000000)(self.large, number=1, **more)

    def springs(self, **more):
        self.session.step(model="springs", springs={"time": 100.0, "step": 0.001}, **more)

    def test_control_c_ends_long_calls(self):
        for work in (self.relax, self.fem, self.springs, self.augment):
            with self.subTest(work.__name__):
                sent = []
                def interrupt():
                    sent.append(time.monotonic())
                    os.kill(os.getpid(), signal.SIGINT)
                timer = threading.Timer(0.3, interrupt)
                timer.start()
                with self.assertRaises(KeyboardInterrupt):
                    work()
                self.late = time.monotonic() - sent[0]
                print(f"{work.__name__}: {1000 * self.late:.0f} ms after the signal")
                self.assertEqual(self.session.hash, self.before)

    def test_other_threads_run_meanwhile(self):
        ticks, is_done = [], threading.Event()
        def tick():
            while not is_done.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.001)
        thread = threading.Thread(target=tick)
        thread.start()
        begin = time.monotonic()
        self.session.relax(passes=40, tolerance=0)
        end = time.monotonic()
        is_done.set()
        thread.join()
        self.assertGreater(len([at for at in ticks if begin < at < end]), 5)
        self.assertTrue(self.session.undo())

    def test_a_callback_hears_and_may_end_it(self):
        heard = []
        def listen(stage, fraction):
            heard.append((stage, fraction))
            return len(heard) < 3
        with self.assertRaises(supple.Cancelled):
            self.relax(progress=listen)
        self.assertEqual(len(heard), 3)
        self.assertTrue(all(0 <= fraction <= 1 for _, fraction in heard))
        self.assertEqual(self.session.hash, self.before)

    def test_an_error_of_a_callback_is_the_callers(self):
        def listen(stage, fraction):
            raise LookupError("of the callback")
        with self.assertRaises(LookupError):
            self.relax(progress=listen)
        self.assertEqual(self.session.hash, self.before)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
