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
#include <memory>
#include <unordered_set>

#include "lib/body/beyond_limits.h"
#include "lib/chainmail/ecm.h"
#include "lib/chainmail/projection.h"

namespace supple {

namespace {

/// floor(sum / 2).
std::int32_t half(std::int64_t sum) {
  return std::int32_t(sum >= 0 ? sum / 2 : -((1 - sum) / 2));
}

/// Puts floor((above + below) / 2) in place of `above`.
void average(BrickValues& above, const BrickValues& below) {
  for (std::size_t b = 0; b < above.brick_count(); ++b) {
    if (above.brick(b) == nullptr && below.brick(b) == nullptr) continue;
    std::int32_t* upper = above.touch(b);
    const std::int32_t* lower = below.brick_or_zero(b);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      upper[offset] = half(std::int64_t(upper[offset]) + lower[offset]);
    }
  }
}

bool meets(const BrickValues& values, const HeldBounds& bounds) {
  return std::all_of(bounds.least.begin(), bounds.least.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) >= seed.value; }) &&
         std::all_of(bounds.most.begin(), bounds.most.end(),
                     [&](const Seed& seed) { return values.at(seed.slot) <= seed.value; });
}

/// Seeds: elements that are nearer to each other than a contact allows, and where they are to go.
/// `pushes` counts those of each contact.
std::vector<Seed> pressed(const std::vector<ContactLink>& contacts, const BrickValues& values,
                          Direction direction, std::vector<int>& pushes) {
  std::vector<Seed> seeds;
  for (std::size_t n = 0; n < contacts.size(); ++n) {
    const ContactLink& contact = contacts[n];
    const std::int64_t below = values.at(contact.below), above = values.at(contact.above);
    if (above - below >= contact.least) continue;
    ++pushes[n];
    if (direction == Direction::raise) {
      seeds.push_back({contact.above, std::int32_t(below + contact.least)});
    } else {
      seeds.push_back({contact.below, std::int32_t(above - contact.least)});
    }
  }
  return seeds;
}

/// The largest |q| by which two states of a coordinate differ.
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

/// Envelopes of one coordinate under links and pieces.
class Envelopes {
 public:
  Envelopes(const BrickValues& values, int coordinate, Propagator& propagator, Progress* progress,
            const FreePieces& pieces)
      : m_values(values),
        m_coordinate(coordinate),
        m_propagator(propagator),
        m_progress(progress),
        m_pieces(pieces) {}

  /// Moves values to the envelope of all elements, or of the seeds.
  void move(Direction direction, BrickValues& moved, const std::vector<Seed>* seeds) {
    moved.resize(m_values.brick_count());
    const PropagationTask task{m_coordinate, direction, moved, nullptr, m_progress};
    if (seeds == nullptr) {
      m_propagator.close(task);
    } else {
      m_propagator.run(task, *seeds);
    }
    if (m_pieces.empty()) return;
    const auto before = [&](std::size_t brick) { return m_values.brick_or_zero(brick); };
    for (;;) {
      const std::vector<Seed> more = m_pieces.lagging(moved, before, direction);
      if (more.empty()) return;
      m_propagator.run(task, more);
    }
  }

 private:
  const BrickValues& m_values;
  const int m_coordinate;
  Propagator& m_propagator;
  Progress* m_progress;
  const FreePieces& m_pieces;
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

BrickValues projected(const BrickValues& values, int coordinate, const HeldBounds& bounds,
                      Propagator& propagator, Progress* progress, const FreePieces& pieces) {
  Envelopes envelopes(values, coordinate, propagator, progress, pieces);
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

ContactProjection::ContactProjection(Body& body, const SlotSet& anchored, const Holds& held,
                                     Progress* progress, Engine engine)
    : m_body(body),
      m_anchored(anchored),
      m_held(held),
      m_progress(progress),
      m_propagator(body, engine) {
  to_admissible(body, m_held);
}

/// Visits the elements of a brick that may not rise (raise) or sink (lower) past a limit, with it.
template <class Visit>
void ContactProjection::for_each_held(int c, std::size_t brick, Direction direction,
                                      Visit&& visit) const {
  const Slot first = Slot(brick * kBrickVoxels);
  if (const BrickMask* mask = m_anchored.find(brick)) {
    const std::int32_t* before = m_undo.saved_of(brick);
    for_each_active(*mask, [&](int offset) { visit(first + Slot(offset), before[offset]); });
  }
  const auto& bounds =
      (direction == Direction::raise ? m_held.at_most : m_held.at_least)[std::size_t(c)];
  auto bound = std::lower_bound(bounds.begin(), bounds.end(), first,
                                [](const Bound& at, Slot slot) { return at.slot < slot; });
  for (; bound != bounds.end() && bound->slot < first + kBrickVoxels; ++bound) {
    visit(bound->slot, bound->value);
  }
}

/// Seeds that take back elements that went too far. An element is beyond B (below A) only if the
/// held one that bounds it is beyond its own bound, as the envelope is valid: only these count.
std::vector<Seed> ContactProjection::beyond_bounds(int c, Direction direction) const {
  std::vector<Seed> seeds;
  const BrickValues& q = m_body.q[std::size_t(c)];
  for (const std::size_t brick : m_undo.bricks()) {
    for_each_held(c, brick, direction, [&](Slot slot, std::int32_t limit) {
      const std::int32_t now = q.at(slot);
      if (direction == Direction::raise ? now > limit : now < limit) seeds.push_back({slot, limit});
    });
  }
  return seeds;
}

/// Moves to the envelope of `seeds`, or of elements that contacts push, under links and contacts;
/// false where that has no end: a contact that pushes again and again pushes itself round about.
bool ContactProjection::move(int c, const std::vector<ContactLink>& contacts, Direction direction,
                             std::vector<Seed> seeds) {
  constexpr int kMostPushes = 8;
  BrickValues& q = m_body.q[std::size_t(c)];
  const PropagationTask task{c, direction, q, &m_undo, m_progress};
  std::vector<int> pushes(contacts.size(), 0);
  if (seeds.empty()) seeds = pressed(contacts, q, direction, pushes);
  while (!seeds.empty()) {
    m_propagator.run(task, seeds);
    m_changed_bricks += std::int64_t(m_undo.bricks().size());
    seeds = pressed(contacts, q, direction, pushes);
    if (std::any_of(pushes.begin(), pushes.end(), [](int n) { return n > kMostPushes; })) {
      return false;
    }
  }
  return true;
}

/// Moves to min(L, B) or to max(U, A), from where q is.
bool ContactProjection::reach(int c, const std::vector<ContactLink>& contacts,
                              Direction direction) {
  const bool rises = direction == Direction::raise;
  if (!move(c, contacts, direction, {})) return false;
  const std::vector<Seed> back = beyond_bounds(c, direction);
  return back.empty() || move(c, contacts, rises ? Direction::lower : Direction::raise, back);
}

/// Moves from max(U, A) half-way to min(L, B), of which `above` has the bricks that it changed.
void ContactProjection::average(int c, const std::vector<std::size_t>& bricks,
                                const std::vector<std::int32_t>& above) {
  BrickValues& q = m_body.q[std::size_t(c)];
  const std::vector<std::size_t> lowered = m_undo.bricks();
  for (std::size_t n = 0; n < bricks.size(); ++n) m_undo.before_change(bricks[n], q);
  const auto to_middle = [&](std::size_t brick, const std::int32_t* other) {
    std::int32_t* now = q.touch(brick);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      now[offset] = half(std::int64_t(now[offset]) + other[offset]);
    }
  };
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    to_middle(bricks[n], above.data() + n * kBrickVoxels);
  }
  const std::unordered_set<std::size_t> raised(bricks.begin(), bricks.end());
  for (const std::size_t brick : lowered) {
    if (raised.count(brick) == 0) to_middle(brick, m_undo.saved_of(brick));
  }
}

std::int64_t ContactProjection::commit(int c) {
  std::int64_t largest = 0;
  for (const std::size_t brick : m_undo.bricks()) {
    const std::int32_t* from = m_undo.saved_of(brick);
    const std::int32_t* to = m_body.q[std::size_t(c)].brick_or_zero(brick);
    for (int offset = 0; offset < kBrickVoxels; ++offset) {
      largest = std::max(largest, std::abs(std::int64_t(to[offset]) - from[offset]));
    }
    m_body.drop_fractions(c, brick, from);
  }
  m_undo.clear();
  return largest;
}

std::optional<std::int64_t> ContactProjection::meet(int c, const std::vector<ContactLink>& given) {
  BrickValues& q = m_body.q[std::size_t(c)];
  q.resize(m_body.elements.brick_count());
  const AdmissibleOffsets admissible(m_body, c);
  std::vector<ContactLink> contacts = given;
  for (ContactLink& contact : contacts) {
    contact.least -= beyond_at(m_body, c, contact.above) - beyond_at(m_body, c, contact.below);
  }
  try {
    if (reach(c, contacts, Direction::raise)) {
      const std::vector<std::size_t> bricks = m_undo.bricks();
      std::vector<std::int32_t> above;
      above.reserve(bricks.size() * kBrickVoxels);
      for (const std::size_t brick : bricks) {
        const std::int32_t* values = q.brick_or_zero(brick);
        above.insert(above.end(), values, values + kBrickVoxels);
      }
      m_undo.roll_back(q);
      if (reach(c, contacts, Direction::lower)) {
        average(c, bricks, above);
        if (beyond_bounds(c, Direction::raise).empty() &&
            beyond_bounds(c, Direction::lower).empty()) {
          return commit(c);
        }
      }
    }
  } catch (...) {
    m_undo.roll_back(q);
    throw;
  }
  m_undo.roll_back(q);
  return std::nullopt;
}

ProjectionReport project(Body& body, const SlotSet& fixed, const Holds& held, Progress* progress) {
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
      poll(progress);
      valid[c] = projected(body.q[c], c, held_bounds(body, c, anchored, held), propagator, progress,
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
  body.beyond.reset();
  return report;
}

void keep_beyond(Body& body, const SlotSet& fixed, const Holds& held, Progress* progress) {
  std::array<BrickValues, 3> q = body.q;
  decltype(Body::fraction) fraction = body.fraction;
  project(body, fixed, held, progress);
  const auto beyond = std::make_shared<std::array<BrickValues, 3>>();
  for (std::size_t c = 0; c < 3; ++c) {
    BrickValues& values = (*beyond)[c];
    values.resize(body.elements.brick_count());
    for (std::size_t b = 0; b < values.brick_count(); ++b) {
      const std::int32_t* const now = q[c].brick_or_zero(b);
      const std::int32_t* const admissible = body.q[c].brick_or_zero(b);
      if (std::equal(now, now + kBrickVoxels, admissible)) continue;
      std::int32_t* const own = values.touch(b);
      for (int n = 0; n < kBrickVoxels; ++n) own[n] = now[n] - admissible[n];
    }
  }
  body.q.swap(q);
  body.fraction.swap(fraction);
  body.beyond = beyond;
}

}  // namespace supple
