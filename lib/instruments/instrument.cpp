#include "lib/instruments/instrument.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"

namespace supple {

namespace {

/// A path of balls, as round cones between neighbours.
struct PathBall {
  Vec3d centre_mm;
  double radius_mm;
};
void add_path(Instrument& tool, const std::vector<PathBall>& path, int jaw = 0) {
  for (std::size_t n = 1; n < path.size(); ++n) {
    const PathBall &a = path[n - 1], &b = path[n];
    tool.parts.push_back({{a.centre_mm, b.centre_mm, a.radius_mm, b.radius_mm}, jaw});
  }
}

/// Balls of the tip first; the shaft goes on from the last of them.
void add_shaft(Instrument& tool, const InstrumentSetup& setup, std::vector<PathBall> tip) {
  tip.push_back({{0, 0, setup.length_mm}, setup.diameter_mm / 2});
  add_path(tool, tip);
}

void add_blunt_shaft(Instrument& tool, const InstrumentSetup& setup) {
  const double r = setup.diameter_mm / 2;
  add_shaft(tool, setup, {{{0, 0, r}, r}});
}

void make_needle(Instrument& tool, const InstrumentSetup& setup) {
  const double r = setup.diameter_mm / 2, fine = 0.06 * r;
  add_shaft(tool, setup, {{{0, 0, fine}, fine}, {{0, 0, 6.4 * r}, r}});
}

/// The tip comes back to the axis from the outer side of a bend.
void make_pick(Instrument& tool, const InstrumentSetup& setup) {
  const double r = setup.diameter_mm / 2, fine = 0.08 * r;
  add_shaft(tool, setup,
            {{{0, 0, fine}, fine},
             {{0, 1.1 * r, 0.9 * r}, 0.3 * r},
             {{0, 1.1 * r, 2.2 * r}, 0.5 * r},
             {{0, 0.3 * r, 4.2 * r}, 0.7 * r},
             {{0, 0, 5.6 * r}, r}});
}

/// Jaws bow apart in their middle and meet at their ends.
void make_forceps(Instrument& tool, const InstrumentSetup& setup) {
  const double r = setup.diameter_mm / 2, fine = 0.16 * r, jaw = setup.jaw_mm;
  tool.hinge_mm = {0, 0, jaw};
  add_shaft(tool, setup, {{{0, 0, jaw + 1.2 * r}, r}});
  for (const int side : {1, -1}) {
    add_path(tool,
             {{{0, side * fine, fine}, fine},
              {{0, side * 0.56 * r, 0.35 * jaw}, 0.22 * r},
              {{0, side * 0.62 * r, 0.65 * jaw}, 0.3 * r},
              {{0, side * 0.4 * r, jaw + 0.4 * r}, 0.42 * r}},
             side);
  }
  // Tips take in a fold that is as wide as they stand apart.
  tool.grip = GripZone{{{0, 0, 0}, {0, 0, 0.35 * jaw}, 3 * fine, 3 * fine}, 6, 10};
}

void make_vitrector(Instrument& tool, const InstrumentSetup& setup) {
  const double r = setup.diameter_mm / 2;
  add_blunt_shaft(tool, setup);
  tool.port = SuctionPort{{0, r, 2.2 * r}, {0, 1, 0}, 0.7 * r, setup.suction_mm};
}

void make_lamp(Instrument& tool, const InstrumentSetup& setup) {
  add_blunt_shaft(tool, setup);
  tool.lamp = TipLamp{setup.cone_degrees};
}

/// A blade of fingers side by side, twice as wide as the shaft.
void make_spatula(Instrument& tool, const InstrumentSetup& setup) {
  constexpr int kFingers = 7;
  const double r = setup.diameter_mm / 2, thin = 0.3 * r;
  for (int n = 0; n < kFingers; ++n) {
    const double across = (n - kFingers / 2) * 2 * (2 * r - thin) / (kFingers - 1);
    const double back = thin + across * across / (4 * r);  // a round front edge
    add_path(tool, {{{across, 0, back}, thin}, {{0.3 * across, 0, 9 * r}, 2 * thin}});
  }
  add_shaft(tool, setup, {{{0, 0, 9 * r}, r}});
}

void make_own(Instrument& tool, const InstrumentSetup& setup) {
  const InstrumentParts& own = setup.own;
  tool.parts = own.parts;
  tool.hinge_mm = own.hinge_mm;
  tool.grip = own.grip;
  tool.port = own.port;
  tool.lamp = own.lamp;
}

void require_whole(const InstrumentParts& own) {
  const auto has = [&](bool jaw) {
    return std::any_of(own.parts.begin(), own.parts.end(),
                       [&](const InstrumentPart& part) { return (part.jaw != 0) == jaw; });
  };
  if (!has(false)) throw InputError({"", "parts", "none of the shaft", "one without a jaw"});
  if (own.grip && !has(true)) {
    throw InputError({"", "grip", "no part of a jaw", "parts with jaw = 1 and jaw = -1"});
  }
}

}  // namespace

Fields fields(InstrumentSetup& setup) {
  Fields list;
  list.push_back(Field("name", setup.name, "Name by which events and tasks know it").required());
  list.push_back(Field("kind", setup.kind,
                       {"needle", "pick", "forceps", "vitrector", "lamp", "spatula", "parts"},
                       "Kind of instrument")
                     .required());
  list.push_back(
      Field("diameter", setup.diameter_mm, "Diameter of the shaft").unit("mm").positive());
  list.push_back(
      Field("length", setup.length_mm, "Length from the tip to the hand").unit("mm").positive());
  list.push_back(Field("jaw", setup.jaw_mm, "Length of the jaws of forceps").unit("mm").positive());
  list.push_back(Field("suction", setup.suction_mm, "Reach of a vitrector from its port")
                     .unit("mm")
                     .positive());
  list.push_back(Field("cone", setup.cone_degrees, "Half of the angle of a lamp's cone of light")
                     .unit("degrees")
                     .range(1, 89));
  list.push_back(Field("stiffness", setup.stiffness_n_m,
                       "Stiffness of the hand that presses it against something rigid")
                     .unit("N/m")
                     .positive());
  return list;
}

Instrument make_instrument(const InstrumentSetup& setup) {
  const auto positive = [&](const char* field, double value) {
    require(value > 0 && std::isfinite(value), field, value, "a positive number");
  };
  positive("diameter", setup.diameter_mm);
  positive("length", setup.length_mm);
  positive("stiffness", setup.stiffness_n_m);
  if (setup.kind == InstrumentKind::forceps) positive("jaw", setup.jaw_mm);
  if (setup.kind == InstrumentKind::vitrector) positive("suction", setup.suction_mm);
  if (setup.kind == InstrumentKind::lamp) positive("cone", setup.cone_degrees);
  const bool is_forceps = setup.kind == InstrumentKind::forceps;
  const bool is_own = setup.kind == InstrumentKind::parts;
  if (is_own) require_whole(setup.own);
  const double tip_mm = (is_forceps ? setup.jaw_mm : 0) + 5 * setup.diameter_mm;
  require(is_own || setup.length_mm > tip_mm, "length", setup.length_mm,
          "more than " + number_text(tip_mm) + " mm, five diameters beyond the jaws");

  Instrument tool;
  tool.name = setup.name;
  tool.kind = setup.kind;
  tool.stiffness_n_m = setup.stiffness_n_m;
  using Maker = void (*)(Instrument&, const InstrumentSetup&);
  constexpr Maker kMakers[] = {make_needle, make_pick,    make_forceps, make_vitrector,
                               make_lamp,   make_spatula, make_own};
  kMakers[int(setup.kind)](tool, setup);
  return tool;
}

}  // namespace supple
