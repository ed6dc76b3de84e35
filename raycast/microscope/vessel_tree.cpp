#include "raycast/microscope/vessel_tree.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr double kThinnestMm = 0.011;
constexpr int kMostLevels = 5;
constexpr double kFoveaFreeMm = 0.75;  // no vessel comes nearer to the fovea

/// Ways in which a vessel is steered.
enum class Course { arcade, to_fovea, outwards };

struct Vessel {
  double x, y, heading, radius_mm;
  double straight_mm;  // before it is steered
  bool is_artery;
  Course course;
  int level;
};

class VesselPainter {
 public:
  VesselPainter(int size, std::uint64_t seed) : m_random(seed) {
    m_maps.size = size;
    m_maps.texels_per_mm = size / (2 * kPi * RetinaPlan::kGlobeMm);
    const std::size_t count = std::size_t(size) * size;
    m_maps.veins.assign(count, 0);
    m_maps.arteries.assign(count, 0);
    m_maps.reflexes.assign(count, 0);
  }
  void grow(Vessel vessel);
  /// A number from `least` to `most`; the same on every machine.
  double between(double least, double most) {
    return least + (most - least) * double(m_random() >> 11) * 0x1p-53;
  }
  VesselMaps take() { return std::move(m_maps); }

 private:
  void stamp(const Vessel& vessel);
  void stamp(double x_mm, double y_mm, double radius_texels, float most, std::vector<float>& map);
  void branch(Vessel& parent, double side);

  std::mt19937_64 m_random;
  VesselMaps m_maps;
};

void VesselPainter::stamp(double x_mm, double y_mm, double radius_texels, float most,
                          std::vector<float>& map) {
  const int size = m_maps.size;
  const double u = size / 2.0 + x_mm * m_maps.texels_per_mm - 0.5;
  const double v = size / 2.0 - y_mm * m_maps.texels_per_mm - 0.5;
  const double reach = radius_texels + 1;
  for (int row = std::max(int(v - reach), 0); row <= std::min(int(v + reach) + 1, size - 1);
       ++row) {
    for (int column = std::max(int(u - reach), 0); column <= std::min(int(u + reach) + 1, size - 1);
         ++column) {
      const double away = std::hypot(column - u, row - v);
      const double cover = std::clamp((radius_texels + 0.7 - away) / 1.4, 0.0, 1.0) *
                           std::min(2 * radius_texels, 1.0);
      float& texel = map[std::size_t(row) * size + column];
      texel = std::max(texel, float(cover) * most);
    }
  }
}

void VesselPainter::stamp(const Vessel& vessel) {
  const double radius = vessel.radius_mm * m_maps.texels_per_mm;
  stamp(vessel.x, vessel.y, radius, 1, vessel.is_artery ? m_maps.arteries : m_maps.veins);
  if (vessel.is_artery && vessel.radius_mm > 0.03) {
    stamp(vessel.x, vessel.y, radius * 0.22, 1, m_maps.reflexes);
  }
}

/// The direction in which a vessel wants to go.
double wanted_heading(const Vessel& vessel) {
  const double from_disc_x = vessel.x - RetinaPlan::kDiscX,
               from_disc_y = vessel.y - RetinaPlan::kDiscY;
  const double from_fovea_x = vessel.x - RetinaPlan::kFoveaX;
  const double from_fovea_y = vessel.y - RetinaPlan::kFoveaY;
  switch (vessel.course) {
    case Course::arcade:  // along parabolas that open to both sides of the disc
      return std::atan2(from_disc_y, 2 * from_disc_x);
    case Course::to_fovea:
      return std::atan2(-from_fovea_y, -from_fovea_x);
    default:
      return std::atan2(from_fovea_y, from_fovea_x);
  }
}

double turned_to(double heading, double wanted, double part) {
  return heading + part * std::remainder(wanted - heading, 2 * kPi);
}

void VesselPainter::branch(Vessel& parent, double side) {
  Vessel child = parent;
  child.heading += side * between(0.45, 0.95);
  child.radius_mm *= between(0.5, 0.75);
  child.straight_mm = between(0.2, 0.5);
  child.level = parent.level + 1;
  if (parent.course == Course::arcade) {
    const bool is_temporal = parent.x < RetinaPlan::kDiscX - 0.5;
    const bool is_inner = side * parent.y > 0 && parent.x > -5;
    child.course = is_temporal && is_inner ? Course::to_fovea : Course::outwards;
  }
  parent.radius_mm *= between(0.90, 0.97);
  grow(child);
}

void VesselPainter::grow(Vessel vessel) {
  const double step = 0.4 / m_maps.texels_per_mm;
  const double wave = between(1.6, 3.4), phase = between(0, 2 * kPi);
  const double swing = (vessel.is_artery ? 0.22 : 0.38) * between(0.6, 1.2);
  double way = 0, next_branch = vessel.level == 0 ? between(1.3, 2.2) : between(0.8, 1.8);
  double side = between(0, 1) < 0.5 ? 1 : -1;
  const double longest = vessel.level == 0 ? 40 : between(2.5, 9) * std::pow(0.8, vessel.level);
  while (way < longest && vessel.radius_mm > kThinnestMm) {
    stamp(vessel);
    const double heading = vessel.heading + swing * std::sin(2 * kPi * way / wave + phase);
    vessel.x += step * std::cos(heading);
    vessel.y += step * std::sin(heading);
    way += step;
    const double from_fovea =
        std::hypot(vessel.x - RetinaPlan::kFoveaX, vessel.y - RetinaPlan::kFoveaY);
    if (from_fovea > RetinaPlan::kEdge || from_fovea < kFoveaFreeMm) return;
    if (way > vessel.straight_mm) {
      const double rate = vessel.course == Course::arcade ? 2.2 : 0.35;  // per mm
      vessel.heading = turned_to(vessel.heading, wanted_heading(vessel), rate * step);
    }
    vessel.radius_mm *= 1 - (vessel.level == 0 ? 0.022 : 0.09) * step;
    if (way < next_branch || vessel.level + 1 >= kMostLevels) continue;
    next_branch = way + between(0.8, 2.1);
    side = -side;
    branch(vessel, side);
  }
}

struct Trunk {
  double x, y;  // where it begins to turn, mm from the disc's middle
  double radius_mm;
  bool is_artery;
};

constexpr Trunk kTrunks[] = {
    {-0.62, 1.55, 0.094, false}, {-0.58, -1.55, 0.096, false}, {0.55, 1.35, 0.070, false},
    {0.60, -1.30, 0.068, false}, {-0.88, 1.50, 0.066, true},   {-0.84, -1.50, 0.067, true},
    {0.95, 1.10, 0.050, true},   {1.00, -1.05, 0.050, true},
};

}  // namespace

VesselMaps paint_vessels(int size, std::uint64_t seed) {
  VesselPainter painter(size, seed);
  for (const Trunk& trunk : kTrunks) {
    const double from_x = 0.06 + 0.14 * trunk.x + painter.between(-0.03, 0.03);
    const double from_y = 0.1 * trunk.y + painter.between(-0.05, 0.05);
    const double out_x = trunk.x + painter.between(-0.05, 0.05);
    Vessel vessel{RetinaPlan::kDiscX + from_x,
                  RetinaPlan::kDiscY + from_y,
                  std::atan2(trunk.y - from_y, out_x - from_x),
                  trunk.radius_mm,
                  std::hypot(trunk.y - from_y, out_x - from_x),
                  trunk.is_artery,
                  Course::arcade,
                  0};
    painter.grow(vessel);
  }
  return painter.take();
}

}  // namespace supple
