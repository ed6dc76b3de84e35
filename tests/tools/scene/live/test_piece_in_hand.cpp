// A rigid piece that a hand shifts and turns, against the pose that was asked for; its journals and
// scenes, its joint, and what stops it.
#include <cmath>
#include <random>
#include <tuple>

#include <gtest/gtest.h>

#include "tests/tools/scene/live/replay_fixture.h"
#include "tools/scene/live/live_session.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

const std::string kBone =
    event("step", "rigid = [{ name = \"bone\", grab_box = [8, 11, 12, 15, 12, 13] }]");
const std::string kGrab = event("grab", "rigid_at = [9, 11, 12]\nslide = true\nspare_fixed = true");

std::string drag(const Vec3d& to, const Vec3d& turn) {
  return event("drag", "to = " + vector_text({to.x, to.y, to.z}) +
                           "\nturn = " + vector_text({turn.x, turn.y, turn.z}));
}

/// Rodrigues' formula.
Vec3d turned_by(const Vec3d& x, const Vec3d& degrees) {
  const double angle = degrees.length() * std::acos(-1.0) / 180;
  if (angle == 0) return x;
  const Vec3d axis = degrees.normalized();
  return x * std::cos(angle) + axis.cross(x) * std::sin(angle) +
         axis * (axis.dot(x) * (1 - std::cos(angle)));
}

class PropertyPieceInHand : public UnitReplay {
 protected:
  PropertyPieceInHand() {
    for (const auto& [name, most, shear] :
         {std::tuple("loose", "8", "8"), std::tuple("tight", "1.5", "0.8")}) {
      write_text(m_folder / (std::string(name) + ".toml"),
                 std::string("domain = [0, 255]\nactive = [1, 255]\nmin_length = [[0, 0.05]]\n") +
                     "max_length = [[0, " + most + "]]\nshear = [[0, " + shear + "]]\n");
    }
  }
  LiveSession& open(const std::string& events, const std::string& material = "loose") {
    const std::string file = journal("[material]\ntable = \"" + material + ".toml\"\n" + events);
    m_live.emplace(Table::parse(read_text(file), file), nullptr);
    for (const LiveEvent& one : m_live->events()) m_live->carry_out(one);
    return *m_live;
  }
  void carry_out(const std::string& events) {
    Table root = Table::parse(events, "events");
    for (Table& table : root.tables("event")) m_live->carry_out(read_event(table, {}));
  }
  /// Place of a voxel, in voxels; the ball has its axes along x, y and z.
  Vec3d place_of(const Vec3i& voxel) {
    const Body& body = m_live->session().body();
    Slot slot = 0;
    EXPECT_TRUE(slot_of(body.elements, voxel, slot));
    Vec3d place(voxel);
    for (int a = 0; a < 3; ++a) place[a] += body.q[std::size_t(a)].at(slot) / 65536.0;
    return place;
  }
  /// The largest distance of the bone's voxels from where that motion takes them from rest.
  double misfit(const Vec3d& to, const Vec3d& turn) {
    const Geometry& geometry = m_live->session().geometry();
    const Vec3d middle(11.5, 11.5, 12.5);
    double most = 0;
    for (int i = 8; i <= 15; ++i) {
      for (int j = 11; j <= 12; ++j) {
        for (int k = 12; k <= 13; ++k) {
          const Vec3d mm = geometry.world_vector_from_index(Vec3d(i, j, k) - middle);
          const Vec3d asked = geometry.index_vector_from_world(turned_by(mm, turn)) + middle +
                              to / geometry.spacing_mm();
          most = std::max(most, (place_of({i, j, k}) - asked).length());
        }
      }
    }
    return most;
  }

  std::optional<LiveSession> m_live;
};

TEST_F(PropertyPieceInHand, EveryDragTakesItToThePoseThatIsAskedForWhereverItWasBefore) {
  open(kBone + kGrab);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> mm(-2, 2), degrees(-60, 60);
  const auto any = [&](auto& number) {
    const double x = number(random), y = number(random);
    return Vec3d(std::round(x * 64) / 64, std::round(y * 64) / 64, 0.5);
  };
  for (int n = 0; n < 8; ++n) {
    const Vec3d to = any(mm), turn = any(degrees);
    carry_out(drag(to, turn));
    EXPECT_LT(misfit(to, turn), 1e-4) << to << " and " << turn;
    EXPECT_NEAR(m_live->hand().led->reached_deg, turn.length(), 1e-4);
  }
  carry_out(drag({0, 0, 0}, {0, 0, 0}));
  EXPECT_LT(misfit({0, 0, 0}, {0, 0, 0}), 1e-4);
}

TEST_F(PropertyPieceInHand, JournalAndSceneLeadToTheSameStateAndOneUndoTakesAllOfItBack) {
  const std::string before = hash(journal(kBone));
  const std::string stroke = event("grab", "rigid_at = [9, 11, 12]\njoint = 2\nslide = true") +
                             drag({1, 0, 0.5}, {0, 12, 7}) + drag({1, 0.5, 0.5}, {0, 0, 0}) +
                             drag({1, 0.5, 0.5}, {3, 20, 7}) + event("release");
  const std::string carried = m_folder / "carried.toml", batch = m_folder / "batch.toml";
  const std::string live =
      hash(journal(kBone + stroke), "--journal " + carried + " --scene " + batch);
  EXPECT_NE(live, before);
  EXPECT_EQ(hash(carried), live);
  EXPECT_EQ(hash(batch), live);
  EXPECT_EQ(hash(journal(kBone + stroke + event("undo", "all = true"))), before);
  EXPECT_EQ(
      hash(journal(kBone + stroke + event("undo", "all = true") + event("redo", "all = true"))),
      live);
  EXPECT_EQ(hash(journal(kBone + stroke + event("undo") + event("redo"))), live);
}

TEST_F(PropertyPieceInHand, WhatStopsATurnLetsItComeBack) {
  open(event("anchor", "grab_box = [14, 10, 15, 15, 13, 16]") + kBone + kGrab, "tight");
  carry_out(drag({0, 0, 0}, {0, 60, 0}));
  const LiveHand::Led stopped = *m_live->hand().led;
  EXPECT_NEAR(stopped.asked_deg, 60, 1e-9);
  EXPECT_GT(stopped.reached_deg, 1);
  EXPECT_LT(stopped.reached_deg, 59);
  EXPECT_LT(misfit(stopped.reached, {0, stopped.reached_deg, 0}), 1e-3);
  carry_out(drag({0, 0, 0}, {0, -5, 0}));
  EXPECT_LT(misfit({0, 0, 0}, {0, -5, 0}), 1e-4);
}

TEST_F(PropertyPieceInHand, AJointLetsItMoveBesideABoneThatIsHeld) {
  const auto reached = [&](const std::string& joint) {
    open(kBone +
             event("step",
                   "rigid = [{ name = \"skull\", grab_box = [8, 11, 16, 15, 12, 17] }]\n"
                   "fix = [[9, 11, 16]]") +
             event("grab", "rigid_at = [9, 11, 12]" + joint),
         "tight");
    carry_out(drag({0, 0, -4}, {0, 0, 0}));
    return m_live->hand().led->reached.z;
  };
  const double without = reached("");
  EXPECT_GT(without, -3.5);
  EXPECT_LT(reached("\njoint = 6"), without - 0.3);
}

TEST_F(PropertyPieceInHand, TheHistoryTellsItsTurn) {
  LiveSession& live =
      open(kBone + kGrab + drag({0, 1, 0}, {0, 0, 10}) + drag({0, 2, 0}, {0, 30, 0}));
  EXPECT_EQ(live.history().done.back().turned_deg, live.hand().led->reached_deg);
  EXPECT_NEAR(live.hand().led->reached_deg, 30, 1e-4);
}

TEST_F(PropertyPieceInHand, OnlyWholePiecesTurnAndHaveJoints) {
  open(kBone + event("grab", "grab = [12, 12, 16]"));
  EXPECT_THROW(carry_out(drag({0, 0, 0}, {0, 5, 0})), InputError);
  EXPECT_THROW(carry_out(event("grab", "grab = [12, 12, 16]\njoint = 3")), InputError);
  EXPECT_THROW(carry_out(event("drag", "to = [0, 0, 0]\njoint = 3")), InputError);
}

}  // namespace
