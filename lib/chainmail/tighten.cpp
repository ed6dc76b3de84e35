#include "lib/chainmail/tighten.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "lib/chainmail/projection.h"
#include "volumes/base/error.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

/// An iteration that takes away less than this part of the squares is undone.
constexpr double kLeastGain = 0.01;

class Tightening {
 public:
  Tightening(Body& body, const SlotSet& anchored, const Holds& held, const TightenParams& params,
             Progress* progress)
      : m_body(body),
        m_anchored(anchored),
        m_held(held),
        m_params(params),
        m_progress(progress),
        m_propagator(body),
        m_q(body.q) {
    for (BrickValues& values : m_q) values.resize(body.elements.brick_count());
    find_bounds();
  }

  void run(TightenReport& result) {
    TightCheck now = check();
    result.excess_before_voxels = now.norm_voxels();
    while (now.squares > 0 && result.iterations < m_params.iterations) {
      report(m_progress, double(result.iterations) / m_params.iterations);
      const LinkOffsets before = m_q;
      iterate();
      const TightCheck next = check();
      if (double(next.squares) > (1 - kLeastGain) * double(now.squares)) {
        m_q = before;
        result.settled = true;
        break;
      }
      now = next;
      ++result.iterations;
    }
    result.settled |= now.squares == 0;
    result.links = now.links;
    result.violated = now.violated;
    result.worst_excess_voxels = double(now.worst) / kFixedOne;
    result.excess_voxels = now.norm_voxels();
  }

  /// Writes the offsets to the body; returns how many elements they move.
  std::int64_t commit() {
    std::int64_t moved = 0;
    for (std::size_t b = 0; b < m_body.elements.brick_count(); ++b) {
      std::int32_t changes[kBrickVoxels] = {};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int32_t* now = m_q[c].brick(b);
        const std::int32_t* before = m_body.q[c].brick(b);
        if (now == nullptr && before == nullptr) continue;
        now = m_q[c].brick_or_zero(b);
        before = m_body.q[c].brick_or_zero(b);
        for (int n = 0; n < kBrickVoxels; ++n) changes[n] |= before[n] ^ now[n];
      }
      moved += kBrickVoxels - std::count(changes, changes + kBrickVoxels, 0);
    }
    for (std::size_t c = 0; c < 3; ++c) {
      if (m_q[c].empty()) m_q[c].clear();
      m_body.q[c].swap(m_q[c]);
      for (std::size_t b = 0; b < m_body.fraction[c].brick_count(); ++b) {
        m_body.drop_fractions(int(c), b, m_q[c].brick_or_zero(b));
      }
    }
    return moved;
  }

 private:
  TightCheck check() { return check_tight(m_body, m_q, m_params.tolerance, m_missing); }

  void iterate() {
    for (int c = 0; c < 3; ++c) {
      if (!move_chains(c)) continue;
      BrickValues& values = m_q[std::size_t(c)];
      values = projected(values, c, m_bounds[std::size_t(c)], m_propagator, m_progress);
    }
  }

  /// Moves every chain along axis c with a link to be changed; false when there is none.
  bool move_chains(int c) {
    BrickValues& missing = m_missing[std::size_t(c)];
    bool found = false;
    for (std::size_t b = 0; b < missing.brick_count(); ++b) {
      if (missing.brick(b) == nullptr) continue;
      for (std::size_t n = 0; n < kBrickVoxels; ++n) {
        if (missing.brick(b)[n] == 0) continue;
        move_chain(c, Slot(b * kBrickVoxels + n));
        found = true;
      }
    }
    return found;
  }

  /// Moves the chain through an element; then nothing is missing there any more.
  void move_chain(int c, Slot through) {
    BrickValues& missing = m_missing[std::size_t(c)];
    Slot slot = through;
    while (neighbour_slot(m_body.elements, m_body.cuts, slot, c, false, slot)) {
    }
    m_chain.clear();
    m_moves.clear();
    std::int64_t move = 0;
    for (bool more = true; more;) {
      m_chain.push_back(slot);
      m_moves.push_back(move);
      const std::int32_t change = missing.at(slot);
      move += change;
      if (change != 0) missing.set(slot, 0);
      more = neighbour_slot(m_body.elements, m_body.cuts, slot, c, true, slot);
    }
    anchor_chain(c);
    for (std::size_t n = 0; n < m_chain.size(); ++n) {
      if (m_moves[n] == 0) continue;
      const std::int64_t place = m_q[std::size_t(c)].at(m_chain[n]) + m_moves[n];
      m_q[std::size_t(c)].set(
          m_chain[n], std::int32_t(std::clamp<std::int64_t>(place, -kMaxOffset, kMaxOffset)));
    }
  }

  /// Chooses the elements of a chain that do not move.
  void anchor_chain(int c) {
    const std::size_t none = m_chain.size();
    std::size_t first = none, last = none;
    for (std::size_t n = 0; n < m_chain.size(); ++n) {
      if (!is_held(c, m_chain[n])) continue;
      if (first == none) first = n;
      last = n;
    }
    if (first == none) {
      const std::int64_t middle = median_move();
      for (std::int64_t& move : m_moves) move -= middle;
      return;
    }
    const std::int64_t at_first = m_moves[first], at_last = m_moves[last];
    for (std::size_t n = 0; n < m_chain.size(); ++n) {
      m_moves[n] = n < first ? m_moves[n] - at_first : n > last ? m_moves[n] - at_last : 0;
    }
  }

  /// The median, about which as many elements move up as down: the shift with the smallest sum of
  /// moves, in the middle where there are several.
  std::int64_t median_move() {
    m_sorted = m_moves;
    const auto upper = m_sorted.begin() + std::ptrdiff_t(m_sorted.size() / 2);
    std::nth_element(m_sorted.begin(), upper, m_sorted.end());
    if (m_sorted.size() % 2 == 1) return *upper;
    return (*upper + *std::max_element(m_sorted.begin(), upper)) / 2;
  }

  bool is_held(int c, Slot slot) const {
    const auto bounds = [&](const std::vector<Bound>& list) {
      const auto found =
          std::lower_bound(list.begin(), list.end(), slot,
                           [](const Bound& bound, Slot wanted) { return bound.slot < wanted; });
      return found != list.end() && found->slot == slot;
    };
    return m_anchored.contains(slot) || bounds(m_held.at_least[std::size_t(c)]) ||
           bounds(m_held.at_most[std::size_t(c)]);
  }

  /// Finds bounds. Held elements stay where the body has them; pushed ones stay at or beyond their
  /// bound, or, where a projection took them back, no further back.
  void find_bounds() {
    for (std::size_t c = 0; c < 3; ++c) {
      const BrickValues& q = m_body.q[c];
      HeldBounds& bounds = m_bounds[c];
      m_anchored.for_each([&](Slot slot) { bounds.least.push_back({slot, q.at(slot)}); });
      bounds.most = bounds.least;
      for (const Bound& bound : m_held.at_least[c]) {
        bounds.least.push_back({bound.slot, std::min(bound.value, q.at(bound.slot))});
      }
      for (const Bound& bound : m_held.at_most[c]) {
        bounds.most.push_back({bound.slot, std::max(bound.value, q.at(bound.slot))});
      }
    }
  }

  Body& m_body;
  const SlotSet& m_anchored;
  const Holds& m_held;
  const TightenParams& m_params;
  Progress* m_progress;
  Propagator m_propagator;
  LinkOffsets m_q;        // of the present iteration
  LinkOffsets m_missing;  // changes of length, at the lower end of a link
  std::array<HeldBounds, 3> m_bounds;
  std::vector<Slot> m_chain;
  std::vector<std::int64_t> m_moves, m_sorted;  // of the chain's elements
};

}  // namespace

void TightenParams::validate() const {
  if (iterations < 0 || iterations > 1000) {
    throw InputError({"", "iterations", std::to_string(iterations), "0 to 1000"});
  }
  if (!(tolerance >= 1e-4 && tolerance <= 1)) {
    throw InputError({"", "tolerance", number_text(tolerance), "1e-4 to 1 rest lengths"});
  }
}

TightenReport tighten(Body& body, const std::vector<Region>& fixed, const Holds& held,
                      const TightenParams& params, Progress* progress) {
  const Stopwatch clock;
  params.validate();
  TightenReport result;
  SlotSet anchored = held.anchored;
  for (const Region& region : fixed) anchored.add(elements_of(body, region, "fix"));
  if (!body.links_known_valid || body.beyond) {
    const ProjectionReport projection = project(body, anchored, held);
    result.projected_links = projection.violated_links;
    result.projected_max_voxels = projection.max_move_voxels;
    result.projected_held = projection.held_moved;
  }

  Tightening tightening(body, anchored, held, params, progress);
  tightening.run(result);
  result.moved = tightening.commit();
  result.milliseconds = clock.ms();
  return result;
}

}  // namespace supple
