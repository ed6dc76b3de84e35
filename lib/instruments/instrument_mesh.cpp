// Surfaces of instruments: sections along the balls of which the parts are made, so that pictures
// show what touches. Bevel and port are pressed into them.
#include <algorithm>
#include <cmath>

#include "lib/instruments/instrument.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kSides = 28, kJawSides = 18;  // of a section
constexpr int kCapRows = 5;                 // of a round end
constexpr int kPathRows = 24;               // of all pieces between balls but the last
constexpr int kLastRows = 12;               // of the last, dense at its begin
constexpr int kPortRows = 14;               // across a port

/// An ellipse across the shaft: half axes along x, or what stands for it, and along `up`.
struct Section {
  Vec3d centre_mm, up;
  double x_mm, y_mm;
  Vec3d across{1, 0, 0};
};

std::vector<double> even_angles(int sides = kSides) {
  std::vector<double> angles;
  for (int n = 0; n < sides; ++n) angles.push_back(2 * kPi * n / sides);
  return angles;
}

/// A closed surface: sections from the tip to the hand, joined, with a fan at both ends.
TriangleMesh skin(const std::vector<Section>& sections, const std::vector<double>& angles) {
  TriangleMesh mesh;
  const int sides = int(angles.size()), rows = int(sections.size());
  for (const Section& s : sections) {
    for (const double angle : angles) {
      mesh.vertices_lps_mm.push_back(s.centre_mm + s.across * (s.x_mm * std::cos(angle)) +
                                     s.up * (s.y_mm * std::sin(angle)));
    }
  }
  const auto at = [&](int row, int side) { return row * sides + side % sides; };
  for (int row = 0; row + 1 < rows; ++row) {
    for (int n = 0; n < sides; ++n) {
      mesh.triangles.push_back({at(row, n), at(row, n + 1), at(row + 1, n + 1)});
      mesh.triangles.push_back({at(row, n), at(row + 1, n + 1), at(row + 1, n)});
    }
  }
  const int tip = rows * sides, hand = tip + 1;
  mesh.vertices_lps_mm.push_back(sections.front().centre_mm);
  mesh.vertices_lps_mm.push_back(sections.back().centre_mm);
  for (int n = 0; n < sides; ++n) {
    mesh.triangles.push_back({tip, at(0, n + 1), at(0, n)});
    mesh.triangles.push_back({hand, at(rows - 1, n), at(rows - 1, n + 1)});
  }
  return mesh;
}

struct AxisBall {
  Vec3d centre_mm;
  double radius_mm;
};

std::vector<AxisBall> balls_of(const Instrument& tool, int jaw) {
  std::vector<AxisBall> balls;
  for (const InstrumentPart& part : tool.parts) {
    if (part.jaw != jaw) continue;
    if (balls.empty()) balls.push_back({part.shape.a_mm, part.shape.a_radius_mm});
    balls.push_back({part.shape.b_mm, part.shape.b_radius_mm});
  }
  return balls;
}

/// Slope of the path at a ball: that of the parabola through it and its neighbours, at the shaft's
/// ends that of the shaft.
Vec3d slope_at(const std::vector<AxisBall>& balls, std::size_t n) {
  const auto piece = [&](std::size_t k) { return balls[k + 1].centre_mm - balls[k].centre_mm; };
  if (n == 0) return piece(0).normalized();
  if (n + 2 >= balls.size()) return piece(balls.size() - 2).normalized();
  const double before = piece(n - 1).length(), after = piece(n).length();
  return (piece(n - 1) * (after / before) + piece(n) * (before / after)) / (before + after);
}

/// Sections along balls by Hermite's cubics, with a round end at the tip; `wide` and `high` are
/// their half axes per radius.
std::vector<Section> sections_along(const std::vector<AxisBall>& balls, double wide, double high) {
  std::vector<Section> sections;
  const auto add = [&](const Vec3d& centre, const Vec3d& slope, double radius) {
    const Vec3d up = slope.normalized().cross(Vec3d(1, 0, 0)).normalized();
    sections.push_back({centre, up, radius * wide, radius * high});
  };
  const Vec3d first = slope_at(balls, 0);
  for (int n = 1; n < kCapRows; ++n) {
    const double angle = kPi / 2 * n / kCapRows, r = balls[0].radius_mm;
    add(balls[0].centre_mm - first * (r * std::cos(angle)), first, r * std::sin(angle));
  }
  for (std::size_t k = 0; k + 1 < balls.size(); ++k) {
    const Vec3d &a = balls[k].centre_mm, &b = balls[k + 1].centre_mm;
    const double length = (b - a).length();
    const Vec3d va = slope_at(balls, k) * length, vb = slope_at(balls, k + 1) * length;
    const bool is_last = k + 2 == balls.size();
    const int rows = is_last ? kLastRows : kPathRows / int(balls.size() - 2);
    for (int n = 0; n < rows + (is_last ? 1 : 0); ++n) {
      const double even = double(n) / rows;
      const double t = is_last ? even * even : even, u = 1 - t;
      const Vec3d centre = a * (u * u * (1 + 2 * t)) + va * (u * u * t) +
                           b * (t * t * (1 + 2 * u)) - vb * (t * t * u);
      const Vec3d slope = (b - a) * (6 * t * u) + va * (u * (u - 2 * t)) + vb * (t * (t - 2 * u));
      add(centre, slope, balls[k].radius_mm + (balls[k + 1].radius_mm - balls[k].radius_mm) * t);
    }
  }
  return sections;
}

/// Flattens the cone of a needle obliquely and presses its bore into the flat.
void press_bevel(TriangleMesh& mesh, const Instrument& tool) {
  const double r = tool.parts.back().shape.b_radius_mm;
  const double rise = r / (1.5 * tool.parts.front().shape.b_mm.z);  // of the flat along the needle
  for (Vec3d& v : mesh.vertices_lps_mm) {
    const double flat = v.z * rise;
    if (v.y <= flat) continue;
    const double across = v.x / (0.45 * r), along = (v.z - 5 * r) / (1.2 * r);
    v.y = flat - (across * across + along * along < 1 ? 0.7 * r : 0);
  }
}

/// Angles and rows that are dense at the port, whose vertices go inwards.
TriangleMesh skin_with_port(const Instrument& tool) {
  const SuctionPort& port = *tool.port;
  const double r = tool.parts.front().shape.a_radius_mm, middle = port.centre_mm.z;
  std::vector<double> angles;
  for (int n = 0; n < kSides / 2; ++n)
    angles.push_back(kPi * (0.175 + 0.65 * (n + 0.5) * 2 / kSides));
  for (int n = 0; n < kSides / 2; ++n) {
    angles.push_back(kPi * (0.5 + 0.325 + (n + 0.5) * 2 / kSides * 1.35));
  }
  const std::vector<Section> ends = sections_along(balls_of(tool, 0), 1, 1);
  std::vector<Section> sections(ends.begin(), ends.begin() + kCapRows);
  const double reach = 1.25 * port.radius_mm;
  for (int n = 0; n <= kPortRows; ++n) {
    sections.push_back({{0, 0, middle - reach + 2 * reach * n / kPortRows}, {0, 1, 0}, r, r});
  }
  for (const Section& s : ends) {
    if (s.centre_mm.z > middle + 1.5 * reach) sections.push_back(s);
  }
  TriangleMesh mesh = skin(sections, angles);
  for (Vec3d& v : mesh.vertices_lps_mm) {
    const double along = (v.z - middle) / port.radius_mm, across = v.x / port.radius_mm;
    if (v.y > 0 && along * along + across * across < 1) v.y -= 1.1 * r;
  }
  return mesh;
}

/// A blade with a round front that becomes the shaft.
TriangleMesh skin_of_blade(const Instrument& tool) {
  const RoundCone& shaft = tool.parts.back().shape;
  const double r = shaft.b_radius_mm, root = shaft.a_mm.z, thin = 0.3 * r;
  std::vector<Section> sections;
  for (int n = 0; n <= kPathRows; ++n) {
    const double t = double(n) / kPathRows, z = root * t * t;
    const double front = std::min(1.0, z / (2 * r)), neck = std::max(0.0, (t - 0.6) / 0.4);
    const double wide = 2 * r * std::sqrt(std::max(0.01, 1 - (1 - front) * (1 - front)));
    const double ease = neck * neck * (3 - 2 * neck);
    const double high = thin * std::sqrt(std::min(1.0, 0.1 + z / thin));
    sections.push_back({{0, 0, z}, {0, 1, 0}, wide + (r - wide) * ease, high + (r - high) * ease});
  }
  for (int n = 1; n <= kLastRows; ++n) {
    const double z = root + (shaft.b_mm.z - root) * n / kLastRows;
    sections.push_back({{0, 0, z}, {0, 1, 0}, r, r});
  }
  return skin(sections, even_angles());
}

TriangleMesh shaft_of(const Instrument& tool) {
  if (tool.port) return skin_with_port(tool);
  if (tool.kind == InstrumentKind::spatula) return skin_of_blade(tool);
  TriangleMesh mesh = skin(sections_along(balls_of(tool, 0), 1, 1), even_angles());
  if (tool.kind == InstrumentKind::needle) press_bevel(mesh, tool);
  return mesh;
}

/// The surface of a round cone: two caps that go on into its side where that touches their balls.
TriangleMesh skin_of_cone(const RoundCone& cone) {
  const Vec3d along = cone.b_mm - cone.a_mm;
  const double length = along.length();
  const Vec3d axis = length > 0 ? along / length : Vec3d(0, 0, 1);
  const Vec3d across = axis.cross(std::abs(axis.z) < 0.7 ? Vec3d(0, 0, 1) : Vec3d(1, 0, 0));
  const Vec3d x = across.normalized(), up = axis.cross(x);
  const double taper = cone.a_radius_mm - cone.b_radius_mm;
  const double edge =
      std::abs(taper) < length ? std::asin(taper / length) : std::copysign(kPi / 2, taper);
  std::vector<Section> sections;
  const auto add_cap = [&](const Vec3d& centre, double radius, double from, double to) {
    for (int n = 0; n <= kCapRows; ++n) {
      const double angle = from + (to - from) * n / kCapRows;
      const double wide = radius * std::cos(angle);
      sections.push_back({centre + axis * (radius * std::sin(angle)), up, wide, wide, x});
    }
  };
  add_cap(cone.a_mm, cone.a_radius_mm, -0.49 * kPi, edge);
  add_cap(cone.b_mm, cone.b_radius_mm, edge, 0.49 * kPi);
  return skin(sections, even_angles());
}

}  // namespace

std::vector<InstrumentMesh> meshes_of(const Instrument& instrument) {
  if (instrument.kind == InstrumentKind::parts) {
    std::vector<InstrumentMesh> own;
    for (const InstrumentPart& part : instrument.parts) {
      own.push_back({skin_of_cone(part.shape), part.jaw});
    }
    return own;
  }
  std::vector<InstrumentMesh> meshes = {{shaft_of(instrument), 0}};
  for (const int jaw : {1, -1}) {
    const std::vector<AxisBall> balls = balls_of(instrument, jaw);
    if (balls.empty()) continue;
    meshes.push_back({skin(sections_along(balls, 1.5, 1), even_angles(kJawSides)), jaw});
  }
  return meshes;
}

}  // namespace supple
