// supple compare: how different two pictures are, and whether that is too much.
#include <cstdio>

#include "raycast/pictures/compare.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

struct CompareOptions {
  std::string a, b, difference;
  std::optional<double> max_rmse, min_ssim, max_diff;
  std::string mask;
};

Fields fields(CompareOptions& options) {
  return {
      Field("max_rmse", options.max_rmse,
            "Largest root mean square difference, of R, G, B on black and of alpha")
          .range(0, 1),
      Field("min_ssim", options.min_ssim, "Smallest structural similarity").range(-1, 1),
      Field("max_diff", options.max_diff, "Largest difference of any channel").range(0, 1),
      Field("mask", options.mask, "foreground: only where either picture is not empty")
          .one_of({"foreground"}),
      Field("diff", options.difference, "Write the amplified difference").shown_as("D.png"),
  };
}

/// One line per limit that is broken.
std::vector<std::string> broken_limits(const CompareOptions& options,
                                       const Comparison& comparison) {
  std::vector<std::string> lines;
  const auto check = [&lines](const char* name, double value, bool good, double limit,
                              const char* relation) {
    if (good) return;
    char line[120];
    std::snprintf(line, sizeof line, "%s: found %.6g, expected %s %.6g", name, value, relation,
                  limit);
    lines.emplace_back(line);
  };
  if (options.max_rmse) {
    const double limit = *options.max_rmse;
    check("rmse", comparison.rmse, comparison.rmse <= limit, limit, "at most");
    check("rmse of alpha", comparison.rmse_alpha, comparison.rmse_alpha <= limit, limit, "at most");
  }
  if (options.min_ssim) {
    check("ssim", comparison.ssim, comparison.ssim >= *options.min_ssim, *options.min_ssim,
          "at least");
  }
  if (options.max_diff) {
    check("max_diff", comparison.max_diff, comparison.max_diff <= *options.max_diff,
          *options.max_diff, "at most");
  }
  return lines;
}

int run_compare(const CompareOptions& options, const GlobalOptions& global, Console& console) {
  OutputPlan plan(global.force);
  plan.protect(options.a);
  plan.protect(options.b);
  if (!options.difference.empty()) plan.add_image(options.difference);
  console.claim(plan.files());
  const Image a = read_png(options.a);
  const Image b = read_png(options.b);
  const Comparison comparison = compare(a, b, options.mask == "foreground");
  if (!options.difference.empty()) write_png(options.difference, difference_image(a, b));

  const std::vector<std::string> broken = broken_limits(options, comparison);
  if (global.json) {
    const Value json = {{"rmse", comparison.rmse},
                        {"rmse_alpha", comparison.rmse_alpha},
                        {"ssim", comparison.ssim},
                        {"max_diff", comparison.max_diff},
                        {"pixels", comparison.compared_pixels},
                        {"within_limits", broken.empty()}};
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    std::printf("rmse %.4g  alpha %.4g  ssim %.4g  max_diff %.4g\n", comparison.rmse,
                comparison.rmse_alpha, comparison.ssim, comparison.max_diff);
  }
  for (const std::string& line : broken) console.note("over the limit: " + line);
  return broken.empty() ? kOk : kFailure;
}

}  // namespace

Command add_compare(CLI::App& program) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* app = add_subcommand(
      program, "compare", "Measure how different two PNG pictures are; exit 1 over a limit",
      "  supple compare new.png reference.png\n"
      "  supple compare new.png reference.png --max-rmse 1e-3 --min-ssim 0.999\n"
      "  supple compare a.png b.png --mask foreground --diff difference.png --json");
  app->add_option("a", options->a, "A PNG file")->required()->option_text("A.png");
  app->add_option("b", options->b, "A PNG file of the same size")->required()->option_text("B.png");
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_compare(*options, global, console);
          }};
}

}  // namespace supple::tools
