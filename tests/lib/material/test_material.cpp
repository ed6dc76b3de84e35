#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "tests/lib/test_bodies.h"
#include "volumes/base/table.h"

using namespace supple;
using namespace supple::test;

namespace {

/// The thesis' table of figure 4.10.
MaterialTable thesis_table() {
  return linear_table(1.5, 0.6, 0.7);
}

}  // namespace

TEST(UnitMaterial, ClassesRoundToNearestOverTheDomainAndClampBeyondIt) {
  MaterialTable table = thesis_table();
  EXPECT_EQ(table.class_of(0), 0);
  EXPECT_EQ(table.class_of(127.4), 127);
  EXPECT_EQ(table.class_of(127.5), 128);
  EXPECT_EQ(table.class_of(255), 255);
  EXPECT_EQ(table.class_of(-40), 0);
  EXPECT_EQ(table.class_of(3000), 255);

  // -1024...3071: one class is 4095/255 = 16.06 HU; 0 HU is 63.77 classes up.
  table.domain_lo = -1024;
  table.domain_hi = 3071;
  EXPECT_EQ(table.class_of(0), 64);
  EXPECT_EQ(table.class_of(-1024 + 16.05 / 2), 0);
  EXPECT_EQ(table.class_of(-1024 + 16.07 / 2), 1);
}

TEST(UnitMaterial, LimitsAreReadAtTheMeanOfBothEndsWithHalfClasses) {
  const MaterialTable table = thesis_table();
  const LinkLimits limits = limits_of(table, 0, 100, 101);  // density 100.5
  EXPECT_DOUBLE_EQ(limits.max_length, 1 + 0.5 * 100.5 / 255);
  EXPECT_DOUBLE_EQ(limits.min_length, 1 - 0.4 * 100.5 / 255);
  EXPECT_DOUBLE_EQ(limits.shear1, 0.7 * 100.5 / 255);
  EXPECT_DOUBLE_EQ(limits.shear2, limits.shear1);
}

TEST(UnitMaterial, CombiningLimitsAveragesTheTwoEndsInsteadOfTheirDensities) {
  MaterialTable table = thesis_table();
  table.max_length = {{{0, 1.0}, {100, 1.0}, {101, 2.0}, {255, 2.0}}};
  EXPECT_DOUBLE_EQ(limits_of(table, 0, 0, 180).max_length, 1.0);  // density 90
  table.combine = Combine::limits;
  EXPECT_DOUBLE_EQ(limits_of(table, 0, 0, 180).max_length, 1.5);
  const SlackTable slacks(table, {1, 1, 1});
  EXPECT_EQ(slacks.upper(0, 0, 0, 180), 32768);
  EXPECT_EQ(slacks.upper(0, 0, 180, 0), 32768);
  EXPECT_EQ(slacks.upper(0, 0, 180, 181), 65536);
}

TEST(UnitMaterial, AxisOverridesReplaceTheCommonCurveOnThatAxisOnly) {
  MaterialTable table = thesis_table();
  table.max_length_axis[1] = Curve{{{0, 1.25}}};
  table.min_length_axis[2] = Curve{{{0, 0.75}}};
  EXPECT_DOUBLE_EQ(limits_of(table, 0, 255, 255).max_length, 1.5);
  EXPECT_DOUBLE_EQ(limits_of(table, 1, 255, 255).max_length, 1.25);
  EXPECT_DOUBLE_EQ(limits_of(table, 1, 255, 255).min_length, 0.6);
  EXPECT_DOUBLE_EQ(limits_of(table, 2, 255, 255).min_length, 0.75);
}

TEST(UnitMaterial, SlackIsRoundedDownInUnitsOfTwoToTheMinus16Voxel) {
  const SlackTable slacks(thesis_table(), {1, 1, 1});
  // Classes 1 and 2: (max_length - 1) * 65536 = 0.5 * 1.5/255 * 65536 = 192.75.
  EXPECT_EQ(slacks.upper(0, 0, 1, 2), 192);
  // (1 - min_length) * 65536 = 0.4 * 1.5/255 * 65536 = 154.2.
  EXPECT_EQ(slacks.lower(0, 0, 1, 2), 154);
  // shear * 65536 = 0.7 * 1.5/255 * 65536 = 269.85.
  EXPECT_EQ(slacks.upper(0, 1, 1, 2), 269);
  EXPECT_EQ(slacks.lower(0, 1, 1, 2), 269);
  EXPECT_EQ(slacks.upper(0, 0, 0, 0), 0);
  EXPECT_EQ(slacks.upper(2, 2, 255, 255), 32768);
  EXPECT_EQ(slacks.lower(2, 2, 255, 255), 26214);  // 0.4 * 65536 = 26214.4
  const LinkSlack link = slacks.slack(1, 1, 2);
  EXPECT_EQ(link.upper[0], 269);
  EXPECT_EQ(link.upper[1], 192);
  EXPECT_EQ(link.lower[1], 154);
}

TEST(UnitMaterial, Shear1BoundsTheLowerNumberedTransverseAxisAndConvertsBySpacing) {
  MaterialTable table = thesis_table();
  table.shear1 = {{{0, 0.25}}};
  table.shear2 = {{{0, 0.5}}};
  const SlackTable slacks(table, {1, 2, 4});
  // A link along i is 1 mm long: 0.25 mm of j is 1/8 voxel, 0.5 mm of k is 1/8 voxel.
  EXPECT_EQ(slacks.upper(0, 1, 0, 0), 65536 / 8);
  EXPECT_EQ(slacks.upper(0, 2, 0, 0), 65536 / 8);
  // Along j, 2 mm: shear1 bounds i (0.5 mm), shear2 bounds k (1 mm).
  EXPECT_EQ(slacks.lower(1, 0, 0, 0), 65536 / 2);
  EXPECT_EQ(slacks.lower(1, 2, 0, 0), 65536 / 4);
  // Along k, 4 mm: shear1 bounds i (1 mm), shear2 bounds j (2 mm).
  EXPECT_EQ(slacks.upper(2, 0, 0, 0), 65536);
  EXPECT_EQ(slacks.upper(2, 1, 0, 0), 65536);
}

TEST(UnitMaterial, VeryWideLimitsBecomeUnlimited) {
  MaterialTable table = thesis_table();
  table.max_length = {{{0, 1e9}}};
  EXPECT_EQ(SlackTable(table, {1, 1, 1}).upper(0, 0, 0, 0), kUnlimitedSlack);
}

TEST(UnitMaterial, EveryErrorNamesTableKeyPointValueAndExpectation) {
  const auto message = [](void (*spoil)(MaterialTable&)) {
    MaterialTable table = thesis_table();
    spoil(table);
    return validation_error(table);
  };
  EXPECT_EQ(validation_error(thesis_table()), "");
  EXPECT_EQ(message([](MaterialTable& t) { t.max_length.keys[1].second = 0.9; }),
            "m.toml: max_length key point 2: found [255, 0.9], expected max_length >= 1");
  EXPECT_EQ(message([](MaterialTable& t) { t.min_length.keys[0].second = 1.5; }),
            "m.toml: min_length key point 1: found [0, 1.5], expected 0 < min_length <= 1");
  EXPECT_EQ(message([](MaterialTable& t) { t.min_length.keys[0].second = 0; }),
            "m.toml: min_length key point 1: found [0, 0], expected 0 < min_length <= 1");
  EXPECT_EQ(message([](MaterialTable& t) { t.shear2.keys[1].second = -0.1; }),
            "m.toml: shear2 key point 2: found [255, -0.1], expected shear >= 0");
  EXPECT_EQ(message([](MaterialTable& t) { t.shear1.keys[1].first = 0; }),
            "m.toml: shear1 key point 2: found [0, 0.7], expected a density above 0 of the key "
            "point before");
  EXPECT_EQ(message([](MaterialTable& t) { t.shear1.keys[1].first = 300; }),
            "m.toml: shear1 key point 2: found [300, 0.7], expected a density inside the domain "
            "[0, 255]");
  EXPECT_EQ(message([](MaterialTable& t) { t.max_length.keys[0].second = NAN; }),
            "m.toml: max_length key point 1: found [0, nan], expected finite numbers");
  EXPECT_EQ(message([](MaterialTable& t) { t.max_length.keys.clear(); }),
            "m.toml: max_length: found no key points, expected at least one [density, value]");
  EXPECT_EQ(message([](MaterialTable& t) {
              t.max_length_axis[2] = Curve{{{10, 0.5}}};
            }),
            "m.toml: max_length_k key point 1: found [10, 0.5], expected max_length >= 1");
  EXPECT_EQ(message([](MaterialTable& t) { t.domain_hi = t.domain_lo; }),
            "m.toml: domain: found [0, 0], expected lower < upper, finite");
  EXPECT_EQ(message([](MaterialTable& t) { t.active_lo = 300; }),
            "m.toml: active: found [300, 255], expected lower <= upper, finite");
  EXPECT_EQ(message([](MaterialTable& t) { t.components = -1; }),
            "m.toml: components: found -1, expected 0 (all) or a count >= 1");
}

// Numbers below 1 and infinite ones: the library's own text of a list is undefined for them.
TEST(UnitMaterial, AnErrorShowsAListOrATableOnOneLine) {
  const auto found = [](const std::string& value) {
    Table table = Table::parse("key = " + value, "m.toml");
    try {
      table.get<std::string>("key");
    } catch (const InputError& error) {
      return error.problem().found;
    }
    return std::string("no error");
  };
  EXPECT_EQ(found("[0.25, -inf, [1, [], true]]"), "[0.25, -inf, [1, [], true]]");
  EXPECT_EQ(found("{a = 0.5, \"b c\" = {}}"), "{ a = 0.5, \"b c\" = {} }");
  const std::string longest = found("[" + std::string(100000, ' ') +
                                    "11111111, 22222222, 33333333, "
                                    "44444444, 55555555, 66666666, 77777777]");
  EXPECT_EQ(longest, "[11111111, 22222222, 33333333, 44444444, 55555555, 666666...");
}

TEST(UnitMaterial, KeyPointsThatShareAClassAreWarnedOf) {
  MaterialTable table = thesis_table();
  EXPECT_TRUE(table.warnings().empty());
  table.domain_lo = -1024;
  table.domain_hi = 3071;
  table.max_length = {{{-1024, 1.0}, {100, 1.0}, {105, 1.5}}};
  const std::vector<std::string> lines = table.warnings();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0],
            "max_length: key points 2 and 3 (densities 100 and 105) share class 70, one class "
            "spans 16.05882353");
}
