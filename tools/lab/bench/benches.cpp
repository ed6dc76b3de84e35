#include "tools/lab/bench/benches.h"

#include "tools/lab/bench/bench_io.h"
#include "tools/lab/bench/ecm/bench_ecm.h"
#include "tools/lab/bench/economy/bench_economy.h"
#include "tools/lab/bench/elastic/bench_fem.h"
#include "tools/lab/bench/elastic/bench_fit.h"
#include "tools/lab/bench/elastic/bench_relax.h"
#include "tools/lab/bench/elastic/bench_springs.h"
#include "tools/lab/bench/invert/bench_invert.h"
#include "tools/lab/bench/render/bench_render.h"

namespace supple::tools {

Bench bench_of(const BenchOptions& options, int threads, Console& console) {
  if (options.name == "economy") {
    const EconomyBenchOptions economy{options.quick, threads, options.only};
    return {[=] { return economy_row_names(economy); },
            [=, &console] { return bench_economy(economy, console); }};
  }
  if (options.name == "fem") {
    const FemBenchOptions fem{options.quick, threads, options.only, options.ct_head};
    return {[=, &console] { return fem_row_names(fem, console); },
            [=, &console] { return bench_fem(fem, console); }};
  }
  if (options.name == "fit") {
    const FitBenchOptions fit{options.quick, options.only};
    return {[=] { return fit_row_names(fit); }, [=, &console] { return bench_fit(fit, console); }};
  }
  if (options.name == "invert") {
    const InvertBenchOptions invert{options.quick, threads, options.only};
    return {[=] { return invert_row_names(invert); },
            [=, &console] { return bench_invert(invert, console); }};
  }
  if (options.name == "io") {
    const IoBenchOptions io{options.quick, threads, options.only};
    return {[=] { return io_row_names(io); }, [=, &console] { return bench_io(io, console); }};
  }
  if (options.name == "relax") {
    const RelaxBenchOptions relax{options.quick, threads, options.only, options.ct_head};
    return {[=, &console] { return relax_row_names(relax, console); },
            [=, &console] { return bench_relax(relax, console); }};
  }
  if (options.name == "render") {
    const RenderBenchOptions render{options.quick, threads, options.only};
    return {[=] { return render_row_names(render); },
            [=, &console] { return bench_render(render, console); }};
  }
  if (options.name == "springs") {
    const SpringsBenchOptions springs{options.quick, options.only};
    return {[=] { return springs_row_names(springs); },
            [=, &console] { return bench_springs(springs, console); }};
  }
  const EcmBenchOptions ecm{options.quick, threads, options.only, options.ct_head};
  return {[=, &console] { return ecm_row_names(ecm, console); },
          [=, &console] { return bench_ecm(ecm, console); }};
}

}  // namespace supple::tools
