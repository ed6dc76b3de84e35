#include "tools/lab/bench/benches.h"

#include <algorithm>
#include <array>

namespace supple::tools {

const Bench& bench_named(const std::string& name) {
  static constexpr std::array<Bench, 11> kBenches = {{
      {"ecm", ecm_row_names, bench_ecm},
      {"economy", economy_row_names, bench_economy},
      {"fem", fem_row_names, bench_fem},
      {"fit", fit_row_names, bench_fit},
      {"invert", invert_row_names, bench_invert},
      {"io", io_row_names, bench_io},
      {"membrane", membrane_row_names, bench_membrane},
      {"mesh", mesh_row_names, bench_mesh},
      {"relax", relax_row_names, bench_relax},
      {"render", render_row_names, bench_render},
      {"springs", springs_row_names, bench_springs},
  }};
  return *std::find_if(kBenches.begin(), kBenches.end(),
                       [&](const Bench& bench) { return bench.name == name; });
}

}  // namespace supple::tools
