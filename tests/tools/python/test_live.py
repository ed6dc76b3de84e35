"""Strokes of a hand: what is shown and told of them, and what they leave."""
import unittest

import numpy as np

import supple
from cases import InFolder, run_json, toml

MATERIAL = {"preset": "soft-tissue"}
WAY = [[0, 0, 0.5], [0.4, 0, 1.0], [0.8, 0.2, 1.5]]
VIEW = {"size": [64, 48], "preset": "MR-Default"}


class Strokes(InFolder):
    def session(self):
        session = supple.Session(self.head, MATERIAL)
        session.event("anchor", grab_box=[0, 0, 0, 23, 21, 4])
        return session

    def stroke(self, session, targets=WAY, **more):
        return supple.live.stroke(session, targets, grab=[12, 10, 14], view=VIEW, **more)

    def replayed(self, session):
        """The hash of the session's journal by the program."""
        file = self.path("journal.toml")
        with open(file, "w") as text:
            text.write("".join(f"{key} = {toml(value)}\n"
                               for key, value in session.journal().items()))
        return run_json("replay", file, "--quiet")["state"]

    def test_chainmail_leads_and_the_pictures_show_it(self):
        session, other = self.session(), self.session()
        other.event("grab", grab=[12, 10, 14])
        count = 0
        for moment in self.stroke(session):
            if moment.report is None:
                other.event("drag", to=WAY[count])
                self.assertEqual(list(moment.hand.asked), WAY[count])
                count += 1
            else:
                other.event("release")
            self.assertEqual((moment.model, moment.error_mm, moment.force_n), ("ecm", None, None))
            self.assert_same(moment.picture.array, other.show(**VIEW).array)
        self.assertEqual(count, len(WAY))
        self.assertEqual(session.hash, other.hash)
        self.assertEqual(session.hash, self.replayed(session))

    def test_elements_lead_with_error_and_force(self):
        session = self.session()
        at_rest = session.hash
        ways = [[0, 0, 0.5], [0, 0, 1.0], [0, 0, 1.5]]
        moments = []
        for moment in self.stroke(session, ways, fem={}, best=True):
            moments.append(moment)
            if moment.report is None:  # the body waits
                self.assertEqual(session.hash, at_rest)
        *led, after = moments
        self.assertEqual([m.model for m in moments], ["fem"] * 4)
        self.assertTrue(all(m.hand.done and m.error_mm == 0 for m in led))
        # In linear theory the force is that of the first place times the way.
        forces = np.array([m.force_n for m in led])
        self.assertGreater(forces[0], 0)
        np.testing.assert_allclose(forces, forces[0] * np.array([1, 2, 3]), rtol=1e-4)
        step = self.session()
        told = step.fem(grab=[12, 10, 14], by=ways[-1])
        own = np.linalg.norm(told.fem.anchor_force_n)
        self.assertLess(abs(forces[-1] - own), 0.01 * own)
        first, last = (np.abs(after.picture.array.astype(int) - m.picture.array).mean()
                       for m in (led[0], led[-1]))
        self.assertLess(last, 0.05 * first)
        self.assertEqual(session.hash, self.replayed(session))

    def test_a_loop_that_is_left_lets_go_there(self):
        session, other = self.session(), self.session()
        for moment in self.stroke(session, pictures=False):
            self.assertIsNone(moment.picture)
            break
        for _ in self.stroke(other, WAY[:1], pictures=False):
            pass
        self.assertEqual(session.hash, other.hash)

    def test_a_move_that_raises_is_taken_back(self):
        session = self.session()
        before = session.hash
        with self.assertRaisesRegex(supple.InputError, "to"):
            list(self.stroke(session, [[0, 0, 1.0], [0, 1.0]]))
        self.assertEqual(session.hash, before)
        with self.assertRaisesRegex(supple.InputError, "did you mean 'grab'"):
            list(supple.live.stroke(session, WAY, grabb=[12, 10, 14]))
        self.assertEqual(len(list(self.stroke(session))), len(WAY) + 1)  # and goes on


if __name__ == "__main__":
    unittest.main(warnings="ignore")
