// Lines of PLY, OBJ and legacy VTK files.
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/mesh/triangle_mesh.h"

using namespace supple;
using namespace supple::test;

namespace {

using Lines = std::vector<std::array<int, 2>>;

LineNetwork network_of(const std::string& name, const std::string& content) {
  const TemporaryFolder folder;
  write_text(folder / name, content);
  return read_network(folder / name);
}

std::string error_of(const std::string& name, const std::string& content) {
  try {
    network_of(name, content);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

template <class Value>
std::string big_endian(Value value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return {bytes.rbegin(), bytes.rend()};
}

const std::string kPlyHead =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "element edge 2\nproperty int vertex1\nproperty int vertex2\nproperty uchar red\n"
    "end_header\n";
const std::string kVtkPoints = "POINTS 5 float\n0 0 0 1 0 0 1 1 0 0 1 0 5 5 5\n";

}  // namespace

TEST(UnitNetwork, EdgesOfPlyAreLines) {
  const LineNetwork text = network_of("a.ply", "ply\nformat ascii 1.0\n" + kPlyHead +
                                                   "0 0 0\n1 0 0\n1 2 0\n0 0 3\n"
                                                   "0 1 255\n3 1 0\n");
  EXPECT_EQ(text.lines, (Lines{{0, 1}, {3, 1}}));
  ASSERT_EQ(text.mesh.vertices_lps_mm.size(), 4u);
  EXPECT_EQ(text.mesh.vertices_lps_mm[3], Vec3d(0, 0, 3));
  std::string binary = "ply\nformat binary_big_endian 1.0\n" + kPlyHead;
  for (int n = 0; n < 12; ++n) binary += big_endian(float(n));
  for (const int end : {2, 0}) binary += big_endian(std::int32_t(end));
  binary += '\7';
  for (const int end : {1, 3}) binary += big_endian(std::int32_t(end));
  binary += '\7';
  EXPECT_EQ(network_of("a.ply", binary).lines, (Lines{{2, 0}, {1, 3}}));
}

TEST(UnitNetwork, PolylinesOfObjAreLinesBesideFaces) {
  const LineNetwork network =
      network_of("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2/5 -1 # a comment\nf 1 2 3\nl 3 1\n");
  EXPECT_EQ(network.lines, (Lines{{0, 1}, {1, 2}, {2, 0}}));
  EXPECT_EQ(network.mesh.triangles.size(), 1u);
}

TEST(UnitNetwork, LinesOfVtkComeFromPolygonalDataAndUnstructuredGrids) {
  const std::string head = "# vtk DataFile Version 3.0\nSPACE=RAS\nASCII\n";
  const LineNetwork polydata =
      network_of("a.vtk", head + "DATASET POLYDATA\n" + kVtkPoints + "LINES 2 7\n3 0 1 2\n2 4 3\n");
  EXPECT_EQ(polydata.lines, (Lines{{0, 1}, {1, 2}, {4, 3}}));
  EXPECT_EQ(polydata.mesh.vertices_lps_mm[4], Vec3d(-5, -5, 5));
  const LineNetwork grid =
      network_of("a.vtk", head + "DATASET UNSTRUCTURED_GRID\n" + kVtkPoints +
                              "CELLS 3 11\n2 0 1\n3 0 1 2\n3 4 3 2\nCELL_TYPES 3\n3\n5\n4\n");
  EXPECT_EQ(grid.lines, (Lines{{0, 1}, {4, 3}, {3, 2}}));
  EXPECT_EQ(grid.mesh.triangles.size(), 1u);
}

TEST(FaultNetwork, LinesWithoutTheirVerticesAreRefused) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\n";
  EXPECT_NE(error_of("a.obj", vertices + "l 1 3\n").find("vertex 2, counted from 0"),
            std::string::npos);
  EXPECT_NE(error_of("a.obj", vertices + "l 1 1\n").find("twice"), std::string::npos);
  EXPECT_NE(error_of("a.obj", vertices + "l 1\n").find("2 or more"), std::string::npos);
  EXPECT_NE(error_of("a.obj", vertices).find("neither line nor triangle"), std::string::npos);
  std::string head = kPlyHead;
  head.replace(head.find("vertex2"), 7, "vertex3");
  const std::string values = "0 0 0 1 0 0 1 2 0 0 0 3 0 ";
  EXPECT_NE(error_of("a.ply", "ply\nformat ascii 1.0\n" + head + values + "1 2 3 1 0")
                .find("properties vertex1 and vertex2"),
            std::string::npos);
  EXPECT_NE(error_of("a.ply", "ply\nformat ascii 1.0\n" + kPlyHead + values + "-1 2 3 1 0")
                .find("PLY edge"),
            std::string::npos);
}

TEST(UnitNetwork, ASurfaceAloneIsReadAsBeforeWhateverItsLinesSay) {
  const TemporaryFolder folder;
  write_text(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 9\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(folder / "a.obj").triangles.size(), 1u);
}
