// The sides of cuts do not pass through each other, whatever is dragged where.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/chainmail/cut_contact.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/projection.h"
#include "lib/model/relax_model.h"
#include "tests/lib/cut_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/grid/voxel_sets.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr int kCube = 10;

/// Cut in two by a plane near its middle; no cell of it folds.
Body cut_cube(const Vec3d& direction) {
  Body body = body_of(homogeneous({kCube, kCube, kCube}, 1.4, 0.6, 0.25));
  const Vec3d normal = direction.normalized();
  const Vec3d along =
      normal.cross(std::abs(normal.z) < 0.5 ? Vec3d(0, 0, 1) : Vec3d(0, 1, 0)).normalized();
  const Vec3d across = normal.cross(along);
  const Vec3d centre = Vec3d(0.5 * (kCube - 1)) + Vec3d(0.13, -0.21, 0.32);
  const double size = 2 * kCube;
  const Geometry& geometry = body.geometry;
  cut(body, PlanePatch{geometry.world_from_index(centre - (along + across) * size),
                       geometry.world_vector_from_index(along * (2 * size)),
                       geometry.world_vector_from_index(across * (2 * size))});
  return body;
}

std::int64_t overlapped_voxels(const Body& body) {
  Displacement field{body.geometry, {body.elements, {}}};
  field.u.vectors.resize(body.elements.brick_count());
  for_each_element(body.elements, [&](Slot slot) {
    Vec3f u;
    for (int c = 0; c < 3; ++c) u[c] = float(body.q[std::size_t(c)].at(slot) / kFixedOne);
    field.u.vectors.set(slot, u);
  });
  const CutElements elements{body.elements, body.cuts};
  InvertParams params;
  params.material = &body.elements;
  const Displacement extended = extend_past_cuts(field, dilate(body.elements, 2), elements);
  return invert_cut(extended, elements, params).certificate.overlapped_voxels;
}

std::array<std::int32_t, 3> part_of(std::array<std::int32_t, 3> by, int parts) {
  for (std::int32_t& q : by) q = std::int32_t(std::int64_t(q) * parts / CutContact::kDragParts);
  return by;
}

std::array<std::int32_t, 3> random_move(std::mt19937& random, int voxels) {
  std::array<std::int32_t, 3> by;
  for (std::int32_t& q : by) q = int(random() % unsigned(2 * voxels * kVoxel)) - voxels * kVoxel;
  return by;
}

/// One envelope of values by relaxing every link and contact until nothing changes; none where that
/// does not end.
std::optional<std::vector<std::int64_t>> envelope(const Body& body, int c, bool raise,
                                                  const std::vector<ContactLink>& contacts,
                                                  std::vector<std::int64_t> q) {
  bool has_changed = true;
  // q[above] - q[below] >= least
  const auto keep = [&](Slot below, Slot above, std::int64_t least) {
    if (q[above] - q[below] >= least) return;
    (raise ? q[above] : q[below]) = raise ? q[below] + least : q[above] - least;
    has_changed = true;
  };
  for (int pass = 0; has_changed && pass < 2000; ++pass) {
    has_changed = false;
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
        const std::uint8_t x = body.classes[low], y = body.classes[high];
        const std::int64_t lower = body.slacks.lower(axis, c, x, y);
        const std::int64_t upper = body.slacks.upper(axis, c, x, y);
        if (lower < kUnlimitedSlack) keep(low, high, -lower);
        if (upper < kUnlimitedSlack) keep(high, low, -upper);
      });
    }
    for (const ContactLink& contact : contacts) keep(contact.below, contact.above, contact.least);
  }
  if (has_changed) return std::nullopt;
  return q;
}

/// The projection by brute force: floor((min(L, B) + max(U, A)) / 2), with B and A those of the
/// elements that stay; none where these move.
std::optional<std::vector<std::int64_t>> projected_by_force(
    const Body& body, int c, const SlotSet& anchored, const std::vector<ContactLink>& contacts) {
  std::vector<std::int64_t> q(slot_count(body.elements), 0);
  for (std::size_t n = 0; n < q.size(); ++n) q[n] = body.q[std::size_t(c)].at(n);
  std::vector<std::int64_t> sum(q.size(), 0);
  for (const bool raise : {true, false}) {
    auto moved = envelope(body, c, raise, contacts, q);
    if (!moved) return std::nullopt;
    anchored.for_each([&](Slot slot) { (*moved)[slot] = q[slot]; });
    moved = envelope(body, c, !raise, contacts, *moved);
    if (!moved) return std::nullopt;
    for (std::size_t n = 0; n < q.size(); ++n) sum[n] += (*moved)[n];
  }
  bool holds = true;
  for (std::int64_t& value : sum) value = value >= 0 ? value / 2 : -((1 - value) / 2);
  anchored.for_each([&](Slot slot) { holds = holds && sum[slot] == q[slot]; });
  if (!holds) return std::nullopt;
  return sum;
}

}  // namespace

TEST(PropertyCutContact, AThousandRandomDragsOfClosedCutsLeaveNoPointBehindTheOtherLip) {
  LEFT_OUT_WHEN_SANITIZED();
  const Vec3d normals[] = {{0, 0, 1}, {1, 0, 0}, {0.5, 0, 0.87}, {0.3, 0.4, 0.87}, {1, 1, 0.2}};
  constexpr int kDrags = cases(1000), kOfABody = 5;
  std::mt19937 random(11);
  int met = 0, shortened = 0, inverted = 0, overlapped_states = 0;
  std::int64_t overlapped = 0;
  for (int n = 0; n * kOfABody < kDrags; ++n) {
    Body body = cut_cube(normals[n % 5]);
    EcmSolver solver(body);
    std::vector<Region> anchors;
    if (n % 3 != 0) anchors.push_back(IndexBox{{0, 0, 0}, {kCube - 1, kCube - 1, 0}});
    const SlotSet fixed = anchors.empty() ? SlotSet() : elements_of(body, anchors[0], "fix");
    for (int k = 0; k < kOfABody; ++k) {
      const Vec3i voxel(int(random() % kCube), int(random() % kCube),
                        1 + int(random() % (kCube - 1)));
      const std::array<std::int32_t, 3> by = random_move(random, 5);
      CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
      Holds holds;
      const SidesReport report = contact.drag(fixed, holds, [&](int parts) {
        solver.drag({Handle(voxel, part_of(by, parts))}, anchors, holds);
      });
      ASSERT_EQ(report.left, 0) << "body " << n << " drag " << k;
      ASSERT_EQ(check_links(body).violated, 0);
      met += report.overlapping > 0;
      shortened += report.parts < CutContact::kDragParts;
    }
    if (n % 2 != 0) continue;
    const std::int64_t voxels = overlapped_voxels(body);
    ++inverted;
    overlapped += voxels;
    overlapped_states += voxels > 0;
  }
  std::printf("lips met in %d drags, %d shortened; %lld overlapped voxels in %d of %d states\n",
              met, shortened, static_cast<long long>(overlapped), overlapped_states, inverted);
  EXPECT_GT(met, kDrags / 4);
  EXPECT_LT(shortened, kDrags / 4);
}

/// Elements go anywhere, alone and in balls, and back to where they were.
TEST(PropertyCutContact, LipsThatFollowABodyFaceWhatNewOnesFace) {
  const Vec3d normals[] = {{0, 0, 1}, {0.5, 0.1, 0.87}, {1, 0.2, 0.2}};
  std::int64_t facing = 0, overlapping = 0;
  for (unsigned n = 0; n < 3; ++n) {
    std::mt19937 random(40 + n);
    Body body = cut_cube(normals[n]);
    for (BrickValues& q : body.q) q.resize(body.elements.brick_count());
    const std::array<BrickValues, 3> rest = body.q;
    CutLips following(body, body.cuts);
    for (int step = 0; step < cases(60); ++step) {
      if (step % 20 == 19) body.q = rest;
      const auto place = [&] { return double(random() % kCube); };
      const Vec3d centre(place(), place(), place());
      const double radius = step % 3 == 0 ? 0.5 : 4;
      std::array<std::int32_t, 3> by = random_move(random, step % 4 == 0 ? 4 : 1);
      for (std::size_t c = 0; c < 3; ++c) {
        if (step % 2 == 1 && c != std::size_t(step / 2 % 3)) by[c] = 0;  // along one axis alone
      }
      for_each_element(body.elements, [&](Slot slot) {
        if ((Vec3d(voxel_of(body.elements, slot)) - centre).length() > radius) return;
        for (std::size_t c = 0; c < 3; ++c) body.q[c].set(slot, body.q[c].at(slot) + by[c]);
      });
      CutLips anew(body, body.cuts);
      const LipsBefore before = anew.points_before();
      ASSERT_EQ(following.points_before().of, before.of) << n << " " << step;
      for (int axis = 0; axis < 3; ++axis) {
        const CutLips::Contacts a = following.contacts(axis, before);
        const CutLips::Contacts b = anew.contacts(axis, before);
        ASSERT_EQ(a.overlapping, b.overlapping) << n << " " << step;
        ASSERT_EQ(a.deepest_voxels, b.deepest_voxels) << n << " " << step;
        ASSERT_EQ(a.links.size(), b.links.size()) << n << " " << step;
        for (std::size_t k = 0; k < a.links.size(); ++k) {
          ASSERT_EQ(a.links[k].below, b.links[k].below);
          ASSERT_EQ(a.links[k].above, b.links[k].above);
          ASSERT_EQ(a.links[k].least, b.links[k].least);
        }
        facing += std::int64_t(a.links.size());
        overlapping += a.overlapping;
      }
    }
  }
  EXPECT_GT(facing, 1000);
  EXPECT_GT(overlapping, 100);
}

TEST(PropertyCutContact, ContactsAreProjectedAsByBruteForce) {
  int compared = 0, contradictions = 0;
  for (unsigned n = 0; n < cases(200); ++n) {
    std::mt19937 random(900 + n);
    Block block = random_block(random, {7, 6, 5});
    cut_randomly(random, block);
    Body body = body_of(block);
    drag(body, {Handle(block.voxel(random_element(random, block)), random_move(random, 2))}, {});
    const int c = int(random() % 3);
    body.q[std::size_t(c)].resize(body.elements.brick_count());
    std::vector<ContactLink> contacts;
    for (unsigned k = 0; k < 1 + random() % 6; ++k) {
      Slot below = 0, above = 0;
      slot_of(body.elements, block.voxel(random_element(random, block)), below);
      slot_of(body.elements, block.voxel(random_element(random, block)), above);
      if (below == above) continue;
      const BrickValues& q = body.q[std::size_t(c)];
      const int closer = int(random() % (2 * kVoxel)) - kVoxel;
      contacts.push_back({below, above, std::int64_t(q.at(above)) - q.at(below) + closer});
    }
    std::vector<Slot> held;
    for (unsigned k = 0; k < random() % 4; ++k) {
      Slot slot = 0;
      slot_of(body.elements, block.voxel(random_element(random, block)), slot);
      held.push_back(slot);
    }
    const SlotSet anchored(std::move(held));
    const auto expected = projected_by_force(body, c, anchored, contacts);
    for (const Engine engine : {Engine::block, Engine::flat}) {
      Body moved = body;
      const Holds none;
      ContactProjection projection(moved, anchored, none, nullptr, engine);
      const auto largest = projection.meet(c, contacts);
      ASSERT_EQ(largest.has_value(), expected.has_value()) << n;
      std::int64_t most = 0;
      for_each_element(body.elements, [&](Slot slot) {
        const std::int64_t before = body.q[std::size_t(c)].at(slot);
        const std::int64_t now = moved.q[std::size_t(c)].at(slot);
        ASSERT_EQ(now, expected ? (*expected)[slot] : before) << n;
        most = std::max(most, std::abs(now - before));
      });
      EXPECT_EQ(largest.value_or(0), most) << n;
    }
    (expected ? compared : contradictions) += 1;
  }
  std::printf("%d compared, %d contradictions\n", compared, contradictions);
  EXPECT_GT(compared, cases(100));
  EXPECT_GT(contradictions, 0);
}

TEST(PropertyCutContact, BothSidesGiveWayAlikeAndSlideFreely) {
  Body body = cut_cube({0, 0, 1});
  const Vec3i low(5, 5, 0), high(5, 5, kCube - 1);
  // Across the cut nothing follows a side that slides.
  {
    CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
    drag(body, {Handle(low, {3 * kVoxel, 0, 0})}, {});
    const SidesReport slid = contact.part({}, {});
    EXPECT_LT(slid.max_move_voxels, 1.0 / 64);  // a film between them, so that no place is of both
    EXPECT_EQ(body.offset(high, 0), 0);
  }
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  EcmSolver solver(body);
  const SidesReport met = contact.drag({}, holds, [&](int parts) {
    solver.drag({Handle(low, part_of({0, 0, 4 * kVoxel}, parts))}, {}, holds);
  });
  EXPECT_EQ(met.parts, CutContact::kDragParts);
  EXPECT_GT(met.overlapping, 0);
  EXPECT_EQ(body.offset(low, 2), 4 * kVoxel);
  EXPECT_GT(body.offset(Vec3i(5, 5, 5), 2), 0);
  EXPECT_EQ(overlapped_voxels(body), 0);
}

TEST(PropertyCutContact, WhatIsHeldOnBothSidesShortensTheDrag) {
  Body body = cut_cube({0, 0, 1});
  const IndexBox top{{0, 0, 6}, {kCube - 1, kCube - 1, kCube - 1}};
  const std::vector<Region> anchors = {top};
  const SlotSet fixed = elements_of(body, anchors[0], "fix");
  const IndexBox bottom{{0, 0, 0}, {kCube - 1, kCube - 1, 3}};
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  EcmSolver solver(body);
  const SidesReport report = contact.drag(fixed, holds, [&](int parts) {
    solver.drag({Handle(Region(bottom), part_of({0, 0, 3 * kVoxel}, parts))}, anchors, holds);
  });
  // One link below the cut and one above it give way by 0.4 voxel each.
  EXPECT_EQ(report.left, 0);
  EXPECT_NEAR(report.parts, 0.8 / 3 * CutContact::kDragParts, 0.3 * CutContact::kDragParts);
  EXPECT_LT(report.parts, CutContact::kDragParts);
  EXPECT_EQ(overlapped_voxels(body), 0);
  for_each_element(body.elements, [&](Slot slot) {
    if (voxel_of(body.elements, slot).z < 6) return;
    EXPECT_EQ(body.q[2].at(slot), 0);
  });
}

TEST(UnitCutContact, AStartThatOtherModelsLeftInvalidIsProjectedForEveryPartThatIsTried) {
  Body body = cut_cube({0, 0, 1});
  for (BrickValues& q : body.q) q.resize(body.elements.brick_count());
  Slot slot = 0;
  ASSERT_TRUE(slot_of(body.elements, {2, 2, 1}, slot));
  body.q[2].set(slot, -2 * kVoxel);
  body.links_known_valid = false;
  const std::vector<Region> anchors = {IndexBox{{0, 0, 6}, {kCube - 1, kCube - 1, kCube - 1}}};
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  EcmSolver solver(body);
  const SidesReport report =
      contact.drag(elements_of(body, anchors[0], "fix"), holds, [&](int parts) {
        EXPECT_FALSE(body.links_known_valid);
        const IndexBox bottom{{0, 0, 0}, {kCube - 1, kCube - 1, 3}};
        solver.drag({Handle(Region(bottom), part_of({0, 0, 3 * kVoxel}, parts))}, anchors, holds);
      });
  EXPECT_LT(report.parts, CutContact::kDragParts);
  EXPECT_EQ(check_links(body).violated, 0);
}

TEST(PropertyCutContact, AfterARelaxationTooTheSidesAreApart) {
  LEFT_OUT_WHEN_SANITIZED();
  int met = 0;
  for (unsigned n = 0; n < cases(12); ++n) {
    std::mt19937 random(40 + n);
    Body body = cut_cube(n % 2 == 0 ? Vec3d(0, 0, 1) : Vec3d(0.5, 0, 0.87));
    const std::vector<Region> anchors = {IndexBox{{0, 0, 0}, {kCube - 1, kCube - 1, 0}}};
    const SlotSet fixed = elements_of(body, anchors[0], "fix");
    Holds holds;
    EcmSolver solver(body);
    {
      // The upper side is lifted and bent, so that it comes back as it relaxes.
      const Vec3i voxel(int(random() % kCube), int(random() % kCube), kCube - 1);
      CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
      contact.drag(fixed, holds, [&](int parts) {
        solver.drag({Handle(voxel, part_of({0, kVoxel, -4 * kVoxel}, parts))}, anchors, holds);
      });
    }
    CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
    RelaxParams params;
    params.passes = 200;
    const SidesReport report = contact.go(fixed, holds, [&] {
      RelaxModel model({body, anchors, holds}, params);
      run_model(model, params.passes);
    });
    met += report.overlapping > 0 || report.parts < CutContact::kDragParts;
    EXPECT_EQ(report.left, 0) << n;
    EXPECT_EQ(check_links(body).violated, 0);
  }
  EXPECT_GT(met, 0);
}

TEST(PropertyCutContact, AWayThatHasNoRoomIsGoneInPartAndKeepsEveryLimit) {
  // The floor comes up by more than both halves can shrink, under a lid that stays.
  Body body = cut_cube({0.3, 0, 1});
  const IndexBox floor{{0, 0, 0}, {kCube - 1, kCube - 1, 1}};
  SlotSet held = elements_of(body, IndexBox{{0, 0, 7}, {kCube - 1, kCube - 1, 9}}, "fix");
  held.add(elements_of(body, floor, "fix"));
  Body moved = body;
  EcmSolver solver(moved);
  solver.drag({Handle(Region(floor), {kVoxel / 2, -kVoxel / 3, 4 * kVoxel + 17})}, {});
  ASSERT_EQ(check_links(moved).violated, 0);
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  const SidesReport report = contact.go(held, holds, [&] {
    body.q = moved.q;
    for_each_element(body.elements, [&](Slot slot) {
      holds.at_least[2].push_back({slot, body.q[2].at(slot)});
      holds.at_most[0].push_back({slot, body.q[0].at(slot)});
    });
  });
  // What holds the end of the way holds where the way ended.
  for (const Bound& bound : holds.at_least[2]) ASSERT_LE(bound.value, body.q[2].at(bound.slot));
  for (const Bound& bound : holds.at_most[0]) ASSERT_GE(bound.value, body.q[0].at(bound.slot));
  EXPECT_EQ(report.left, 0);
  EXPECT_GT(report.parts, 0);
  EXPECT_LT(report.parts, CutContact::kDragParts);
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_EQ(overlapped_voxels(body), 0);
}

TEST(PropertyCutContact, LipsThatMeetMoveNothingFarAway) {
  Body body = body_of(homogeneous({64, 24, 24}, 1.4, 0.6, 0.25));
  const Geometry& geometry = body.geometry;
  cut(body, PlanePatch{geometry.world_from_index({-1, -1, 11.4}),
                       geometry.world_vector_from_index({66, 0, 0}),
                       geometry.world_vector_from_index({0, 26, 0})});
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  EcmSolver solver(body);
  const SidesReport report = contact.drag({}, holds, [&](int parts) {
    solver.drag({Handle(Vec3i(4, 12, 11), part_of({0, 0, 2 * kVoxel}, parts))}, {}, holds);
  });
  EXPECT_GT(report.overlapping, 0);
  EXPECT_EQ(report.left, 0);
  EXPECT_EQ(overlapped_voxels(body), 0);
  for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
    const bool is_far = body.elements.origin(b).x >= 24;
    EXPECT_TRUE(!is_far || body.q[2].brick(b) == nullptr) << b;
  }
}

TEST(PropertyCutContact, CutsThatEndAndSlicesAreKeptApartWithAnyLinks) {
  std::mt19937 random(17);
  int met = 0;
  std::int64_t left = 0, overlapped = 0, states = 0;
  for (unsigned n = 0; n < cases(24); ++n) {
    const int links = n % 3 == 0 ? 6 : n % 3 == 1 ? 18 : 26;
    const bool is_slice = n % 4 == 3;
    Block block = homogeneous({16, 14, is_slice ? 1 : 12}, 1.4, 0.6, 0.25);
    block.table.links = links;
    Body body = body_of(block);
    const Geometry& geometry = body.geometry;
    // The cut goes from one side to the middle of the body, across j.
    cut(body, PlanePatch{geometry.world_from_index({-1, 6.3, -2}),
                         geometry.world_vector_from_index({9.2, n % 2 == 0 ? 0 : 2.1, 0}),
                         geometry.world_vector_from_index({0, 0, 20})});
    EcmSolver solver(body);
    for (int k = 0; k < 3; ++k) {
      const Vec3i voxel(int(random() % 6), int(random() % 14), is_slice ? 0 : int(random() % 12));
      std::array<std::int32_t, 3> by = random_move(random, 4);
      if (is_slice) by[2] = 0;
      CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
      Holds holds;
      const SidesReport report = contact.drag({}, holds, [&](int parts) {
        solver.drag({Handle(voxel, part_of(by, parts))}, {}, holds);
      });
      met += report.overlapping > 0;
      left += report.left;
      ASSERT_EQ(check_links(body).violated, 0);
    }
    const std::int64_t voxels = overlapped_voxels(body);
    overlapped += voxels;
    states += voxels > 0;
  }
  std::printf("lips met in %d drags; %lld points left, %lld voxels in %lld states\n", met,
              static_cast<long long>(left), static_cast<long long>(overlapped),
              static_cast<long long>(states));
  EXPECT_GT(met, int(cases(24)));
  EXPECT_EQ(left, 0);
}

TEST(PropertyCutContact, LipsOfAnyCutsLieBesideEachOtherAtRest) {
  int with_sheets = 0;
  for (unsigned n = 0; n < cases(100); ++n) {
    std::mt19937 random(300 + n);
    Block block = random_block(random, {9, 8, 7});
    cut_randomly(random, block);
    Body body = body_of(block);
    CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
    EXPECT_EQ(contact.part({}, {}).overlapping, 0) << n;
    with_sheets += !contact.empty();
  }
  EXPECT_GT(with_sheets, cases(20));
}

TEST(PropertyCutContact, AStackOfSlicesIsPushedOnFromSliceToSlice) {
  constexpr int kSlices = 12, kThick = 2;
  Body body = body_of(homogeneous({6, 6, kSlices * kThick}, 1.2, 0.9, 0.25));
  const Geometry& geometry = body.geometry;
  for (int n = 1; n < kSlices; ++n) {
    cut(body, PlanePatch{geometry.world_from_index({-1, -1, n * kThick - 0.5}),
                         geometry.world_vector_from_index({8, 0, 0}),
                         geometry.world_vector_from_index({0, 8, 0})});
  }
  CutContact contact(body, std::make_shared<CutLips>(body, body.cuts));
  Holds holds;
  EcmSolver solver(body);
  const SidesReport report = contact.drag({}, holds, [&](int parts) {
    solver.drag({Handle(Vec3i(3, 3, 0), part_of({0, 0, 3 * kVoxel}, parts))}, {}, holds);
  });
  EXPECT_GT(report.overlapping, 0);
  EXPECT_EQ(report.left, 0);
  EXPECT_EQ(report.parts, CutContact::kDragParts);
  EXPECT_GT(body.offset({3, 3, kSlices * kThick - 1}, 2), kVoxel);
  EXPECT_EQ(check_links(body).violated, 0);
  EXPECT_EQ(overlapped_voxels(body), 0);
}
