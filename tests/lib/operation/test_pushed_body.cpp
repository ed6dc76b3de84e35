// Bodies of voxels that instruments push, and bone that stops these.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/ecm.h"
#include "lib/material/material.h"
#include "lib/operation/operation.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"
#include "volumes/base/parallel.h"

namespace supple::test {
namespace {

Body soft_lattice() {
  Block block = homogeneous({14, 14, 14}, 1.2, 0.8, 0.3);
  block.spacing_mm = {1, 1.2, 1.5};
  return body_of(block);
}

Slot slot_at(const Body& body, const Vec3i& voxel) {
  Slot slot = 0;
  EXPECT_TRUE(slot_of(body.elements, voxel, slot));
  return slot;
}

MovingPart ball_that_goes(const Vec3d& from_mm, const Vec3d& to_mm, double radius_mm) {
  return {{from_mm, from_mm, radius_mm, radius_mm}, {to_mm, to_mm, radius_mm, radius_mm}};
}

std::int64_t moved_elements(const Body& body) {
  std::int64_t count = 0;
  for_each_element(body.elements, [&](Slot slot) {
    count += std::any_of(body.q.begin(), body.q.end(),
                         [&](const BrickValues& q) { return q.at(slot) != 0; });
  });
  return count;
}

TEST(PropertyPushedBody, OneElementInAToolMovesAllAsAPushHandleDoes) {
  Body pushed = soft_lattice(), dragged = soft_lattice();
  const Vec3i voxel(6, 7, 6);
  const IndexBox floor{{0, 0, 0}, {13, 13, 0}};
  const Vec3d place = pushed.geometry.world_from_index(Vec3d(voxel));
  const Vec3d centre = place - Vec3d(0.15, -0.1, 0.12);
  const double radius_mm = 0.7, skin_mm = 0.3;
  PushedBody body(pushed, slots_in_box(pushed.elements, floor));
  const PushReport report = body.push({ball_that_goes(centre, centre, radius_mm)});

  const Vec3d normal = (place - centre).normalized();
  const double depth_mm = radius_mm - (place - centre).length() - skin_mm;
  const Vec3d by = pushed.geometry.index_vector_from_world(normal * depth_mm);
  std::array<std::int32_t, 3> by_q;
  for (int c = 0; c < 3; ++c) by_q[std::size_t(c)] = std::int32_t(std::lround(by[c] * kVoxel));
  EcmSolver solver(dragged);
  const EcmReport drag = solver.drag({Handle(voxel, by_q, HandleKind::push)}, {Region(floor)});
  ASSERT_EQ(drag.fraction(), 1);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(pushed.q[c], dragged.q[c]) << c;
  EXPECT_EQ(report.moved, drag.moved);
  EXPECT_FALSE(report.stopped);
}

TEST(PropertyPushedBody, NothingMovesThatNoToolMeets) {
  Body body = soft_lattice();
  PushedBody pushed(body, {});
  const MovingPart beside = ball_that_goes({-4, 8, 8}, {-4, 12, 8}, 2);
  EXPECT_EQ(pushed.push({beside}).moved, 0);
  EXPECT_EQ(moved_elements(body), 0);
  const PushReport report = pushed.push({ball_that_goes({-4, 8, 8}, {1, 8, 8}, 2)});
  EXPECT_GT(report.moved, 0);
  EXPECT_EQ(moved_elements(body), report.moved);
  EXPECT_LT(report.moved, body.elements.active_count() / 2);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyPushedBody, HeldElementsOfABodyThatHasMovedStayWhereTheyAre) {
  Body body = soft_lattice();
  const Vec3i voxel(6, 6, 8);
  EcmSolver solver(body);
  solver.drag({Handle(voxel, {2 * kVoxel, 0, kVoxel})}, {});
  const Slot held = slot_at(body, voxel);
  PushedBody pushed(body, SlotSet(std::vector<Slot>{held}));
  const PushReport report = pushed.push({ball_that_goes({-4, 7.2, 12}, {7, 7.2, 12}, 2)});
  EXPECT_GT(report.moved, 0);
  EXPECT_EQ(body.q[0].at(held), 2 * kVoxel);
  EXPECT_EQ(body.q[1].at(held), 0);
  EXPECT_EQ(body.q[2].at(held), kVoxel);
  EXPECT_EQ(check_links(body).violated, 0);
}

/// A block of 4 x 4 x 4 elements above a floor that is held, and nothing else but a thread between
/// the two where that is wanted.
class Island {
 public:
  explicit Island(bool has_thread) : m_body(soft_lattice()), m_pushed(m_body, held()) {
    const Vec3d middle(7, 8, 10);
    m_pushed.remove({{middle, middle, 100, 100}}, [&](const Vec3d& place_mm) {
      const Vec3d at = m_body.geometry.index_from_world(place_mm);
      const Vec3i voxel(int(std::lround(at.x)), int(std::lround(at.y)), int(std::lround(at.z)));
      const bool is_thread = voxel.x == 6 && voxel.y == 6 && voxel.z < 7;
      return voxel.z > 1 && !block().contains(voxel) && !(has_thread && is_thread);
    });
  }
  static IndexBox block() { return {{5, 5, 6}, {8, 8, 9}}; }
  PushedBody& pushed() { return m_pushed; }
  const Body& body() const { return m_body; }

  /// Pushes the block by a ball 12 mm along x; true where something was left in the ball.
  bool push() {
    bool is_stopped = false;
    for (double x = -2; x < 10; x += 0.5) {
      is_stopped |=
          m_pushed.push({ball_that_goes({x, 7.8, 11.2}, {x + 0.5, 7.8, 11.2}, 4)}).stopped;
    }
    return is_stopped;
  }
  /// The least way along x of the elements in a box, in voxels.
  double least_way(const IndexBox& box) const {
    double least = HUGE_VAL;
    slots_in_box(m_body.elements, box).for_each([&](Slot slot) {
      least = std::min(least, m_body.q[0].at(slot) / kFixedOne);
    });
    return least;
  }

 private:
  SlotSet held() const { return slots_in_box(m_body.elements, {{0, 0, 0}, {13, 13, 0}}); }

  Body m_body;
  PushedBody m_pushed;
};

TEST(PropertyPushedBody, APieceThatIsCutOffFromItsAnchorsGoesWhereToolsPushIt) {
  Island island(false);
  EXPECT_EQ(island.pushed().adrift(), 64);
  EXPECT_FALSE(island.push());
  EXPECT_GT(island.least_way(Island::block()), 6);
  EXPECT_EQ(check_links(island.body()).violated, 0);
  EXPECT_EQ(island.least_way({{0, 0, 0}, {13, 13, 1}}), 0);
}

TEST(PropertyPushedBody, APieceThatAThreadHoldsStaysByIt) {
  Island island(true);
  EXPECT_EQ(island.pushed().adrift(), 0);
  EXPECT_TRUE(island.push());
  EXPECT_LT(island.least_way(Island::block()), 3);
  EXPECT_EQ(check_links(island.body()).violated, 0);
}

TEST(PropertyVoxelSolid, DistancesFromABallOfVoxelsAreThoseOfTheBallWithinAVoxel) {
  const Geometry geometry({40, 40, 40}, {3, -2, 1},
                          {Vec3d(0.8, 0, 0), Vec3d(0, -1, 0), Vec3d(0, 0, 1)});
  const Vec3d centre(17, -21, 19);
  const double radius_mm = 6;
  std::vector<Vec3i> voxels;
  for (int n = 0; n < 40 * 40 * 40; ++n) {
    const Vec3i voxel(n % 40, n / 40 % 40, n / 1600);
    const Vec3d from = geometry.world_from_index(Vec3d(voxel)) - centre;
    if (from.length() <= radius_mm) voxels.push_back(voxel);
  }
  const VoxelSolid solid(geometry, voxels);
  for (int n = 0; n < 2000; ++n) {
    const Vec3d way(std::sin(1.3 * n), std::sin(2.1 * n + 1), std::sin(0.7 * n + 2));
    const Vec3d place = centre + way.normalized() * (0.01 * n);
    const Approach found = solid.distance_to(place);
    const double expected = (place - centre).length() - radius_mm;
    EXPECT_LE(found.distance_mm, expected + 1) << n;
    EXPECT_LT((found.place_mm + found.normal * found.distance_mm - place).length(), 1e-9);
    if (expected < 2) {  // where the box around the ball reaches
      EXPECT_GE(found.distance_mm, expected - 1) << n;
    }
    if (expected > -2) {
      EXPECT_GT(found.normal.dot(place - centre), 0) << n;
    }
  }
}

/// A bone of 15 · 6 · 4 voxels of 1 mm in soft tissue.
class UnitBoneInOperation : public ::testing::Test {
 protected:
  static constexpr double kBoneTopMm = 11.5;

  UnitBoneInOperation() {
    const IndexBox bone{{4, 4, 8}, {18, 9, 11}};
    std::string voxels;
    for (int n = 0; n < 24 * 14 * 16; ++n) {
      const Vec3i voxel(n % 24, n / 24 % 14, n / 336);
      voxels += char(static_cast<unsigned char>(n == 0 ? 0 : bone.contains(voxel) ? 200 : 100));
    }
    write_text(m_folder / "bone.raw", voxels);
    write_text(m_folder / "bone.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 24 14 16\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: bone.raw\n");
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nrigid = [180, 255]\n",
        "test");
    open();
  }

  void open() { m_session = std::make_unique<Session>(m_folder / "bone.nhdr", m_options); }

  OperationSetup setup() {
    OperationSetup setup;
    OperationTool needle;
    needle.shape.name = "needle";
    needle.shape.diameter_mm = 2;
    needle.start.tip_mm = {10, 6, 20};
    setup.tools = {needle};
    setup.volume = OperationVolume{&m_session->body_to_push(), m_session->held()};
    setup.shapes = {{"bone", *solid_of(m_session->body())}};
    return setup;
  }

  /// Presses the needle down to 5 mm, 6.5 mm below the face of the bone.
  const OperationSample& press(Operation& operation) {
    InstrumentPose asked = operation.setup().tools[0].start;
    for (int n = 0; n < 20; ++n) {
      asked.tip_mm.z -= 0.75;
      operation.step({asked});
    }
    return operation.sample();
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
  std::unique_ptr<Session> m_session;
};

TEST_F(UnitBoneInOperation, BoneStopsATipWithinAVoxelAndTellsTheForce) {
  Operation operation(setup());
  const OperationSample& sample = press(operation);
  EXPECT_NEAR(sample.instruments[0].pose.tip_mm.z, kBoneTopMm, 1);
  ASSERT_EQ(sample.events.size(), 1u);
  EXPECT_EQ(sample.events[0].kind, "touch");
  EXPECT_EQ(sample.events[0].at, "bone");
  EXPECT_NEAR(sample.events[0].value, 0.65, 0.1);  // 100 N/m over 6.5 mm
}

TEST_F(UnitBoneInOperation, TissueGivesWayWhileBoneStays) {
  Operation operation(setup());
  press(operation);
  const Body& body = m_session->body();
  EXPECT_GT(moved_elements(body), 0);
  for (const RigidPiece& piece : body.rigid.list) {
    piece.elements->for_each([&](Slot slot) {
      for (const BrickValues& q : body.q) ASSERT_EQ(q.at(slot), 0);
    });
  }
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST_F(UnitBoneInOperation, TheEndIsTheSameToTheBitWithOneAndTwoThreads) {
  std::vector<std::string> ends;
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    open();
    Operation operation(setup());
    press(operation);
    ends.push_back(operation.digest());
  }
  EXPECT_EQ(ends[0], ends[1]);
}

}  // namespace
}  // namespace supple::test
