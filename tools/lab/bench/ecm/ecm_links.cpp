#include <memory>

#include "tools/lab/bench/bodies/ecm_motion.h"
#include "tools/lab/bench/ecm/ecm_cases.h"
#include "tools/lab/bench/ecm/ecm_sides.h"

namespace supple::tools {

namespace {

/// The body under a material with that many links.
Body with_links(const Body& body, int links) {
  Body other = body;
  other.material.links = links;
  other.slacks = SlackTable(other.material, other.geometry.spacing_mm());
  return other;
}

struct LinksSide {
  EcmSide side;
  int links;
  std::shared_ptr<MeasuredBody> measured;  // of all sides with these links
  WarmSide warm;
};

std::vector<LinksSide> warm_up_links(const EcmWorkload& workload, const MeasuredBody& measured,
                                     const std::vector<BenchDrag>& script, Progress& cancel) {
  std::vector<LinksSide> sides;
  for (const EcmSide& side : workload.sides) {
    const int links = std::stoi(side.engine.substr(std::string("links").size()));
    if (!sides.empty() && sides.back().links == links) {
      sides.push_back({side, links, sides.back().measured, {}});
    } else {
      const std::int64_t before = heap_bytes();
      auto body = std::make_shared<MeasuredBody>(MeasuredBody{with_links(measured.body, links), 0});
      body->bytes = heap_bytes() - before;
      sides.push_back({side, links, body, {}});
    }
    LinksSide& added = sides.back();
    added.warm = warm_up({"supple", side.threads}, *added.measured, script, cancel);
    if (sides.size() > 1 && sides[sides.size() - 2].links == links) {
      require_equal_offsets(workload, side, added.warm.checksum,
                            sides[sides.size() - 2].warm.checksum);
    }
  }
  return sides;
}

}  // namespace

std::vector<BenchRow> measure_links(const EcmWorkload& workload, MeasuredBody& measured,
                                    const EcmCaseLimits& limits, Progress& cancel) {
  const Motion motion = motion_of_all(workload, measured.body);
  std::vector<LinksSide> sides = warm_up_links(workload, measured, motion.script, cancel);
  std::vector<TimedSide> timed;
  for (LinksSide& side : sides) {
    TimedSide timed_side;
    timed_side.run = [&](Times& times) {
      side.warm.engine->reset();
      times.ms.push_back(timed_pull(*side.warm.engine, motion.cycle.front(), side.side.threads));
    };
    timed.push_back(std::move(timed_side));
  }
  take_turns(timed, limits.rounds, [&] { report(&cancel, 0); });

  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    const LinksSide& side = sides[n];
    const LinkCheck check = check_links(side.measured->body);
    if (check.violated > 0) {
      throw Error(row_name(workload, side.side) + ": found " + std::to_string(check.violated) +
                  " violated links, expected none");
    }
    const double ns = timed[n].times.median() * 1e6;
    const double nodes = double(side.measured->body.elements.active_count());
    BenchRow row = row_of(workload, side.warm, side.measured->body, side.warm.moved, ns / nodes);
    row["engine"] = side.side.engine;
    row["links"] = check.links;
    row["ns_per_link"] = ns / double(check.links);
    row["relative_time"] = timed[n].times.median() / timed.front().times.median();
    add_times(row, timed[n].times, side.side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools
