// Mesh files whose vertices move: every format is written here byte by byte, and so is what comes
// out.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/mesh/mesh_file.h"

using namespace supple;
using namespace supple::test;

namespace {

Vec3d moved(const Vec3d& p) {
  return {2 * p.x + 1, p.y - 0.5, p.z};
}
/// Turns a normal by the cofactor of diag(2, 1, 1).
Vec3d turned(std::size_t, const Vec3d& n) {
  return {n.x, 2 * n.y, 2 * n.z};
}

/// The file after the move.
std::string after(const std::string& name, const std::string& content,
                  const std::function<Vec3d(const Vec3d&)>& move = moved,
                  const MeshFile::TurnNormal& turn = turned) {
  const TemporaryFolder scratch;
  write_text(scratch / name, content);
  const MeshFile file(scratch / name);
  std::vector<Vec3d> positions;
  for (const Vec3d& p : file.positions_lps_mm()) positions.push_back(move(p));
  file.write_moved(scratch / ("out_" + name), positions, turn);
  return read_text(scratch / ("out_" + name));
}

template <class Value>
std::string all_of(const std::vector<Value>& values, bool big_endian) {
  std::string bytes;
  for (const Value value : values) bytes += bytes_of_value(value, big_endian);
  return bytes;
}

Vec3d still(const Vec3d& p) {
  return p;
}
Vec3d not_turned(std::size_t, const Vec3d& n) {
  return n;
}

}  // namespace

TEST(UnitMeshFile, ObjKeepsAllButPlacesAndNormals) {
  const std::string before =
      "# made by hand\r\nmtllib a.mtl\no thing\nv  1 2 3 0.5 0.25 1\nv 0 0.5\t0\nv -1.5e0 4 0\n"
      "vt 0.1 0.2\nvn 0 0 2\nvn 0 1 0\nusemtl red\ns 1\nf 1/1/1 2/1/1 3/1/2 # face\nl 1 2\n";
  const std::string expected =
      "# made by hand\r\nmtllib a.mtl\no thing\nv  3 1.5 3 0.5 0.25 1\nv 1 0\t0\nv -2 3.5 0\n"
      "vt 0.1 0.2\nvn 0 0 2\nvn 0 1 0\nusemtl red\ns 1\nf 1/1/1 2/1/1 3/1/2 # face\nl 1 2\n";
  EXPECT_EQ(after("a.obj", before), expected);
}

TEST(UnitMeshFile, NormalsTurnAndKeepTheirLength) {
  const std::string before = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 3 4 0\nvn 7 7 7\nf 1//1 2//1 3//1\n";
  const std::string out = after("a.obj", before);
  const double length = std::sqrt(9 + 64.0);
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(out.c_str() + out.find("vn"), "vn %lf %lf %lf", &x, &y, &z), 3) << out;
  EXPECT_NEAR(x, 5 * 3 / length, 1e-12);
  EXPECT_NEAR(y, 5 * 8 / length, 1e-12);
  EXPECT_EQ(z, 0);
  EXPECT_NE(out.find("vn 7 7 7"), std::string::npos) << "a normal without vertex stays";
}

TEST(UnitMeshFile, ANormalOfSeveralVerticesBecomesTheMeanOfTheirs) {
  const auto turn = [](std::size_t vertex, const Vec3d&) {
    return vertex == 0 ? Vec3d(1, 0, 0) : vertex == 1 ? Vec3d(0, 9, 0) : Vec3d(0, 0, 0);
  };
  const std::string out =
      after("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n", still, turn);
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(out.c_str() + out.find("vn"), "vn %lf %lf %lf", &x, &y, &z), 3) << out;
  EXPECT_NEAR(x, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(y, std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(z, 0, 1e-12);
}

TEST(UnitMeshFile, PlyKeepsColoursListsAndElementsInAnyEncoding) {
  const auto header = [](const std::string& format) {
    return "ply\nformat " + format +
           " 1.0\ncomment kept\nelement vertex 2\nproperty uchar red\nproperty float x\n"
           "property double y\nproperty float z\nproperty float nx\nproperty float ny\n"
           "property float nz\nproperty short label\nelement edge 1\nproperty int vertex1\n"
           "property int vertex2\nend_header\n";
  };
  EXPECT_EQ(after("a.ply", header("ascii") + "9 1 2 3 1 0 0 -7\n8 0.1 0 0  0 0 1 5\n0 1\n"),
            header("ascii") + "9 3 1.5 3 1 0 0 -7\n8 1.2 -0.5 0  0 0 1 5\n0 1\n");
  for (const bool big : {false, true}) {
    const auto vertex = [&](int red, float x, double y, float z, float nx, float ny, float nz) {
      return std::string(1, char(red)) + bytes_of_value(x, big) + bytes_of_value(y, big) +
             bytes_of_value(z, big) + all_of<float>({nx, ny, nz}, big) +
             bytes_of_value(std::int16_t(-7), big);
    };
    const std::string head = header(big ? "binary_big_endian" : "binary_little_endian");
    const std::string edge = all_of<std::int32_t>({0, 1}, big);
    const float s = float(2 / std::sqrt(5.0)), c = float(1 / std::sqrt(5.0));
    const float h = std::sqrt(0.5f);
    EXPECT_EQ(after("a.ply",
                    head + vertex(9, 1, 2, 3, 0, 0, 1) + vertex(200, -1, 0, 0.25f, h, h, 0) + edge),
              head + vertex(9, 3, 1.5, 3, 0, 0, 1) + vertex(200, -1, -0.5, 0.25f, c, s, 0) + edge);
  }
}

TEST(UnitMeshFile, StlTrianglesGetTheNormalsOfTheirNewCorners) {
  // The facet is in the plane x + y = 1; stretched twofold along x its normal leans to y.
  const std::string before =
      "solid a name\nfacet normal 0.5 0.5 0\n outer loop\n  vertex 1 0 0\n  vertex 0 1 0\n"
      "  vertex 0 1 1\n endloop\nendfacet\nfacet normal 0 0 0\n outer loop\n  vertex 1 0 0\n"
      "  vertex 0 1 0\n  vertex 0 1 1\n endloop\nendfacet\nendsolid a name\n";
  const std::string out = after("a.stl", before);
  double x = 0, y = 0, z = 0;
  ASSERT_EQ(std::sscanf(out.c_str() + out.find("normal"), "normal %lf %lf %lf", &x, &y, &z), 3);
  EXPECT_NEAR(x, std::sqrt(0.5) * 1 / std::sqrt(5.0), 1e-12);
  EXPECT_NEAR(y, std::sqrt(0.5) * 2 / std::sqrt(5.0), 1e-12);
  EXPECT_NE(out.find("vertex 3 -0.5 0\n  vertex 1 0.5 0\n  vertex 1 0.5 1\n"), std::string::npos);
  EXPECT_NE(out.find("facet normal 0 0 0\n"), std::string::npos) << "a normal left out stays so";
}

TEST(UnitMeshFile, BinaryStlKeepsItsHeadAndAttributes) {
  const auto file = [](const std::vector<float>& floats) {
    return std::string(76, 'h') + "head" + bytes_of_value(std::uint32_t(1), false) +
           all_of<float>(floats, false) + "\x12\x34";
  };
  // Turned the other way round than its corners, as it was before.
  const auto swap_y_and_z = [](const Vec3d& p) { return Vec3d(p.x, p.z, p.y); };
  EXPECT_EQ(after("a.stl", file({0, 0, -1, 0, 0, 0, 1, 0, 0, 0, 1, 0}), swap_y_and_z),
            file({0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}));
}

TEST(UnitMeshFile, AFileInRasMovesInLpsAndStaysInRas) {
  const auto file = [](const std::string& vertex) {
    return "# SPACE=RAS\nv " + vertex + "\nvn 0 -1 0\n";
  };
  Vec3d seen;
  const auto move = [&](const Vec3d& p) {
    seen = p;
    return p + Vec3d(10, 0, 0);
  };
  EXPECT_EQ(after("a.obj", file("1 2 3"), move), file("-9 2 3"));
  EXPECT_EQ(seen, Vec3d(-1, -2, 3));
}

TEST(PropertyMeshFile, NothingMovedIsTheSameFile) {
  const std::string text =
      "v 1.0 2.50 3e0\nv 0 0 0\nv 0 1 0\nvn 0 0 1.00\nvn 1 1 1\nf 1//1 2//1 3//2\n";
  EXPECT_EQ(after("a.obj", text, still, not_turned), text);
  const std::string stl =
      "solid\nfacet normal 0 0 1.1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0.1\n"
      "endloop\nendfacet\nendsolid\n";
  EXPECT_EQ(after("a.stl", stl, still, not_turned), stl);
}

TEST(FaultMeshFile, WhatCannotMoveIsRefused) {
  EXPECT_THROW(after("a.ply",
                     "ply\nformat ascii 1.0\nelement vertex 1\nproperty int x\nproperty int y\n"
                     "property int z\nend_header\n1 2 3\n"),
               InputError);
  EXPECT_THROW(after("a.txt", "v 1 2 3\n"), InputError);
  EXPECT_THROW(after("a.obj", "v 1 nan 3\n"), InputError);
  EXPECT_THROW(after("a.obj", "v 1 2\n"), InputError);
}
