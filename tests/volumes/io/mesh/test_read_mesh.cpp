// Meshes from files that are written here byte by byte.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/io/mesh/triangle_mesh.h"

using namespace supple;
using namespace supple::test;

namespace {

std::string text_of(const Vec3d& v) {
  char text[100];
  std::snprintf(text, sizeof text, "%.17g %.17g %.17g", v.x, v.y, v.z);
  return text;
}

std::string binary_stl(const TriangleMesh& mesh, std::string head = "written by a test") {
  head.resize(80, ' ');
  std::string bytes = head + bytes_of_value(std::uint32_t(mesh.triangles.size()));
  for (const auto& triangle : mesh.triangles) {
    bytes += std::string(12, '\0');
    for (const int index : triangle) {
      const Vec3d& v = mesh.vertices_lps_mm[index];
      for (int a = 0; a < 3; ++a) bytes += bytes_of_value(float(v[a]));
    }
    bytes += std::string(2, '\0');
  }
  return bytes;
}

std::string text_stl(const TriangleMesh& mesh) {
  std::string text = "solid a test\n";
  for (const auto& triangle : mesh.triangles) {
    text += " facet normal 0 0 1\n  outer loop\n";
    for (const int index : triangle) {
      text += "   vertex " + text_of(mesh.vertices_lps_mm[index]) + "\n";
    }
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid a test\n";
}

std::string obj(const TriangleMesh& mesh) {
  std::string text = "# a test\no thing\n";
  for (const Vec3d& v : mesh.vertices_lps_mm) text += "v " + text_of(v) + "\n";
  for (const auto& [a, b, c] : mesh.triangles) {
    text += "f " + std::to_string(a + 1) + "/7 " + std::to_string(b + 1) + "//2 " +
            std::to_string(c + 1) + "\r\n";
  }
  return text;
}

enum class Ply { text, little, big };

std::string ply(const TriangleMesh& mesh, Ply form) {
  const char* names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
  const std::size_t vertices = mesh.vertices_lps_mm.size(), faces = mesh.triangles.size();
  std::string text = std::string("ply\nformat ") + names[int(form)] +
                     " 1.0\ncomment a test\nelement vertex " + std::to_string(vertices) +
                     "\nproperty uchar red\nproperty double x\nproperty double y\n"
                     "property double z\nelement edge 1\nproperty list uchar short ends\n"
                     "element face " +
                     std::to_string(faces) +
                     "\nproperty list uchar int vertex_indices\nproperty ushort flags\n"
                     "end_header\n";
  const bool big = form == Ply::big;
  for (const Vec3d& v : mesh.vertices_lps_mm) {
    if (form == Ply::text) {
      text += "7 " + text_of(v) + "\n";
    } else {
      text += '\7';
      for (int a = 0; a < 3; ++a) text += bytes_of_value(v[a], big);
    }
  }
  text += form == Ply::text
              ? "2 0 1\n"
              : "\2" + bytes_of_value(std::int16_t(0), big) + bytes_of_value(std::int16_t(1), big);
  for (const auto& triangle : mesh.triangles) {
    if (form != Ply::text) text += '\3';
    if (form == Ply::text) text += "3";
    for (const int index : triangle) {
      text += form == Ply::text ? " " + std::to_string(index) : bytes_of_value(index, big);
    }
    text += form == Ply::text ? " 9\n" : bytes_of_value(std::uint16_t(9), big);
  }
  return text;
}

/// Corners of all triangles in order: what counts, however vertices are shared.
std::vector<Vec3d> corners_of(const TriangleMesh& mesh) {
  std::vector<Vec3d> corners;
  for (const auto& triangle : mesh.triangles) {
    for (const int index : triangle) corners.push_back(mesh.vertices_lps_mm[index]);
  }
  return corners;
}

TriangleMesh random_mesh(std::mt19937& random, bool floats) {
  std::uniform_real_distribution<double> place(-200, 200);
  TriangleMesh mesh;
  const int vertices = 3 + int(random() % 30), triangles = 1 + int(random() % 40);
  for (int n = 0; n < vertices; ++n) {
    const Vec3d v(place(random), place(random), place(random));
    mesh.vertices_lps_mm.push_back(floats ? Vec3d(Vec3f(v)) : v);
  }
  for (int n = 0; n < triangles; ++n) {
    const auto index = [&] { return int(random() % unsigned(vertices)); };
    mesh.triangles.push_back({index(), index(), index()});
  }
  return mesh;
}

class FaultMesh : public ::testing::Test {
 protected:
  /// The message of reading these bytes under that name; "" when they read.
  std::string message_of(const std::string& name, const std::string& bytes) {
    write_text(m_folder / name, bytes);
    try {
      read_mesh(m_folder / name);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
      return error.what();
    }
    return "";
  }
  void expect_message(const std::string& name, const std::string& bytes, const std::string& part) {
    const std::string message = message_of(name, bytes);
    EXPECT_NE(message.find(part), std::string::npos) << message;
  }

  TemporaryFolder m_folder;
};

const TriangleMesh kTriangle{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
const TriangleMesh kPair{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 3, 2}}};

}  // namespace

TEST(PropertyMesh, EveryFormatReadsBackTheCornersOfItsTriangles) {
  const TemporaryFolder folder;
  std::mt19937 random(31);
  for (int n = 0; n < 30; ++n) {
    const TriangleMesh exact = random_mesh(random, false), rounded = random_mesh(random, true);
    write_text(folder / "binary.stl", binary_stl(rounded, n % 2 ? "solid as some write" : "x"));
    EXPECT_EQ(corners_of(read_mesh(folder / "binary.stl")), corners_of(rounded));
    write_text(folder / "text.STL", text_stl(exact));
    EXPECT_EQ(corners_of(read_mesh(folder / "text.STL")), corners_of(exact));
    for (const Ply form : {Ply::text, Ply::little, Ply::big}) {
      write_text(folder / "a.ply", ply(exact, form));
      EXPECT_EQ(corners_of(read_mesh(folder / "a.ply")), corners_of(exact));
    }
    write_text(folder / "a.obj", obj(exact));
    EXPECT_EQ(corners_of(read_mesh(folder / "a.obj")), corners_of(exact));
  }
}

TEST(UnitMesh, PolygonsBecomeFansAndNegativeIndicesCountFromTheEnd) {
  const TemporaryFolder folder;
  write_text(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nl 1 2\nf -4 2 3 -1");
  const TriangleMesh mesh = read_mesh(folder / "a.obj");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0], (std::array<int, 3>{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (std::array<int, 3>{0, 2, 3}));
  write_text(folder / "a.ply",
             "ply\r\nformat ascii 1.0\r\nelement vertex 4\r\nproperty float x\r\nproperty float "
             "y\r\nproperty float z\r\nelement face 2\r\nproperty list uchar uint vertex_index\r\n"
             "end_header\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3\r\n2 0 1\r\n");
  EXPECT_EQ(corners_of(read_mesh(folder / "a.ply")), corners_of(mesh));
}

TEST(UnitMesh, CoordinatesAreLpsUnlessTheFileSaysRas) {
  const TemporaryFolder folder;
  const TriangleMesh mesh{{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}}, {{0, 1, 2}}};
  write_text(folder / "lps.stl", binary_stl(mesh, "3D Slicer output. SPACE=LPS"));
  write_text(folder / "ras.stl", binary_stl(mesh, "3D Slicer output. SPACE=RAS"));
  write_text(folder / "ras.obj", "# 3D Slicer output. SPACE=RAS\n" + obj(mesh));
  EXPECT_EQ(read_mesh(folder / "lps.stl").vertices_lps_mm[0], Vec3d(1, 2, 3));
  EXPECT_EQ(read_mesh(folder / "ras.stl").vertices_lps_mm[0], Vec3d(-1, -2, 3));
  EXPECT_EQ(read_mesh(folder / "ras.obj").vertices_lps_mm[2], Vec3d(-7, -8, 10));
}

TEST_F(FaultMesh, FilesThatAreNoMeshAreNamed) {
  EXPECT_THROW(read_mesh(m_folder / "none.stl"), InputError);
  EXPECT_THROW(read_mesh(m_folder / "."), InputError);
  EXPECT_THROW(read_mesh("/dev/zero"), InputError);
  expect_message("a.stl", "", "0 bytes");
  expect_message("a.txt", "solid\nendsolid\n",
                 "extension: found .txt, expected .stl, .ply, .obj or .vtk");
  expect_message("a", "solid\n", "extension: found none");
  expect_message("a.stl", "solid a\nendsolid a\n", "no triangle");
  expect_message("b.stl", binary_stl({}), "no triangle");
  expect_message("a.obj", "v 0 0 0\nv 1 1 1\nl 1 2\n", "no triangle");
  expect_message("a.ply", ply({{{0, 0, 0}, {1, 1, 1}}, {}}, Ply::text), "no triangle");
}

TEST_F(FaultMesh, DamagedContentIsNamedWithItsLine) {
  const std::string text = text_stl(kPair), binary = binary_stl(kPair);
  expect_message("a.stl", binary.substr(0, 150), "found 150 bytes, expected 184 bytes by its own");
  expect_message("a.stl", binary + "x", "found 185 bytes, expected 184 bytes");
  expect_message("a.stl", text.substr(0, text.size() - 25), "line 15: found");
  expect_message("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex 1 1 1\n",
                 "line 5: found vertex, expected a number");
  expect_message("a.obj", "v 0 0\n", "line 1: found nothing, expected a number");
  expect_message("a.obj", obj(kPair) + "f 1 2\n", "fewer than 3 vertices");
  expect_message("a.obj", obj(kPair) + "f 0 1 2\n", "found 0, expected the number of a vertex");
  expect_message("a.obj", obj(kPair) + "f 1.5 1 2\n", "found 1.5, expected the number");
  expect_message("a.obj", obj(kPair) + "f -5 1 2\n", "found -5, expected the number");
  expect_message("a.obj", obj(kPair) + "f 1e300 1 2\n", "the number of a vertex");
  expect_message("a.obj", obj(kPair) + "f 5 1 2\n", "vertex 4, counted from 0, expected one of 4");
  expect_message("a.ply", "ply\nformat ascii 1.0\n", "line 3: found nothing");
  expect_message("a.ply", "ply\nelement vertex 1\n", "expected format");
  for (const Ply form : {Ply::little, Ply::big}) {
    const std::string whole = ply(kPair, form);
    expect_message("a.ply", whole.substr(0, whole.size() - 1), "data that end early");
  }
  expect_message("a.ply", ply({kPair.vertices_lps_mm, {{0, 1, 4}}}, Ply::text), "vertex 4");
  expect_message("a.ply", ply({kPair.vertices_lps_mm, {{0, 1, -1}}}, Ply::big), "found -1");
}

TEST_F(FaultMesh, HeadersThatPromiseMoreThanTheFileHoldsCostNothing) {
  const auto header = [](const std::string& elements) {
    return "ply\nformat binary_little_endian 1.0\n" + elements + "end_header\n";
  };
  const std::string vertex = "property float x\nproperty float y\nproperty float z\n";
  expect_message("a.ply", header("element vertex 2000000000\n" + vertex), "2000000000 items");
  expect_message("a.ply", header("element vertex 99999999999\n" + vertex), "a count from 0");
  expect_message("a.ply", header("element vertex -1\n" + vertex), "a count from 0");
  expect_message("a.ply", header("element vertex nan\n" + vertex), "a count from 0");
  expect_message("a.ply", header("element dust 2000000000\n") + "x", "2000000000 items of 0");
  expect_message("a.ply", header("element vertex 1\nproperty float x\n") + "1234",
                 "vertices without y");
  expect_message("a.ply",
                 header("element face 1\nproperty list uint uchar vertex_indices\n") +
                     bytes_of_value(std::uint32_t(4000000000u)),
                 "4e+09 values");
  expect_message(
      "a.ply",
      header("element face 1\nproperty list float uchar vertex_indices\n") + bytes_of_value(-1.0f),
      "found -1 values");
  std::string stl = binary_stl(kPair);
  stl.replace(80, 4, bytes_of_value(std::uint32_t(-1)));
  expect_message("a.stl", stl, "expected 214748364834 bytes");
}

TEST_F(FaultMesh, CoordinatesThatAreNotFiniteAreErrors) {
  TriangleMesh mesh = kPair;
  for (const double bad : {double(NAN), double(INFINITY), -double(INFINITY)}) {
    mesh.vertices_lps_mm[3].y = bad;
    expect_message("a.stl", binary_stl(mesh), "not finite");
    expect_message("a.stl", text_stl(mesh), "vertex 4, counted from 0: found a coordinate that");
    expect_message("a.obj", obj(mesh), "not finite");
    for (const Ply form : {Ply::text, Ply::little, Ply::big}) {
      expect_message("a.ply", ply(mesh, form), "not finite");
    }
  }
}

TEST_F(FaultMesh, RandomDamageGivesAMeshOrOneLineButNeverACrash) {
  std::mt19937 random(32);
  int read = 0, refused = 0;
  for (int n = 0; n < 3000; ++n) {
    const TriangleMesh mesh = random_mesh(random, true);
    const int form = n % 6;
    std::string bytes = form == 0   ? binary_stl(mesh)
                        : form == 1 ? text_stl(mesh)
                        : form == 2 ? obj(mesh)
                                    : ply(mesh, Ply(form - 3));
    const auto at = [&] { return random() % bytes.size(); };
    if (random() % 4 == 0) bytes.resize(1 + at());
    for (unsigned change = unsigned(random() % 6); change > 0 && bytes.size() > 20; --change) {
      switch (random() % 4) {
        case 0:
          bytes[at()] = char(random());
          break;
        case 1:
          bytes[at()] = "0123456789-e. \n"[random() % 15];
          break;
        case 2:
          bytes.insert(at(), "99999999");
          break;
        default:
          bytes.erase(at(), 1 + random() % 10);
      }
    }
    const char* names[] = {"a.stl", "a.stl", "a.obj", "a.ply", "a.ply", "a.ply"};
    const std::string message = message_of(names[form], bytes);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_LT(message.size(), 400u);
    ++(message.empty() ? read : refused);
  }
  EXPECT_GT(read, 300);
  EXPECT_GT(refused, 300);
}
