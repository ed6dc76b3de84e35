// Plans take the memory of models from constants beside them (*_cost.h): what a model takes really.
#include <algorithm>

#include <gtest/gtest.h>
#include <malloc.h>

#include "lib/fem/voxel/fem_cost.h"
#include "lib/model/fem_model.h"
#include "lib/model/relax_model.h"
#include "lib/model/spring_models.h"
#include "lib/relax/relax_cost.h"
#include "lib/springs/spring_cost.h"
#include "raycast/march/march_cost.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/sanitized.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kEdge = 40;

MaterialTable cost_tissue() {
  MaterialTable table = linear_table(1.5, 0.6, 0.7);
  table.stiffness = Curve{{{0, 10}}};
  return table;
}

Body cost_block(const Vec3i& dims) {
  return body_of(full_block(dims, cost_tissue(), [](int, int, int) { return 255.0; }));
}

double allocated_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return double(info.uordblks) + double(info.hblkhd);
}

/// Notes the most that is allocated while work reports its progress.
class Watch final : public Progress {
 public:
  Watch() : m_before(allocated_bytes()) {}
  void stage(std::string_view) override { look(); }
  void update(double) override { look(); }
  bool cancelled() const override {
    look();
    return false;
  }
  double most() const {
    look();
    return m_most;
  }

 private:
  void look() const { m_most = std::max(m_most, allocated_bytes() - m_before); }
  double m_before;
  mutable double m_most = 0;
};

/// A block whose first layer is fixed and whose last voxel is dragged.
struct Bench {
  Body body;
  std::vector<Region> anchors;
  Holds holds;
  std::vector<Handle> handles;

  explicit Bench(const Vec3i& dims)
      : body(cost_block(dims)),
        anchors{Region({0, 0, 0}, {0, dims.y - 1, dims.z - 1})},
        handles{{Vec3i(dims.x - 1, dims.y / 2, dims.z / 2), {int(kFixedOne) / 2, 0, 0}}} {}
  HeldBody held() { return {body, anchors, holds}; }
  double elements() const { return double(body.elements.active_count()); }
};

}  // namespace

TEST(UnitModelCosts, SpringsTakeTheirBytes) {
  LEFT_OUT_WHEN_SANITIZED();
  if (kSanitized) GTEST_SKIP() << "sanitizers have a heap of their own";
  Bench bench({20, 20, 20});
  MotionParams params;
  Watch watch;
  VoxelSpringModel model(bench.held(), LatticeSpringParams(), params, &watch);
  model.move(bench.handles, 2, &watch);
  model.step(&watch);
  const double springs = double(model.system().springs.size());
  // A block has more springs per element than a head: bytes go by the springs.
  const double planned = (kSpringBytes + kSpringMatrixBytes) / kSpringsOfElement;
  EXPECT_NEAR(watch.most() / springs, planned, 0.25 * planned) << springs / bench.elements();
}

TEST(UnitModelCosts, FiniteElementsTakeTheirBytesPerUnknown) {
  LEFT_OUT_WHEN_SANITIZED();
  if (kSanitized) GTEST_SKIP() << "sanitizers have a heap of their own";
  Bench bench({kEdge, kEdge, kEdge});
  FemParams params;
  Watch watch;
  VoxelFemModel model(bench.held(), material_elasticity(bench.body.material), {}, params, nullptr,
                      0, &watch);
  model.move(bench.handles, 1, &watch);
  const double unknowns = 3.0 * (kEdge + 1) * (kEdge + 1) * (kEdge + 1);
  EXPECT_NEAR(watch.most() / unknowns, kFemBytes, 0.25 * kFemBytes);
}

TEST(UnitModelCosts, ARelaxationTakesItsBytesPerVoxel) {
  LEFT_OUT_WHEN_SANITIZED();
  if (kSanitized) GTEST_SKIP() << "sanitizers have a heap of their own";
  Bench bench({kEdge, kEdge, kEdge});
  RelaxParams params;
  Watch watch;
  RelaxModel model(bench.held(), params);
  model.move(bench.handles, 1, &watch);
  run_model(model, 40, &watch);
  // The handle moves along one axis, so that a single coordinate does.
  const double planned = kRelaxBytes + kFractionBytes;
  EXPECT_NEAR(watch.most() / bench.elements(), planned, 0.25 * planned);
}

TEST(UnitModelCosts, ABrickOfNodesHasNineAlongEachEdge) {
  EXPECT_EQ(kNodeBytes, 8748);
  EXPECT_EQ(kPixelBytes, sizeof(float) * 4 + 4 + 4);
}
