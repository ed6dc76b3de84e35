// Transfer functions and presets.
#include <algorithm>
#include <iterator>

#include <gtest/gtest.h>

#include "raycast/scene/transfer_function.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

TransferFunction ramp() {
  TransferFunction f;
  f.opacity = {{0, 0}, {100, 0.5}};
  f.colour = {{0, {0, 0, 0}}, {100, {1, 0.5, 0}}};
  f.gradient_opacity = {{0, 0}, {10, 1}};
  return f;
}

std::string field_of(const TransferFunction& f) {
  try {
    f.validate("");
  } catch (const InputError& error) {
    return error.problem().field;
  }
  return "valid";
}

TEST(UnitTransferFunction, IsLinearBetweenKeyPointsAndConstantBeyond) {
  const TransferFunction f = ramp();
  EXPECT_DOUBLE_EQ(f.opacity_at(-5), 0);
  EXPECT_DOUBLE_EQ(f.opacity_at(50), 0.25);
  EXPECT_DOUBLE_EQ(f.opacity_at(1000), 0.5);
  EXPECT_DOUBLE_EQ(f.colour_at(25)[0], 0.25);
  EXPECT_DOUBLE_EQ(f.colour_at(100)[1], 0.5);
  EXPECT_DOUBLE_EQ(f.gradient_opacity_at(5), 0.5);
  EXPECT_DOUBLE_EQ(TransferFunction().gradient_opacity_at(3), 1);
}

TEST(UnitTransferFunction, ErrorsNameTheKeyPoint) {
  EXPECT_EQ(field_of(ramp()), "valid");
  TransferFunction f = ramp();
  f.opacity[1].opacity = 1.5;
  EXPECT_EQ(field_of(f), "opacity[1]");
  f = ramp();
  f.colour[1].density = 0;
  EXPECT_EQ(field_of(f), "colour[1]");
  f = ramp();
  f.colour.clear();
  EXPECT_EQ(field_of(f), "colour");
  f = ramp();
  f.unit_distance_mm = 0;
  EXPECT_EQ(field_of(f), "unit_distance");
}

TEST(UnitTransferFunction, PresetsAreValidAndHaveTheNamesOfTheirLists) {
  const std::vector<std::string> names = preset_names();
  ASSERT_EQ(names.size(), 29u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names) {
    const TransferFunction f = preset(name);
    EXPECT_EQ(f.name, name);
    EXPECT_EQ(field_of(f), "valid") << name;
  }
}

TEST(UnitTransferFunction, EveryPresetShowsWhatItIsNamedAfterAndNotAll) {
  struct Case {
    const char* name;
    double hidden, shown;  // densities
  };
  const Case cases[] = {{"Bone", 60, 600},
                        {"Muscle", -1000, 60},
                        {"Skin", -1000, 60},
                        {"CT-AAA", 60, 250},
                        {"CT-AAA2", 60, 250},
                        {"CT-Air", 0, -900},
                        {"CT-Bone", -100, 600},
                        {"CT-Bones", 60, 600},
                        {"CT-Cardiac", -1000, 250},
                        {"CT-Cardiac2", 0, 250},
                        {"CT-Cardiac3", -100, 250},
                        {"CT-Chest-Contrast-Enhanced", -1000, 250},
                        {"CT-Chest-Vessels", -1300, 250},
                        {"CT-Coronary-Arteries", 60, 250},
                        {"CT-Coronary-Arteries-2", 60, 250},
                        {"CT-Coronary-Arteries-3", 60, 250},
                        {"CT-Cropped-Volume-Bone", -1000, 600},
                        {"CT-Fat", 60, -90},
                        {"CT-Liver-Vasculature", 60, 250},
                        {"CT-Lung", 60, -500},
                        {"CT-MIP", -1000, 600},
                        {"CT-Muscle", -1000, 60},
                        {"CT-Pulmonary-Arteries", -600, 60},
                        {"CT-Soft-Tissue", -1000, 60},
                        {"CT-X-ray", -1000, 600},
                        {"MR-Angio", 100, 250},
                        {"MR-Default", 0, 100},
                        {"MR-MIP", 0, 250},
                        {"MR-T2-Brain", 0, 200}};
  ASSERT_EQ(std::size(cases), preset_names().size());
  for (const Case& c : cases) {
    const TransferFunction f = preset(c.name);
    EXPECT_EQ(f.opacity_at(c.hidden), 0) << c.name;
    EXPECT_GT(f.opacity_at(c.shown), f.ambient == 1 ? 0.002 : 0.1) << c.name;
    EXPECT_EQ(f.blend == Blend::maximum, f.name.find("MIP") != std::string::npos) << c.name;
  }
  EXPECT_THROW(preset("CT-Brain"), InputError);
}

}  // namespace
}  // namespace supple
