// The physical columns of material tables: look-up, defaults, errors, class sharing; presets.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/material/presets.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Linear over densities 0…255.
Curve ramp(double at_0, double at_255) {
  return {{{0, at_0}, {255, at_255}}};
}

MaterialTable physical_table() {
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.stiffness = ramp(10, 61);         // 10 kPa and 0.2 kPa per class
  table.mass_density = ramp(900, 1920);   // 900 kg/m³ and 4 kg/m³ per class
  table.rayleigh_beta_ms = ramp(0, 51);   // 0.2 ms per class
  table.yield_strain = ramp(0.1, 0.355);  // 0.1 and 0.001 per class
  return table;
}

/// A table of a label, rigid in its limits and without physical columns.
LimitTable rigid_table() {
  return linear_table(1, 1, 0);
}

}  // namespace

TEST(UnitMaterialPhysics, ALinkReadsItsCurvesAtTheMeanOfBothEndsWithHalfClasses) {
  const MaterialTable table = physical_table();
  const MaterialClasses classes(table);
  const LinkPhysics link = classes.physics(100, 151);  // density 125.5
  EXPECT_DOUBLE_EQ(link.stiffness_kpa, 10 + 0.2 * 125.5);
  EXPECT_DOUBLE_EQ(link.rayleigh_beta_ms, 0.2 * 125.5);
  EXPECT_DOUBLE_EQ(link.yield_strain, 0.1 + 0.001 * 125.5);
  const LinkPhysics turned = classes.physics(151, 100);
  EXPECT_EQ(turned.stiffness_kpa, link.stiffness_kpa);
  EXPECT_EQ(turned.rayleigh_beta_ms, link.rayleigh_beta_ms);
  EXPECT_EQ(turned.yield_strain, link.yield_strain);
}

TEST(UnitMaterialPhysics, CombiningLimitsAveragesTheValuesOfTheTwoEnds) {
  MaterialTable table = physical_table();
  table.stiffness = Curve{{{0, 5}, {100, 5}, {101, 25}, {255, 25}}};
  EXPECT_DOUBLE_EQ(MaterialClasses(table).physics(0, 180).stiffness_kpa, 5);  // density 90
  table.combine = Combine::limits;
  const LinkPhysics link = MaterialClasses(table).physics(0, 180);
  EXPECT_DOUBLE_EQ(link.stiffness_kpa, 15);
  EXPECT_DOUBLE_EQ(link.rayleigh_beta_ms, 0.2 * 90);
  EXPECT_DOUBLE_EQ(link.yield_strain, 0.1 + 0.001 * 90);
}

TEST(UnitMaterialPhysics, AnElementsMassDensityIsThatOfItsOwnClass) {
  MaterialTable table = physical_table();
  for (const Combine combine : {Combine::density, Combine::limits}) {
    table.combine = combine;
    const MaterialClasses classes(table);
    EXPECT_DOUBLE_EQ(classes.mass_density_of_class(0), 900);
    EXPECT_DOUBLE_EQ(classes.mass_density_of_class(25), 1000);
    EXPECT_DOUBLE_EQ(classes.mass_density_of_class(255), 1920);
  }
}

TEST(UnitMaterialPhysics, WithoutCurvesALinkHasOneKilopascalNoDampingAndNeverYields) {
  const MaterialTable table = linear_table(1.5, 0.6, 0.7);
  const MaterialClasses classes(table);
  const LinkPhysics link = classes.physics(3, 250);
  EXPECT_EQ(link.stiffness_kpa, 1);
  EXPECT_EQ(link.rayleigh_beta_ms, 0);
  EXPECT_EQ(link.yield_strain, HUGE_VAL);
  EXPECT_EQ(classes.mass_density_of_class(250), 1000);
}

TEST(UnitMaterialPhysics, BetweenTwoTablesALinkTakesTheMeanAndYieldsOnlyIfBothEndsDo) {
  MaterialTable table = physical_table();
  table.labels[3] = rigid_table();
  table.labels[4] = rigid_table();
  table.labels[4].stiffness = Curve{{{0, 100}}};
  table.labels[4].mass_density = Curve{{{0, 1500}}};
  table.labels[4].rayleigh_beta_ms = Curve{{{0, 2}}};
  table.labels[4].yield_strain = Curve{{{0, 0.01}}};
  const MaterialClasses classes(table);
  const int soft = classes.class_of(255), bare = classes.class_of(9, 3),
            given = classes.class_of(9, 4);
  EXPECT_DOUBLE_EQ(classes.physics(soft, given).stiffness_kpa, (61 + 100) / 2.0);
  EXPECT_DOUBLE_EQ(classes.physics(soft, given).rayleigh_beta_ms, (51 + 2) / 2.0);
  EXPECT_DOUBLE_EQ(classes.physics(soft, given).yield_strain, (0.355 + 0.01) / 2);
  EXPECT_DOUBLE_EQ(classes.physics(bare, given).stiffness_kpa, (1 + 100) / 2.0);
  EXPECT_EQ(classes.physics(bare, given).yield_strain, HUGE_VAL);
  EXPECT_EQ(classes.mass_density_of_class(bare), 1000);
  EXPECT_EQ(classes.mass_density_of_class(given), 1500);
  EXPECT_EQ(classes.mass_density_of_class(soft), 1920);
}

TEST(UnitMaterialPhysics, ATableTellsWhichCurvesItOrALabelGives) {
  using Column = std::optional<Curve> LimitTable::*;
  const Column columns[] = {&LimitTable::stiffness, &LimitTable::mass_density,
                            &LimitTable::rayleigh_beta_ms, &LimitTable::yield_strain,
                            &LimitTable::poisson};
  const auto given = [](const MaterialTable& table) {
    return std::vector<bool>{table.has_stiffness(), table.has_mass_density(),
                             table.has_rayleigh_beta(), table.has_yield_strain(),
                             table.has_poisson()};
  };
  for (int n = 0; n < 5; ++n) {
    std::vector<bool> expected(5, false);
    MaterialTable table = linear_table(1, 1, 0);
    table.labels[7] = rigid_table();
    EXPECT_EQ(given(table), expected);
    expected[std::size_t(n)] = true;
    table.labels[7].*columns[n] = ramp(1, 2);
    EXPECT_EQ(given(table), expected) << "label, column " << n;
    table.labels.clear();
    table.*columns[n] = ramp(1, 2);
    EXPECT_EQ(given(table), expected) << "common table, column " << n;
  }
}

TEST(UnitMaterialPhysics, ATableOfALabelWhosePhysicsVaryTakesMoreThanOneClass) {
  using Column = std::optional<Curve> LimitTable::*;
  for (const Column column :
       {&LimitTable::stiffness, &LimitTable::mass_density, &LimitTable::rayleigh_beta_ms,
        &LimitTable::yield_strain, &LimitTable::poisson}) {
    MaterialTable table = linear_table(1.5, 0.6, 0.7);
    table.labels[3] = rigid_table();
    table.labels[3].*column = ramp(5, 5);
    EXPECT_TRUE(table.labels[3].is_constant());
    EXPECT_EQ(MaterialClasses(table).shares()[1].count, 1);
    table.labels[3].*column = ramp(5, 6);
    EXPECT_FALSE(table.labels[3].is_constant());
    EXPECT_EQ(MaterialClasses(table).shares()[1].count, 128);
  }
}

TEST(UnitMaterialPhysics, EveryErrorNamesColumnKeyPointValueAndUnit) {
  const auto message = [](void (*spoil)(MaterialTable&)) {
    MaterialTable table = physical_table();
    spoil(table);
    return validation_error(table);
  };
  EXPECT_EQ(validation_error(physical_table()), "");
  EXPECT_EQ(message([](MaterialTable& t) { t.stiffness->keys[1].second = 0; }),
            "m.toml: stiffness key point 2: found [255, 0], expected stiffness > 0 kPa");
  EXPECT_EQ(message([](MaterialTable& t) { t.mass_density->keys[0].second = 0; }),
            "m.toml: density key point 1: found [0, 0], expected density > 0 kg/m³");
  EXPECT_EQ(message([](MaterialTable& t) { t.rayleigh_beta_ms->keys[1].second = -1; }),
            "m.toml: damping key point 2: found [255, -1], expected damping >= 0 ms");
  EXPECT_EQ(message([](MaterialTable& t) { t.yield_strain->keys[0].second = 0; }),
            "m.toml: plastic key point 1: found [0, 0], expected plastic > 0");
  EXPECT_EQ(message([](MaterialTable& t) { t.yield_strain->keys[0].second = HUGE_VAL; }),
            "m.toml: plastic key point 1: found [0, inf], expected finite numbers");
  EXPECT_EQ(message([](MaterialTable& t) { t.stiffness->keys.clear(); }),
            "m.toml: stiffness: found no key points, expected at least one [density, value]");
  EXPECT_EQ(message([](MaterialTable& t) { t.rayleigh_beta_ms->keys[1].first = 256; }),
            "m.toml: damping key point 2: found [256, 51], expected a density inside the domain "
            "[0, 255]");
  EXPECT_EQ(message([](MaterialTable& t) {
              t.labels[3] = rigid_table();
              t.labels[3].stiffness = Curve{{{0, -2}}};
            }),
            "m.toml: label.3.stiffness key point 1: found [0, -2], expected stiffness > 0 kPa");
}

TEST(UnitMaterialPhysics, KeyPointsOfAColumnThatShareAClassAreWarnedOf) {
  MaterialTable table = physical_table();
  EXPECT_TRUE(table.warnings().empty());
  table.yield_strain = Curve{{{0, 0.1}, {40, 0.1}, {40.25, 0.2}}};
  const auto lines = table.warnings();
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].find("plastic: key points 2 and 3"), 0u) << lines[0];
}

TEST(UnitMaterialPhysics, ATableWithoutTheStiffnessOrDensityOfAnotherIsWarnedOf) {
  MaterialTable table = physical_table();
  table.labels[3] = rigid_table();
  EXPECT_EQ(
      table.warnings(),
      (std::vector<std::string>{"label.3: no stiffness as other tables have, counts as 1 kPa",
                                "label.3: no density as other tables have, counts as 1000 kg/m³"}));
  table.labels[3].stiffness = table.labels[3].mass_density = Curve{{{0, 2000}}};
  EXPECT_TRUE(table.warnings().empty());
  table.stiffness.reset();
  ASSERT_EQ(table.warnings().size(), 1u);
  EXPECT_EQ(table.warnings()[0].find("common table: no stiffness"), 0u);
}

TEST(UnitMaterialPresets, EachIsAValidTableByItselfAndRulesOutFolds) {
  for (const MaterialPreset& preset : material_presets()) {
    MaterialTable table;
    table.domain_lo = -1000;
    table.domain_hi = 3000;
    table.labels[3] = preset_table(preset.name, -1000, 3000);
    static_cast<LimitTable&>(table) = table.labels[3];
    EXPECT_EQ(validation_error(table), "") << preset.name;
    EXPECT_TRUE(table.is_constant()) << preset.name;
    EXPECT_TRUE(table.warnings().empty()) << preset.name;
    EXPECT_GT(preset.min_length, 2 * preset.shear) << preset.name;
    const MaterialClasses classes(table);
    const LinkLimits limits = classes.limits(1, 0, 255);
    EXPECT_EQ(limits.min_length, preset.min_length) << preset.name;
    EXPECT_EQ(limits.max_length, preset.max_length) << preset.name;
    EXPECT_EQ(limits.shear1, preset.shear) << preset.name;
    EXPECT_EQ(limits.shear2, preset.shear) << preset.name;
    const LinkPhysics physics = classes.physics(0, classes.class_of(7, 3));
    EXPECT_EQ(physics.stiffness_kpa, preset.stiffness_kpa) << preset.name;
    EXPECT_EQ(physics.rayleigh_beta_ms, preset.rayleigh_beta_ms) << preset.name;
    EXPECT_EQ(physics.yield_strain, HUGE_VAL) << preset.name;
    EXPECT_EQ(classes.mass_density_of_class(0), preset.mass_density) << preset.name;
  }
}

TEST(UnitMaterialPresets, TheirNumbersAreThoseOfTheSourcesInTheUnitsOfTheColumns) {
  const auto stiffness_kpa = [](const char* name) {
    const LimitTable table = preset_table(name, 0, 255);
    return (*table.stiffness)(0);
  };
  const auto mass_density = [](const char* name) {
    const LimitTable table = preset_table(name, 0, 255);
    return (*table.mass_density)(0);
  };
  EXPECT_DOUBLE_EQ(stiffness_kpa("soft-tissue"), 3.25);
  EXPECT_DOUBLE_EQ(stiffness_kpa("bone"), 18.6e9 / 1e3);  // GPa
  EXPECT_DOUBLE_EQ(stiffness_kpa("brain"), 6);
  EXPECT_DOUBLE_EQ(stiffness_kpa("membrane"), 2.5e6 / 1e3);    // MPa
  EXPECT_DOUBLE_EQ(mass_density("soft-tissue"), 1.06 * 1000);  // g/cm³
  EXPECT_DOUBLE_EQ(mass_density("bone"), 1.92 * 1000);
  EXPECT_DOUBLE_EQ(mass_density("brain"), 1.04 * 1000);
  EXPECT_DOUBLE_EQ(mass_density("membrane"), 1.13 * 1000);
}

TEST(UnitMaterialPresets, AnUnknownOneIsAnErrorWithTheNames) {
  EXPECT_EQ(input_error([] { preset_table("muscle", 0, 255); }),
            "preset: found \"muscle\", expected one of \"soft-tissue\", \"bone\", \"brain\", "
            "\"membrane\"");
}
