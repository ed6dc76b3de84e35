#include "tools/lab/bench/elastic/relax_cases.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <random>

#include "lib/body/slot_set.h"
#include "lib/chainmail/tighten.h"
#include "lib/model/relax_model.h"
#include "tools/lab/bench/bodies/ecm_motion.h"
#include "tools/lab/bench/report/timing.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

/// A body under a drag, and what holds it.
struct DraggedBody {
  Body body;
  SlotSet anchored;
  Holds holds;
};

/// The body under a material with that many links.
Body with_links(Body body, int links) {
  body.material.links = links;
  body.slacks = SlackTable(body.material, body.geometry.spacing_mm());
  return body;
}

RelaxParams params_of(const RelaxRow& row) {
  RelaxParams params;
  params.method = row.method;
  params.bulk_modulus_kpa = row.volume_kpa;
  return params;
}

/// The front pulled along j by that many voxels, the rearmost layers fixed.
DraggedBody pull_front(const Body& rest, double voxels, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const IndexBox& bounds = rest.elements.active_bounds();
  Vec3i front;
  nearest_element(
      rest, {(bounds.lo.x + bounds.hi.x) / 2, bounds.hi.y, (bounds.lo.z + bounds.hi.z) / 2}, front);
  IndexBox back = bounds;
  back.hi.y = back.lo.y + (bounds.hi.y - bounds.lo.y) / 16;
  drag(dragged.body, {{front, {0, std::int32_t(voxels * kFixedOne), 0}}}, {Region(back)},
       dragged.holds, &cancel);
  dragged.anchored = anchored_elements(dragged.body, {Region(back)}, dragged.holds);
  return dragged;
}

/// The middle pulled along every axis, so far that much of the body follows.
DraggedBody pull_middle(const Body& rest, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const auto by = std::int32_t(0.25 * rest.elements.active_bounds().hi.y * kFixedOne);
  drag(dragged.body, {{middle_element(rest), {by, by, by}}}, {}, dragged.holds, &cancel);
  dragged.anchored = anchored_elements(dragged.body, {}, dragged.holds);
  return dragged;
}

/// One to three random elements dragged by up to 8 voxels in every axis.
DraggedBody drag_at_random(const Body& rest, std::mt19937& random, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const IndexBox& bounds = rest.elements.active_bounds();
  for (int handles = 1 + int(random() % 3); handles > 0; --handles) {
    Vec3i voxel;
    std::array<std::int32_t, 3> by;
    for (int c = 0; c < 3; ++c) {
      voxel[c] = bounds.lo[c] + int(random() % unsigned(bounds.hi[c] - bounds.lo[c] + 1));
      by[std::size_t(c)] = std::int32_t(random() % (16u * 65536)) - 8 * 65536;
    }
    nearest_element(rest, voxel, voxel);
    drag(dragged.body, {{voxel, by}}, {}, dragged.holds, &cancel);
  }
  dragged.anchored = anchored_elements(dragged.body, {}, dragged.holds);
  return dragged;
}

/// Plates without friction push two layers at both ends along k together, by 30 % of the height
/// between them.
DraggedBody press(const Body& rest, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const IndexBox& box = rest.elements.active_bounds();
  const auto by = std::int32_t(0.15 * (box.hi.z - box.lo.z - 2) * kFixedOne);
  const Region low(box.lo, {box.hi.x, box.hi.y, box.lo.z + 1});
  const Region high({box.lo.x, box.lo.y, box.hi.z - 1}, box.hi);
  drag(dragged.body, {{low, {0, 0, by}, HandleKind::push}, {high, {0, 0, -by}, HandleKind::push}},
       {}, dragged.holds, &cancel);
  return dragged;
}

/// One end along i stays, the other is pulled away by 20 % of the length.
DraggedBody pull_end(const Body& rest, Progress& cancel) {
  DraggedBody dragged{rest, {}, {}};
  const IndexBox& box = rest.elements.active_bounds();
  const auto by = std::int32_t(0.2 * (box.hi.x - box.lo.x) * kFixedOne);
  const Region low(box.lo, {box.lo.x, box.hi.y, box.hi.z});
  const Region high({box.hi.x, box.lo.y, box.lo.z}, box.hi);
  drag(dragged.body, {{high, {by, 0, 0}}}, {low}, dragged.holds, &cancel);
  // From here on elements hold the bar, without a region.
  dragged.anchored = anchored_elements(dragged.body, {low}, dragged.holds);
  dragged.holds.anchored = dragged.anchored;
  return dragged;
}

DraggedBody press_or_pull(const RelaxRow& row, const Body& rest, Progress& cancel) {
  return row.field == "tissue_bar" ? pull_end(rest, cancel) : press(rest, cancel);
}

BenchRow row_of(const RelaxRow& row, const Body& body) {
  BenchRow fields;
  fields["case"] = row.kind;
  fields["method"] = name_of(row.method);
  if (row.kind == "links") fields["links_per_node"] = row.links;
  if (row.is_of_volume()) fields["volume_kpa"] = row.volume_kpa;
  fields["field"] = row.field;
  const Vec3i size = body.geometry.dims();
  fields["size"] = {size.x, size.y, size.z};
  fields["nodes"] = body.elements.active_count();
  return fields;
}

double mean(const Times& times) {
  double sum = 0;
  for (const double ms : times.ms) sum += ms;
  return sum / double(times.ms.size());
}

/// Percent of the elements that are not where they were at rest.
double moved_percent(const Body& body) {
  std::int64_t moved = 0;
  for_each_element(body.elements, [&](Slot slot) {
    moved += (body.q[0].at(slot) | body.q[1].at(slot) | body.q[2].at(slot)) != 0;
  });
  return 100.0 * double(moved) / double(body.elements.active_count());
}

}  // namespace

/// Passes of all rows in turns, each on a relaxation of its own that has run for a while, so that
/// memory is there and what moves is in motion.
std::vector<BenchRow> measure_passes(const std::vector<RelaxRow>& rows, const Body& rest,
                                     bool quick, Progress& cancel) {
  std::map<int, DraggedBody> starts;  // by links
  for (const RelaxRow& row : rows) {
    if (starts.count(row.links) != 0) continue;
    const Body body = with_links(rest, row.links);
    starts.insert(
        {row.links, row.kind == "volume"
                        ? pull_middle(body, cancel)
                        : pull_front(body, 0.45 * body.elements.active_bounds().hi.y, cancel)});
  }
  std::vector<std::unique_ptr<Relaxation>> relaxations;
  std::vector<TimedSide> sides;
  for (const RelaxRow& row : rows) {
    DraggedBody& start = starts.at(row.links);
    relaxations.push_back(
        std::make_unique<Relaxation>(start.body, start.anchored, start.holds, params_of(row)));
    for (int n = 0; n < 2 * row.count; ++n) relaxations.back()->pass();
    sides.push_back({[&relaxation = *relaxations.back(), &row](Times& times) {
                       const ThreadLimit limit(row.threads);
                       for (int n = 0; n < row.count; ++n) {
                         times.ms.push_back(time_ms([&] { relaxation.pass(); }));
                       }
                     },
                     0,
                     {}});
  }
  take_turns(sides, quick ? RoundLimits{6, 6, 400} : RoundLimits{12, 12, 2000},
             [&] { report(&cancel, 0); });
  std::vector<BenchRow> result;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BenchRow fields = row_of(rows[n], rest);
    relaxations[n]->store();
    const Body& body = starts.at(rows[n].links).body;
    const double nodes = double(rest.elements.active_count());
    fields["moved_percent"] = moved_percent(body);
    fields["ns_per_node_pass"] = sides[n].times.median() * 1e6 / nodes;
    if (rows[n].kind == "links") {
      const LinkCheck check = check_links(body);
      fields["links"] = check.links;
      fields["violated"] = check.violated;
      fields["ns_per_link_pass"] = sides[n].times.median() * 1e6 / double(check.links);
    }
    fields["mean_ns_per_node_pass"] = mean(sides[n].times) * 1e6 / nodes;
    fields["bytes_per_node"] = double(relaxations[n]->bytes()) / nodes;
    add_times(fields, sides[n].times, rows[n].threads);
    result.push_back(std::move(fields));
  }
  return result;
}

/// Limits are counted after every pass.
std::vector<BenchRow> measure_states(const std::vector<RelaxRow>& rows, const Body& rest,
                                     Progress& cancel) {
  std::vector<BenchRow> result;
  for (const RelaxRow& row : rows) {
    // The accelerated method looks for elements that block each other in the 24th.
    const int passes = row.method == RelaxMethod::accelerated ? 25 : 5;
    std::mt19937 random(2001);
    Times times;
    std::int64_t violations = 0, links = 0, rises = 0;
    double worst = 0, before = 0, after = 0;
    for (int n = 0; n < row.count; ++n) {
      DraggedBody state = drag_at_random(rest, random, cancel);
      Relaxation relaxation(state.body, state.anchored, state.holds, params_of(row));
      double energy = HUGE_VAL;
      const auto compare = [&](double now) {
        rises += now > energy * (1 + 1e-12);
        energy = now;
      };
      for (int pass = 0; pass < passes; ++pass) {
        report(&cancel, 0);
        times.ms.push_back(time_ms([&] { relaxation.pass(); }));
        compare(relaxation.energy_before_pass());
        if (pass == 0) before += energy;
        relaxation.store();
        const LinkCheck check = check_links(state.body);
        violations += check.violated;
        links += check.links;
        worst = std::max(worst, check.worst_excess_voxels);
      }
      compare(relaxation.energy());
      after += energy;
    }
    BenchRow fields = row_of(row, rest);
    fields["states"] = row.count;
    fields["passes"] = passes;
    fields["violations"] = violations;
    fields["violated_percent"] = 100.0 * double(violations) / double(links);
    fields["worst_excess_voxels"] = worst;
    fields["energy_rises"] = rises;
    fields["energy_before"] = before / row.count;
    fields["energy_after"] = after / row.count;
    add_times(fields, times, row.threads);
    result.push_back(std::move(fields));
  }
  return result;
}

/// Energies after every pass of each method.
std::vector<BenchRow> measure_descent(const std::vector<RelaxRow>& rows, const Body& rest,
                                      Progress& cancel) {
  DraggedBody start = pull_front(rest, 4, cancel);
  std::vector<std::vector<double>> energies;
  std::vector<Times> times(rows.size());
  double least = HUGE_VAL;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    Relaxation relaxation(start.body, start.anchored, start.holds, params_of(rows[n]));
    energies.emplace_back();
    for (int pass = 0; pass < rows[n].count; ++pass) {
      report(&cancel, 0);
      times[n].ms.push_back(time_ms([&] { relaxation.pass(); }));
      energies.back().push_back(relaxation.energy_before_pass());
    }
    energies.back().push_back(relaxation.energy());
    // A relaxation that breaks limits is no measure for those that keep them.
    if (rows[n].method != RelaxMethod::plain) least = std::min(least, energies.back().back());
  }
  std::vector<BenchRow> result;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    BenchRow fields = row_of(rows[n], rest);
    const std::vector<double>& energy = energies[n];
    fields["energy_before"] = energy.front();
    for (const int passes : {10, 20, 100, 500}) {
      fields["energy_" + std::to_string(passes)] = energy[std::size_t(passes)];
    }
    fields["energy_after"] = energy.back();
    fields["passes"] = rows[n].count;
    const auto near = std::find_if(energy.begin(), energy.end(),
                                   [&](double value) { return value <= 1.01 * least; });
    if (near == energy.end() || rows[n].method == RelaxMethod::plain) {
      fields["passes_to_1_percent"] = nullptr;
    } else {
      fields["passes_to_1_percent"] = near - energy.begin();
    }
    add_times(fields, times[n], rows[n].threads);
    result.push_back(std::move(fields));
  }
  return result;
}

/// Runs `measure` on the pressed or pulled body of each row; it returns the times of the row.
template <class Measure>
std::vector<BenchRow> measure_dragged(const std::vector<RelaxRow>& rows, const Body& rest,
                                      Progress& cancel, const Measure& measure) {
  std::vector<BenchRow> result;
  for (const RelaxRow& row : rows) {
    DraggedBody start = press_or_pull(row, rest, cancel);
    BenchRow fields = row_of(row, rest);
    fields["volume_dragged"] = cell_volumes(start.body).ratio();
    const Times times = measure(row, start, fields);
    fields["violations"] = check_links(start.body).violated;
    add_times(fields, times, row.threads);
    result.push_back(std::move(fields));
  }
  return result;
}

/// The part of the volume that is left after so many passes.
std::vector<BenchRow> measure_press(const std::vector<RelaxRow>& rows, const Body& rest,
                                    Progress& cancel) {
  return measure_dragged(
      rows, rest, cancel, [&](const RelaxRow& row, DraggedBody& start, BenchRow& fields) {
        Relaxation relaxation(start.body, start.anchored, start.holds, params_of(row));
        Times times;
        for (int pass = 1; pass <= row.count; ++pass) {
          report(&cancel, 0);
          times.ms.push_back(time_ms([&] { relaxation.pass(); }));
          const bool is_shown = pass == 10 || pass == 20 || pass == 50 || pass == 100;
          if (!is_shown && pass != row.count) continue;
          relaxation.store();
          const double ratio = cell_volumes(start.body).ratio();
          if (is_shown) fields["volume_" + std::to_string(pass)] = ratio;
          if (pass == row.count) fields["volume_after"] = ratio;
        }
        fields["passes"] = row.count;
        return times;
      });
}

/// The same start, tightened again and again.
std::vector<BenchRow> measure_tighten(const std::vector<RelaxRow>& rows, const Body& rest,
                                      Progress& cancel) {
  return measure_dragged(
      rows, rest, cancel, [&](const RelaxRow& row, DraggedBody& start, BenchRow& fields) {
        fields["relax_passes"] = row.count;
        RelaxParams relaxing = params_of(row);
        relaxing.passes = row.count;
        if (row.count > 0) relax(start.body, {}, start.holds, relaxing, &cancel);
        fields["volume_before"] = cell_volumes(start.body).ratio();

        const Body before = start.body;
        TightenReport tightened;
        Times times;
        for (int n = 0; n < 20; ++n) {
          start.body = before;
          times.ms.push_back(time_ms(
              [&] { tightened = tighten(start.body, {}, start.holds, TightenParams(), &cancel); }));
        }
        const CellVolumes volumes = cell_volumes(start.body);
        fields["volume_after"] = volumes.ratio();
        fields["smallest_cell"] = volumes.smallest;
        fields["largest_cell"] = volumes.largest;
        fields["iterations"] = tightened.iterations;
        fields["moved"] = tightened.moved;
        fields["ns_per_moved"] = times.median() * 1e6 / double(tightened.moved);
        fields["links"] = tightened.links;
        fields["violated"] = tightened.violated;
        fields["worst_excess_voxels"] = tightened.worst_excess_voxels;
        return times;
      });
}

}  // namespace supple::tools
