// Solids of other programs that have moved, as warps; composed transforms.
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "volumes/io/vtu/vtu.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

std::string array(const std::string& name, const std::string& type, int components,
                  const std::string& values) {
  return "<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
         std::to_string(components) + "\" format=\"ascii\">" + values + "</DataArray>\n";
}

std::string vtu(const std::string& points, const std::string& data, const std::string& ids,
                const std::string& offsets, const std::string& types) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" "
         "byte_order=\"LittleEndian\">\n<UnstructuredGrid><Piece NumberOfPoints=\"8\" "
         "NumberOfCells=\"1\">\n<PointData>" +
         data + "</PointData>\n<Points>" + array("Points", "Float64", 3, points) +
         "</Points>\n<Cells>" + array("connectivity", "Int32", 1, ids) +
         array("offsets", "Int32", 1, offsets) + array("types", "UInt8", 1, types) +
         "</Cells>\n</Piece></UnstructuredGrid></VTKFile>\n";
}

/// y = A x + t, of a cube from -10 to 10.
Vec3d moved(const Vec3d& x) {
  return {1.1 * x.x + 0.2 * x.y + 1, 0.9 * x.y - 0.1 * x.z, 1.05 * x.z + 0.05 * x.x - 2};
}
Vec3d back(const Vec3d& y) {
  // The inverse by fixed point iteration: the map is near the identity.
  Vec3d x = y;
  for (int n = 0; n < 200; ++n) x += y - moved(x);
  return x;
}

std::string cube(const std::string& name) {
  const int corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                             {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  std::string points, vectors;
  for (const auto& corner : corners) {
    const Vec3d x(20.0 * corner[0] - 10, 20.0 * corner[1] - 10, 20.0 * corner[2] - 10);
    const Vec3d u = moved(x) - x;
    for (int a = 0; a < 3; ++a) points += std::to_string(x[a]) + " ";
    for (int a = 0; a < 3; ++a) vectors += std::to_string(u[a]) + " ";
  }
  return vtu(points,
             array("velocity", "Float64", 3, std::string(vectors)) +
                 array(name, "Float64", 3, vectors) +
                 array("pressure", "Float64", 1, "1 2 3 4 5 6 7 8"),
             "0 1 2 3 4 5 6 7", "8", "12");
}

const Geometry kAround({30, 30, 30}, {-14.5, -14.3, -14.1}, {Vec3d(1, 0, 0), {0, 1, 0}, {0, 0, 1}});

TEST(PropertyVtu, ASolidBringsItsContentAlongAndLeavesAllElse) {
  const TemporaryFolder folder;
  write_text(folder / "cube.vtu", cube("Displacement"));
  const Warp warp = read_warp(folder / "cube.vtu", nullptr, &kAround);
  EXPECT_EQ(warp.direction, WarpDirection::resample);
  int inside = 0;
  for (int n = 0; n < 30 * 30 * 30; ++n) {
    const Vec3d y = kAround.world_from_index(Vec3d(n % 30, n / 30 % 30, n / 900));
    const Vec3d x = back(y);
    const double beyond = std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) - 10;
    if (std::abs(beyond) < 1e-3) continue;
    const Vec3d expected = beyond < 0 ? x - y : Vec3d(0);
    ASSERT_LT((Vec3d(warp.vectors[std::size_t(n)]) - expected).length(), 1e-4) << n;
    inside += beyond < 0;
  }
  EXPECT_GT(inside, 6000);
}

bool is_in(const MovedSolid& solid, const std::array<int, 4>& tetrahedron, const Vec3d& x) {
  std::array<Vec3d, 4> p;
  for (std::size_t n = 0; n < 4; ++n) {
    p[n] = solid.points_lps_mm[std::size_t(tetrahedron[n])] - x;
  }
  const auto volume = [](const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return a.dot(b.cross(c));
  };
  const double v[] = {volume(p[1], p[3], p[2]), volume(p[0], p[2], p[3]), volume(p[0], p[3], p[1]),
                      volume(p[0], p[1], p[2])};
  const auto all = [&](double sign) {
    return std::all_of(v, v + 4, [&](double part) { return part * sign > 1e-12; });
  };
  return all(1) || all(-1);
}

TEST(UnitVtu, OtherCellsAreTheTetrahedraOfTheirCorners) {
  const TemporaryFolder folder;
  const auto count_of = [&](const std::string& type, const std::vector<int>& corners) {
    std::string points, ids;
    for (int n = 0; n < 8; ++n) {
      points += std::to_string(n % 2) + " " + std::to_string(n / 2 % 2) + " " +
                std::to_string(n / 4) + " ";
    }
    for (const int n : corners) ids += std::to_string(n) + " ";
    std::string zeros;
    for (int n = 0; n < 24; ++n) zeros += "0 ";
    write_text(folder / "a.vtu", vtu(points, array("U", "Float32", 3, zeros), ids,
                                     std::to_string(corners.size()), type));
    // Counts the tetrahedra that a place lies in, over places in the cube.
    const auto solid = read_vtu(folder / "a.vtu");
    std::array<int, 4> places{};
    for (int n = 0; n < 1000; ++n) {
      const Vec3d x(0.013 + 0.1 * (n % 10), 0.027 + 0.1 * (n / 10 % 10), 0.041 + 0.1 * (n / 100));
      int holding = 0;
      for (const auto& t : solid.tetrahedra) holding += is_in(solid, t, x);
      ++places[std::size_t(std::min(holding, 3))];
    }
    return places;
  };
  // Each fills its part of the cube once, and nothing twice; points count along x, y, z.
  EXPECT_EQ(count_of("11", {0, 1, 2, 3, 4, 5, 6, 7})[1], 1000);
  EXPECT_EQ(count_of("12", {0, 1, 3, 2, 4, 5, 7, 6})[1], 1000);
  EXPECT_EQ(count_of("10", {0, 1, 2, 3})[0], 1000);  // four corners of a face
  const auto wedge = count_of("13", {0, 2, 1, 4, 6, 5}), pyramid = count_of("14", {0, 1, 3, 2, 4});
  EXPECT_NEAR(wedge[1], 500, 60);
  EXPECT_NEAR(pyramid[1], 333, 60);
  EXPECT_EQ(wedge[2] + wedge[3] + pyramid[2] + pyramid[3], 0);
}

std::string base64(const std::string& bytes) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t n = 0; n < bytes.size(); n += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - n);
    std::uint32_t bits = 0;
    for (std::size_t b = 0; b < 3; ++b) {
      bits = bits << 8 | (b < count ? std::uint8_t(bytes[n + b]) : 0u);
    }
    for (std::size_t d = 0; d < 4; ++d) {
      text += d <= count ? digits[bits >> (18 - 6 * d) & 63] : '=';
    }
  }
  return text;
}

/// The length of the values in front of them.
enum class LengthCoding { together, apart };

template <class Word, class T>
std::string coded(LengthCoding coding, const std::vector<T>& values) {
  const std::string length = bytes_of_value(Word(values.size() * sizeof(T)));
  const std::string bytes = bytes_of_values(values);
  return coding == LengthCoding::together ? base64(length + bytes) : base64(length) + base64(bytes);
}

template <class Word>
std::string coded_tetrahedron(LengthCoding coding, const std::string& header_type) {
  std::string text = vtu("", "", "", "", "");
  const std::size_t begin = text.find("<PointData>"), end = text.find("</Piece>");
  const auto array_of = [](const char* type, const char* name, int components,
                           const std::string& values) {
    std::string one = array(name, type, components, values);
    return one.replace(one.find("ascii"), 5, "binary");
  };
  const std::vector<double> points = {0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10};
  const std::vector<double> moved = {1, 2, 3, 1, 2, 3, 1, 2, 3, 1, 2, 3};
  text.replace(
      begin, end - begin,
      "<PointData>" + array_of("Float64", "u", 3, coded<Word>(coding, moved)) +
          "</PointData><Points>" + array_of("Float64", "p", 3, coded<Word>(coding, points)) +
          "</Points><Cells>" +
          array_of("Int64", "connectivity", 1,
                   coded<Word>(coding, std::vector<std::int64_t>{0, 1, 2, 3})) +
          array_of("Int64", "offsets", 1, coded<Word>(coding, std::vector<std::int64_t>{4})) +
          array_of("UInt8", "types", 1, coded<Word>(coding, std::vector<std::uint8_t>{10})) +
          "</Cells>");
  return text.insert(text.find("byte_order"), header_type);
}

TEST(UnitVtu, LengthsMayBeCodedApartFromTheValuesBehindThem) {
  const TemporaryFolder folder;
  for (const LengthCoding coding : {LengthCoding::together, LengthCoding::apart}) {
    write_text(folder / "a.vtu", coded_tetrahedron<std::uint32_t>(coding, ""));
    write_text(folder / "b.vtu",
               coded_tetrahedron<std::uint64_t>(coding, "header_type=\"UInt64\" "));
    for (const char* name : {"a.vtu", "b.vtu"}) {
      const MovedSolid solid = read_vtu(folder / name);
      ASSERT_EQ(solid.points_lps_mm.size(), 4u) << name;
      EXPECT_EQ(solid.points_lps_mm[1], Vec3d(10, 0, 0));
      EXPECT_EQ(solid.moved_mm[3], Vec3d(1, 2, 3));
      EXPECT_EQ(solid.tetrahedra.size(), 1u);
    }
  }
}

class Heard : public Progress {
 public:
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return false; }
  void warn(const std::string& line) override { lines.push_back(line); }
  std::vector<std::string> lines;
};

TEST(UnitVtu, CellsThatTheirMotionTurnsInsideOutAreWarnedOf) {
  const TemporaryFolder folder;
  const auto warnings = [&](const std::string& u) {
    const std::string corners = "0 0 0 10 0 0 0 10 0 0 0 10 0 0 0 0 0 0 0 0 0 0 0 0";
    write_text(folder / "a.vtu", vtu(corners, array("u", "Float64", 3, u), "0 1 2 3", "4", "10"));
    Heard heard;
    read_warp(folder / "a.vtu", &heard, &kAround);
    return heard.lines;
  };
  const std::string rest = " 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0";
  EXPECT_TRUE(warnings("0 0 0 -5 0 0" + rest).empty());
  const auto lines = warnings("0 0 0 -20 0 0" + rest);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NE(lines[0].find("1 of 1 tetrahedra"), std::string::npos) << lines[0];
  EXPECT_NE(lines[0].find("inside out"), std::string::npos) << lines[0];
}

TEST(FaultVtu, WhatIsNoMovedSolidNamesFileAndField) {
  const TemporaryFolder folder;
  const auto expect_field = [&](const std::string& content, const std::string& field) {
    write_text(folder / "a.vtu", content);
    const std::string line = input_error([&] { read_vtu(folder / "a.vtu"); });
    EXPECT_NE(line.find("a.vtu: " + field), std::string::npos) << line << " for " << field;
  };
  const std::string good = cube("u");
  write_text(folder / "a.vtu", good);
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string changed = good;
    const std::size_t at = changed.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return changed.replace(at, from.size(), to);
  };
  EXPECT_EQ(read_vtu(folder / "a.vtu").tetrahedra.size(), 6u);
  expect_field(good.substr(0, good.size() / 2), "XML");
  expect_field(with("Name=\"u\"", "Name=\"v\""), "PointData");
  expect_field(with("6 7</Data", "6 8</Data"), "connectivity");
  expect_field(with("12</Data", "9</Data"), "Cells");
  expect_field(with(">8</Data", ">9</Data"), "offsets");
  expect_field(with("-10.000000", "nan"), "DataArray Points");
  expect_field(with("-10.000000", "x"), "DataArray Points");
  std::string coded = good;
  for (std::size_t at = 0; (at = coded.find("ascii", at)) != std::string::npos;) {
    coded.replace(at, 5, "binary");
  }
  expect_field(coded, "DataArray Points");  // numbers are no base64
  write_text(folder / "a.vtu", good);
  EXPECT_NE(input_error([&] { read_warp(folder / "a.vtu"); }).find("grid"), std::string::npos);
}

TEST(FaultVtu, BlocksThatTheFileIsTooShortForTakeNoMemory) {
  const TemporaryFolder folder;
  std::string claims = cube("u");
  const std::string head = "version=\"0.1\"";
  claims.insert(claims.find(head), "compressor=\"vtkZLibDataCompressor\" ");
  const std::size_t begin = claims.find("ascii\">", claims.find("Name=\"Points\""));
  const std::size_t end = claims.find("</DataArray>", begin);
  // 2^28 - 1 blocks of 32 kB.
  claims.replace(begin, end - begin, "binary\">////DwCAAAAAAAAA");
  write_text(folder / "a.vtu", claims);
  rusage before, after;
  getrusage(RUSAGE_SELF, &before);
  const std::string line = input_error([&] { read_vtu(folder / "a.vtu"); });
  getrusage(RUSAGE_SELF, &after);
  EXPECT_NE(line.find("DataArray Points: found 16 characters"), std::string::npos) << line;
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 100 << 10);  // kB
}

const std::string kItkHead = "#Insight Transform File V1.0\n#Transform 0\n";

/// Neither commutes with the other.
TEST(PropertyCompose, TheLastTransformIsAppliedFirstAsInAComposite) {
  const TemporaryFolder folder;
  const std::string turn =
      "Transform: AffineTransform_double_3_3\nParameters: 0 -1 0 1 0 0 0 0 1 5 0 2\n"
      "FixedParameters: 0 0 0\n";
  const std::string scale =
      "Transform: AffineTransform_double_3_3\nParameters: 2 0 0 0 1 0 0 0 1 0 7 0\n"
      "FixedParameters: 0 0 0\n";
  write_text(folder / "turn.tfm", kItkHead + turn);
  write_text(folder / "scale.tfm", kItkHead + scale);
  write_text(folder / "both.tfm", kItkHead +
                                      "Transform: CompositeTransform_double_3_3\n#Transform 1\n" +
                                      turn + "#Transform 2\n" + scale);
  const auto composed = [&](const char* first, const char* second) {
    std::vector<TransformChain> chains;
    chains.push_back(read_transform(folder / first));
    chains.push_back(read_transform(folder / second));
    return compose(std::move(chains));
  };
  const TransformChain both = read_transform(folder / "both.tfm");
  const Vec3d x(3, -4, 11);
  EXPECT_LT((composed("turn.tfm", "scale.tfm").at(x) - Vec3d(-3 + 5, 6, 13)).length(), 1e-12);
  EXPECT_LT((composed("turn.tfm", "scale.tfm").at(x) - both.at(x)).length(), 1e-12);
  EXPECT_GT((composed("scale.tfm", "turn.tfm").at(x) - both.at(x)).length(), 1);
}

}  // namespace
}  // namespace supple::test
