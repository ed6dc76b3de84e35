// `supple bench fit`: how near Enhanced ChainMail and relaxation come to finite elements on
// standard loads of an elastic block, and with which limits and which bulk modulus.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include "lib/material/material.h"
#include "lib/model/fem_model.h"
#include "lib/model/relax_model.h"
#include "tools/console/command.h"
#include "tools/console/console.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/ecm_bodies.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/error.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

constexpr double kYoung_kpa = 1;
/// Elements that the reference moves by less than this part of its largest move do not count.
constexpr double kLeastMove = 0.01;
constexpr int kMostPasses = 20000;

/// Elements that a handle moves while others stay; about 2 % of the height.
struct StandardLoad {
  const char* name;
  Vec3i size;
  IndexBox grabbed, fixed;
  Vec3d by_voxels;
};

const std::vector<StandardLoad>& standard_loads() {
  static const std::vector<StandardLoad> loads = {
      {"pull", {16, 16, 16}, {{0, 0, 15}, {15, 15, 15}}, {{0, 0, 0}, {15, 15, 0}}, {0, 0, 0.3}},
      {"press", {16, 16, 16}, {{0, 0, 15}, {15, 15, 15}}, {{0, 0, 0}, {15, 15, 0}}, {0, 0, -0.3}},
      {"shear", {16, 16, 16}, {{0, 0, 15}, {15, 15, 15}}, {{0, 0, 0}, {15, 15, 0}}, {0.3, 0, 0}},
      {"bend", {8, 8, 32}, {{0, 0, 31}, {7, 7, 31}}, {{0, 0, 0}, {7, 7, 0}}, {0.6, 0, 0}},
      {"indent", {24, 24, 16}, {{8, 8, 15}, {15, 15, 15}}, {{0, 0, 0}, {23, 23, 0}}, {0, 0, -0.3}},
      {"tug", {24, 24, 16}, {{8, 8, 15}, {15, 15, 15}}, {{0, 0, 0}, {23, 23, 0}}, {0.3, 0, 0}}};
  return loads;
}

const std::vector<std::string> kModels = {"ecm6",    "ecm26",   "relax6",
                                          "relax26", "poisson", "fitted"};

struct FitRow {
  const StandardLoad* load;
  double poisson;
  std::string model;

  std::string name() const {
    return std::string(load->name) + "/" + number_text(poisson) + "/" + model;
  }
};

std::vector<FitRow> plan_fit(const BenchOptions& options) {
  std::vector<FitRow> plan;
  for (const StandardLoad& load : standard_loads()) {
    for (const double poisson :
         options.quick ? std::vector<double>{0.45} : std::vector<double>{0, 0.3, 0.45, 0.48}) {
      for (const std::string& model : kModels) {
        const FitRow row{&load, poisson, model};
        if (is_wanted_row(options.only, row.name())) plan.push_back(row);
      }
    }
  }
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as pull/0.45/poisson"}));
  }
  return plan;
}

/// Links that give by `slack` of their length, along and across.
MaterialTable tissue(double slack, int links, double poisson) {
  char text[400];
  std::snprintf(text, sizeof text,
                "domain = [0, 255]\nlinks = %d\nmax_length = [[0, %.12g]]\nmin_length = [[0, "
                "%.12g]]\nshear = [[0, %.12g]]\nstiffness = [[0, %g]]\npoisson = [[0, %g]]\n",
                links, 1 + slack, std::max(0.01, 1 - slack), slack, kYoung_kpa, poisson);
  return parse_material(text, "bench tissue");
}

Handle handle_of(const StandardLoad& load) {
  std::array<std::int32_t, 3> by;
  for (int c = 0; c < 3; ++c) by[std::size_t(c)] = std::int32_t(load.by_voxels[c] * kFixedOne);
  return Handle(Region(load.grabbed), by);
}

struct FitError {
  double rms = 0, p95 = 0;
};

/// One load and Poisson's ratio with the answer of finite elements.
class FitProblem {
 public:
  FitProblem(const StandardLoad& load, double poisson, Progress& cancel)
      : m_load(load), m_poisson(poisson), m_anchors{Region(load.fixed)}, m_cancel(cancel) {
    Body solved = even_block_body(load.size, tissue(kLoose, 6, poisson));
    Holds holds;
    VoxelFemModel model({solved, m_anchors, holds}, ElasticTable::uniform(kYoung_kpa, poisson));
    model.move({handle_of(load)}, 1, &cancel);
    model.store();
    m_mesh = model.solid().mesh();
    m_wanted = element_displacements(m_mesh, solved);
  }

  FitError of_ecm(double slack, int links) const {
    Body body = even_block_body(m_load.size, tissue(slack, links, m_poisson));
    Holds holds;
    drag(body, {handle_of(m_load)}, m_anchors, holds, &m_cancel);
    return error_of(body);
  }

  FitError of_relaxation(int links, double bulk_modulus_kpa, bool poisson) const {
    Body body = even_block_body(m_load.size, tissue(kLoose, links, m_poisson));
    Holds holds;
    RelaxParams params;
    params.passes = kMostPasses;
    params.tolerance_voxels = 1e-6;
    params.bulk_modulus_kpa = bulk_modulus_kpa;
    params.poisson = poisson;
    RelaxModel model({body, m_anchors, holds}, params);
    model.move({handle_of(m_load)}, 1, &m_cancel);
    run_model(model, params.passes, &m_cancel);
    return error_of(body);
  }

 private:
  static constexpr double kLoose = 0.9;

  FitError error_of(const Body& body) const {
    const std::vector<Vec3d> found = element_displacements(m_mesh, body);
    double off = 0, way = 0, most = 0;
    for (const Vec3d& wanted : m_wanted) most = std::max(most, wanted.length());
    std::vector<double> distances;
    for (std::size_t e = 0; e < found.size(); ++e) {
      const double distance = (found[e] - m_wanted[e]).length();
      off += distance * distance;
      way += m_wanted[e].length2();
      if (m_wanted[e].length() > kLeastMove * most) distances.push_back(distance / most);
    }
    const auto p95 = distances.begin() + std::ptrdiff_t(0.95 * double(distances.size()));
    std::nth_element(distances.begin(), p95, distances.end());
    return {std::sqrt(off / way), *p95};
  }

  const StandardLoad& m_load;
  double m_poisson;
  std::vector<Region> m_anchors;
  Progress& m_cancel;
  HexMesh m_mesh;
  std::vector<Vec3d> m_wanted;
};

/// The value of least error between two values, to 2 % of the value: by golden sections of its
/// logarithm, as if there were one minimum.
double best_between(double lo, double hi, const std::function<double(double)>& error_at) {
  constexpr double kGolden = 0.6180339887498949;
  double a = std::log(lo), b = std::log(hi);
  double x = b - kGolden * (b - a), y = a + kGolden * (b - a);
  double at_x = error_at(std::exp(x)), at_y = error_at(std::exp(y));
  while (b - a > 0.02) {
    if (at_x <= at_y) {
      b = y;
      y = x;
      at_y = at_x;
      at_x = error_at(std::exp(x = b - kGolden * (b - a)));
    } else {
      a = x;
      x = y;
      at_x = at_y;
      at_y = error_at(std::exp(y = a + kGolden * (b - a)));
    }
  }
  return std::exp((a + b) / 2);
}

BenchRow measure(const FitRow& row, const FitProblem& problem) {
  FitError error;
  double slack = 0, bulk_kpa = 0;
  const double ms = time_ms([&] {
    if (row.model == "ecm6" || row.model == "ecm26") {
      const int links = row.model == "ecm6" ? 6 : 26;
      slack = best_between(1e-3, 0.5, [&](double of) { return problem.of_ecm(of, links).rms; });
      error = problem.of_ecm(slack, links);
    } else if (row.model == "fitted") {
      bulk_kpa = best_between(0.05, 500,
                              [&](double of) { return problem.of_relaxation(6, of, false).rms; });
      error = problem.of_relaxation(6, bulk_kpa, false);
    } else {
      const bool is_poisson = row.model == "poisson";
      if (is_poisson) bulk_kpa = kYoung_kpa / (1 - 2 * row.poisson);
      error = problem.of_relaxation(row.model == "relax26" ? 26 : 6, 0, is_poisson);
    }
  });
  BenchRow fields{
      {"case", "fit"}, {"load", row.load->name}, {"poisson", row.poisson}, {"model", row.model}};
  if (slack > 0) fields["slack"] = slack;
  if (bulk_kpa > 0) fields["bulk_over_young"] = bulk_kpa / kYoung_kpa;
  fields["error_rms"] = error.rms;
  fields["error_p95"] = error.p95;
  fields["ms"] = ms;
  return fields;
}

}  // namespace

std::vector<std::string> fit_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const FitRow& row : plan_fit(options)) names.push_back(row.name());
  return names;
}

/// Rows by load (pull, press, shear, bend, indent, tug), Poisson's ratio and model:
///   ecm6, ecm26      Enhanced ChainMail whose links give by the part that comes closest, alike in
///                    length and shear;
///   relax6, relax26  relaxed to the end without a limit in its way;
///   poisson          the same with the bulk modulus E / (1 - 2 nu) (RelaxParams::poisson);
///   fitted           and with the bulk modulus that comes closest.
/// Errors are distances from linear finite elements of the same voxels: root mean square over the
/// way, and the 95th percentile over the way of the handle. Throws UsageError, Cancelled.
BenchReport bench_fit(const BenchOptions& options, Console& console) {
  BenchReport result{"fit", measure_machine(), {}};
  CancelOnly cancel(&console);
  std::unique_ptr<FitProblem> problem;
  const FitRow* last = nullptr;
  const std::vector<FitRow> plan = plan_fit(options);
  for (const FitRow& row : plan) {
    console.stage(row.name());
    if (last == nullptr || last->load != row.load || last->poisson != row.poisson) {
      problem = std::make_unique<FitProblem>(*row.load, row.poisson, cancel);
    }
    result.rows.push_back(measure(row, *problem));
    last = &row;
  }
  return result;
}

}  // namespace supple::tools
