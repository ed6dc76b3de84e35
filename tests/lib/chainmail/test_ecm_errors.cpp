// Errors of drag() and their words; the body is untouched then.
#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

/// 6 x 4 x 1 voxels of 2 mm, soft, with a hole at (3, 2).
Body soft_plate() {
  Block block = soft_block({6, 4, 1});
  block.spacing_mm = {2, 2, 2};
  block.element[block.index(3, 2, 0)] = 0;
  return body_of(block);
}

Handle grab_at(int i, int j, std::int32_t by) {
  return {Vec3i(i, j, 0), {by, 0, 0}};
}
IndexBox voxel_box(int i, int j) {
  return {{i, j, 0}, {i, j, 0}};
}

/// The error of a drag, checking that nothing changed.
std::string drag_error(Body& body, const std::vector<Handle>& handles,
                       const std::vector<Region>& anchors = {}) {
  const auto before = body.q;
  const std::string error = input_error([&] { drag(body, handles, anchors); });
  EXPECT_EQ(body.q, before);
  return error;
}

/// Stops whoever polls it with an exception, after some polls.
template <class Exception>
class Interrupt : public Progress {
 public:
  explicit Interrupt(int polls) : m_polls(polls) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override {
    if (m_polls-- <= 0) throw Exception();
    return false;
  }

 private:
  mutable int m_polls;
};

}  // namespace

TEST(UnitEcmErrors, AHandleOnVoidNamesTheNearestElement) {
  Body body = soft_plate();
  EXPECT_EQ(drag_error(body, {grab_at(3, 2, kVoxel)}),
            "grab 3,2,0: found no element, expected a voxel of the body; the nearest is 2,2,0, 2 "
            "mm away");
  EXPECT_EQ(drag_error(body, {grab_at(-5, 1, kVoxel)}),
            "grab -5,1,0: found no element, expected a voxel of the body; the nearest is 0,1,0, 10 "
            "mm away");
}

TEST(UnitEcmErrors, AVoxelGrabbedTwiceOrGrabbedAndFixedIsRefused) {
  Body body = soft_plate();
  EXPECT_EQ(drag_error(body, {grab_at(1, 1, 5), grab_at(1, 1, 5)}),
            "grab 1,1,0 and grab 1,1,0: found voxel 1,1,0 in both, expected every voxel in one "
            "of them");
  EXPECT_EQ(
      drag_error(body, {grab_at(1, 1, 5)}, {{{0, 0, 0}, {1, 1, 0}}}),
      "grab 1,1,0 and fix 0,0,0:1,1,0: found voxel 1,1,0 in both, expected every voxel in one of "
      "them");
}

TEST(UnitEcmErrors, AnAnchorBoxWithoutElementsNamesTheNearestOne) {
  Body body = soft_plate();
  EXPECT_EQ(drag_error(body, {grab_at(1, 1, 5)}, {voxel_box(3, 2)}),
            "fix 3,2,0: found no element, expected a voxel of the body; the nearest is 2,2,0, 2 mm "
            "away");
  EXPECT_EQ(
      drag_error(body, {grab_at(1, 1, 5)}, {{{20, 0, 0}, {30, 3, 0}}}),
      "fix 20,0,0:30,3,0: found no element, expected a region that holds elements; the nearest "
      "is 5,0,0, 30 mm away");
}

TEST(UnitEcmErrors, HandlesThatContradictEachOtherNameThePairAndTheMissingMillimetres) {
  Body body = soft_plate();
  // The two links behind stretch by 0.5 voxel each, so 3 voxels are 2 too many; the two ahead
  // shorten by 26214 units each, so 144180 units are too many: 4.40002 mm.
  EXPECT_EQ(
      drag_error(body, {grab_at(0, 0, 0), grab_at(4, 0, 0), grab_at(2, 0, 3 * kVoxel)}),
      "grab 2,0,0 and 4,0,0: found targets 4.40002 mm further apart along axis i than the links "
      "between them allow, expected handles that agree with each other");
}

TEST(UnitEcmErrors, AnOffsetBeyondTheRangeIsAnErrorAndNeverAWrap) {
  Body body = soft_plate();
  const std::int32_t far = 10000 * kVoxel;
  drag(body, {grab_at(1, 1, far)}, {});
  const std::string error = drag_error(body, {grab_at(1, 1, far)});
  EXPECT_NE(error.find("grab 1,1,0: found a move by 10000"), std::string::npos) << error;
  EXPECT_NE(error.find("20000"), std::string::npos) << error;
  EXPECT_NE(drag_error(body, {grab_at(1, 1, INT32_MIN)}), "");
  drag(body, {grab_at(1, 1, -far)}, {});
  EXPECT_EQ(body.offset({1, 1, 0}, 0), 0);
}

TEST(UnitEcmErrors, MillimetresBecomeTheNearestFixedPoint) {
  const auto by = fixed_from_mm({2.0, -2.0, 3.0}, {3.0, 3.0, 2.0});
  EXPECT_EQ(by[0], 43691);  // 2 * 65536 / 3 = 43690.67
  EXPECT_EQ(by[1], -43691);
  EXPECT_EQ(by[2], 98304);
  EXPECT_NE(input_error([] { fixed_from_mm({NAN, 0, 0}, {1, 1, 1}); }), "");
  EXPECT_NE(input_error([] { fixed_from_mm({0, HUGE_VAL, 0}, {1, 1, 1}); }), "");
  EXPECT_NE(input_error([] { fixed_from_mm({0, 0, 8192.5}, {1, 1, 0.5}); }), "");
}

class UnitEcmInterrupted : public testing::TestWithParam<Engine> {};
INSTANTIATE_TEST_SUITE_P(, UnitEcmInterrupted, testing::Values(Engine::block, Engine::flat),
                         [](const auto& engine) { return name_of(engine.param); });

TEST_P(UnitEcmInterrupted, ADragLeavesTheBodyAsItWasAndTheSolverUsable) {
  // Large enough that the solver polls while it works.
  Body body = body_of(full_block({64, 64, 48}, linear_table(1.5, 0.6, 0.7),
                                 [](int i, int j, int k) { return double((i * j + k) % 256); }));
  drag(body, {{{3, 3, 3}, {30 * kVoxel, 0, 0}}}, {});
  const std::vector<Handle> handles = {{{3, 3, 3}, {-90 * kVoxel, 70 * kVoxel, 0}}};
  Body moved = body;
  drag(moved, handles, {});
  const auto before = body.q;

  EcmSolver solver(body, GetParam());
  for (const int polls : {0, 1, 2, 3}) {
    Interrupt<Cancelled> cancel(polls);
    EXPECT_THROW(solver.drag(handles, {}, &cancel), Cancelled);
    ASSERT_EQ(body.q, before) << polls;
    Interrupt<std::bad_alloc> fault(polls);
    EXPECT_THROW(solver.drag(handles, {}, &fault), std::bad_alloc);
    ASSERT_EQ(body.q, before) << polls;
  }
  solver.drag(handles, {});
  EXPECT_EQ(body.q, moved.q);
}
