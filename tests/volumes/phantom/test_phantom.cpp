#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"
#include "volumes/phantom/phantom.h"

namespace supple::test {
namespace {

/// A phantom that reads like a file.
class PhantomFile : public VolumeFile {
 public:
  explicit PhantomFile(Phantom phantom) : m_phantom(std::move(phantom)) {
    m_header.path = "phantom";
    m_header.type = ValueType::float32;
    m_header.geometry = m_phantom.geometry;
  }
  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    auto* values = static_cast<float*>(out);
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) *values++ = m_phantom.density(i, j, m_next);
    }
    ++m_next;
  }

 private:
  Phantom m_phantom;
  int m_next = 0;
};

TEST(UnitHeadPhantom, DemoVoxelIsJawBoneAndTheBackOfTheSkullIsInTheDemoBox) {
  const Phantom head = head_phantom({256, 256, 108});
  EXPECT_GT(head.density(128, 211, 12), 300);
  int bone = 0;
  for (int k = 60; k <= 107; k += 3) {
    for (int j = 20; j <= 150; j += 3) {
      for (int i = 20; i <= 235; i += 3) bone += head.density(i, j, k) > 300;
    }
  }
  EXPECT_GT(bone, 1000);
}

TEST(UnitHeadPhantom, HasTheGeometryOfTheHeadCt) {
  const Geometry geometry = head_phantom({64, 64, 27}).geometry;
  EXPECT_LT(geometry.determinant(), 0);
  EXPECT_LT(geometry.axes_mm()[1].y, 0) << "+j faces anterior";
  EXPECT_GT(geometry.axes_mm()[2].z, 0);
  EXPECT_NEAR(geometry.spacing_mm().x, 4 * 0.957031, 1e-9);
}

TEST(UnitHeadPhantom, HoldsTissuesOfTheRightDensity) {
  const Phantom head = head_phantom({256, 256, 108});
  EXPECT_EQ(head.density(5, 250, 100), -1000) << "air";
  EXPECT_NEAR(head.density(80, 130, 75), 30, 15) << "brain";
  EXPECT_NEAR(head.density(137, 130, 57), 6, 12) << "lateral ventricle";
  EXPECT_LT(head.density(138, 170, 27), -900) << "nasal cavity";
  EXPECT_NEAR(head.density(160, 199, 36), 18, 5) << "eye";
  EXPECT_LT(head.density(128, 118, 107), 300) << "the vault closes below the top";
}

TEST(PropertyHeadPhantom, HeadrestIsAPieceOfItsOwnAtAnyResolution) {
  for (const Vec3i& dims : {Vec3i(64, 64, 40), Vec3i(128, 128, 54)}) {
    const auto elements = [&](int components) {
      PhantomFile file(head_phantom(dims));
      return load_elements(file, -300, 3000, components).elements;
    };
    const BrickTopology all = elements(0), head = elements(1);
    // A voxel of the trough beneath the middle of the head.
    Vec3i trough(dims.x / 2, 0, dims.z / 2);
    while (trough.y < dims.y && !all.is_active(trough)) ++trough.y;
    EXPECT_FALSE(head.is_active(trough)) << trough;
    EXPECT_TRUE(head.is_active({dims.x / 2, dims.y / 2, dims.z / 2}));
    EXPECT_GT(double(head.active_count()), 0.8 * double(all.active_count()));
  }
}

TEST(PropertyPhantoms, DensitiesAreIntegersOfTheirRange) {
  const Phantom phantoms[] = {gradient_phantom(50), t_shape_phantom(50), irregular_phantom(61),
                              extrude(irregular_phantom(40), 3), sphere_phantom(20, 6, 200)};
  for (const Phantom& phantom : phantoms) {
    const Vec3i dims = phantom.geometry.dims();
    for (int k = 0; k < dims.z; ++k) {
      for (int j = 0; j < dims.y; ++j) {
        for (int i = 0; i < dims.x; ++i) {
          const float density = phantom.density(i, j, k);
          ASSERT_EQ(density, std::round(density));
          ASSERT_TRUE(density >= 0 && density <= 255) << density;
        }
      }
    }
  }
}

TEST(UnitPhantoms, FiguresHaveTheirParts) {
  const Phantom t = t_shape_phantom(50);
  EXPECT_EQ(t.density(25, 15, 0), 0);
  EXPECT_EQ(t.density(25, 35, 0), 0);
  EXPECT_EQ(t.density(12, 15, 0), 0);
  EXPECT_EQ(t.density(12, 35, 0), 255);
  const Phantom gradient = gradient_phantom(50);
  EXPECT_EQ(gradient.density(2, 25, 0), 255);
  EXPECT_LT(gradient.density(12, 25, 0), gradient.density(30, 25, 0));
  EXPECT_EQ(extrude(t, 10).geometry.dims(), Vec3i(50, 50, 10));
  EXPECT_EQ(constant_phantom({3, 4, 5}, 7).density(1, 1, 1), 7);
  const Phantom irregular = irregular_phantom(60);
  EXPECT_EQ(irregular.density(0, 0, 0), 255);
  EXPECT_EQ(irregular.density(40, 30, 0), 0);
}

}  // namespace
}  // namespace supple::test
