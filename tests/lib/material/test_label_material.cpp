// Tables of labels: how classes are shared out, and what a link between two tables may do.
#include <gtest/gtest.h>

#include "lib/body/slot_set.h"
#include "lib/material/material.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

LimitTable constant_limits(double longest, double shear) {
  LimitTable table;
  table.max_length = {{{0, longest}}};
  table.min_length = {{{0, 1.0}, {255, 1.0}}};
  table.shear1 = table.shear2 = {{{0, shear}}};
  return table;
}

MaterialTable varying_table() {
  return linear_table(1.5, 0.6, 0.7);
}

}  // namespace

TEST(UnitLabelMaterial, ConstantTablesTakeOneClassAndTheOthersShareTheRest) {
  MaterialTable material = varying_table();
  material.labels[3] = constant_limits(1.2, 0.1);
  material.labels[7] = varying_table();
  material.labels[65535] = varying_table();
  material.labels[9] = constant_limits(1.0, 0);
  const MaterialClasses classes(material);  // (256 - 2) / 3 = 84 each
  ASSERT_EQ(classes.shares().size(), 5u);
  EXPECT_EQ(classes.class_of(0), 0);
  EXPECT_EQ(classes.class_of(255), 83);
  EXPECT_EQ(classes.class_of(127.5), 42);  // 83 / 2 rounds up
  EXPECT_EQ(classes.class_of(0, 3), 84);
  EXPECT_EQ(classes.class_of(255, 3), 84);
  EXPECT_EQ(classes.class_of(0, 7), 85);
  EXPECT_EQ(classes.class_of(255, 7), 168);
  EXPECT_EQ(classes.class_of(0, 9), 169);
  EXPECT_EQ(classes.class_of(0, 65535), 170);
  EXPECT_EQ(classes.class_of(900, 65535), 253);
  for (const int common : {4, 8, 10, 65534}) EXPECT_EQ(classes.class_of(255, common), 83);
}

TEST(UnitLabelMaterial, WithoutLabelsAllClassesAreTheCommonTables) {
  for (const MaterialTable& material : {varying_table(), linear_table(1, 1, 0)}) {
    const MaterialClasses classes(material);
    for (const double density : {-1.0, 0.0, 0.49, 100.5, 254.9, 300.0}) {
      EXPECT_EQ(classes.class_of(density), material.class_of(density));
    }
    EXPECT_EQ(classes.class_of(255, 12), 255);
  }
}

TEST(UnitLabelMaterial, ALinkTakesTheMeanOfBothEndsLimits) {
  MaterialTable material = varying_table();
  material.labels[3] = constant_limits(1.2, 0.1);
  material.labels[5] = varying_table();
  material.labels[5].domain_lo = -1000;
  material.labels[5].domain_hi = 1000;
  material.labels[5].max_length = {{{-1000, 1.0}, {1000, 3.0}}};
  const MaterialClasses classes(material);
  const LinkLimits across = classes.limits(0, classes.class_of(255), classes.class_of(40, 3));
  EXPECT_DOUBLE_EQ(across.max_length, (1.5 + 1.2) / 2);
  EXPECT_DOUBLE_EQ(across.min_length, (0.6 + 1.0) / 2);
  EXPECT_DOUBLE_EQ(across.shear1, (0.7 + 0.1) / 2);
  const LinkLimits within =
      classes.limits(1, classes.class_of(1000, 5), classes.class_of(-1000, 5));
  EXPECT_DOUBLE_EQ(within.max_length, 2.0);
  const SlackTable slacks(material, {1, 1, 1});
  EXPECT_EQ(slacks.upper(0, 0, classes.class_of(0, 3), classes.class_of(9, 3)), 13107);  // 0.2
  EXPECT_EQ(slacks.stride(), 256);
}

TEST(UnitLabelMaterial, ALabelMayOverrideOneAxis) {
  MaterialTable material = varying_table();
  material.labels[3] = constant_limits(1.2, 0.1);
  material.labels[3].max_length_axis[2] = Curve{{{0, 1.7}}};
  const MaterialClasses classes(material);
  EXPECT_EQ(classes.shares()[1].count, 1);
  const int of_label = classes.class_of(100, 3);
  EXPECT_DOUBLE_EQ(classes.limits(2, of_label, of_label).max_length, 1.7);
  EXPECT_DOUBLE_EQ(classes.limits(1, of_label, of_label).max_length, 1.2);
  material.labels[3].max_length_axis[2] = Curve{{{0, 1.7}, {255, 1.8}}};
  EXPECT_EQ(MaterialClasses(material).shares()[1].count, 128);
}

TEST(UnitLabelMaterial, ElementsTakeTheTableOfTheirLabel) {
  Block block = full_block({3, 1, 1}, varying_table(), [](int, int, int) { return 255.0; });
  block.table.labels[3] = constant_limits(1.2, 0.1);
  block.label = {0, 3, 4};
  const Body body = body_of(block);
  const MaterialClasses classes(block.table);
  const auto class_at = [&](int i) {
    Slot slot = 0;
    EXPECT_TRUE(slot_of(body.elements, {i, 0, 0}, slot));
    return int(body.classes[slot]);
  };
  EXPECT_EQ(class_at(0), classes.class_of(255));
  EXPECT_EQ(class_at(1), classes.class_of(255, 3));
  EXPECT_EQ(class_at(2), classes.class_of(255));
}

TEST(UnitLabelMaterial, FoldsAreRuledOutOnlyWhereEveryTableDoes) {
  Block block = full_block({4, 4, 4}, linear_table(1.1, 0.9, 0.1),
                           [](int i, int, int) { return i < 2 ? 255.0 : 0.0; });
  EXPECT_TRUE(check_links(body_of(block)).fold_free);
  block.table.labels[3] = constant_limits(1.2, 0.6);
  EXPECT_TRUE(check_links(body_of(block)).fold_free);
  block.label.assign(64, 3);
  EXPECT_FALSE(check_links(body_of(block)).fold_free);
}

TEST(UnitLabelMaterial, KeyPointsThatShareAClassOfALabelAreWarnedOfWithItsClassWidth) {
  MaterialTable material = varying_table();
  material.labels[3] = varying_table();
  EXPECT_TRUE(material.warnings().empty());
  material.labels[3].domain_lo = -1000;
  material.labels[3].domain_hi = 3000;
  material.labels[3].shear1.keys = {{0, 0.1}, {10, 0.2}};
  const auto lines = material.warnings();  // 128 classes each: 4000 / 127
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_EQ(lines[0].find("label.3.shear1: key points 1 and 2"), 0u) << lines[0];
  EXPECT_NE(lines[0].find("one class spans 31.496"), std::string::npos) << lines[0];
}

TEST(FaultLabelMaterial, TooManyTablesAreAnErrorThatCountsThem) {
  MaterialTable material = linear_table(1, 1, 0);
  for (int label = 1; label <= 255; ++label) material.labels[label] = constant_limits(1.2, 0.1);
  EXPECT_EQ(input_error([&] { material.validate("m.toml"); }), "");
  EXPECT_EQ(MaterialClasses(material).class_of(9, 255), 255);
  material.labels[256] = constant_limits(1.2, 0.1);
  const std::string error = input_error([&] { material.validate("m.toml"); });
  EXPECT_NE(error.find("m.toml: label: found 256 tables that need 257 classes"), std::string::npos)
      << error;
  material.labels.erase(256);
  material.labels[255] = varying_table();
  EXPECT_NE(input_error([&] { material.validate("m.toml"); }), "");
}

TEST(FaultLabelMaterial, ErrorsNameTheLabelAndItsKeyPoint) {
  const auto error_of = [](const std::function<void(MaterialTable&)>& damage) {
    MaterialTable material = varying_table();
    material.labels[3] = constant_limits(1.2, 0.1);
    damage(material);
    return input_error([&] { material.validate("m.toml"); });
  };
  EXPECT_EQ(error_of([](MaterialTable&) {}), "");
  EXPECT_NE(error_of([](MaterialTable& m) {
              m.labels[3].max_length.keys[0].second = 0.5;
            }).find("label.3.max_length key point 1"),
            std::string::npos);
  EXPECT_NE(error_of([](MaterialTable& m) { m.labels[3].domain_hi = 0; }).find("label.3.domain"),
            std::string::npos);
  EXPECT_NE(error_of([](MaterialTable& m) { m.labels[0] = m.labels[3]; }).find("labels 1 to 65535"),
            std::string::npos);
  EXPECT_NE(error_of([](MaterialTable& m) { m.labels[65536] = m.labels[3]; }).find("label.65536"),
            std::string::npos);
}
