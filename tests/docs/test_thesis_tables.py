#!/usr/bin/env python3
"""docs/studies/craniotomy/thesis_tables.toml against itself: every row obeys dV/V = -dp / K of the
thesis within its rounding, but for those that are named as misprints."""
import os
import tomllib
import unittest

FOLDER = os.environ.get("SUPPLE_SOURCE_DIR", os.path.join(os.path.dirname(__file__), "../.."))
KPA_PER_MMHG = 0.133322


def bulk_kpa(stiffness_kpa, poisson):
    return stiffness_kpa / (3 * (1 - 2 * poisson))


class ThesisTables(unittest.TestCase):
    def setUp(self):
        with open(os.path.join(FOLDER, "docs/studies/craniotomy/thesis_tables.toml"), "rb") as file:
            self.data = tomllib.load(file)

    def expect_law(self, volume_percent, fall_mmhg, bulk, digits, what):
        """Either number may be rounded by half of its last digit; `digits` of both."""
        percent = fall_mmhg * KPA_PER_MMHG / bulk * 100
        half_mmhg = 10 ** -digits * 0.51
        slack = half_mmhg + half_mmhg * KPA_PER_MMHG / bulk * 100
        return abs(percent - volume_percent) <= slack, f"{what}: {volume_percent} and {percent:.3f} %"

    def test_rows_of_both_parameters_obey_the_law(self):
        for name, bulk_of in (
                ("table_6_1", lambda t, x: bulk_kpa(t["stiffness_kpa"], x)),
                ("table_6_2", lambda t, x: bulk_kpa(x, t["poisson"]))):
            table = self.data[name]
            for x, percent, fall, left in table["rows"]:
                self.assertAlmostEqual(table["pressure_mmhg"] - fall, left, 6)
                holds, what = self.expect_law(percent, fall, bulk_of(table, x), 2, (name, x))
                self.assertTrue(holds, what)
        rows = {name: dict((row[0], row[1:]) for row in self.data[name]["rows"])
                for name in ("table_6_1", "table_6_2")}
        self.assertEqual(rows["table_6_1"][0.47], rows["table_6_2"][6.0])

    def test_rows_of_openings_obey_the_law_but_for_the_misprints(self):
        model, table = self.data["model"], self.data["table_6_3"]
        bulk = bulk_kpa(model["stiffness_kpa"], model["poisson_of_tables"])
        found = []
        for opening in ("bi_frontal", "lateral", "lateral_with_temporal_lobe"):
            self.assertEqual([row[0] for row in table[opening]], [10, 40, 80])
            for row in table[opening]:
                for n in (1, 3):
                    holds, what = self.expect_law(row[n], row[0] - row[n + 1], bulk, 1, opening)
                    if not holds:
                        found.append((opening, row[0], table["columns"][n], row[n]))
        told = [(m["opening"], m["pressure_mmhg"], m["column"], m["printed"])
                for m in self.data["misprint"]]
        self.assertEqual(found, told)
        for m in self.data["misprint"]:
            row = next(r for r in table[m["opening"]] if r[0] == m["pressure_mmhg"])
            n = table["columns"].index(m["column"])
            self.assertTrue(self.expect_law(m["expected"], row[0] - row[n + 1], bulk, 1, "")[0])

    def test_the_ratio_of_the_text_is_not_that_of_the_tables(self):
        model = self.data["model"]
        bulk = bulk_kpa(model["stiffness_kpa"], model["poisson_of_text"])
        holds = [self.expect_law(row[3], row[0] - row[4], bulk, 1, "")[0]
                 for opening in ("bi_frontal", "lateral", "lateral_with_temporal_lobe")
                 for row in self.data["table_6_3"][opening]]
        self.assertFalse(any(holds))


if __name__ == "__main__":
    unittest.main()
