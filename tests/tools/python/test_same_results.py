"""The same operations by command line and by Python lead to the same states, warps and pictures."""
import json
import unittest

import numpy as np

import supple
from cases import AFFINE, InFolder, head, labels, read_nrrd, run, run_json, toml

MATERIAL = {"preset": "soft-tissue"}
DRAG = {"grab": [12, 10, 14], "by": [1.2, 0.8, 2.5]}
STEPS = {
    "drag": [DRAG],
    "fixed": [{**DRAG, "fix": [[0, 0, 0, 23, 21, 4]]}],
    "in the patient's frame": [{"at_mm": [-2.0, 1.5, 19.0], "by_mm_lps": [1.0, -2.0, 1.0]}],
    "soft ball": [{"handles": [{"grab_ball": [12, 10, 12], "radius": 4.0, "soft": 3.0,
                                "by": [0.0, 0.0, 3.0]}]}],
    "two handles": [{"handles": [{"grab": [7, 10, 12], "by": [-1.5, 0, 0]},
                                 {"grab": [17, 10, 12], "by": [1.5, 0, 0]}]}],
    "ball limits": [{**DRAG, "limits": "ball"}],
    "tightened": [{**DRAG, "limits": "tighten"}],
    "relaxed": [DRAG, {"relax": {"passes": 8}}],
    "released": [DRAG, {"release": True}, {"grab": [8, 10, 10], "by": [0.0, 1.0, 0.0]}],
    "cut": [{"cut": [{"plane": {"corner": [11.5, 0, 9], "edge1": [0, 21, 0], "edge2": [0, 0, 11],
                                "frame": "voxel"}}]}, {"grab": [14, 10, 15], "by": [2.0, 0, 1.0]}],
    "removed": [{"remove": [{"grab_density": [200, 255]}]}, DRAG],
    "rigid": [{"rigid_density": [200, 255]}, {"grab": [11, 10, 10], "by": [0.0, 1.0, 1.0]}],
    "labels": [{"grab_label": 2, "by": [0.5, 0, 0], "fix": [[4, 10, 10]]}],
    "springs": [{**DRAG, "model": "springs", "springs": {"time": 0.01, "step": 0.005}}],
    "finite elements": [{**DRAG, "fix": [[0, 0, 0, 23, 21, 4]], "model": "fem"}],
    "finite strain": [{**DRAG, "fix": [[0, 0, 0, 23, 21, 4]], "model": "fem",
                       "fem": {"strain": "finite"}}],
    "box": [{"grab_box": [10, 8, 12, 14, 12, 14], "by": [0.0, 1.0, 1.0]}],
    "voxel's soft edge": [{**DRAG, "soft": 5.0}],
    "densities": [{"grab_density": [200, 255], "by": [0.0, 1.0, 0.5]}],
    "piece": [{"piece_at": [11, 10, 10], "by": [3.0, 0.0, 0.0]}],
    "turned": [{"grab_ball": [12, 10, 12], "radius": 4.0, "rotate": 4.0, "axis": [0, 0, 1.0]}],
    "grown": [{"grab_ball": [12, 10, 12], "radius": 4.0, "scale": 1.05}],
    "pushed": [{**DRAG, "push": True}],
    "slid": [{**DRAG, "fix": [[0, 0, 0, 23, 21, 4]], "slide": True}],
    "RAS frame": [{"frame": "ras", "grab_ball": [2.0, -1.5, 15.0], "radius": 4.0,
                   "by": [0.0, 1.0, 1.0]}],
    "fixed densities": [{"fix_density": [200, 255], "grab": [12, 10, 16], "by": [0.0, 0.0, 2.0]}],
    "fixed label": [{"fix_label": [1], "grab_label": 2, "by": [0.3, 0, 0]}],
    "rigid turn": [{"rigid_density": [200, 255]}, {"rigid_at": [11, 10, 10], "rotate": 3.0,
                                                   "axis": [0, 0, 1.0]}],
    "three strokes": [DRAG, {"grab": [7, 10, 12], "by": [-1.5, 0, 0]}, {"relax": {"passes": 4}}],
    "springs after a cut": [
        {"cut": [{"plane": {"corner": [11.5, 0, 9], "edge1": [0, 21, 0], "edge2": [0, 0, 11],
                            "frame": "voxel"}}]},
        {**DRAG, "model": "springs", "springs": {"time": 0.01, "step": 0.005}}],
}


class SameSteps(InFolder):
    """Each of the thirty scenes of steps: state, both warps, resampled volume, picture and reports."""

    def test_scenes_by_the_program_and_sessions_agree(self):
        for number, (name, steps) in enumerate(STEPS.items()):
            with self.subTest(name):
                self.check(f"case{number}", steps)

    def check(self, name, steps):
        scene = {"volume": {"path": self.head}, "labels": {"path": self.labels},
                 "material": MATERIAL, "step": steps,
                 "view": [{"image": "view.png", "size": [64, 64]}],
                 "output": {"state": "state.vdb", "offsets": ["pull.nrrd"],
                            "displacements": ["push.nrrd"], "volumes": ["deformed.nrrd"]}}
        file, folder = self.path(name + ".toml"), self.path(name)
        with open(file, "w") as text:
            text.write("".join(f"{key} = {toml(value)}\n" for key, value in scene.items()))
        told = run_json("run", file, "-o", folder, "--quiet")

        session = supple.Session(self.head, MATERIAL, labels=self.labels)
        for step in steps:
            session.step(**step)
        self.assertGreater(np.abs(session.displacement().array).max(), 0.1)
        self.assertEqual(supple.Session(folder + "/state.vdb").hash, session.hash)
        self.assert_same(read_nrrd(folder + "/pull.nrrd"), session.offsets().array)
        self.assert_same(read_nrrd(folder + "/push.nrrd"), session.displacement().array)
        self.assert_same(read_nrrd(folder + "/deformed.nrrd"), session.resample().array)
        picture = supple.show(session, size=[64, 64])
        self.assert_same(supple._supple.pixels_of(folder + "/view.png"), picture.array)
        self.assertGreater(picture.array[..., :3].std(), 5)
        self.assertEqual(told["certificate"], session.certificate)
        for by_program, by_python in zip(told["steps"], session.reports):
            self.assertEqual(set(by_program), set(by_python))
            self.assertEqual(by_program.get("moved"), by_python.get("moved"))

        again = supple.Scene(scene).run(self.path(name + "-again"))
        self.assertEqual(again.certificate, told["certificate"])
        self.assert_same(read_nrrd(self.path(name + "-again/pull.nrrd")), session.offsets().array)


class SameCommands(InFolder):
    """Commands of the program beside functions of the package."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.material = cls.path("material.toml")
        with open(cls.material, "w") as file:
            file.write('preset = "soft-tissue"\n')
        run("deform", cls.head, "--material", cls.material, "--grab", "12,10,14", "--by",
            "1.2,0.8,2.5", "-o", cls.path("state.vdb"), "--quiet")
        run("export", cls.path("state.vdb"), "-o", cls.path("pull.nrrd"), "--quiet")
        run("export", cls.path("state.vdb"), "--direction", "material", "-o",
            cls.path("push.nrrd"), "--quiet")
        cls.session = supple.Session(cls.head, cls.material)
        cls.session.drag([12, 10, 14], [1.2, 0.8, 2.5])
        cls.pull = supple.read_warp(cls.path("pull.nrrd"))
        cls.push = supple.read_warp(cls.path("push.nrrd"))

    def by_program(self, *arguments):
        """The values that a command writes behind -o."""
        path = self.path("out.nrrd")
        run(*arguments, "-o", path, "--force", "--quiet")
        return read_nrrd(path)

    def test_deform_and_replay(self):
        self.assertEqual(supple.Session(self.path("state.vdb")).hash, self.session.hash)
        journal = self.path("journal.toml")
        with open(journal, "w") as file:
            file.write("".join(f"{key} = {toml(value)}\n"
                               for key, value in self.session.journal().items()))
        self.assertEqual(run_json("replay", journal, "--quiet")["state"], self.session.hash)

    def test_warps_are_read_as_they_are(self):
        self.assertEqual((self.pull.direction, self.push.direction), ("resample", "material"))
        self.assert_same(read_nrrd(self.path("pull.nrrd")), self.pull.array)
        self.assert_same(self.session.offsets().array, self.pull.array)
        self.assertEqual(self.session.offsets().direction, self.pull.direction)
        self.assertEqual(self.session.displacement().direction, self.push.direction)
        self.assertTrue(np.allclose(self.pull.affine, AFFINE, atol=1e-12))

    def test_export_with_other_voids_and_grids(self):
        state = self.path("state.vdb")
        for void in ("outside", "extend"):
            self.assert_same(self.by_program("export", state, "--void", void),
                             self.session.offsets(void=void).array)
        coarse = supple.Grid((7, 8, 9), AFFINE @ np.diag([2.7, 2.9, 2.8, 1]))
        supple.Volume(np.zeros((7, 8, 9), np.uint8), coarse).save(self.path("coarse.nrrd"))
        self.assert_same(self.by_program("export", state, "--grid", self.path("coarse.nrrd")),
                         self.session.offsets(grid=coarse).array)

    def test_resample_of_states(self):
        state = self.path("state.vdb")
        self.assert_same(self.by_program("resample", state), self.session.resample().array)
        self.assert_same(self.by_program("resample", state, "--interpolation", "cubic"),
                         self.session.resample(interpolation="cubic").array)

    def test_resample_of_volumes(self):
        for interpolation in ("linear", "nearest", "cubic"):
            self.assert_same(
                self.by_program("resample", self.head, "--spacing", "1,2,1.5", "--interpolation",
                                interpolation),
                supple.resample(self.head, spacing=(1, 2, 1.5), interpolation=interpolation).array)
        moved = supple.Grid((12, 13, 14), AFFINE @ np.array(
            [[1.3, 0.2, 0, 1], [0, 1.5, 0, 2], [0, 0.1, 1.4, 1], [0, 0, 0, 1]]))
        supple.Volume(np.zeros((12, 13, 14), np.uint8), moved).save(self.path("moved.nrrd"))
        self.assert_same(self.by_program("resample", self.head, "--grid", self.path("moved.nrrd")),
                         supple.resample(self.head, grid=moved).array)

    def test_fit(self):
        at = np.random.default_rng(5).uniform([-18, -10, -7], [12, 12, 27], (14, 3))
        to = at + np.sin(at / 7) + [1.0, 0, -0.5]
        for name, points in (("from", at), ("to", to)):
            np.savetxt(self.path(name + ".csv"), points, "%.17g", ",", header="x,y,z", comments="")
        command = ["fit", "--grid", self.head, "--points", self.path("from.csv"),
                   self.path("to.csv")]
        for direction in ("resample", "material"):
            for options, more in (([], {}), (["--stiffness", "2.5"], {"stiffness": 2.5}),
                                  (["--labels", self.labels, "--rigid", "2", "--rigid-width", "4"],
                                   {"labels": self.labels, "rigid": [2], "rigid_width": 4}),
                                  (["--no-folds"], {"no_folds": True})):
                with self.subTest(direction=direction, **more):
                    path = self.path("fitted.nrrd")
                    told = run_json(*command, *options, "--direction", direction, "-o", path,
                                    "--force", "--quiet")
                    warp = supple.fit(at, to, self.head, direction=direction, **more)
                    self.assert_same(read_nrrd(path), warp.array)
                    told.pop("output")
                    self.assertEqual((warp.direction, warp.report), (direction, told))

    def test_fit_is_the_spline_of_scipy(self):
        try:
            from scipy.interpolate import RBFInterpolator
        except ImportError:
            self.skipTest("python3-scipy is not installed")
        at = np.random.default_rng(6).uniform([-18, -10, -7], [12, 12, 27], (20, 3))
        to = at + np.sin(at / 7)
        k, j, i = np.indices(head().shape).reshape(3, -1)
        places = (AFFINE @ np.stack([i, j, k, np.ones_like(i)]))[:3].T
        for stiffness in (0.0, 2.5):
            theirs = RBFInterpolator(at, to - at, kernel="linear", degree=1,
                                     smoothing=stiffness)(places)
            ours = supple.fit(at, to, self.head, direction="material", stiffness=stiffness).array
            self.assertLess(np.abs(ours.reshape(-1, 3) - theirs).max(), 5e-7)  # float32 of 4 mm
            self.assertGreater(np.abs(theirs).max(), 0.5)

    def test_straighten(self):
        along = np.array([[-15.0, -8, 5], [-6, 2, 9], [3, 3, 12], [10, -5, 20]])
        np.savetxt(self.path("along.csv"), along, "%.17g", ",", header="x,y,z", comments="")
        for options, more in ((["--radius", "4"], {"radius": 4}),
                              (["--radius", "30", "--height", "3", "--no-folds", "--up", "0,1,1",
                                "--spacing", "1.5", "--interpolation", "nearest"],
                               {"radius": 30, "height": 3, "no_folds": True, "up": (0, 1, 1),
                                "spacing": 1.5, "interpolation": "nearest"})):
            with self.subTest(**more):
                paths = [self.path("straight.nrrd"), self.path("straight_warp.nrrd")]
                told = run_json("straighten", self.head, "--along", self.path("along.csv"),
                                *options, "-o", paths[0], "--warp", paths[1], "--force")
                straight = supple.straighten(self.head, along, **more)
                self.assert_same(read_nrrd(paths[0]), straight.volume.array)
                self.assert_same(read_nrrd(paths[1]), straight.warp.array)
                told.pop("output")
                self.assertEqual((straight.warp.direction, straight.warp.report),
                                 ("resample", told))
                self.assertEqual(straight.volume.grid, straight.warp.grid)

    def test_what_is_straightened_is_bent_back(self):
        along = np.array([[-15.0, -8, 5], [-6, -2, 9], [3, 0, 12], [10, -1, 18]])
        straight = supple.straighten(self.head, along, radius=6, spacing=1)
        place = np.eye(4)
        place[:3, 3] = -25, -20, -8
        grid = supple.Grid((42, 36, 46), place)
        bend = supple.invert(straight.warp, grid=grid, void="outside")
        self.assertLess(bend.certificate["residual_max_voxels"], 1e-4)
        self.assertEqual(bend.certificate["folded_cells"], 0)
        waves = supple.Volume.from_array(
            np.sin(np.indices(straight.volume.shape) / 4).sum(0).astype(np.float32),
            straight.volume.affine)
        bent = supple.resample(waves, warp=bend, grid=grid)
        again = supple.straighten(bent, along, radius=3, spacing=1).volume.array
        inner = waves.array[3:-3, 3:-3]
        self.assertEqual(inner.shape, again.shape)
        self.assertLess(np.abs(again - inner)[:, :, 5:-5].max(), 0.15)  # linear, twice

    def test_invert(self):
        for void in ("extend", "outside", "nearest"):
            self.assert_same(self.by_program("invert", self.path("pull.nrrd"), "--void", void),
                             supple.invert(self.pull, void=void).array)
        self.assert_same(self.by_program("invert", self.path("pull.nrrd")),
                         supple.invert(self.pull).array)
        path = self.path("inverse.nrrd")
        told = run_json("invert", self.path("push.nrrd"), "-o", path, "--direction", "resample",
                        "--force")
        inverse = supple.invert(self.push, direction="resample")
        self.assert_same(read_nrrd(path), inverse.array)
        self.assertEqual(told["certificate"], inverse.certificate)
        self.assertEqual(supple.read_warp(path).direction, inverse.direction)

    def test_compose(self):
        inverse = supple.invert(self.pull)
        inverse.save(self.path("inverse.nrrd"))
        whole = supple.compose(self.pull, inverse)
        self.assert_same(self.by_program("compose", self.path("pull.nrrd"),
                                         self.path("inverse.nrrd")), whole.array)
        self.assert_same(supple.compose(self.path("pull.nrrd"), self.path("inverse.nrrd")).array,
                         whole.array)
        core = head() > 100
        self.assertGreater(np.abs(self.pull.array[core]).max(), 1)
        self.assertLess(np.abs(whole.array[core]).max(), 1e-3)

    def test_metrics_with_maps(self):
        for given, path in ((self.session, "state.vdb"), (self.push, "push.nrrd")):
            with self.subTest(path):
                options = {"--jacobian": "jacobian", "--displacement": "length_mm",
                           "--folds": "folded", "--bending": "bending_per_mm2"}
                told = run_json("metrics", self.path(path), "--force", *(
                    word for option, name in options.items()
                    for word in (option, self.path(name + ".nrrd"))))
                told.pop("direction", None)
                measured = supple.metrics(given)
                self.assertEqual(told, measured.summary)
                for name in options.values():
                    self.assert_same(read_nrrd(self.path(name + ".nrrd")), measured.maps[name])

    def test_points_go_there_and_back(self):
        points = np.array([[-2.0, 1.5, 17], [0, 0, 10], [3, 2, 15], [400, 0, 0]])
        source, moved = self.path("points.csv"), self.path("moved.csv")
        np.savetxt(source, points, delimiter=",", header="x,y,z", comments="")
        for given, path in ((self.session, "state.vdb"), (self.push, "push.nrrd"),
                            (self.pull, "pull.nrrd")):
            for back in (False, True):
                told = run_json("apply", self.path(path), "--points", source, "-o", moved,
                                "--force", "--quiet", *(["--back"] if back else []))
                places = supple.apply(given, points=points, back=back)
                written = np.loadtxt(moved, delimiter=",", skiprows=1)
                self.assertLess(np.abs(places.at - written).max(), 1e-4)
                self.assertEqual(places.kinds[3], "outside")
                self.assertIn("outside", json.dumps(told))

    def test_labels_follow(self):
        for given, path in ((self.session, "state.vdb"), (self.push, "push.nrrd"),
                            (self.pull, "pull.nrrd")):
            for back in (False, True):
                self.assert_same(
                    self.by_program("apply", self.path(path), "--labels", self.labels,
                                    *(["--back"] if back else [])),
                    supple.apply(given, labels=self.labels, back=back).array)
        followed = supple.apply(self.session, labels=supple.Volume.from_array(labels(), AFFINE))
        self.assertEqual(set(np.unique(followed.array)), {0, 1, 2})

    def test_volumes_through_warps_are_what_states_resample(self):
        through = supple.resample(self.head, warp=self.session.offsets(void="outside"))
        core = read_nrrd(self.labels) > 0
        inside = core & (self.session.resample().array > 0) & (through.array > 0)
        self.assertGreater(inside.sum(), 0.9 * core.sum())
        self.assertLessEqual(np.abs(through.array.astype(int) -
                                    self.session.resample().array)[inside].max(), 1)

    def test_pictures(self):
        views = [(self.head, ["--preset", "MR-Default"], {"preset": "MR-Default"}),
                 (self.path("state.vdb"), ["--view", "left", "--zoom", "1.5"],
                  {"camera": {"view": "left"}, "zoom": 1.5}),
                 (self.path("state.vdb"), ["--no-inverse"], {"inverse": False}),
                 (self.path("state.vdb"), ["--undeformed"], {"deformed": False})]
        for subject, options, view in views:
            with self.subTest(options):
                path = self.path("picture.png")
                run("render", subject, "--size", "80,60", *options, "-o", path, "--force",
                    "--quiet")
                pixels = supple._supple.pixels_of(path)
                self.assert_same(pixels, supple.show(subject, size=[80, 60], **view).array)
                if subject != self.head:
                    self.assert_same(pixels, self.session.show(size=[80, 60], **view).array)
        path = self.path("slices.png")
        run("slice", self.path("state.vdb"), "--plane", "sagittal", "-o", path, "--quiet")
        self.assert_same(supple._supple.pixels_of(path),
                         self.session.show(slice={"plane": "sagittal"}).array)

    def test_plan(self):
        scene = {"volume": {"path": self.head}, "material": MATERIAL, "step": [DRAG],
                 "output": {"state": "planned.vdb"}}
        file = self.path("planned.toml")
        with open(file, "w") as text:
            text.write("".join(f"{key} = {toml(value)}\n" for key, value in scene.items()))
        told = run_json("run", file, "-o", self.path("planned"), "--dry-run", "--quiet")
        plan = supple.Scene(scene).plan(self.path("planned"))
        rows = told.get("plan", told)["rows"]
        self.assertEqual([row["what"] for row in rows], [row.what for row in plan.rows])
        self.assertEqual(plan.files, [self.path("planned/planned.vdb")])

    def test_files_of_every_direction_are_read_back(self):
        for name in ("warp.nrrd", "warp.mha", "warp.nii.gz", "warp.h5"):
            self.push.save(self.path(name))
            self.assert_same(supple.read_warp(self.path(name), direction="material").array,
                             self.push.array)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
