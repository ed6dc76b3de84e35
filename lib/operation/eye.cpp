#include "lib/operation/eye.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace supple {

namespace {

constexpr double kGullstrand = 11;  // radius of the retina of the schematic eye, mm
constexpr double kCornea = 12;      // height of its cornea above the centre, mm

/// Rodrigues' formula.
Vec3d turned(const Vec3d& v, const Vec3d& by) {
  const double angle = by.length();
  if (angle == 0) return v;
  const Vec3d axis = by / angle;
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1 - c));
}

/// Solves the symmetric system of three by Cramer's rule.
Vec3d solve(const std::array<Vec3d, 3>& columns, const Vec3d& right) {
  const double det = columns[0].dot(columns[1].cross(columns[2]));
  return Vec3d(right.dot(columns[1].cross(columns[2])), columns[0].dot(right.cross(columns[2])),
               columns[0].dot(columns[1].cross(right))) /
         det;
}

/// The turn of least energy by Gauss and Newton's method, from `start`.
Vec3d least_energy_turn(const EyeSetup& eye, const Vec3d& start, const std::vector<Shaft>& shafts) {
  Vec3d w = start;
  for (int round = 0; round < 8; ++round) {
    // Columns of the matrix muscles + wall sum J^T J, and the gradient; J = -[R p]_x without the
    // part along the shaft.
    std::array<Vec3d, 3> matrix{Vec3d(eye.muscles_n_mm_per_rad, 0, 0),
                                Vec3d(0, eye.muscles_n_mm_per_rad, 0),
                                Vec3d(0, 0, eye.muscles_n_mm_per_rad)};
    Vec3d gradient = w * eye.muscles_n_mm_per_rad;
    for (const Shaft& shaft : shafts) {
      const Vec3d p = turned(shaft.incision_mm, w);
      const Vec3d from = p - shaft.tip_mm;
      const Vec3d away = from - shaft.axis * from.dot(shaft.axis);
      gradient += p.cross(away) * eye.wall_n_per_mm;
      for (int c = 0; c < 3; ++c) {
        Vec3d unit(0.0);
        unit[c] = 1;
        const Vec3d moved = unit.cross(p);
        const Vec3d across = moved - shaft.axis * moved.dot(shaft.axis);
        matrix[std::size_t(c)] += p.cross(across) * eye.wall_n_per_mm;
      }
    }
    const Vec3d change = solve(matrix, gradient);
    w -= change;
    if (change.length() < 1e-9) break;
  }
  return w;
}

}  // namespace

Fields fields(EyeSetup& setup) {
  return {
      Field("radius", setup.radius_mm, "Radius of the retina").unit("mm").range(5, 50),
      Field("lens", setup.lens, "Whether the eye has its lens"),
      Field("pupil", setup.pupil_mm, "Radius of the pupil").unit("mm").positive(),
      Field("incision", setup.incision_mm, "Radius of the wall that lets a shaft through")
          .unit("mm")
          .positive(),
      Field("muscles", setup.muscles_n_mm_per_rad, "Torque per radian that turns the eye back")
          .unit("N mm")
          .positive(),
      Field("wall", setup.wall_n_per_mm, "Force with which an incision follows a shaft")
          .unit("N/mm")
          .at_least(0),
      Field("settles", setup.settles_s, "Time in which the eye follows").unit("s").positive(),
      Field("bleeds_from", setup.bleeds_from_n, "Force of a touch that opens a vessel")
          .unit("N")
          .at_least(0),
      Field("bleeding", setup.bleeding_mm_s, "Growth of the radius of a spot of blood")
          .unit("mm/s")
          .at_least(0),
      Field("largest_spot", setup.largest_spot_mm, "Largest radius of a spot")
          .unit("mm")
          .positive(),
      Field("fundus_seed", setup.fundus_seed, "Seed of the vessels of the fundus").at_least(0),
  };
}

LensShape lens_of(const EyeSetup& eye) {
  const double scale = eye.radius_mm / kGullstrand;
  const double front = kCornea - 3.6;  // z of the vertices
  const double back = front - 3.6;
  return {{{0, 0, (front - 10) * scale}, 10 * scale}, {{0, 0, (back + 6) * scale}, 6 * scale}};
}

std::vector<Obstacle> obstacles_of(const EyeSetup& eye) {
  HollowSphere retina{{0, 0, 0}, eye.radius_mm, {}, eye.incision_mm};
  for (const Incision& incision : eye.incisions) retina.gates_mm.push_back(incision.place_mm);
  std::vector<Obstacle> all{{kRetina, std::move(retina)}};
  if (eye.lens) all.push_back({kLens, lens_of(eye)});
  return all;
}

Vec3d EyeTurn::to_head(const Vec3d& in_eye) const {
  return turned(in_eye, vector);
}

Vec3d EyeTurn::to_eye(const Vec3d& in_head) const {
  return turned(in_head, -vector);
}

EyeTurn next_turn(const EyeSetup& eye, const EyeTurn& turn, const std::vector<Shaft>& shafts,
                  double dt_s) {
  const Vec3d goal = least_energy_turn(eye, turn.vector, shafts);
  return {turn.vector + (goal - turn.vector) * (1 - std::exp(-dt_s / eye.settles_s))};
}

}  // namespace supple
