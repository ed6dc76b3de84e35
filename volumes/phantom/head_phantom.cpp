// A head in Hounsfield units, laid out like the demo's head CT, so that the same scene works on it:
// skin, fat and muscle, a skull with vault, base, orbits, cheek bones and jaws with teeth, airways
// and sinuses, a brain with ventricles, and a headrest that does not touch the head.
//
// Every structure is a signed distance (mm, negative inside) painted over what lies beneath it with
// a soft edge of one voxel, as partial volume does in a scanner. The distances of ellipsoids are
// first-order approximations, good near their surface. Cost: about 0.5 µs per voxel.
#include <algorithm>
#include <cmath>

#include "volumes/phantom/phantom.h"

namespace supple {

namespace {

// Position in mm: x to the patient's left, y anterior, z superior; the origin lies at voxel
// (128, 118, 0) of a 256 x 256 x 108 grid.
using Pos = Vec3d;

namespace hu {
constexpr double kAir = -1000, kSkin = 30, kFat = -95, kMuscle = 55, kCortical = 1350,
                 kDiploe = 550, kSpongy = 750, kJaw = 1100, kTooth = 1900, kCartilage = 220,
                 kWater = 6, kGrey = 39, kWhite = 29, kEye = 18, kLens = 75, kHeadrest = 260;
}  // namespace hu

double ellipsoid(const Pos& p, const Pos& center, const Pos& radii) {
  const Pos q = (p - center) / radii;
  const double steepness = (q / radii).length();
  const double k = q.length();
  return steepness > 1e-9 ? k * (k - 1) / steepness : -std::min({radii.x, radii.y, radii.z});
}

double capsule(const Pos& p, const Pos& a, const Pos& b, double radius) {
  const Pos axis = b - a;
  const double along = std::clamp((p - a).dot(axis) / axis.dot(axis), 0.0, 1.0);
  return (p - a - axis * along).length() - radius;
}

double box(const Pos& p, const Pos& center, const Pos& half) {
  const Pos d(std::abs(p.x - center.x) - half.x, std::abs(p.y - center.y) - half.y,
              std::abs(p.z - center.z) - half.z);
  const Pos outside(std::max(d.x, 0.0), std::max(d.y, 0.0), std::max(d.z, 0.0));
  return outside.length() + std::min(std::max({d.x, d.y, d.z}), 0.0);
}

/// Union with a fillet of about `blend` mm.
double smooth_union(double a, double b, double blend) {
  const double h = std::clamp(0.5 + 0.5 * (b - a) / blend, 0.0, 1.0);
  return b + (a - b) * h - blend * h * (1 - h);
}

double smooth_step(double value, double from, double to) {
  const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Density at one point, structure by structure.
class Painter {
 public:
  void paint(double distance, double density) {
    constexpr double kEdge = 1.4;
    const double coverage = std::clamp(0.5 - distance / kEdge, 0.0, 1.0);
    m_density += (density - m_density) * coverage;
  }
  double density() const { return m_density; }

 private:
  double m_density = hu::kAir;
};

const Pos kVaultCenter(0, 0, 79);
const Pos kVaultRadii(70, 86, 73);

double vault(const Pos& p, double inwards) {
  return ellipsoid(p, kVaultCenter, kVaultRadii - Pos(inwards));
}

/// Height of the skull base: high over the orbits, deep behind the ear canals.
double base_height(const Pos& p) {
  return 26 + 24 * smooth_step(p.y, -22, 2) + 22 * smooth_step(p.y, 24, 48);
}

/// Outer surface of the head: cranium, face, chin, nose, ears and neck.
double head_surface(const Pos& p) {
  const Pos mirrored(std::abs(p.x), p.y, p.z);
  double d = ellipsoid(p, kVaultCenter, kVaultRadii + Pos(6, 7, 7));
  d = smooth_union(d, ellipsoid(p, {0, 38, 26}, {60, 60, 62}), 18);
  d = smooth_union(d, ellipsoid(p, {0, 62, 2}, {38, 37, 26}), 12);
  d = smooth_union(d, ellipsoid(p, {0, -14, -20}, {58, 62, 70}), 16);
  d = smooth_union(d, capsule(p, {0, 88, 62}, {0, 108, 36}, 8), 9);
  d = smooth_union(d, ellipsoid(mirrored, {9, 100, 33}, {6, 9, 6}), 5);
  d = smooth_union(d, ellipsoid(p, {0, 96, 12}, {21, 9, 9}), 6);
  d = smooth_union(d, ellipsoid(mirrored, {77, -8, 46}, {6, 15, 27}), 5);
  // Eye sockets lie a little back from brow and cheek.
  return std::max(d, -(ellipsoid(mirrored, {31, 103, 54}, {13, 12, 9})));
}

/// Skin, fat and muscle; the cheeks are fatter than the scalp.
void paint_soft_tissue(Painter& painter, const Pos& p, double surface) {
  const double cheek = smooth_step(p.y, 30, 70) * (1 - smooth_step(p.z, 40, 60));
  painter.paint(surface, hu::kSkin);
  painter.paint(surface + 2.0, hu::kFat);
  painter.paint(surface + 4.0 + 5.0 * cheek, hu::kMuscle);
}

/// Vault and base with their outer and inner tables, and the hole for the spinal cord.
void paint_cranium(Painter& painter, const Pos& p) {
  const double height = base_height(p);
  const double outer = std::max(vault(p, 0), height - 7 - p.z);
  painter.paint(outer, hu::kCortical);
  painter.paint(std::max(vault(p, 2.2), height - 5 - p.z), hu::kDiploe);
  const double inner = std::max(vault(p, 5.0), height - 2 - p.z);
  painter.paint(inner, hu::kCortical);
  painter.paint(capsule(p, {0, -30, 0}, {0, -30, 26}, 14), hu::kWater);
  painter.paint(capsule(p, {0, -30, -10}, {0, -26, 40}, 7), hu::kWhite);
}

void paint_brain(Painter& painter, const Pos& p, const Pos& mirrored) {
  const double cavity = std::max(vault(p, 7.0), base_height(p) - p.z);
  painter.paint(cavity, hu::kWater);
  const double folds = 1.6 * std::sin(0.34 * p.x) * std::sin(0.30 * p.y) * std::sin(0.33 * p.z);
  double brain = std::max(cavity + 2.5 + folds, 1.4 - mirrored.x - 0.2 * std::max(0.0, 92 - p.z));
  painter.paint(brain, hu::kGrey);
  painter.paint(brain + 5 + 1.5 * folds, hu::kWhite);
  painter.paint(ellipsoid(mirrored, {16, 6, 72}, {9, 20, 10}), hu::kGrey);
  painter.paint(capsule(mirrored, {8, 30, 84}, {11, -20, 88}, 5.5), hu::kWater);
  painter.paint(capsule(mirrored, {11, -20, 88}, {27, -16, 62}, 4.5), hu::kWater);
  painter.paint(box(p, {0, 0, 72}, {2, 12, 8}), hu::kWater);
  painter.paint(ellipsoid(p, {0, -32, 42}, {9, 5, 8}), hu::kWater);
}

/// Brow, cheek bones and the walls of the eye sockets, then what lies in the sockets.
void paint_orbits(Painter& painter, const Pos& p, const Pos& mirrored) {
  const Pos center(31, 68, 54);
  painter.paint(std::max(ellipsoid(mirrored, center, {23, 25, 22}), p.y - 86), hu::kSpongy);
  painter.paint(ellipsoid(mirrored, {27, 72, 71}, {30, 15, 8}), hu::kCortical);
  painter.paint(capsule(mirrored, {44, 74, 38}, {58, 44, 40}, 5.5), hu::kCortical);
  painter.paint(capsule(mirrored, {58, 44, 40}, {63, 2, 42}, 4), hu::kCortical);
  painter.paint(ellipsoid(mirrored, center + Pos(0, 4, 0), {18, 26, 17}), hu::kFat);
  painter.paint(capsule(mirrored, {31, 68, 54}, {14, 42, 58}, 2.5), hu::kMuscle);
  painter.paint(ellipsoid(mirrored, {31, 78, 54}, Pos(12)), hu::kEye);
  painter.paint(ellipsoid(mirrored, {31, 86, 54}, {4.5, 2.5, 4.5}), hu::kLens);
  // Lids close the socket towards the front.
  painter.paint(
      std::abs(ellipsoid(mirrored, {31, 78, 54}, Pos(14.5))) - 1.2 + std::max(0.0, 84 - p.y),
      hu::kSkin);
}

/// Horseshoe of the dental arches: signed distance in the xy plane and the angle along it.
struct Arch {
  double distance;  // to the arch's band
  double angle;     // 0 on the patient's left, pi/2 in front
};

Arch dental_arch(const Pos& p, double half_width) {
  const double y0 = 46, rx = 29, ry = 42;
  const double u = p.x / rx, v = (p.y - y0) / ry;
  const double k = std::hypot(u, v);
  const double steepness = std::hypot(u / rx, v / ry);
  const double line = steepness > 1e-9 ? k * (k - 1) / steepness : -rx;
  return {std::max(std::abs(line) - half_width, y0 - 4 - p.y), std::atan2(v, u)};
}

/// Fourteen teeth of one jaw between two heights, with gaps between them.
double teeth(const Pos& p, double z_lo, double z_hi) {
  constexpr double kTeeth = 14;
  const Arch arch = dental_arch(p, 3.6);
  const double along = arch.angle / 3.14159265358979 * kTeeth;
  const double off_middle = std::abs(along - std::floor(along) - 0.5);
  const double gap = (off_middle - 0.43) * 8.0;  // about 8 mm of arch per tooth
  return std::max({arch.distance, z_lo - p.z, p.z - z_hi, gap});
}

void paint_jaws(Painter& painter, const Pos& p, const Pos& mirrored) {
  // Upper jaw: body beneath the eye sockets, alveolar arch, palate.
  painter.paint(std::max(ellipsoid(mirrored, {28, 64, 36}, {17, 19, 16}), 16 - p.z), hu::kSpongy);
  const Arch arch = dental_arch(p, 6.2);
  painter.paint(std::max({arch.distance, 15 - p.z, p.z - 32}), hu::kJaw);
  painter.paint(
      std::max(box(p, {0, 62, 26}, {26, 24, 2.2}), std::hypot(p.x / 28, (p.y - 46) / 41) * 28 - 28),
      hu::kJaw);
  painter.paint(teeth(p, 9.5, 20), hu::kTooth);
  // Lower jaw: arch, and rami rising to the joints before the ears.
  const Arch lower = dental_arch(p + Pos(0, 3, 0), 6.0);
  painter.paint(std::max(lower.distance, p.z - 3.5), hu::kJaw);
  painter.paint(teeth(p + Pos(0, 3, 0), -2, 8.5), hu::kTooth);
  painter.paint(capsule(mirrored, {29, 44, -1}, {47, 10, 3}, 6.5), hu::kJaw);
  const double ramus =
      std::max(std::abs(mirrored.x - 48 - 0.12 * p.z) - 3.5, box(p, {p.x, 12, 18}, {1, 14, 22}));
  painter.paint(ramus, hu::kJaw);
  painter.paint(capsule(mirrored, {51, 4, 32}, {53, 1, 42}, 5), hu::kJaw);
}

/// Nose bones, the airways from the nostrils to the throat, and the air-filled sinuses.
void paint_airways(Painter& painter, const Pos& p, const Pos& mirrored) {
  painter.paint(capsule(mirrored, {2.5, 88, 68}, {4, 99, 54}, 3), hu::kCortical);
  painter.paint(capsule(mirrored, {14, 84, 32}, {7, 90, 60}, 3.5), hu::kCortical);
  painter.paint(std::max(ellipsoid(p, {0, 58, 44}, {15, 36, 16}), 28.5 - p.z), hu::kAir);
  painter.paint(capsule(mirrored, {6, 84, 34}, {7, 101, 29}, 3.6), hu::kAir);
  painter.paint(ellipsoid(mirrored, {30, 64, 36}, {12.5, 14, 12.5}), hu::kAir);
  painter.paint(box(p, {0, 58, 44}, {1.1, 32, 16}), hu::kCartilage);
  painter.paint(capsule(mirrored, {8, 40, 36}, {8, 80, 34}, 3), hu::kMuscle);
  painter.paint(capsule(mirrored, {8, 42, 46}, {8, 76, 46}, 2.4), hu::kMuscle);
  painter.paint(ellipsoid(mirrored, {8, 80, 77}, {7, 3.5, 6}), hu::kAir);
  painter.paint(ellipsoid(p, {0, 26, 55}, {13, 11, 9}), hu::kCortical);
  painter.paint(ellipsoid(p, {0, 26, 55}, {11, 9, 7}), hu::kAir);
  painter.paint(capsule(p, {0, 28, 40}, {0, 16, 18}, 8), hu::kAir);
  painter.paint(capsule(p, {0, 16, 18}, {0, 14, -20}, 7), hu::kAir);
  painter.paint(capsule(mirrored, {54, -8, 44}, {85, -10, 46}, 3), hu::kAir);
}

/// First vertebra around the spinal canal.
void paint_spine(Painter& painter, const Pos& p) {
  const double ring = std::abs(std::hypot(p.x / 1.25, p.y + 30) - 19) - 5;
  painter.paint(std::max(ring, std::abs(p.z - 6) - 7), hu::kSpongy);
  painter.paint(capsule(p, {0, -6, -20}, {0, -8, 14}, 8), hu::kSpongy);
}

/// A trough of the table beneath the head; it stays clear of the skin by 6 mm and more.
double headrest(const Pos& p) {
  const double shell = std::abs(ellipsoid({p.x, p.y, 0}, {0, 18, 0}, {113, 126, 1e6})) - 2.2;
  return std::max({shell, p.y - 12, p.z - 150});
}

double density_at(const Pos& p) {
  constexpr double kFarOutside = 4.0;
  Painter painter;
  painter.paint(headrest(p), hu::kHeadrest);
  const double surface = head_surface(p);
  if (surface > kFarOutside) return painter.density();
  const Pos mirrored(std::abs(p.x), p.y, p.z);
  paint_soft_tissue(painter, p, surface);
  paint_spine(painter, p);
  if (p.y > -5 && p.z > 20) paint_orbits(painter, p, mirrored);
  paint_cranium(painter, p);
  if (p.z > 20) paint_brain(painter, p, mirrored);
  if (p.y > -10 && p.z < 60) paint_jaws(painter, p, mirrored);
  if (p.y > -25 && p.z < 100) paint_airways(painter, p, mirrored);
  return painter.density();
}

}  // namespace

Phantom head_phantom(const Vec3i& dims) {
  // The box of ct_head, whatever the number of voxels.
  constexpr double kPixelMm = 0.957031, kSliceMm = 1.5;
  const Vec3d step(kPixelMm * 256 / dims.x, kPixelMm * 256 / dims.y, kSliceMm * 108 / dims.z);
  const Geometry geometry(dims, {-122.02, 122.02, -80.25},
                          {Vec3d(step.x, 0, 0), {0, -step.y, 0}, {0, 0, step.z}});
  return {geometry, [step](int i, int j, int k) {
            const Pos p(step.x * (i + 0.5) - 128.5 * kPixelMm,
                        step.y * (j + 0.5) - 118.5 * kPixelMm, step.z * (k + 0.5) - 0.5 * kSliceMm);
            return float(std::round(density_at(p)));
          }};
}

}  // namespace supple
