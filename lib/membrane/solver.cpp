#include "lib/membrane/solver.h"

#include <cmath>

namespace supple {

namespace {

/// Reciprocal masses and what a substep makes of stiffnesses. Implicit damping of masses makes them
/// seem larger.
struct SubstepSizes {
  double h2, slowing;
  double link_per_mm2;  // h^2 times a link's stiffness per area
};

void solve_spring(SheetSpring& s, Vec3d* pos, const double* mobility, const SubstepSizes& sizes) {
  const double w_a = mobility[s.a] * sizes.slowing, w_b = mobility[s.b] * sizes.slowing;
  const Vec3d along = pos[s.b] - pos[s.a];
  const double length = std::sqrt(along.length2());
  if (length < 1e-12) return;
  const double stiffness = sizes.h2 * s.stiffness_n_m;
  const double change =
      -(stiffness * (length - s.rest_mm) + s.multiplier) / (1 + stiffness * (w_a + w_b));
  s.multiplier += change;
  const Vec3d push = along * (change / length);
  pos[s.a] -= push * w_a;
  pos[s.b] += push * w_b;
}

void sweep_springs(std::vector<SheetSpring>& springs, Sheet& sheet, const SubstepSizes& sizes,
                   bool forwards) {
  Vec3d* pos = sheet.body.pos_mm.data();
  const double* mobility = sheet.mobility.data();
  if (forwards) {
    for (auto s = springs.begin(); s != springs.end(); ++s) solve_spring(*s, pos, mobility, sizes);
  } else {
    for (auto s = springs.rbegin(); s != springs.rend(); ++s)
      solve_spring(*s, pos, mobility, sizes);
  }
}

void sweep_links(Sheet& sheet, const SubstepSizes& sizes) {
  for (std::size_t n = 0; n < sheet.clings.size(); ++n) {
    if (!sheet.clings[n]) continue;
    const double stiffness = sizes.link_per_mm2 * sheet.area_mm2[n];
    const double w = sheet.mobility[n] * sizes.slowing;
    Vec3d& pos = sheet.body.pos_mm[n];
    const Vec3d change = ((pos - sheet.anchor_mm[n]) * stiffness + sheet.link_multiplier[n]) *
                         (-1 / (1 + stiffness * w));
    sheet.link_multiplier[n] += change;
    pos += change * w;
  }
}

void forget_multipliers(Sheet& sheet) {
  for (SheetSpring& s : sheet.springs) s.multiplier = 0;
  for (SheetSpring& s : sheet.bending) s.multiplier = 0;
  sheet.link_multiplier.assign(std::size_t(sheet.node_count()), Vec3d(0.0));
}

}  // namespace

void predict(Sheet& sheet, const MembraneParams& params) {
  const double h = params.substep_s, slowing = 1 / (1 + h * params.damping_per_s);
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (sheet.mobility[n] > 0) sheet.body.pos_mm[n] += sheet.body.velocity_mm_s[n] * (h * slowing);
  }
}

void solve(Sheet& sheet, const MembraneParams& params, SubstepSurroundings around) {
  const double h = params.substep_s;
  const SubstepSizes sizes{h * h, 1 / (1 + h * params.damping_per_s),
                           h * h * link_stiffness_n_m(params, 1)};
  forget_multipliers(sheet);
  around.ground.begin(sheet);
  for (int n = 0; n < params.sweeps; ++n) {
    const bool forwards = n % 2 == 0;
    sweep_springs(sheet.springs, sheet, sizes, forwards);
    sweep_springs(sheet.bending, sheet, sizes, forwards);
    sweep_links(sheet, sizes);
    around.tools.push(sheet);
    around.ground.push(sheet);
  }
  around.tools.rub(sheet, params.friction);
  around.ground.rub(sheet, params.friction);
  around.ground.push(sheet);
  for (int n = 0; n < sheet.node_count(); ++n) {
    sheet.body.velocity_mm_s[n] = (sheet.body.pos_mm[n] - sheet.start_mm[n]) / h;
  }
}

void add_grip_forces(const Sheet& sheet, double h, double weight, std::vector<Vec3d>& by_tool_mn) {
  const std::vector<Vec3d>& pos = sheet.body.pos_mm;
  const auto add = [&](int node, const Vec3d& impulse) {
    const int tool = sheet.holder[node];
    if (tool < 0) return;
    if (by_tool_mn.size() <= std::size_t(tool))
      by_tool_mn.resize(std::size_t(tool) + 1, Vec3d(0.0));
    by_tool_mn[std::size_t(tool)] += impulse * (weight / (h * h));
  };
  for (const auto* springs : {&sheet.springs, &sheet.bending}) {
    for (const SheetSpring& s : *springs) {
      if (sheet.holder[s.a] < 0 && sheet.holder[s.b] < 0) continue;
      const Vec3d impulse = (pos[s.b] - pos[s.a]).normalized() * s.multiplier;
      add(s.a, -impulse);
      add(s.b, impulse);
    }
  }
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (sheet.clings[n]) add(n, sheet.link_multiplier[n]);
  }
}

}  // namespace supple
