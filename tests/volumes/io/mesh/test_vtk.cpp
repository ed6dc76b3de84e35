// Legacy VTK files, written here byte by byte: as surfaces and as files whose points move.
#include <cstring>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/mesh/mesh_file.h"

using namespace supple;
using namespace supple::test;

namespace {

std::string head(const std::string& encoding, const std::string& kind,
                 const std::string& version = "3.0") {
  return "# vtk DataFile Version " + version + "\na title\n" + encoding + "\nDATASET " + kind +
         "\n";
}
const std::string kText = head("ASCII", "POLYDATA");
const std::string kSquare = "POINTS 4 float\n0 0 0 1 0 0 1 1 0\n0 1 0\n";

TriangleMesh read(const std::string& content) {
  const TemporaryFolder scratch;
  write_text(scratch / "a.vtk", content);
  return read_mesh(scratch / "a.vtk");
}

/// The file with x + 1 everywhere, normals turned a quarter from z to x.
std::string shifted(const std::string& content) {
  const TemporaryFolder scratch;
  write_text(scratch / "a.vtk", content);
  const MeshFile file(scratch / "a.vtk");
  std::vector<Vec3d> positions;
  for (const Vec3d& p : file.positions_lps_mm()) positions.push_back(p + Vec3d(1, 0, 0));
  file.write_moved(scratch / "out.vtk", positions,
                   [](std::size_t, const Vec3d& n) { return Vec3d(n.z, n.y, -n.x); });
  return read_text(scratch / "out.vtk");
}

template <class Value>
std::string big(const std::vector<Value>& values) {
  std::string bytes;
  for (const Value value : values) {
    char part[sizeof value];
    std::memcpy(part, &value, sizeof value);
    bytes.append(std::reverse_iterator<char*>(part + sizeof value),
                 std::reverse_iterator<char*>(part));
  }
  return bytes;
}

using Triangles = std::vector<std::array<int, 3>>;

}  // namespace

TEST(UnitVtk, PolygonsAndStripsAreTriangles) {
  const TriangleMesh mesh =
      read(kText + kSquare + "POLYGONS 1 5\n4 0 1 2 3\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\n");
  EXPECT_EQ(mesh.vertices_lps_mm[2], Vec3d(1, 1, 0));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}, {0, 1, 3}, {3, 1, 2}}));
}

TEST(UnitVtk, Version5WritesOffsetsAndConnectivity) {
  const TriangleMesh mesh =
      read(head("ASCII", "POLYDATA", "5.1") + kSquare +
           "POLYGONS 3 6\nOFFSETS vtktypeint64\n0 3 6\nCONNECTIVITY vtktypeint64\n0 1 2 0 2 3\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
}

TEST(UnitVtk, FlatCellsOfUnstructuredGridsAreTriangles) {
  const TriangleMesh mesh =
      read(head("ASCII", "UNSTRUCTURED_GRID") + kSquare +
           "CELLS 3 14\n3 0 1 2\n4 0 1 3 2\n4 0 1 2 3\nCELL_TYPES 3\n5 8 10\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
}

TEST(UnitVtk, TextKeepsAllButPlacesAndNormals) {
  const auto file = [](const std::string& points, const std::string& normals) {
    return kText + "POINTS 4 double\n" + points +
           "METADATA\nINFORMATION 0\n\nLINES 1 3\n2 0 1\nPOLYGONS 1 4\n3 0 1 2\nCELL_DATA 2\n"
           "NORMALS flat float\n0 0 1\n" +
           normals +
           "POINT_DATA 4\nSCALARS temperature float 1\nLOOKUP_TABLE default\n1 2 3 4.50\n"
           "SCALARS bare int\n1 2 3 4\nCOLOR_SCALARS rgb 3\n0 0 0 1 1 1 .5 .5 .5 0 0 0\n"
           "LOOKUP_TABLE mine 1\n0 0 0 1\nVECTORS v float\n1 0 0 1 0 0 1 0 0 1 0 0\n"
           "NORMALS n double\n" +
           normals + normals + normals +
           "0 0 0\nTEXTURE_COORDINATES t 2 float\n0 0 0 1 1 1 1 0\nFIELD more 2\nids 1 4 int\n"
           "1 2 3 4\nnames 1 2 string\nfirst one\nsecond%20one\n";
  };
  std::string expected = file("1 0 0  2 0 0\n2 1.50 0\n1 1 7\n", "2 0 0\n");
  expected.replace(expected.find("0 0 1\n2 0 0"), 5, "1 0 0");
  EXPECT_EQ(shifted(file("0 0 0  1 0 0\n1 1.50 0\n0 1 7\n", "0 0 2\n")), expected);
}

TEST(UnitVtk, BinaryKeepsAllButPlacesAndNormals) {
  const auto file = [](const std::string& version, const std::vector<float>& points,
                       const std::vector<double>& normals) {
    const bool is_new = version[0] == '5';
    const std::string cells =
        is_new ? "POLYGONS 2 3\nOFFSETS vtktypeint64\n" + big<std::int64_t>({0, 3}) +
                     "\nCONNECTIVITY vtktypeint64\n" + big<std::int64_t>({0, 1, 2}) + "\n"
               : "POLYGONS 1 4\n" + big<std::int32_t>({3, 0, 1, 2}) + "\n";
    return head("BINARY", "POLYDATA", version) + "POINTS 3 float\n" + big(points) + "\n" + cells +
           "POINT_DATA 3\nSCALARS flags bit 1\nLOOKUP_TABLE default\n\xA0\nSCALARS s "
           "unsigned_char 1\nLOOKUP_TABLE mine\n\n\n\n\nLOOKUP_TABLE mine 2\nrgbaRGBA\nFIELD f 1\n"
           "text 1 2 string\n\xC3"
           "abc\x80\x02"
           "de\nNORMALS n double\n" +
           big(normals) + "\n";
  };
  for (const std::string version : {"3.0", "5.1"}) {
    EXPECT_EQ(shifted(file(version, {0, 0, 0, 1, 0, 0, 0, 1, 0.25f}, {0, 0, 1, 1, 0, 0, 0, 3, 0})),
              file(version, {1, 0, 0, 2, 0, 0, 1, 1, 0.25f}, {1, 0, 0, 0, 0, -1, 0, 3, 0}))
        << version;
  }
}

TEST(FaultVtk, WhatIsDamagedIsRefused) {
  const std::string good = kText + kSquare + "POLYGONS 1 5\n4 0 1 2 3\n";
  EXPECT_NO_THROW(read(good));
  for (std::size_t length = 0; length + 2 < good.size(); ++length) {
    EXPECT_THROW(read(good.substr(0, length)), InputError) << length;
  }
  EXPECT_THROW(read(kText + kSquare + "POLYGONS 1 5\n4 0 1 2 4\n"), InputError);
  EXPECT_THROW(read(kText + kSquare + "POLYGONS 1 5\n5 0 1 2 3\n"), InputError);
  EXPECT_THROW(read(kText + kSquare + "POLYGONS 1 6\n4 0 1 2 3 0\n"), InputError);
  EXPECT_THROW(read(kText + kSquare + "POLYGONS 2147483640 2147483640\n4 0 1 2 3\n"), InputError);
  EXPECT_THROW(read(kText + "POINTS 2147483640 float\n0 0 0\n"), InputError);
  EXPECT_THROW(read(kText + kSquare + "SURPRISE 1\n"), InputError);
  const std::string polygons =
      "POLYGONS 2 3\nOFFSETS vtktypeint64\n0 3\nCONNECTIVITY vtktypeint64\n";
  const std::string twice = head("ASCII", "POLYDATA", "5.1") + kSquare + polygons + "0 1 2\n";
  EXPECT_NO_THROW(read(twice));
  EXPECT_THROW(read(twice + polygons + "0 2 3\n"), InputError);
  EXPECT_THROW(read(kText + kSquare + kSquare), InputError);
  EXPECT_THROW(read(head("ASCII", "RECTILINEAR_GRID") + kSquare), InputError);
  EXPECT_THROW(read(head("XML", "POLYDATA") + kSquare), InputError);
  EXPECT_THROW(shifted(kText + "POINTS 1 int\n0 0 0\n"), InputError);
  const std::string binary = head("BINARY", "POLYDATA") + "POINTS 3 float\n" +
                             big<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "\nPOLYGONS 1 4\n" +
                             big<std::int32_t>({3, 0, 1, 2});
  EXPECT_NO_THROW(read(binary));
  for (std::size_t length = 0; length < binary.size(); ++length) {
    EXPECT_THROW(read(binary.substr(0, length)), InputError) << length;
  }
}
