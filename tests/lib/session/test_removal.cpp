// Remains of bodies where elements are taken out.
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/support/program.h"
#include "volumes/base/json.h"

using namespace supple;
using namespace supple::test;

namespace {

/// A session of a block of 20 x 20 x 20 voxels, the first of which is none.
struct BlockSession {
  TemporaryFolder folder;
  std::unique_ptr<Session> session;

  BlockSession() {
    std::string voxels(20 * 20 * 20, char(100));
    voxels[0] = 0;
    write_text(folder / "block.raw", voxels);
    write_text(folder / "block.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 20 20 20\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: block.raw\n");
    SessionOptions options;
    options.material = parse_material(
        "domain = [0, 100]\nactive = [1, 100]\nmax_length = [[0, 1.2]]\n"
        "min_length = [[0, 0.8]]\nshear = [[0, 0.3]]\n",
        "test");
    session = std::make_unique<Session>(folder / "block.nhdr", options);
  }
};

}  // namespace

TEST(UnitRemoval, DensitiesFallToThoseOfAirWithinAVoxelOfTheSurfaceOfABall) {
  const BlockSession block;
  Session& session = *block.session;
  Step request;
  ChosenPart ball;
  ball.selection = Selection();
  ball.selection->ball_index = Vec3d(9.5, 10, 10.25);
  ball.selection->radius_mm = 5.25;
  request.remove = {ball};
  session.step(request);
  const State state = session.state();
  int partial = 0;
  for (int n = 0; n < 20 * 20 * 20; ++n) {
    const Vec3i voxel(n % 20, n / 20 % 20, n / 400);
    const double beyond = (Vec3d(voxel) - *ball.selection->ball_index).length() - 5.25;
    const bool is_left = beyond > 0 && n != 0;
    ASSERT_EQ(state.elements.is_active(voxel), is_left) << n;
    if (n == 0) continue;
    EXPECT_NEAR(state.density.at(voxel), 100 * std::clamp(1 + beyond, 0.0, 1.0), 1e-4) << n;
    partial += beyond < 0 && beyond > -1;
  }
  EXPECT_GT(partial, 200);
}

TEST(UnitRemoval, TheJournalTellsOfEachStepOnceWhereALaterOneRemoves) {
  const BlockSession block;
  Session& session = *block.session;
  session.drag(IndexBox{{5, 5, 5}, {5, 5, 5}}, {1, 0, 0});
  Step removal;
  ChosenPart corner;
  corner.selection = Selection();
  corner.selection->box = IndexBox{{17, 17, 17}, {19, 19, 19}};
  removal.remove = {corner};
  session.step(removal);
  EXPECT_EQ(parse_json(session.journal())["steps"].size(), 2u);
  EXPECT_EQ(session.state().configuration, session.journal());
}
