#include "tools/lab/bench/elastic/error_bodies.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "lib/body/slot_set.h"
#include "tools/lab/bench/bodies/block_topology.h"

namespace supple::tools {

namespace {

/// Class of a voxel: none (-1), soft, stiff, or stiffer.
using ClassOf = std::function<int(const Vec3i&)>;
constexpr int kNone = -1, kSoftTissue = 0, kStiffTissue = 1, kStifferTissue = 2, kRandomClasses = 6;
constexpr double kRatios[] = {0.3, 0.45, 0.48, 0.49, 0.495, 0.499};

class Dice {
 public:
  explicit Dice(unsigned seed) : m_random(seed) { m_random.discard(20); }

  double in(double lo, double hi) { return lo + (hi - lo) * double(m_random()) / 0x1p32; }
  int whole(int lo, int hi) { return lo + int(m_random() % unsigned(hi - lo + 1)); }
  double decades(double lo, double hi) { return lo * std::pow(hi / lo, in(0, 1)); }
  double ratio() { return kRatios[whole(0, 5)]; }
  Vec3d inside(const Vec3i& size) {
    const double x = in(0, size.x), y = in(0, size.y), z = in(0, size.z);
    return {x, y, z};
  }
  Vec3d direction() {
    const double height = in(-1, 1), turn = in(0, 2 * M_PI), width = std::sqrt(1 - height * height);
    return {width * std::cos(turn), width * std::sin(turn), height};
  }

 private:
  std::mt19937 m_random;
};

/// A number from 0 to 1 per voxel.
double noise_at(const Vec3i& voxel) {
  std::uint32_t h = std::uint32_t(voxel.x) * 0x9e3779b1u ^ std::uint32_t(voxel.y) * 0x85ebca77u ^
                    std::uint32_t(voxel.z) * 0xc2b2ae3du;
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return double(h ^ (h >> 16)) / 0x1p32;
}

/// Place from the middle, 1 at the ends of each axis.
Vec3d from_middle(const Vec3i& voxel, const Vec3i& size) {
  const Vec3d middle = (Vec3d(size) - Vec3d(1)) / 2.0;
  return (Vec3d(voxel) - middle) / middle;
}

Vec3i size_of(const std::string& kind, Dice& dice) {
  if (kind == "plate") return Vec3i(dice.whole(20, 40), dice.whole(20, 40), dice.whole(1, 4));
  if (kind == "bar") return Vec3i(dice.whole(30, 80), dice.whole(3, 8), dice.whole(3, 8));
  return Vec3i(dice.whole(16, 28), dice.whole(16, 28), dice.whole(16, 28));
}

ClassOf mixed_tissue(const std::string& kind, const Vec3i& size, Dice& dice) {
  if (kind == "inclusions") {
    std::vector<std::pair<Vec3d, double>> balls(std::size_t(dice.whole(2, 14)));
    for (auto& [middle, radius] : balls) {
      middle = dice.inside(size);
      radius = dice.in(1.5, 0.25 * size.x);
    }
    return [=](const Vec3i& voxel) {
      const auto has = [&](const auto& ball) {
        return (Vec3d(voxel) - ball.first).length() < ball.second;
      };
      return std::any_of(balls.begin(), balls.end(), has) ? kStiffTissue : kSoftTissue;
    };
  }
  if (kind == "random") {
    const int edge = dice.whole(2, 5);
    return [=](const Vec3i& voxel) {
      const double noise = noise_at(voxel / edge);
      return noise < 0.15 && voxel.x > 2 ? kNone : int(noise * 20) % kRandomClasses;
    };
  }
  const int edge = kind == "bar" ? 3 : 1;
  const double share = kind == "plate" ? dice.in(0, 0.3) : dice.in(0.05, 0.6);
  return [=](const Vec3i& voxel) {
    return noise_at(voxel / edge) < share ? kStiffTissue : kSoftTissue;
  };
}

ClassOf curved_tissue(const std::string& kind, const Vec3i& size, Dice& dice) {
  if (kind == "shell") {
    const double inner = dice.in(0.65, 0.9);
    return [=](const Vec3i& voxel) {
      const double radius = from_middle(voxel, size).length();
      return radius > 1 ? kNone : radius > inner ? kStiffTissue : kSoftTissue;
    };
  }
  if (kind == "foam") {
    const Vec3d rate(dice.in(0.3, 0.7), dice.in(0.3, 0.7), dice.in(0.3, 0.7));
    const double level = dice.in(-0.4, 0.8);
    return [=](const Vec3i& voxel) {
      const Vec3d at = rate * Vec3d(voxel);
      const double gyroid = std::sin(at.x) * std::cos(at.y) + std::sin(at.y) * std::cos(at.z) +
                            std::sin(at.z) * std::cos(at.x);
      return gyroid > level ? kNone : gyroid > level - 0.3 ? kStiffTissue : kSoftTissue;
    };
  }
  if (kind == "gyri") {
    const double rate = dice.in(0.4, 0.9), depth = dice.in(0.05, 0.25);
    return [=](const Vec3i& voxel) {
      const double fold = std::sin(rate * voxel.x) * std::sin(1.1 * rate * voxel.y) *
                          std::sin(0.9 * rate * voxel.z);
      const double radius = from_middle(voxel, size).length() + depth * fold;
      return radius > 0.95 ? kNone : radius > 0.75 ? kStiffTissue : kSoftTissue;
    };
  }
  const double skin = dice.in(0.75, 0.9), bone = dice.in(0.1, 0.2), jaw = dice.in(0.2, 0.5);
  return [=](const Vec3i& voxel) {
    const Vec3d at = from_middle(voxel, size);
    const double radius = at.length();
    if (radius > 1) return kNone;
    if (at.y > 0.2 && at.z < -jaw)
      return std::abs(radius - 0.7) < 0.1 ? kStifferTissue : kSoftTissue;
    return radius > skin || radius < skin - bone ? kSoftTissue : kStiffTissue;
  };
}

ClassOf class_of_kind(const std::string& kind, const Vec3i& size, Dice& dice) {
  if (kind != "layers") {
    const bool is_curved = kind == "shell" || kind == "foam" || kind == "gyri" || kind == "skull";
    return is_curved ? curved_tissue(kind, size, dice) : mixed_tissue(kind, size, dice);
  }
  const int every = dice.whole(2, 8), depth = dice.whole(4, 9);
  const bool has_gaps = dice.in(0, 1) < 0.5;
  return [=](const Vec3i& voxel) {
    if (voxel.z % every == 0) return kStiffTissue;
    return has_gaps && voxel.z % every == 1 && voxel.x > depth ? kNone : kSoftTissue;
  };
}

Body body_of_classes(const Vec3i& size, double height_mm, const ClassOf& class_of) {
  Body body;
  body.geometry =
      Geometry(size, {0, 0, 0}, {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, height_mm)});
  body.elements = largest_components(
      block_topology(size, [&](const Vec3i& voxel) { return class_of(voxel) != kNone; }), 1);
  body.material = parse_material(
      "domain = [0, 255]\nmax_length = [[0, 1.5]]\n"
      "min_length = [[0, 0.6]]\nshear = [[0, 0.25]]\n",
      "error bodies");
  body.slacks = SlackTable(body.material, body.geometry.spacing_mm());
  body.links_known_valid = true;
  body.classes.assign(slot_count(body.elements), 0);
  for_each_element(body.elements, [&](Slot slot) {
    body.classes[slot] = std::uint8_t(class_of(voxel_of(body.elements, slot)));
  });
  return body;
}

/// The elements of a box around the element that is nearest to a place.
SlotSet elements_near(const Body& body, const Vec3d& place, int edge) {
  double least = 1e300;
  Vec3i nearest(0);
  for_each_element(body.elements, [&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const double distance = (Vec3d(voxel) - place).length();
    if (distance < least) nearest = voxel;
    least = std::min(least, distance);
  });
  return slots_in_box(body.elements, {nearest - Vec3i(edge / 2), nearest + Vec3i((edge - 1) / 2)});
}

void hold(SlotSet elements, const Vec3d& moved_mm, FemLoads& loads) {
  HeldElements& held = loads.held.emplace_back();
  held.elements = std::move(elements);
  held.displacement_mm = [=](const Vec3d&) { return moved_mm; };
}

void load(const std::string& kind, int number, Dice& dice, const Body& body, FemLoads& loads) {
  const IndexBox& bounds = body.elements.active_bounds();
  const Vec3i size = bounds.hi + Vec3i(1);
  const int axis = kind == "plate" || kind == "bar" || kind == "layers" ? 0 : 2;
  IndexBox near = bounds, far = bounds;
  near.hi[axis] = bounds.lo[axis];
  far.lo[axis] = bounds.hi[axis];
  hold(slots_in_box(body.elements, near), Vec3d(0.0), loads);
  const int way = number % 5;
  if (way == 0) hold(slots_in_box(body.elements, far), dice.direction() * 3.0, loads);
  for (int handle = 0; handle < (way == 1 ? 1 : way == 2 ? 2 : 0); ++handle) {
    const Vec3d moved_mm = dice.direction() * dice.in(0.5, 6);
    hold(elements_near(body, dice.inside(size), dice.whole(1, 5)), moved_mm, loads);
  }
  if (way == 3) {
    const Vec3d force_n = dice.direction() * 1e-3;
    loads.forces.push_back({elements_near(body, dice.inside(size), dice.whole(1, 5)), force_n});
  } else if (way == 4) {
    loads.gravity_m_s2 = dice.direction() * 9.81;
    loads.mass_density.fill(1000);
  }
}

}  // namespace

const std::vector<std::string>& error_kinds() {
  static const std::vector<std::string> kinds = {
      "noise", "inclusions", "shell", "plate", "foam", "gyri", "bar", "skull", "layers", "random"};
  return kinds;
}

FemProblem error_problem(const std::string& kind, int number) {
  const auto& kinds = error_kinds();
  const auto place = std::find(kinds.begin(), kinds.end(), kind) - kinds.begin();
  Dice dice(unsigned(7919 * number + 17 + place));
  const double contrast = dice.decades(2, 1e5), height_mm = number % 3 == 2 ? dice.in(1, 2.5) : 1;
  const Vec3i size = size_of(kind, dice);
  FemProblem problem{body_of_classes(size, height_mm, class_of_kind(kind, size, dice)),
                     ElasticTable::uniform(1, dice.ratio()),
                     {}};
  const auto set = [&](int of, double young_kpa, double poisson) {
    problem.elastic.young_kpa[std::size_t(of)] = young_kpa;
    problem.elastic.poisson[std::size_t(of)] = poisson;
  };
  set(kStiffTissue, contrast, 0.3);
  set(kStifferTissue, 2 * contrast, 0.3);
  if (kind == "random") {
    for (int of = 1; of < kRandomClasses; ++of) {
      const double young_kpa = dice.decades(0.3, contrast);
      set(of, young_kpa, dice.ratio());
    }
  }
  load(kind, number, dice, problem.body, problem.loads);
  return problem;
}

}  // namespace supple::tools
