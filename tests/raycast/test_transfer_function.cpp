// Transfer functions and presets.
#include <gtest/gtest.h>

#include "raycast/transfer_function.h"
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

TEST(UnitTransferFunction, PresetsAreValidTransparentInAirAndOpaqueInTissue) {
  ASSERT_EQ(preset_names().size(), 6u);
  for (const std::string& name : preset_names()) {
    const TransferFunction f = preset(name);
    EXPECT_EQ(f.name, name);
    EXPECT_EQ(field_of(f), "valid");
    EXPECT_EQ(f.opacity_at(name[0] == 'M' ? 0 : -1000), 0);
    EXPECT_GT(f.opacity_at(name[0] == 'M' ? 200 : 1000), 0.3);
  }
  EXPECT_EQ(preset("CT-Bone").opacity_at(60), 0);
  EXPECT_THROW(preset("CT-Brain"), InputError);
}

}  // namespace
}  // namespace supple
