"""Random motions in a loop: the bits of `supple augment`, whatever holds the volume."""
import json
import multiprocessing
import pickle
import random
import unittest
import unittest.mock

import numpy as np

import supple
from cases import AFFINE, InFolder, head, labels, read_nrrd, run

RAS = np.diag([-1.0, -1, 1, 1])
MATERIAL = {"domain": [-10, 255], "active": [1, 255], "max_length": [[0, 1.5]],
            "min_length": [[0, 0.6]], "shear": [[0, 0.4]], "rigid": [180, 255]}
OPTIONS = {"reach": 5, "radius": 4, "seed": 3}
POINTS = np.array([[-2.0, 1.5, 17.0], [0.0, 0.0, 10.0], [-90.0, 0, 0]])


def a_case():
    return {"image": head(), "labels": labels(), "points": POINTS, "affine": AFFINE, "name": "a"}


def image_of(number, move=None):
    move = move or supple.augment.RandomDrag(MATERIAL, **OPTIONS)
    return move(a_case(), number=number)["image"]


class Augmented(InFolder):
    def assert_alike(self, a, b):
        self.assertEqual(set(a), set(b))
        for name in set(a) - {"truth"}:
            self.assertTrue(np.array_equal(np.asarray(a[name]), np.asarray(b[name])), name)
        self.assertEqual(a["truth"]["hash"], b["truth"]["hash"])

    def test_samples_have_the_bits_of_the_program(self):
        material = self.path("material.toml")
        with open(material, "w") as file:
            file.write("".join(f"{key} = {json.dumps(value)}\n" for key, value in MATERIAL.items()))
        two = labels() + 2 * (head() == 230)  # the core in two pieces
        supple.Volume.from_array(two.astype(np.uint8), AFFINE).save(self.path("two.nrrd"))
        turns = {"turn": 9, "seed": 3}
        for motion, kind, more in (("drag", supple.augment.RandomDrag, OPTIONS),
                                   ("joint", supple.augment.RandomJointMotion, turns)):
            options = [str(part) for key, value in more.items() for part in (f"--{key}", value)]
            run("augment", self.head, "--material", material, "--labels", self.path("two.nrrd"),
                "--fix", "3,10,10", "--motion", motion, *options, "--count", 3, "-o",
                self.path("a%d.nrrd"), "--label-maps", self.path("l%d.nrrd"), "--warps",
                self.path("w%d.nrrd"), "--back-warps", self.path("b%d.nrrd"), "--truth",
                self.path("t.json"), "--quiet", "--force")
            with open(self.path("t.json")) as file:
                truth = json.load(file)
            move = kind(MATERIAL, body={"fix": [[3, 10, 10]]}, **more)
            case = {**a_case(), "labels": two.astype(np.uint8)}
            for number in (2, 1, 3):
                with self.subTest(motion, number=number):
                    sample = move(case, number=number)
                    for letter, name in zip("alwb", ("image", "labels", "warp", "inverse")):
                        self.assert_same(read_nrrd(self.path(f"{letter}{number}.nrrd")),
                                         np.asarray(sample[name]))
                    told = truth[number - 1]
                    told.pop("files")
                    sample["truth"].pop("point_kinds")
                    self.assertEqual(sample["truth"], told)
                    self.assertEqual((sample["warp"].direction, sample["inverse"].direction),
                                     ("resample", "material"))
            self.assertTrue(any(told["part"] > 0 for told in truth))

    def test_points_go_where_the_inverse_takes_them(self):
        sample = supple.augment.RandomDrag(MATERIAL, **OPTIONS)(a_case(), number=1)
        expected = supple.apply(sample["inverse"], points=POINTS[:2]).at
        self.assertLess(np.abs(sample["points"][:2] - expected).max(), 1e-5)
        self.assertEqual(sample["truth"].point_kinds[2], "outside")
        self.assertGreater(np.abs(np.asarray(sample["inverse"])).max(), 0.1)
        self.assertEqual(sample["name"], "a")

    def test_a_volume_a_path_and_arrays_of_any_kind_give_the_same_sample(self):
        move = supple.augment.RandomDrag(MATERIAL, **OPTIONS)
        expected = move(a_case(), number=2)
        for given in (self.head, supple.open(self.head)):
            sample = move(given, 3, 2)
            self.assertIsInstance(sample["image"], supple.Volume)
            self.assert_same(sample["image"].array, expected["image"])
        try:
            image = supple.open(self.head).to_nibabel()
            self.assert_same(move(image, number=2)["image"].array, expected["image"])
        except ImportError:
            pass  # python3-nibabel is not installed
        ras = supple.augment.RandomDrag(MATERIAL, frame="ras", names={"labels": "seg"}, **OPTIONS)
        sample = ras({"image": head().transpose()[None], "affine": RAS @ AFFINE,
                      "seg": labels().transpose().astype(np.float16)[None],
                      "points": POINTS * [-1, -1, 1]}, number=2)
        self.assert_same(sample["image"][0].transpose(), expected["image"])
        self.assertEqual(sample["seg"].dtype, np.float16)
        self.assertTrue(np.array_equal(sample["seg"][0].transpose(), expected["labels"]))
        self.assertTrue(np.allclose(sample["points"] * [-1, -1, 1], expected["points"], atol=1e-9))

    def test_a_case_is_opened_once_and_again_where_its_values_change(self):
        move = supple.augment.RandomDrag(MATERIAL, cases=2, **OPTIONS)
        other = {**a_case(), "image": np.where(head() > 100, head() + 3, head())}
        with unittest.mock.patch("supple.augment.Session", wraps=supple.Session) as opened:
            first = move(a_case(), number=1)
            self.assertEqual(move(a_case(), 8, 1)["truth"].seed, 8)
            changed = move(other, number=1)
            self.assert_alike(move(a_case(), number=1), first)
            self.assertEqual(opened.call_count, 2)
        self.assertFalse(np.array_equal(changed["image"], first["image"]))

    def test_numbers_that_nobody_gives_are_those_of_random(self):
        move = supple.augment.RandomDrag(MATERIAL, returns=["truth"], **OPTIONS)
        random.seed(4)
        drawn = [move(a_case())["truth"].sample for _ in range(3)]
        random.seed(4)
        again = move(a_case())
        self.assertEqual(again["truth"].sample, drawn[0])
        self.assertEqual(len(set(drawn)), 3)
        self.assertNotIn("warp", again)
        self.assert_same(move(a_case(), number=drawn[0])["image"], again["image"])

    def test_motions_go_to_other_processes(self):
        move = supple.augment.RandomDrag(MATERIAL, **OPTIONS)
        expected = [image_of(number, move) for number in (1, 2)]
        self.assert_same(image_of(1, pickle.loads(pickle.dumps(move))), expected[0])
        with multiprocessing.get_context("fork").Pool(2) as pool:
            for ours, theirs in zip(expected, pool.map(image_of, (1, 2))):
                self.assert_same(ours, theirs)


if __name__ == "__main__":
    unittest.main(warnings="ignore")
