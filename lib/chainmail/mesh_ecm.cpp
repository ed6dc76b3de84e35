#include "lib/chainmail/mesh_ecm.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "lib/chainmail/mesh_drag.h"
#include "lib/chainmail/node_owners.h"
#include "volumes/base/error.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

using MeshOffsets = std::array<std::int32_t, 3>;
constexpr double kUnitMm = 1 / kFixedOne;
constexpr const char* kRangeText = "finite moves and offsets within +-16383 mm";

/// Turns millimetres to fixed point; `what` names them in the message.
template <class Round>
MeshOffsets fixed_offsets(const Vec3d& mm, Round&& round, const std::string& node,
                          const std::string& what) {
  MeshOffsets fixed;
  for (int c = 0; c < 3; ++c) {
    const double units = round(mm[c] * kFixedOne);
    if (!(std::abs(units) <= double(kMaxOffset))) {
      throw InputError(
          {"", node, what + " " + number_text(mm[c]) + " mm along " + "xyz"[c], kRangeText});
    }
    fixed[std::size_t(c)] = std::int32_t(units);
  }
  return fixed;
}

/// The position's offset from rest, rounded to the nearest unit.
MeshOffsets offset_of(const MeshBody& body, std::size_t node) {
  return fixed_offsets(
      body.pos_mm[node] - body.rest_mm[node], [](double units) { return std::round(units); },
      "node " + std::to_string(node), "an offset of");
}

/// Units by which coordinate differences exceed a step's slack, at most 0 when it holds.
std::int64_t excess_of(const MeshStep& step, std::int32_t from, std::int32_t to) {
  const std::int64_t rise = std::int64_t(to) - from;
  const std::int32_t slack = rise > 0 ? step.in : step.out;
  return slack >= kUnlimitedSlack ? 0 : std::abs(rise) - slack;
}

/// Checks all links; `value(node, c)` is an offset.
template <class Value>
MeshLinkCheck check(const MeshLinks& links, Value&& value) {
  MeshLinkCheck result;
  result.links = std::int64_t(links.link_count());
  std::int64_t worst = 0;
  for (Slot node = 0; node < links.node_count(); ++node) {
    for (std::size_t n = links.first(node); n < links.first(node + 1); ++n) {
      const Slot to = links.step(0, n).to;
      if (to < node) continue;
      std::int64_t excess = 0;
      for (int c = 0; c < 3; ++c) {
        excess = std::max(excess, excess_of(links.step(c, n), value(node, c), value(to, c)));
      }
      result.violated += excess > 0;
      worst = std::max(worst, excess);
    }
  }
  result.worst_excess_mm = double(worst) * kUnitMm;
  return result;
}

void require_range(const HeldNodes::Handle& handle, const std::array<MeshValues, 3>& values,
                   const std::string& name) {
  for (std::size_t c = 0; c < 3; ++c) {
    for (const Slot node : handle.nodes) {
      const std::int64_t target = std::int64_t(values[c].value(node)) + handle.by[c];
      if (std::abs(target) <= kMaxOffset) continue;
      throw InputError({"", name,
                        "a move to an offset of " + number_text(double(target) * kUnitMm) +
                            " mm along " + "xyz"[c],
                        kRangeText});
    }
  }
}

HeldNodes hold(const std::vector<MeshHandle>& handles, const std::vector<NodeSet>& anchors,
               const std::array<MeshValues, 3>& values, std::size_t node_count) {
  NodeOwners owners(node_count);
  HeldNodes held;
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const MeshHandle& handle = handles[h];
    const std::string name = "handle " + std::to_string(h);
    const MeshOffsets by = fixed_offsets(
        handle.by_mm, [](double units) { return std::trunc(units); }, name, "a move by");
    held.handles.push_back(
        {owners.claim(handle.nodes, name, false), by, handle.kind == HandleKind::push});
    require_range(held.handles.back(), values, name);
  }
  for (std::size_t a = 0; a < anchors.size(); ++a) {
    const std::vector<Slot> nodes = owners.claim(anchors[a], "anchor " + std::to_string(a), true);
    held.fixed.insert(held.fixed.end(), nodes.begin(), nodes.end());
  }
  return held;
}

using Drags = std::vector<std::unique_ptr<MeshDrag>>;

/// Moves all coordinates to their whole targets; again, shortened by one common fraction, when
/// anchors stop one of them.
Drags solve(std::array<MeshValues, 3>& values, const HeldNodes& held, Fraction& fraction,
            Progress* progress) {
  Drags drags;
  for (std::size_t c = 0; c < 3; ++c) {
    report(progress, double(c) / 3);
    const bool moves = std::any_of(held.handles.begin(), held.handles.end(),
                                   [&](const HeldNodes::Handle& h) { return h.by[c] != 0; });
    if (!moves) continue;
    drags.push_back(std::make_unique<MeshDrag>(values[c], held, progress));
    drags.back()->try_whole(fraction);
  }
  if (!fraction.is_whole()) {
    for (const auto& drag : drags) drag->redo(fraction);
  }
  return drags;
}

}  // namespace

struct MeshEcm::Coordinates {
  Coordinates(const MeshBody& body, const std::vector<MeshLimits>& limits)
      : links(body, limits),
        values{MeshValues(links, 0), MeshValues(links, 1), MeshValues(links, 2)} {}

  MeshLinks links;
  std::array<MeshValues, 3> values;
};

MeshEcm::MeshEcm(MeshBody& body, const MeshLimits& limits)
    : MeshEcm(body, std::vector<MeshLimits>(body.links.size(), limits)) {}

MeshEcm::MeshEcm(MeshBody& body, const std::vector<MeshLimits>& limits)
    : m_body(body),
      m_coordinates(std::make_unique<Coordinates>(body, limits)),
      m_links(m_coordinates->links),
      m_values(m_coordinates->values) {}

MeshEcm::~MeshEcm() = default;

Vec3d MeshEcm::place_of(Slot node) const {
  const Vec3d offset(m_values[0].value(node), m_values[1].value(node), m_values[2].value(node));
  return m_body.rest_mm[node] + offset * kUnitMm;
}

void MeshEcm::require_positions() const {
  if (m_body.pos_mm.size() == m_links.node_count()) return;
  throw InputError({"", "positions", std::to_string(m_body.pos_mm.size()),
                    "one for each of " + std::to_string(m_links.node_count()) + " nodes"});
}

bool MeshEcm::holds_positions() const {
  require_positions();
  if (!m_is_valid) return false;
  for (Slot node = 0; node < m_body.node_count(); ++node) {
    if (m_body.pos_mm[node] != place_of(node)) return false;
  }
  return true;
}

/// Takes the body's positions as values; projects these when they break limits.
MeshProjection MeshEcm::take_positions(const std::vector<NodeSet>& anchors, Progress* progress) {
  m_is_valid = false;
  for (MeshValues& values : m_values) values.forget();  // of a projection that was cancelled
  for (Slot node = 0; node < m_body.node_count(); ++node) {
    const MeshOffsets offset = offset_of(m_body, node);
    for (std::size_t c = 0; c < 3; ++c) m_values[c].place(node, offset[c]);
  }
  const auto value = [&](Slot node, int c) { return m_values[std::size_t(c)].value(node); };
  MeshProjection projection;
  projection.violated_links = check(m_links, value).violated;
  if (projection.violated_links > 0) {
    std::vector<Slot> anchored;
    NodeOwners owners(m_body.node_count());
    for (std::size_t a = 0; a < anchors.size(); ++a) {
      const std::vector<Slot> nodes = owners.claim(anchors[a], "anchor " + std::to_string(a), true);
      anchored.insert(anchored.end(), nodes.begin(), nodes.end());
    }
    std::array<std::vector<std::int32_t>, 3> before;
    for (std::size_t c = 0; c < 3; ++c) {
      for (const Slot node : anchored) before[c].push_back(m_values[c].value(node));
    }
    for (MeshValues& values : m_values) {
      const std::int64_t largest = values.project(anchored, progress);
      projection.max_move_mm = std::max(projection.max_move_mm, double(largest) * kUnitMm);
    }
    for (std::size_t n = 0; n < anchored.size(); ++n) {
      bool has_moved = false;
      for (std::size_t c = 0; c < 3; ++c)
        has_moved |= m_values[c].value(anchored[n]) != before[c][n];
      projection.held_moved += has_moved;
    }
  }
  m_is_valid = true;
  return projection;
}

/// Gives the body every place, or those of the nodes that changed.
void MeshEcm::give_positions(bool all) {
  if (all) {
    for (Slot node = 0; node < m_body.node_count(); ++node) m_body.pos_mm[node] = place_of(node);
    return;
  }
  for (const MeshValues& values : m_values) {
    for (const auto& change : values.changes()) m_body.pos_mm[change.node] = place_of(change.node);
  }
}

/// Counts nodes whose value differs in any coordinate.
std::int64_t MeshEcm::count_moved() const {
  std::vector<char> is_moved(m_body.node_count(), 0);
  std::int64_t moved = 0;
  for (const MeshValues& values : m_values) {
    for (const auto& change : values.changes()) {
      if (change.before == values.value(change.node) || is_moved[change.node]) continue;
      is_moved[change.node] = 1;
      ++moved;
    }
  }
  return moved;
}

MeshEcmReport MeshEcm::drag(const std::vector<MeshHandle>& handles,
                            const std::vector<NodeSet>& anchors, Progress* progress) {
  const Stopwatch clock;
  MeshEcmReport result;
  const bool is_new = !holds_positions();
  if (is_new) result.projection = take_positions(anchors, progress);

  const HeldNodes held = hold(handles, anchors, m_values, m_body.node_count());
  Fraction fraction;
  const Drags drags = solve(m_values, held, fraction, progress);
  result.fraction_numerator = fraction.numerator;
  result.fraction_denominator = fraction.denominator;
  result.moved = count_moved();
  for (const auto& drag : drags) {
    result.visited += drag->counts().visits;
    result.max_queue = std::max(result.max_queue, drag->counts().max_queue);
    drag->commit();
  }
  give_positions(is_new);
  for (MeshValues& values : m_values) values.forget();
  result.milliseconds = clock.ms();
  return result;
}

MeshLinkCheck MeshEcm::check_links() const {
  require_positions();
  std::vector<MeshOffsets> offsets(m_links.node_count());
  for (std::size_t n = 0; n < offsets.size(); ++n) offsets[n] = offset_of(m_body, n);
  return check(m_links, [&](Slot node, int c) { return offsets[node][std::size_t(c)]; });
}

MeshProjection MeshEcm::project(const std::vector<NodeSet>& anchored, Progress* progress) {
  if (holds_positions()) return {};
  const MeshProjection projection = take_positions(anchored, progress);
  give_positions(true);
  return projection;
}

std::size_t MeshEcm::bytes() const {
  std::size_t total = m_links.bytes();
  for (const MeshValues& values : m_values) total += values.bytes();
  return total;
}

}  // namespace supple
