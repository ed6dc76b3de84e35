// Anchors that are meant to hold rigid pieces, and what is told where they do not.
#include <gtest/gtest.h>

#include "lib/material/material.h"
#include "lib/session/session.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr Vec3i kHeldDims(24, 14, 14);
const IndexBox kSkull{{4, 4, 8}, {18, 9, 11}}, kJaw{{8, 5, 2}, {14, 8, 4}};

/// Two bones, one above the other, in soft tissue.
class UnitHeldPieces : public ::testing::Test {
 protected:
  UnitHeldPieces() {
    std::string voxels;
    for (int k = 0; k < kHeldDims.z; ++k) {
      for (int j = 0; j < kHeldDims.y; ++j) {
        for (int i = 0; i < kHeldDims.x; ++i) {
          const Vec3i voxel(i, j, k);
          const bool is_air = i == 0 && j == 0 && k == 0;
          const bool is_bone = kSkull.contains(voxel) || kJaw.contains(voxel);
          voxels += char(static_cast<unsigned char>(is_air ? 0 : is_bone ? 200 : 100));
        }
      }
    }
    write_text(m_folder / "bones.raw", voxels);
    write_text(m_folder / "bones.nhdr",
               "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
               "sizes: 24 14 14\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
               "space origin: (0,0,0)\nencoding: raw\ndata file: bones.raw\n");
    m_options.material = parse_material(
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.6]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.29]]\nrigid = [180, 255]\nrelax = false\n",
        "test");
  }

  /// The jaw goes forward beside an anchor at a voxel.
  Step advanced(const Vec3i& fixed) const {
    Step request;
    request.drags.push_back({Region({10, 6, 3}), {0, 0.5, 0}});
    request.fix = {{fixed, fixed}};
    return request;
  }
  static std::size_t lines_with(const Session& session, const std::string& part) {
    std::size_t count = 0;
    for (const std::string& line : session.messages()) {
      count += line.find(part) != std::string::npos;
    }
    return count;
  }

  TemporaryFolder m_folder;
  SessionOptions m_options;
};

}  // namespace

TEST_F(UnitHeldPieces, AnAnchorBesideABoneThatNothingHoldsIsToldWithItsNearestVoxel) {
  Session session(m_folder / "bones.nhdr", m_options);
  ASSERT_EQ(session.body().rigid.list.size(), 2u);
  session.step(advanced({10, 6, 13}));
  ASSERT_EQ(lines_with(session, "no rigid piece is held"), 1u);
  EXPECT_EQ(lines_with(session, "voxel 10,6,11 of rigid piece:4,4,8 is 2 mm"), 1u)
      << session.messages().back();
}

TEST_F(UnitHeldPieces, AnAnchorOnABoneIsNotToldNorOneFarFromAllBones) {
  Session on(m_folder / "bones.nhdr", m_options);
  on.step(advanced({10, 6, 11}));
  EXPECT_EQ(lines_with(on, "no rigid piece is held"), 0u);
  // The only piece that is left is grabbed itself.
  Session alone(m_folder / "bones.nhdr", m_options);
  Step request = advanced({10, 6, 6});
  request.remove.emplace_back();
  request.remove.back().selection = Selection();
  request.remove.back().selection->box = kSkull;
  alone.step(request);
  EXPECT_EQ(lines_with(alone, "no rigid piece is held"), 0u);
}

TEST_F(UnitHeldPieces, FiniteElementsTellHowFarAFreeBoneTips) {
  Session free(m_folder / "bones.nhdr", m_options);
  Step request = advanced({10, 6, 13});
  request.drags[0].by_mm = {0, 2, 0};
  request.fem.emplace();
  free.step(request);
  EXPECT_EQ(lines_with(free,
                       "finite elements moved 1 free rigid piece, the largest of them, "
                       "piece:4,4,8, by up to "),
            1u);
  EXPECT_EQ(lines_with(free, "such as 4,4,8, holds it"), 1u);
  Session held(m_folder / "bones.nhdr", m_options);
  request.fix = {{{10, 6, 11}, {10, 6, 11}}};
  held.step(request);
  EXPECT_EQ(lines_with(held, "free rigid piece"), 0u);
}

TEST_F(UnitHeldPieces, LinksThatAJointPartsAreCounted) {
  m_options.material->rigid.reset();
  Session session(m_folder / "bones.nhdr", m_options);
  Step request;
  for (const IndexBox& box : {kSkull, kJaw}) {
    request.rigid.parts.emplace_back();
    request.rigid.parts.back().selection = Selection();
    request.rigid.parts.back().selection->box = box;
  }
  request.rigid.joint_mm = 6;
  const std::int64_t counted = session.step(request).cut_links;
  EXPECT_GT(counted, 0);
  EXPECT_EQ(counted, session.state().cuts.count());
}
