// Files that are sealed and still wrong: what only a program that knows our format could write.
// Reading checks every grid that later code trusts.
#include <fstream>

#include <gtest/gtest.h>
#include <openvdb/io/Stream.h>

#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/grid/density_grid_vdb.h"
#include "volumes/io/vdb/vdb_seal.h"

using namespace supple;
using namespace supple::test;

namespace {

struct Parts {
  openvdb::GridPtrVecPtr grids;
  openvdb::MetaMap::Ptr metadata;

  template <class Grid>
  typename Grid::Ptr grid(const std::string& name) const {
    for (const auto& candidate : *grids) {
      if (candidate->getName() == name) return openvdb::gridPtrCast<Grid>(candidate);
    }
    return nullptr;
  }
};

class FaultForgedState : public ::testing::Test {
 protected:
  FaultForgedState() : m_path(m_folder / "a.vdb") {
    openvdb::initialize();
    State state = random_state(40, 12);
    m_element = state.elements.origin(0);
    while (!state.elements.is_active(m_element)) ++m_element.z;
    write_state(m_path, state);
    std::ifstream in(m_path, std::ios::binary);
    openvdb::io::Stream stream(in, false);
    m_parts = {stream.getGrids(), stream.getMetadata()};
  }

  /// Writes the parts as an OpenVDB stream, sealed or not, and returns the reader's message.
  std::string read_error(bool sealed = true) {
    {
      std::ofstream out(m_path, std::ios::binary);
      openvdb::io::Stream(out).write(*m_parts.grids, *m_parts.metadata);
    }
    if (sealed) seal_vdb(m_path, VdbKind::state);
    try {
      read_state(m_path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  void expect_error(const std::string& part) {
    const std::string message = read_error();
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  TemporaryFolder m_folder;
  std::string m_path;
  Vec3i m_element;
  Parts m_parts;
};

}  // namespace

TEST_F(FaultForgedState, UnchangedPartsReadWell) {
  EXPECT_EQ(read_error(), "");
}

TEST_F(FaultForgedState, AStateWithoutSealIsRejected) {
  EXPECT_NE(read_error(false).find("no trailer"), std::string::npos);
}

TEST_F(FaultForgedState, AnotherProgramsGridIsForeign) {
  m_parts.metadata->clearMetadata();
  const std::string message = read_error(false);
  EXPECT_NE(message.find("another program"), std::string::npos) << message;
  EXPECT_FALSE(is_state_file(m_path));
}

TEST_F(FaultForgedState, OffsetsWithoutElementAreRejected) {
  auto element = m_parts.grid<openvdb::BoolGrid>("element");
  auto q = m_parts.grid<openvdb::Vec3IGrid>("q");
  const openvdb::Coord voxel(m_element.x, m_element.y, m_element.z);
  q->tree().setValueOn(voxel, openvdb::Vec3i(1, 2, 3));
  ASSERT_EQ(read_error(), "");
  element->tree().setActiveState(voxel, false);
  expect_error("a value without element");
}

TEST_F(FaultForgedState, OffsetsBeyondTheLimitAreRejected) {
  m_parts.grid<openvdb::Vec3IGrid>("q")->tree().setValueOn(
      openvdb::Coord(m_element.x, m_element.y, m_element.z),
      openvdb::Vec3i(0, std::numeric_limits<int>::min(), 0));
  expect_error("q.y at");
}

TEST_F(FaultForgedState, VelocitiesThatAreNotFiniteOrWithoutElementAreRejected) {
  auto velocity = m_parts.grid<openvdb::Vec3DGrid>("velocity");
  ASSERT_TRUE(velocity);
  const openvdb::Coord voxel(m_element.x, m_element.y, m_element.z);
  velocity->tree().setValueOn(voxel, openvdb::Vec3d(0, 1, HUGE_VAL));
  expect_error("velocity.z at");
  velocity->tree().setValueOn(voxel, openvdb::Vec3d(1));
  ASSERT_EQ(read_error(), "");
  m_parts.grid<openvdb::BoolGrid>("element")->tree().setActiveState(voxel, false);
  for (const char* name : {"q", "rest_i", "rest_j", "rest_k"}) {
    if (auto grid = m_parts.grid<openvdb::Vec3IGrid>(name)) {
      grid->tree().setActiveState(voxel, false);
    }
  }
  expect_error("grid velocity: found a value without element");
}

TEST_F(FaultForgedState, ElementsOutsideTheVolumeAreRejected) {
  m_parts.grid<openvdb::BoolGrid>("element")->tree().setValueOn(openvdb::Coord(-1, 0, 0), true);
  expect_error("grid element: found voxels outside the volume");
}

TEST_F(FaultForgedState, ElementsWithoutDensityAreRejected) {
  m_parts.grid<openvdb::FloatGrid>("density")->tree().setActiveState(
      openvdb::Coord(m_element.x, m_element.y, m_element.z), false);
  expect_error("no density");
}

TEST_F(FaultForgedState, DensitiesThatAreNotFiniteAreRejected) {
  m_parts.grid<openvdb::FloatGrid>("density")->tree().setValueOn(
      openvdb::Coord(m_element.x, m_element.y, m_element.z),
      std::numeric_limits<float>::infinity());
  expect_error("not finite");
}

TEST_F(FaultForgedState, ActiveTilesAreRejected) {
  m_parts.grid<openvdb::FloatGrid>("density")->tree().addTile(1, openvdb::Coord(4096, 0, 0), 1,
                                                              true);
  expect_error("active tiles");
}

TEST_F(FaultForgedState, MissingGridsAndGridsOfAnotherTypeAreRejected) {
  m_parts.grid<openvdb::Vec3IGrid>("q")->setName("p");
  expect_error("grid q: found nothing");
  m_parts.grid<openvdb::Vec3SGrid>("displacement")->setName("q");
  expect_error("grid q: found nothing");
}

TEST_F(FaultForgedState, CutsWhereThereIsNoLinkAreRejected) {
  const auto forge = [&](const Vec3i& voxel, int bits) {
    for (auto& grid : *m_parts.grids) {
      if (grid->getName() == "cut_links") grid->setName("was cut_links");
    }
    auto cuts = make_grid<openvdb::Int32Grid>(0);
    cuts->setName("cut_links");
    cuts->tree().setValueOn(openvdb::Coord(voxel.x, voxel.y, voxel.z), bits);
    m_parts.grids->insert(m_parts.grids->begin(), cuts);
  };
  const auto element = m_parts.grid<openvdb::BoolGrid>("element");
  const auto is_element = [&](const Vec3i& voxel) {
    return element->tree().isValueOn(openvdb::Coord(voxel.x, voxel.y, voxel.z));
  };
  Vec3i linked = m_element, lonely = m_element, empty = m_element;
  while (!(is_element(linked) && is_element(linked + Vec3i(0, 1, 0)))) ++linked.z;
  while (!is_element(lonely) || is_element(lonely + Vec3i(0, 0, 1))) ++lonely.z;
  while (is_element(empty)) ++empty.z;
  forge(linked, 2);
  ASSERT_EQ(read_error(), "");
  forge(linked, 511 << 12 | 2);
  ASSERT_EQ(read_error(), "");
  forge(linked, 1 << 30 | 2);
  expect_error("grid cut_links: found 1073741826, expected bits 1 to 7");
  forge(linked, 8 | 2);
  expect_error("grid cut_links: found 10, expected bits 1 to 7");
  forge(linked, 0);
  expect_error("grid cut_links: found 0, expected bits 1 to 7");
  forge(linked, -1);
  expect_error("grid cut_links: found -1");
  forge(lonely, 4);
  expect_error("a cut along k where there is no link");
  forge(empty, 1);
  expect_error("where there is no link");
  forge({-1, 0, 0}, 1);
  expect_error("grid cut_links: found voxels outside the volume");
  m_parts.grids->front()->setName("none");
  m_parts.grid<openvdb::Vec3SGrid>("displacement")->setName("cut_links");
  expect_error("grid cut_links: found nothing, expected a grid of");
}

TEST_F(FaultForgedState, DerivedGridsAndWhatFollowsThemAreNotRead) {
  m_parts.grid<openvdb::Int32Grid>("cut_links")->setName("was cut_links");
  auto bad = make_grid<openvdb::Int32Grid>(0);
  bad->setName("cut_links");
  bad->tree().setValueOn(openvdb::Coord(0), 8);
  m_parts.grids->push_back(bad);
  EXPECT_EQ(read_error(), "");
  m_parts.grids->pop_back();
  m_parts.grids->insert(m_parts.grids->begin(), bad);
  expect_error("bits 1 to 7");
}

TEST_F(FaultForgedState, LabelsThatNoElementCanHaveAreRejected) {
  const auto forge = [&](const Vec3i& voxel, int value) {
    for (auto& grid : *m_parts.grids) {
      if (grid->getName() == "label") grid->setName("was label");
    }
    auto labels = make_grid<openvdb::Int32Grid>(0);
    labels->setName("label");
    labels->tree().setValueOn(openvdb::Coord(voxel.x, voxel.y, voxel.z), value);
    m_parts.grids->insert(m_parts.grids->begin(), labels);
  };
  m_parts.metadata->removeMeta("supple_anchors");
  m_parts.metadata->insertMeta("supple_anchors", openvdb::StringMetadata(R"([{"label": 9}])"));
  forge(m_element, 9);
  ASSERT_EQ(read_error(), "");
  forge(m_element, 8);
  expect_error("label 9 without elements");
  forge(m_element, 0);
  expect_error("grid label: found 0");
  forge(m_element, 65536);
  expect_error("found 65536, expected 0 to 65535");
  forge({-1, 0, 0}, 1);
  expect_error("grid label: found voxels outside the volume");
  const auto element = m_parts.grid<openvdb::BoolGrid>("element");
  Vec3i empty = m_element;
  while (element->tree().isValueOn(openvdb::Coord(empty.x, empty.y, empty.z))) ++empty.z;
  forge(empty, 9);
  EXPECT_NE(read_error(), "");
  m_parts.grids->front()->setName("none");
  m_parts.grid<openvdb::Vec3SGrid>("displacement")->setName("label");
  expect_error("grid label: found nothing, expected a grid of");
}

TEST_F(FaultForgedState, MetadataMustBeWholeAndValid) {
  const auto forge = [&](const char* name, const std::string& text) {
    m_parts.metadata->removeMeta(name);
    m_parts.metadata->insertMeta(name, openvdb::StringMetadata(text));
  };
  const std::string geometry =
      m_parts.metadata->getMetadata<openvdb::StringMetadata>("supple_geometry")->value();
  for (const char* bad :
       {"", "nonsense", "{}", "[1, 2, 3]",
        R"({"axes_mm":[[1,0,0],[0,1,0],[0,0,0]],"dims":[9,9,9],"origin_lps_mm":[0,0,0]})",
        R"({"axes_mm":[[1,0,0],[0,1,0],[0,0,1]],"dims":[9,9,1e99],"origin_lps_mm":[0,0,0]})",
        R"({"axes_mm":[[1,0,0],[0,1,0],[0,0,1]],"dims":[-9,9,9],"origin_lps_mm":[0,0,0]})",
        R"({"axes_mm":[[1,0,0],[0,1,0],["a",0,1]],"dims":[9,9,9],"origin_lps_mm":[0,0,0]})"}) {
    forge("supple_geometry", bad);
    EXPECT_NE(read_error(), "") << bad;
  }
  forge("supple_geometry", geometry);
  ASSERT_EQ(read_error(), "");
  for (const char* bad :
       {"{", "{}", "[1]", "[[1,2,3,4,5]]", "[[0,0,0,-1,0,0]]", "[[0,0,0,0,0,1.5]]", "[{}]",
        "[{\"label\": 65536}]", "[{\"label\": 1.5}]"}) {
    forge("supple_anchors", bad);
    EXPECT_NE(read_error(), "") << bad;
  }
  forge("supple_anchors", "[]");
  forge("supple_format", "state 3");
  expect_error("format: found state 3, expected state 1 or state 2");
  forge("supple_format", "state 2");
  expect_error("supple_source: found nothing");
  m_parts.metadata->removeMeta("supple_format");
  expect_error("supple_format: found nothing");
}
