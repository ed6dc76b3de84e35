#include <algorithm>

#include "lib/body/slot_set.h"
#include "lib/chainmail/ball_limits.h"
#include "tools/lab/bench/bodies/ecm_motion.h"
#include "tools/lab/bench/ecm/ecm_cases.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

using BallOffsets = std::array<BrickValues, 3>;

struct BallSide {
  EcmSide side;
  EcmReport box;
  BallReport ball;
  BallOffsets q;  // after the pull
};

bool is_ball(const BallSide& side) {
  return side.side.engine == "ball";
}

/// One pull from rest; returns its milliseconds.
double pull_from_rest(BallSide& side, Body& body, const BenchDrag& pull, Progress& cancel) {
  release_offsets(body);
  const ThreadLimit limit(side.side.threads);
  const double ms = time_ms([&] {
    if (is_ball(side)) {
      side.ball = drag_ball(body, {{pull.voxel, pull.by_q}}, {}, {}, &cancel);
    } else {
      side.box = drag(body, {{pull.voxel, pull.by_q}}, {}, &cancel);
    }
  });
  side.q = body.q;
  return ms;
}

/// Euclidean, in voxels.
struct Distance {
  double mean = 0, largest = 0;
};
Distance distance_between(const Body& body, const BallOffsets& a, const BallOffsets& b) {
  Distance distance;
  for_each_element(body.elements, [&](Slot slot) {
    Vec3d apart;
    for (int c = 0; c < 3; ++c) {
      apart[c] = (double(a[std::size_t(c)].at(slot)) - b[std::size_t(c)].at(slot)) / kFixedOne;
    }
    distance.mean += apart.length();
    distance.largest = std::max(distance.largest, apart.length());
  });
  distance.mean /= double(body.elements.active_count());
  return distance;
}

BenchRow row_of(const EcmWorkload& workload, const BallSide& side, const Body& body,
                const Times& times) {
  const double nodes = double(body.elements.active_count());
  return {{"case", workload.kind},
          {"engine", side.side.engine},
          {"field", workload.field},
          {"size", {workload.size.x, workload.size.y, workload.size.z}},
          {"direction", workload.direction},
          {"start", workload.start},
          {"nodes", body.elements.active_count()},
          {"moved", is_ball(side) ? side.ball.moved : side.box.moved},
          {"ns_per_node", times.median() * 1e6 / nodes},
          {"max_list", is_ball(side) ? side.ball.max_queue : side.box.max_queue}};
}

}  // namespace

std::vector<BenchRow> measure_ball(const EcmWorkload& workload, MeasuredBody& measured,
                                   const EcmCaseLimits& limits, Progress& cancel) {
  Body& body = measured.body;
  const BenchDrag pull = motion_of_all(workload, body).script.front();
  std::vector<BallSide> sides;
  for (const EcmSide& side : workload.sides) sides.push_back({side, {}, {}, {}});
  std::vector<TimedSide> timed;
  for (BallSide& side : sides) {
    TimedSide timed_side;
    timed_side.run = [&](Times& times) {
      times.ms.push_back(pull_from_rest(side, body, pull, cancel));
    };
    timed.push_back(std::move(timed_side));
  }
  take_turns(timed, limits.rounds, [&] { report(&cancel, 0); });
  BallSide box{{"supple", 1}, {}, {}, {}};
  pull_from_rest(box, body, pull, cancel);
  release_offsets(body);

  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    BenchRow row = row_of(workload, sides[n], body, timed[n].times);
    if (is_ball(sides[n])) {
      const Distance distance = distance_between(body, sides[n].q, box.q);
      row["moves"] = sides[n].ball.moves;
      row["capped"] = sides[n].ball.capped;
      row["violated"] = sides[n].ball.violated;
      row["worst_excess_voxels"] = sides[n].ball.worst_excess_voxels;
      row["mean_distance_voxels"] = distance.mean;
      row["max_distance_voxels"] = distance.largest;
    }
    add_times(row, timed[n].times, sides[n].side.threads);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools
