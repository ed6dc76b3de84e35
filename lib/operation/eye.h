// The eyeball that instruments work in (thesis section 6.1.2): an analytic globe with its lens, two
// or more incisions, and a cardanic suspension with springs, which instruments turn.
//
// Frame of the eye: the origin at the centre of the globe, z from the posterior pole of the retina
// to the cornea, mm. Measures of the lens are Gullstrand's (schematic eye, 1909): radii 10 and 6
// mm, thickness 3.6 mm, its front 3.6 mm behind the cornea; it scales with the globe.
#pragma once

#include <string>
#include <vector>

#include "lib/instruments/tool_contact.h"
#include "volumes/base/fields.h"

namespace supple {

/// Place on the globe through which instruments enter.
struct Incision {
  std::string name;
  Vec3d place_mm;  // in the eye's frame; its direction from the centre counts
};

struct EyeSetup {
  double radius_mm = 11;            // of the retina, the inside of the globe
  bool lens = true;                 // whether there is one
  double pupil_mm = 4;              // radius
  double incision_mm = 0.8;         // radius of the wall that lets a shaft through
  double muscles_n_mm_per_rad = 2;  // torque per radian that turns the eye back
  double wall_n_per_mm = 40;        // N/mm with which an incision follows a shaft
  double settles_s = 0.05;          // time in which the eye follows
  double bleeds_from_n = 0.01;      // force of a touch that opens a vessel
  double bleeding_mm_s = 0.15;      // growth of a spot's radius
  double largest_spot_mm = 1.2;     // radius
  int fundus_seed = 1;
  std::vector<Incision> incisions = {{"temporal", {-8.2, -2.4, 6.9}}, {"nasal", {8.2, -2.4, 6.9}}};
};
/// Keys of a table [eye], but for its incisions.
Fields fields(EyeSetup& setup);

constexpr char kRetina[] = "retina";
constexpr char kLens[] = "lens";

/// The retina with the incisions as gates, and the lens.
std::vector<Obstacle> obstacles_of(const EyeSetup& eye);
/// The lens as two balls, in the eye's frame.
LensShape lens_of(const EyeSetup& eye);

/// Turn of the eye from its own frame to that of the head, the rotation vector in radians.
struct EyeTurn {
  Vec3d vector{0, 0, 0};

  Vec3d to_head(const Vec3d& in_eye) const;
  Vec3d to_eye(const Vec3d& in_head) const;
};

/// A shaft in the head's frame that goes through an incision.
struct Shaft {
  Vec3d tip_mm, axis;  // unit
  Vec3d incision_mm;   // in the eye's frame
};

/// The turn one step later: that which makes the energy of muscles and incisions least,
///   E = muscles |w|^2 / 2 + wall sum |distance of R(w) p_i from shaft i|^2 / 2,
/// approached with the eye's own time. Without shafts it goes back to rest.
EyeTurn next_turn(const EyeSetup& eye, const EyeTurn& turn, const std::vector<Shaft>& shafts,
                  double dt_s);

/// Blood on the retina.
struct Bleeding {
  Vec3d place_mm;  // on the retina
  double radius_mm = 0;
};

}  // namespace supple
