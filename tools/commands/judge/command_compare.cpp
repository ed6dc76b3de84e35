// supple compare: how different two pictures, warps, segmentations or lists of points are, and for
// pictures whether that is too much.
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "lib/state/state_outputs.h"
#include "raycast/pictures/compare.h"
#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"
#include "volumes/compare/compare_labels.h"
#include "volumes/compare/compare_warps.h"
#include "volumes/field/points/point_motion.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/stored_labels.h"
#include "volumes/io/point_file.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

namespace supple::tools {

namespace {

/// A file with more is taken for a volume of densities.
constexpr std::size_t kMostLabels = 1000;

struct CompareOptions {
  std::string a, b, difference;
  std::optional<double> max_rmse, min_ssim, max_diff;
  std::string mask, points, labels, grid;
};

Fields fields(CompareOptions& options) {
  return {
      Field("max_rmse", options.max_rmse,
            "Pictures: largest root mean square difference, of R, G, B on black and of alpha")
          .range(0, 1),
      Field("min_ssim", options.min_ssim, "Pictures: smallest structural similarity").range(-1, 1),
      Field("max_diff", options.max_diff, "Pictures: largest difference of any channel")
          .range(0, 1),
      Field("mask", options.mask,
            "Pictures: foreground, only where either is not empty; warps and label volumes: only "
            "where this volume of whole numbers is not 0")
          .shown_as("foreground|FILE"),
      Field("diff", options.difference,
            "Write the amplified difference; of warps the endpoint error in mm as a volume")
          .shown_as("D.png|VOLUME"),
      Field("points", options.points,
            "Warps: target registration error at these points of their grid")
          .shown_as("POINTS"),
      Field("labels", options.labels,
            "Warps: Dice of the labels of this volume as either warp carries them")
          .shown_as("VOLUME"),
      Field("grid", options.grid, "Warps: grid for transforms that name none").shown_as("FILE"),
  };
}

enum class Kind { pictures, points, labels, warps };

const char* name_of(Kind kind) {
  const char* const names[] = {"a picture", "points", "a label volume", "a warp"};
  return names[int(kind)];
}

/// `grid`: as for read_warp.
Kind kind_of(const std::string& path, const Geometry* grid) {
  if (std::filesystem::path(path).extension() == ".png") return Kind::pictures;
  if (is_point_file_name(path)) return Kind::points;
  if (is_state_file(path)) {
    throw UsageError("compare: found the state " + path +
                     ", expected a picture, a warp (supple export writes its), a label volume or "
                     "points");
  }
  ReadOptions read;
  read.grid = grid;
  const int components = open_scalars_or_vectors(path, read)->header().components;
  return components == 1 ? Kind::labels : Kind::warps;
}

/// Refuses options that say nothing about files of this kind.
void require_fitting(const CompareOptions& options, Kind kind) {
  const auto require = [&](const char* option, bool given, std::initializer_list<Kind> kinds) {
    if (!given || std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return;
    throw UsageError(std::string(option) + ": found " + name_of(kind) + ", expected " +
                     name_of(*kinds.begin()));
  };
  require("--max-rmse", options.max_rmse.has_value(), {Kind::pictures});
  require("--min-ssim", options.min_ssim.has_value(), {Kind::pictures});
  require("--max-diff", options.max_diff.has_value(), {Kind::pictures});
  require("--mask", !options.mask.empty(), {Kind::warps, Kind::labels, Kind::pictures});
  require("--diff", !options.difference.empty(), {Kind::pictures, Kind::warps});
  require("--points", !options.points.empty(), {Kind::warps});
  require("--labels", !options.labels.empty(), {Kind::warps});
  require("--grid", !options.grid.empty(), {Kind::warps});
  if (kind == Kind::pictures && !options.mask.empty() && options.mask != "foreground") {
    throw UsageError("--mask: found " + options.mask + ", expected foreground for pictures");
  }
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

int compare_pictures(const CompareOptions& options, const GlobalOptions& global, Console& console) {
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

Value errors_json(const EndpointErrors& errors, const char* counted) {
  const LengthStatistics& s = errors.statistics;
  return {{counted, s.count},   {"outside", errors.outside}, {"mean_mm", s.mean_mm},
          {"rms_mm", s.rms_mm}, {"median_mm", s.median_mm},  {"p95_mm", s.p95_mm},
          {"max_mm", s.max_mm}};
}

Value overlaps_json(const LabelOverlaps& overlaps) {
  Value json = {{"mean_dice", nullptr}, {"labels", Value::Entries()}};
  if (const auto mean = mean_dice(overlaps)) json["mean_dice"] = *mean;
  for (const auto& [label, overlap] : overlaps) {
    json["labels"][number_text(label)] = {{"voxels_a", overlap.in_a},
                                          {"voxels_b", overlap.in_b},
                                          {"voxels_both", overlap.in_both},
                                          {"dice", overlap.dice()}};
  }
  return json;
}

/// Names, numbers and the table of labels.
void print_report(const Value& json) {
  const auto print_errors = [](const char* what, const Value& row, const char* counted) {
    std::printf("%-16s %10lld %s, mean %.4g mm, rms %.4g, median %.4g, 95 %% %.4g, max %.4g\n",
                what, static_cast<long long>(row[counted].whole()), counted,
                row["mean_mm"].number(), row["rms_mm"].number(), row["median_mm"].number(),
                row["p95_mm"].number(), row["max_mm"].number());
  };
  if (json.contains("endpoint_error")) {
    print_errors("endpoint error", json["endpoint_error"], "voxels");
  }
  if (json.contains("points")) print_errors("at points", json["points"], "points");
  if (!json.contains("dice")) return;
  std::printf("%16s %10s %10s %10s %8s\n", "label", "voxels a", "voxels b", "both", "Dice");
  for (const auto& [label, row] : json["dice"]["labels"].entries()) {
    std::printf("%16s %10lld %10lld %10lld %8.4f\n", label.c_str(),
                static_cast<long long>(row["voxels_a"].whole()),
                static_cast<long long>(row["voxels_b"].whole()),
                static_cast<long long>(row["voxels_both"].whole()), row["dice"].number());
  }
  const auto& mean = json["dice"]["mean_dice"];
  if (!mean.is_null()) std::printf("%16s %41.4f\n", "mean", mean.number());
}

int finish(const Value& json, const GlobalOptions& global) {
  if (global.json) {
    std::printf("%s\n", json_text(json, 2).c_str());
  } else if (!global.quiet) {
    print_report(json);
  }
  return kOk;
}

/// Labels of a file, and how places look them up.
class LabelFile {
 public:
  LabelFile(const std::string& path, Console& console)
      : m_labels(*open_volume(path, {}, &console), &console) {}

  const StoredLabels& labels() const { return m_labels; }
  LabelLookup here() const {
    return [this](const Vec3d& place) { return m_labels.label_at(place); };
  }
  /// The label that `apply --labels` writes at a place; `back` leads to where its content was.
  LabelLookup carried_by(const PointMotion& back) const {
    return [this, &back](const Vec3d& place) {
      const MovedPoint from = back.move(place);
      const bool is_found = from.kind != PlaceKind::unresolved && from.kind != PlaceKind::outside;
      return is_found ? m_labels.label_at(from.to_lps_mm) : 0.0;
    };
  }
  /// Throws InputError for a volume of densities.
  void require_few(const std::string& path) const {
    if (m_labels.counts().size() <= kMostLabels) return;
    throw InputError({path, "", with_count(std::int64_t(m_labels.counts().size()), "value"),
                      "a label volume: at most " + std::to_string(kMostLabels)});
  }

 private:
  StoredLabels m_labels;
};

/// A mask of places, or all space where no file is named.
class Mask {
 public:
  Mask(const std::string& path, Console& console) {
    if (!path.empty()) m_file = std::make_unique<LabelFile>(path, console);
  }
  LabelLookup here() const { return m_file ? m_file->here() : LabelLookup(); }

 private:
  std::unique_ptr<LabelFile> m_file;
};

void write_errors(const std::string& path, const Geometry& grid, const EndpointErrors& errors,
                  Console& console) {
  const std::size_t slice = std::size_t(grid.dims().x) * grid.dims().y;
  const auto slices = [&](int k, float* out) {
    for (std::size_t n = 0; n < slice; ++n) {
      const float error = errors.errors_mm[slice * k + n];
      out[n] = std::isnan(error) ? 0 : error;
    }
  };
  warn_of_all(path, write_volume(path, grid, ValueType::float32, slices, &console), &console);
}

int compare_warp_files(const CompareOptions& options, const std::optional<Geometry>& grid,
                       const GlobalOptions& global, Console& console) {
  const Warp a = read_warp(options.a, &console, grid ? &*grid : nullptr);
  const Warp b = read_warp(options.b, &console, grid ? &*grid : &a.geometry);
  const Mask mask(options.mask, console);
  const EndpointErrors errors = compare_warps(a, b, mask.here(), &console);
  if (errors.outside > 0) {
    console.warn(options.b + ": " + with_count(errors.outside, "voxel") + " of the grid of " +
                 options.a + " beyond its own are left out");
  }
  if (errors.statistics.count == 0) {
    throw InputError({options.mask.empty() ? options.b : options.mask, "",
                      "no voxel of the grid of " + options.a, "a part of it at least"});
  }
  Value json = {{"endpoint_error", errors_json(errors, "voxels")}};
  if (!options.points.empty()) {
    std::vector<Vec3d> points;
    for (const auto& row : read_point_file(options.points).rows) points.push_back(row.at_lps_mm);
    const EndpointErrors at_points = compare_warps_at(points, a, b);
    if (at_points.outside > 0) {
      console.warn(options.points + ": " + with_count(at_points.outside, "point") +
                   " beyond the grid of a warp are left out");
    }
    json["points"] = errors_json(at_points, "points");
  }
  if (!options.labels.empty()) {
    const LabelFile labels(options.labels, console);
    labels.require_few(options.labels);
    const auto back_a = motion_through(a, true), back_b = motion_through(b, true);
    json["dice"] = overlaps_json(compare_labels(a.geometry, labels.carried_by(*back_a),
                                                labels.carried_by(*back_b), mask.here(), &console));
  }
  if (!options.difference.empty()) write_errors(options.difference, a.geometry, errors, console);
  console.stage_seconds();
  return finish(json, global);
}

int compare_label_files(const CompareOptions& options, const GlobalOptions& global,
                        Console& console) {
  const LabelFile a(options.a, console), b(options.b, console);
  a.require_few(options.a);
  b.require_few(options.b);
  const Mask mask(options.mask, console);
  const LabelOverlaps overlaps =
      compare_labels(a.labels().geometry(), a.here(), b.here(), mask.here(), &console);
  console.stage_seconds();
  return finish({{"dice", overlaps_json(overlaps)}}, global);
}

int compare_point_files(const CompareOptions& options, const GlobalOptions& global) {
  std::vector<Vec3d> points[2];
  for (int n = 0; n < 2; ++n) {
    for (const auto& row : read_point_file(n == 0 ? options.a : options.b).rows) {
      points[n].push_back(row.at_lps_mm);
    }
  }
  if (points[0].size() != points[1].size()) {
    throw InputError({options.b, "", with_count(std::int64_t(points[1].size()), "point"),
                      std::to_string(points[0].size()) + ", as in " + options.a});
  }
  return finish({{"points", errors_json(compare_points(points[0], points[1]), "points")}}, global);
}

int run_compare(const CompareOptions& options, const GlobalOptions& global, Console& console) {
  std::optional<Geometry> grid;
  if (!options.grid.empty()) grid = grid_of_file({options.grid});
  const Kind kind = kind_of(options.a, grid ? &*grid : nullptr);
  require_fitting(options, kind);
  OutputPlan plan(global.force);
  for (const std::string* input :
       {&options.a, &options.b, &options.points, &options.labels, &options.grid}) {
    if (!input->empty()) plan.protect(*input);
  }
  if (kind != Kind::pictures && !options.mask.empty()) plan.protect(options.mask);
  if (!options.difference.empty()) {
    kind == Kind::pictures ? plan.add_image(options.difference)
                           : plan.add_dense(options.difference);
  }
  console.claim(plan.files());
  if (kind == Kind::pictures) return compare_pictures(options, global, console);
  if (kind == Kind::warps) return compare_warp_files(options, grid, global, console);
  if (kind == Kind::labels) return compare_label_files(options, global, console);
  return compare_point_files(options, global);
}

}  // namespace

Command add_compare(CLI::App& program) {
  auto options = std::make_shared<CompareOptions>();
  CLI::App* app = add_subcommand(
      program, "compare",
      "Measure how different two PNG pictures are (exit 1 over a limit), or two warps, label "
      "volumes "
      "or lists of points",
      "  supple compare a.png b.png --max-rmse 1e-3 --mask foreground --diff difference.png\n"
      "  supple compare truth.nrrd 1Warp.nii.gz --mask lung.nii.gz --points landmarks.csv\n"
      "  supple compare found.nii.gz drawn.nii.gz");
  app->add_option("a", options->a, "A PNG file, warp, label volume or list of points")
      ->required()
      ->option_text("A");
  app->add_option("b", options->b, "A file of the same kind; pictures of the same size")
      ->required()
      ->option_text("B");
  add_field_options(*app, fields(*options));
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_compare(*options, global, console);
          }};
}

}  // namespace supple::tools
