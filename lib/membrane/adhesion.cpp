#include "lib/membrane/adhesion.h"

namespace supple {

void break_links(Sheet& sheet, const MembraneParams& params, double h, MembraneReport& report) {
  MembraneEvent event{MembraneEvent::Kind::link_broken, 0, -1, Vec3d(0.0)};
  const double force_per_area = 2 * params.adhesion_j_m2 / params.adhesion_mm;
  for (int n = 0; n < sheet.node_count(); ++n) {
    if (!sheet.clings[n]) continue;
    const double limit = force_per_area * sheet.area_mm2[n] * h * h;
    if (sheet.link_multiplier[n].length2() <= limit * limit) continue;
    sheet.clings[n] = 0;
    ++event.count;
    event.place_mm += sheet.anchor_mm[n];
  }
  if (event.count == 0) return;
  event.place_mm /= double(event.count);
  report.events.push_back(event);
}

void load_links(Sheet& sheet, const MembraneParams& params, double h) {
  for (int n = 0; n < sheet.node_count(); ++n) {
    const double stiffness = link_stiffness_n_m(params, sheet.area_mm2[n]);
    sheet.link_multiplier[n] = (sheet.anchor_mm[n] - sheet.body.pos_mm[n]) * (h * h * stiffness);
  }
}

}  // namespace supple
