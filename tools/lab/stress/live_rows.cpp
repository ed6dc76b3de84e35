#include <algorithm>
#include <cmath>
#include <random>

#include "lib/session/step_model.h"
#include "tools/lab/stress/stress_rows.h"
#include "tools/scene/live/live_session.h"
#include "tools/scene/live/replay.h"
#include "volumes/base/files.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

/// The keys of random events, as TOML.
class RandomOperations {
 public:
  explicit RandomOperations(const Vec3i& dims) : m_dims(dims) {}

  std::string next() {
    switch (below(20)) {
      case 0:
      case 1:
        return "kind = \"grab\"\n" + grabbed();
      case 2:
        return "kind = \"push\"\n" + grabbed();
      case 3:
        return "kind = \"release\"\nall = " + std::string(below(2) == 0 ? "true" : "false") + '\n';
      case 4:
        return below(4) == 0 ? "kind = \"anchor\"\n" + grabbed() : "kind = \"undo\"\n";
      case 5:
        return below(8) == 0 ? cut() : std::string("kind = \"redo\"\n");
      case 6:
        return "kind = \"relax\"\npasses = " + std::to_string(1 + below(12)) + '\n';
      case 7:
        return "kind = \"limits\"\nlimits = \"" +
               std::string(below(4) == 0   ? "ball"
                           : below(3) == 0 ? "tighten"
                                           : "box") +
               "\"\n";
      case 8:
        return model();
      case 9:
        return "kind = \"undo\"\nall = " + std::string(below(2) == 0 ? "true" : "false") + '\n';
      case 10:
        return "kind = \"camera\"\ncamera = { view = \"left\" }\n";
      default:
        return "kind = \"drag\"\nto = " + toml_text({span(6), span(6), span(6)}) + '\n';
    }
  }

 private:
  int below(int count) { return int(m_random() % unsigned(count)); }
  double span(double most) {
    return std::round((double(m_random()) / 4294967295.0 - 0.5) * 2 * most * 64) / 64;
  }
  std::string voxel() { return to_text(Vec3i(below(m_dims.x), below(m_dims.y), below(m_dims.z))); }
  std::string grabbed() {
    switch (below(3)) {
      case 0:
        return "grab_ball = [" + voxel() + "]\nradius = 2\n";
      default:
        return "grab = [" + voxel() + "]\n";
    }
  }
  std::string cut() {
    const Vec3d corner(below(m_dims.x) + 0.5, below(m_dims.y) - 2.5, below(m_dims.z) - 2.5);
    return "kind = \"cut\"\nplane = { frame = \"voxel\", corner = " + toml_text(corner) +
           ", edge1 = " + toml_text({span(1), 5, 0}) + ", edge2 = " + toml_text({span(1), 0, 5}) +
           " }\n";
  }
  std::string model() {
    if (below(3) != 0) return "kind = \"model\"\nmodel = \"ecm\"\n";
    const char* integrators[] = {"implicit", "projective", "xpbd"};
    return std::string("kind = \"model\"\nmodel = \"springs\"\nsprings = { integrator = \"") +
           integrators[below(3)] + "\", time = 0.02, step = 0.005 }\n";
  }

  std::mt19937 m_random{20011};
  Vec3i m_dims;
};

/// Counts of faults that no operation may cause.
struct LiveFaults {
  double refused = 0, refused_with_change = 0;
  double violated = 0;      // links after operations that keep them
  double beyond_range = 0;  // elements
  double strange = 0;       // velocities that are no numbers
};

bool keeps_limits(const LiveSession& live, EventKind kind) {
  if (live.model().name == "springs") return false;
  return kind == EventKind::relax || (kind == EventKind::drag && live.limits() == Limits::box);
}

void look_at(const LiveSession& live, const Session& session, EventKind kind, LiveFaults& faults) {
  const Body& body = session.body();
  for (const BrickValues& q : body.q) {
    for (std::size_t b = 0; b < q.brick_count(); ++b) {
      const std::int32_t* values = q.brick(b);
      if (values == nullptr) continue;
      faults.beyond_range +=
          double(std::count_if(values, values + kBrickVoxels,
                               [](std::int32_t v) { return v > kMaxOffset || v < -kMaxOffset; }));
    }
  }
  for (const BrickArray<double>& velocity : body.velocity_mm_s) {
    for (std::size_t b = 0; b < velocity.brick_count(); ++b) {
      const double* values = velocity.brick(b);
      if (values == nullptr) continue;
      faults.strange += double(
          std::count_if(values, values + kBrickVoxels, [](double v) { return !std::isfinite(v); }));
    }
  }
  const bool has_moved = session.records().empty() || !session.records().back().drags.empty() ||
                         session.records().back().relax.has_value();
  if (has_moved && keeps_limits(live, kind)) faults.violated += double(check_links(body).violated);
}

LiveEvent event_of(const std::string& keys, int number) {
  const std::string place = "operation " + std::to_string(number);
  Table root = Table::parse("[[event]]\n" + keys, place);
  std::vector<Table> tables = root.tables("event");
  LiveEvent event = read_event(tables.front(), {});
  event.place = event.step.place = place;
  return event;
}

void carry_out(LiveSession& live, const LiveEvent& event, Console& console, LiveFaults& faults) {
  Session& session = live.session();
  const std::size_t steps = session.records().size();
  try {
    live.carry_out(event, &console);
    look_at(live, session, event.kind, faults);
  } catch (const InputError&) {
    faults.refused += 1;
    faults.refused_with_change += session.records().size() != steps;
  }
}

/// Writes the events that led to the error, and that which did not go on, as a journal.
void write_journal(const LiveSession& live, const std::string& next, const std::string& folder) {
  replace_text_file(folder + "/journal.toml",
                    toml_document(live.journal()) + "\n[[event]]\n" + next);
}

std::string replayed_hash(const Value& journal, const std::string& folder, Console& console) {
  LiveSession again(Table(journal, folder + "/journal.toml"), &console);
  for (const LiveEvent& event : again.events()) {
    again.carry_out(event, &console);
    again.stop();
  }
  return hash_of(again.session().state());
}

}  // namespace

void run_live(const StressInput& input, const std::string& folder, Console& console,
              MeasuredValues& all) {
  LiveSession live(Table::read(write_input(input, folder, true)), &console);
  const std::string start = hash_of(live.session().state());
  RandomOperations operations(input.dims);
  LiveFaults faults;
  double moved = 0;
  console.stage("operations");
  for (int n = 0; n < input.operations; ++n) {
    report(&console, double(n) / input.operations);
    const std::string keys = operations.next();
    try {
      carry_out(live, event_of(keys, n), console, faults);
      if (live.has_more() && n % 2 == 0) live.go_on(&console);
    } catch (const Cancelled&) {
      throw;
    } catch (const std::exception&) {
      write_journal(live, keys, folder);
      throw;
    }
  }
  for (const StepRecord& record : live.session().records()) moved += double(record.report.moved);
  const std::string last = hash_of(live.session().state());
  const bool is_replayed = replayed_hash(live.journal(), folder, console) == last;
  while (!live.history().done.empty()) {
    const std::size_t left = live.history().done.size();
    live.carry_out(event_of("kind = \"undo\"\n", input.operations), &console);
    if (live.history().done.size() == left) break;  // older steps are not kept
  }
  const bool is_back = hash_of(live.session().state()) == start;
  const double most_refused = 0.8 * input.operations;
  all.push_back({"operations refused", faults.refused, 0, most_refused});
  all.push_back({"refused, yet something changed", faults.refused_with_change, 0, 0});
  all.push_back({"elements moved in all", moved, 1, 1e12});
  all.push_back({"links beyond their limits", faults.violated, 0, 0});
  all.push_back({"elements beyond the range", faults.beyond_range, 0, 0});
  all.push_back({"velocities that are no numbers", faults.strange, 0, 0});
  all.push_back({"undone to the start", is_back ? 1.0 : 0.0, 1, 1});
  all.push_back({"replayed to the same state", is_replayed ? 1.0 : 0.0, 1, 1});
}

}  // namespace supple::tools
