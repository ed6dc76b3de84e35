// Projection of an invalid configuration (design.md section 3).
//
// L_j = max_i (q_i - dist(i, j)) is the least valid majorant of q, U_j = min_i (q_i + dist(j, i))
// its greatest valid minorant. floor((L + U) / 2) is valid, since both are: the differences of the
// sums along a link are at most 2 W, of the floors W. Its largest move is the smallest possible:
// a broken chain of links between i and j costs at least half its excess at one of the ends.
//
// Elements a that are held lie between bounds l_a and u_b, l = u = q for those that stay. With
//   A_j = max over a (l_a - dist(a, j)),   B_j = min over b (u_b + dist(j, b))
// min(L, B) and max(U, A) are valid too, and so is floor of half their sum. If the bounds can be
// met at all, A <= B, and U_a <= q_a <= L_a makes both q_a where l_a = u_a = q_a.
#include <algorithm>
#include <cstdlib>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/projection.h"

namespace supple {

namespace {

/// floor((above + below) / 2) in place of `above`.
void average(BrickValues& above, const BrickValues& below) {
  for (std::size_t b = 0; b < above.brick_count(); ++b) {
    if (above.brick(b) == nullptr && below.brick(b) == nullptr) continue;
    std::int32_t* upper = above.touch(b);
    const std::int32_t* lower = below.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      const std::int64_t sum = std::int64_t(upper[offset]) + lower[offset];
      upper[offset] = std::int32_t(sum >= 0 ? sum / 2 : -((1 - sum) / 2));
    }
  }
}

bool meets(const BrickValues& values, const HeldBounds& bounds) {
  return std::all_of(bounds.least.begin(), bounds.least.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) >= seed.value; }) &&
         std::all_of(bounds.most.begin(), bounds.most.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) <= seed.value; });
}

/// Elements that are nearer to each other than a contact allows, and where they are to go.
std::vector<Seed> pressed(const std::vector<ContactLink>& contacts, const BrickValues& values,
                          Direction direction) {
  std::vector<Seed> seeds;
  for (const ContactLink& contact : contacts) {
    const std::int64_t below = values.at(contact.below), above = values.at(contact.above);
    if (above - below >= contact.least) continue;
    if (direction == Direction::raise) {
      seeds.push_back({contact.above, std::int32_t(below + contact.least)});
    } else {
      seeds.push_back({contact.below, std::int32_t(above - contact.least)});
    }
  }
  return seeds;
}

/// Envelopes of one coordinate under links, pieces and contacts.
class Envelopes {
 public:
  Envelopes(const BrickValues& values, int coordinate, const std::vector<ContactLink>& contacts,
            Propagator& propagator, Progress* progress, const FreePieces& pieces)
      : m_values(values),
        m_coordinate(coordinate),
        m_contacts(contacts),
        m_propagator(propagator),
        m_progress(progress),
        m_pieces(pieces),
        m_of_pieces(pieces.empty() ? std::vector<std::size_t>() : pieces.bricks()) {}

  /// That of all elements, or of the seeds.
  void move(Direction direction, BrickValues& moved, const std::vector<Seed>* seeds) {
    moved.resize(m_values.brick_count());
    const PropagationTask task{m_coordinate, direction, moved, nullptr, m_progress};
    if (seeds == nullptr) {
      m_propagator.close(task);
    } else {
      m_propagator.run(task, *seeds);
    }
    for (int run = 0;; ++run) {
      std::vector<Seed> more = pressed(m_contacts, moved, direction);
      if (!m_pieces.empty()) {
        const auto before = [&](std::size_t brick) { return m_values.brick_or_zero(brick); };
        const std::vector<Seed> lagging = m_pieces.lagging(moved, before, direction, m_of_pieces);
        more.insert(more.end(), lagging.begin(), lagging.end());
      }
      if (more.empty()) return;
      if (!m_contacts.empty() && run == kMostRuns) {
        m_has_contradiction = true;
        return;
      }
      m_propagator.run(task, more);
    }
  }
  /// Contacts that go round and round, as links pull back what they push.
  bool has_contradiction() const { return m_has_contradiction; }

 private:
  static constexpr int kMostRuns = 500;

  const BrickValues& m_values;
  const int m_coordinate;
  const std::vector<ContactLink>& m_contacts;
  Propagator& m_propagator;
  Progress* m_progress;
  const FreePieces& m_pieces;
  const std::vector<std::size_t> m_of_pieces;
  bool m_has_contradiction = false;
};

}  // namespace

HeldBounds held_bounds(const Body& body, int c, const SlotSet& anchored, const Holds& held) {
  HeldBounds bounds;
  anchored.for_each([&](Slot slot) { bounds.least.push_back({slot, body.q[c].at(slot)}); });
  bounds.most = bounds.least;
  for (const Bound& bound : held.at_least[c]) bounds.least.push_back({bound.slot, bound.value});
  for (const Bound& bound : held.at_most[c]) bounds.most.push_back({bound.slot, bound.value});
  return bounds;
}

std::int64_t largest_move(const BrickValues& before, const BrickValues& after) {
  std::int64_t largest = 0;
  for (std::size_t b = 0; b < after.brick_count(); ++b) {
    if (after.brick(b) == nullptr) continue;
    const std::int32_t* from = before.brick_or_zero(b);
    const std::int32_t* to = after.brick(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      largest = std::max(largest, std::abs(std::int64_t(to[offset]) - from[offset]));
    }
  }
  return largest;
}

BrickValues projected(const BrickValues& values, int coordinate, const HeldBounds& bounds,
                      Propagator& propagator, Progress* progress, const FreePieces& pieces) {
  const std::vector<ContactLink> none;
  Envelopes envelopes(values, coordinate, none, propagator, progress, pieces);
  BrickValues above = values, below = values;
  envelopes.move(Direction::raise, above, nullptr);
  envelopes.move(Direction::lower, below, nullptr);
  if (!bounds.least.empty() || !bounds.most.empty()) {
    BrickValues lowered = above, raised = below;
    envelopes.move(Direction::lower, lowered, &bounds.most);
    envelopes.move(Direction::raise, raised, &bounds.least);
    average(lowered, raised);
    if (meets(lowered, bounds)) return lowered;
  }
  average(above, below);
  return above;
}

std::optional<BrickValues> projected(const BrickValues& values, int coordinate,
                                     const HeldBounds& bounds,
                                     const std::vector<ContactLink>& contacts,
                                     Propagator& propagator, Progress* progress,
                                     const FreePieces& pieces) {
  Envelopes envelopes(values, coordinate, contacts, propagator, progress, pieces);
  BrickValues lowered = values, raised = values;
  const std::vector<Seed> none;
  envelopes.move(Direction::raise, lowered, &none);
  if (envelopes.has_contradiction()) return std::nullopt;
  envelopes.move(Direction::lower, lowered, &bounds.most);
  envelopes.move(Direction::lower, raised, &none);
  envelopes.move(Direction::raise, raised, &bounds.least);
  if (envelopes.has_contradiction()) return std::nullopt;
  average(lowered, raised);
  if (!meets(lowered, bounds)) return std::nullopt;
  return lowered;
}

ProjectionReport project(Body& body, const SlotSet& fixed, const Holds& held) {
  ProjectionReport report;
  report.violated_links = check_links(body).violated;
  if (report.violated_links > 0) {
    SlotSet anchored = held.anchored;
    anchored.add(fixed);
    Propagator propagator(body);
    const FreePieces pieces = body.rigid.empty() ? FreePieces() : FreePieces(body, {});
    std::array<BrickValues, 3> valid;
    std::int64_t largest = 0;
    for (int c = 0; c < 3; ++c) {
      if (body.q[c].empty()) continue;
      valid[c] = projected(body.q[c], c, held_bounds(body, c, anchored, held), propagator, nullptr,
                           pieces);
      largest = std::max(largest, largest_move(body.q[c], valid[c]));
    }
    report.max_move_voxels = double(largest) / kFixedOne;
    body.q.swap(valid);
    anchored.for_each([&](Slot slot) {
      bool has_moved = false;
      for (int c = 0; c < 3; ++c) has_moved |= body.q[c].at(slot) != valid[c].at(slot);
      report.held_moved += has_moved;
    });
    for (int c = 0; c < 3; ++c) {
      for (std::size_t b = 0; b < body.fraction[c].brick_count(); ++b) {
        body.drop_fractions(c, b, valid[c].brick_or_zero(b));
      }
    }
  }
  body.links_known_valid = true;
  return report;
}

}  // namespace supple
