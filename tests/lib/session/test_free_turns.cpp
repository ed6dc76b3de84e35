// Free rigid pieces turn: a rod of bone on chains of tissue, and the smallest motion by itself.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/body/smallest_motion.h"
#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/lib/test_bodies.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kShear = 0.29;

/// A rod of six voxels of 1 mm, i = 3 to 8, with a chain of three elements of tissue at each end.
class UnitRod : public ::testing::Test {
 protected:
  UnitRod() {
    std::string voxels;
    for (int n = 0; n < 12 * 3 * 3; ++n) {
      const int i = n % 12;
      const bool is_row = n / 12 == 4;
      voxels += char(static_cast<unsigned char>(!is_row ? 0 : i < 3 || i > 8 ? 100 : 200));
    }
    write_text(m_folder / "rod.raw", voxels);
    write_text(m_folder / "rod.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 12 3 3\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: rod.raw\n");
    m_options.keeps_undo = true;
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 2.5]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nlinks = 6\n",
        "test");
    ChosenPart rod;
    rod.name = "rod";
    rod.selection = Selection();
    rod.selection->box = IndexBox{{3, 1, 1}, {8, 1, 1}};
    m_rod.rigid.parts = {rod};
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
  Step m_rod;
};

Step pull(const std::vector<std::pair<Vec3i, Vec3d>>& pulls) {
  Step request;
  for (const auto& [at, by_mm] : pulls) request.drags.push_back({Region(at), by_mm});
  return request;
}

double angle_deg(const Session& session) {
  return session.body().rigid.list[0].pose.turn.angle_deg();
}

double voxels(const Session& session, const Vec3i& at, int c) {
  return double(session.body().offset(at, c)) / kVoxel;
}

/// Difference of the rod's length from that at rest.
double stretch(const Session& session) {
  Vec3d between(5, 0, 0);
  for (int c = 0; c < 3; ++c) {
    between[c] += voxels(session, {8, 1, 1}, c) - voxels(session, {3, 1, 1}, c);
  }
  return std::abs(between.length() - 5);
}

}  // namespace

TEST_F(UnitRod, PulledAtAnEndTakesTheMotionOfTheLeastSumOfSquares) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  session.step(pull({{{11, 1, 1}, {0, 3, 0}}}));
  // Three links shear, so the end of the rod goes at least so far along j. Of all angles that bring
  // it there the best: 6 t^2 + 2 (1 - cos a) (sum of x^2 + 2 edge^2 / 12 of each voxel), the edge
  // of the cube that it carries being four times the shift.
  const double end = 3 - 3 * kShear, edge = 4 * end;
  double best = 0, least = 1e9;
  for (double a = 0; a < 90; a += 1e-3) {
    const double t = end - 2.5 * std::sin(a * kDegree);
    const double sum =
        6 * t * t + 2 * (1 - std::cos(a * kDegree)) * (17.5 + 6 * 2 * edge * edge / 12);
    if (sum < least) {
      least = sum;
      best = a;
    }
  }
  EXPECT_GT(best, 10);
  EXPECT_NEAR(angle_deg(session), best, 0.01);
  EXPECT_NEAR(voxels(session, {8, 1, 1}, 1), end, 1e-3);
  EXPECT_LT(stretch(session), 1e-4);
  EXPECT_EQ(check_links(session.body()).violated, 0);
  // Nothing holds the rod: it goes on with the next drag.
  session.step(pull({{{11, 1, 1}, {0, 1, 0}}}));
  EXPECT_NEAR(voxels(session, {8, 1, 1}, 1), end + 1, 1e-3);
}

TEST_F(UnitRod, PulledAlongItselfShiftsAndDoesNotTurn) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  session.step(pull({{{11, 1, 1}, {6, 0, 0}}}));
  EXPECT_NEAR(angle_deg(session), 0, 1e-6);
  EXPECT_NEAR(voxels(session, {3, 1, 1}, 0), 6 - 3 * 1.5, 1e-3);
}

TEST_F(UnitRod, AnAnchorStopsTheShiftButNotTheTurn) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  session.fix({{0, 1, 1}, {0, 1, 1}});
  const StepRecord& record = session.step(pull({{{11, 1, 1}, {0, 4, 0}}}));
  // Shifts alone: six links shear. With turns the far end of the rod stays behind.
  EXPECT_GT(record.report.fraction(), 1.3 * 6 * kShear / 4);
  EXPECT_NEAR(voxels(session, {11, 1, 1}, 1), 4 * record.report.fraction(), 1e-3);
  EXPECT_EQ(session.body().offset({0, 1, 1}, 1), 0);
  EXPECT_LT(stretch(session), 1e-4);
  EXPECT_EQ(check_links(session.body()).violated, 0);
}

TEST_F(UnitRod, HandlesThatNoShiftReconcilesTurnThePiece) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  session.step(pull({{{11, 1, 1}, {0, 1.5, 0}}, {{0, 1, 1}, {0, -1.5, 0}}}));
  // Each end of the rod goes 1.5 less three shears, to its side.
  EXPECT_NEAR(std::sin(angle_deg(session) * kDegree), (1.5 - 3 * kShear) / 2.5, 1e-3);
  EXPECT_EQ(check_links(session.body()).violated, 0);
  const std::string error = input_error([&] {
    session.step(pull({{{11, 1, 1}, {0, 9, 0}}, {{0, 1, 1}, {0, -9, 0}}}));
  });
  EXPECT_NE(error.find("further apart along axis j"), std::string::npos) << error;
}

TEST_F(UnitRod, ShiftedInManyDragsThenTurnsAsInASingleOne) {
  Session whole(m_folder / "rod.nhdr", m_options);
  whole.step(m_rod);
  whole.step(pull({{{11, 1, 1}, {0, 3, 0}}}));
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  const State before = session.state();
  Step part = pull({{{11, 1, 1}, {0, 0.75, 0}}});
  part.shift_pieces = true;
  for (int n = 0; n < 4; ++n) session.step(part);
  EXPECT_EQ(angle_deg(session), 0);
  EXPECT_NEAR(voxels(session, {3, 1, 1}, 1), 3 - 3 * kShear, 1e-3);
  EXPECT_TRUE(session.has_shifted_pieces());
  session.step({});
  EXPECT_FALSE(session.has_shifted_pieces());
  EXPECT_NEAR(angle_deg(session), angle_deg(whole), 0.01);
  for (const int i : {3, 8, 11}) {
    EXPECT_NEAR(voxels(session, {i, 1, 1}, 1), voxels(whole, {i, 1, 1}, 1), 1e-3);
  }
  EXPECT_EQ(check_links(session.body()).violated, 0);
  for (int n = 0; n < 5; ++n) ASSERT_TRUE(session.undo());
  EXPECT_EQ(session.state().q, before.q);
  EXPECT_EQ(session.state().piece_records, before.piece_records);
}

TEST_F(UnitRod, LetGoOfAfterAShiftStaysWhereItIs) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  Step part = pull({{{11, 1, 1}, {0, 3, 0}}});
  part.shift_pieces = true;
  session.step(part);
  const State shifted = session.state();
  session.release();
  EXPECT_FALSE(session.has_shifted_pieces());
  EXPECT_EQ(session.state().q, shifted.q);
}

TEST_F(UnitRod, ADragThatShiftsDoNotAllowTurnsThePieceAllTheSame) {
  Session whole(m_folder / "rod.nhdr", m_options), session(m_folder / "rod.nhdr", m_options);
  Step request = pull({{{11, 1, 1}, {0, 4, 0}}});
  for (Session* each : {&whole, &session}) {
    each->step(m_rod);
    each->fix({{0, 1, 1}, {0, 1, 1}});
    each->step(request);
    request.shift_pieces = true;
  }
  EXPECT_GT(angle_deg(session), 1);
  EXPECT_EQ(session.state().q, whole.state().q);
}

TEST_F(UnitRod, UndoTakesATurnBackBitForBit) {
  Session session(m_folder / "rod.nhdr", m_options);
  session.step(m_rod);
  const State before = session.state();
  session.step(pull({{{11, 1, 1}, {0, 3, 0}}}));
  EXPECT_GT(angle_deg(session), 1);
  ASSERT_TRUE(session.undo());
  EXPECT_EQ(session.state().q, before.q);
  EXPECT_EQ(session.state().piece_records, before.piece_records);
}

namespace {

/// A random box of elements as a piece, and bounds on some of its elements.
struct BoundedPiece {
  Body body;
  RigidPiece piece;
  std::vector<ElementBounds> bounds;
};

BoundedPiece random_piece(std::mt19937& random) {
  const Vec3i dims(2 + int(random() % 7), 1 + int(random() % 5), 1 + int(random() % 4));
  BoundedPiece made{body_of(homogeneous(dims, 1.2, 0.8, 0.3)), {}, {}};
  made.body.geometry =
      Geometry(dims, {3, -7, 11}, {Vec3d(0.8, 0.2, 0), Vec3d(-0.3, 1.1, 0.1), Vec3d(0, -0.2, 1.5)});
  for (BrickValues& q : made.body.q) q.resize(made.body.elements.brick_count());
  std::vector<Slot> slots;
  for_each_element(made.body.elements, [&](Slot slot) {
    slots.push_back(slot);
    made.piece.centre_index += Vec3d(voxel_of(made.body.elements, slot));
  });
  made.piece.centre_index /= double(slots.size());
  made.piece.elements = std::make_shared<SlotSet>(slots);
  for (int n = 0; n < 4; ++n) {
    const std::int32_t none = ElementBounds::kNone;
    ElementBounds bounds{slots[random() % slots.size()], {-none, -none, -none}, {none, none, none}};
    const std::size_t c = random() % 3;
    const auto at = std::int32_t(pick(random, -0.8, 0.8) * kVoxel);
    (random() % 2 == 0 ? bounds.least : bounds.most)[c] = at;
    made.bounds.push_back(bounds);
  }
  return made;
}

/// Sum of squared ways in mm^2, a voxel's own turning included; -1 where bounds are broken.
double sum_of_squares(const BoundedPiece& given, const RigidPose& pose) {
  RigidPiece moved = given.piece;
  moved.pose = pose;
  const PoseOffsets offsets(given.body.geometry, moved);
  for (const ElementBounds& bounds : given.bounds) {
    const auto q = offsets(voxel_of(given.body.elements, bounds.slot));
    for (std::size_t c = 0; c < 3; ++c) {
      if (q[c] < bounds.least[c] || q[c] > bounds.most[c]) return -1;
    }
  }
  double sum = 0;
  const Geometry& geometry = given.body.geometry;
  const Vec3d spacing = geometry.spacing_mm();
  given.piece.elements->for_each([&](Slot slot) {
    const auto q = offsets(voxel_of(given.body.elements, slot));
    const Vec3d way = Vec3d(double(q[0]), double(q[1]), double(q[2])) / double(kVoxel);
    sum += geometry.world_vector_from_index(way).length2();
    for (int a = 0; a < 3; ++a) {
      Vec3d arm(0.0);
      arm[a] = spacing[a] / std::sqrt(12.0);
      sum += pose.turn.way_of(arm).length2();
    }
  });
  return sum;
}

}  // namespace

TEST(PropertySmallestMotion, MeetsItsBoundsAndNoPoseBesideItIsSmaller) {
  std::mt19937 random(21);
  int moved = 0, impossible = 0, better = 0;
  for (int n = 0; n < 400; ++n) {
    const BoundedPiece given = random_piece(random);
    const auto pose = smallest_pose(given.body, given.piece, given.bounds);
    if (!pose) {
      ++impossible;
      continue;
    }
    const double least = sum_of_squares(given, *pose);
    ASSERT_GE(least, 0) << n;
    if (least == 0) continue;
    ++moved;
    // Bounds are kept by up to three units of q, which costs so much.
    const double rounding = 2e-4 * std::sqrt(double(given.piece.elements->size()) * least);
    RigidPiece at = given.piece;
    at.pose = *pose;
    for (int m = 0; m < 100; ++m) {
      RigidMotion motion;
      const double size = std::pow(10, pick(random, -3, -1));
      motion.turn = turn_about({pick(random, -1, 1), pick(random, -1, 1), pick(random, -1, 1)},
                               pick(random, 0, 20) * size);
      motion.about_lps_mm = given.body.geometry.world_from_index(given.piece.centre_index);
      motion.shift_lps_mm =
          Vec3d(pick(random, -1, 1), pick(random, -1, 1), pick(random, -1, 1)) * size;
      const double other = sum_of_squares(given, moved_by(motion, at, given.body.geometry));
      better += other >= 0 && other < least - rounding;
    }
  }
  EXPECT_EQ(better, 0);
  EXPECT_GE(moved, 200);
  EXPECT_LE(impossible, 80);
}

TEST(PropertySmallestMotion, ItsSearchCanBeCancelled) {
  class Stopped final : public Progress {
   public:
    void stage(std::string_view) override {}
    void update(double) override {}
    bool cancelled() const override { return true; }
  } stopped;
  std::mt19937 random(24);
  const BoundedPiece given = random_piece(random);
  EXPECT_THROW(smallest_pose(given.body, given.piece, given.bounds, 0, &stopped), Cancelled);
}

TEST(PropertySmallestMotion, OfBoundsThatContradictEachOtherThereIsNone) {
  std::mt19937 random(22);
  for (int n = 0; n < 50; ++n) {
    BoundedPiece given = random_piece(random);
    given.bounds.resize(1);
    given.bounds[0].least = {kVoxel, 0, 0};
    given.bounds[0].most = {kVoxel - 1, kVoxel, kVoxel};
    EXPECT_FALSE(smallest_pose(given.body, given.piece, given.bounds));
  }
}

TEST(PropertyNearestPoint, IsThatOfHildrethsIterationWhateverIsAddedFirst) {
  std::mt19937 random(23);
  int several = 0;
  for (int n = 0; n < 100; ++n) {
    // Half-spaces that hold a point away from the origin.
    std::vector<Vec6> rows(20);
    std::vector<double> least;
    Vec6 inside;
    for (double& value : inside) value = pick(random, -2, 2);
    for (Vec6& row : rows) {
      for (double& value : row) value = pick(random, -1, 1);
      least.push_back(dot(row, inside) - pick(random, 0, 0.5));
    }
    NearestPoint nearest;
    int added = 0;
    for (; added < 500; ++added) {
      std::size_t worst = rows.size();
      double missing = 1e-10;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const double excess = least[r] - dot(rows[r], nearest.x());
        if (excess > missing) {
          missing = excess;
          worst = r;
        }
      }
      if (worst == rows.size()) break;
      ASSERT_TRUE(nearest.add(rows[worst], least[worst])) << n;
    }
    several += added > 6;
    // Multipliers one by one, until nothing changes.
    Vec6 x{};
    std::vector<double> multipliers(rows.size(), 0);
    double largest = 1;
    for (int sweep = 0; sweep < 20000 && largest > 1e-11; ++sweep) {
      largest = 0;
      for (std::size_t r = 0; r < rows.size(); ++r) {
        const double step = (least[r] - dot(rows[r], x)) / dot(rows[r], rows[r]);
        const double change = std::max(step, -multipliers[r]);
        multipliers[r] += change;
        largest = std::max(largest, std::abs(change));
        for (std::size_t a = 0; a < 6; ++a) x[a] += change * rows[r][a];
      }
    }
    for (std::size_t a = 0; a < 6; ++a) EXPECT_NEAR(nearest.x()[a], x[a], 1e-5) << n;
  }
  EXPECT_GE(several, 10);
}

TEST(PropertyNearestPoint, ThereIsNoneWithinHalfSpacesThatDoNotMeet) {
  NearestPoint nearest;
  ASSERT_TRUE(nearest.add({1, 1, 0, 0, 0, 0}, 2));
  EXPECT_FALSE(nearest.add({-1, -1, 0, 0, 0, 0}, -1));
}
