#include "lib/chainmail/ball_limits.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "lib/chainmail/ball_links.h"
#include "lib/chainmail/held_voxels.h"
#include "volumes/base/error.h"
#include "volumes/base/stopwatch.h"

namespace supple {

namespace {

/// Rounding a link's ends to 2^-16 voxel changes it by up to that much along each axis.
constexpr double kRounding = 1 / kFixedOne;
constexpr std::int64_t kMovesPerReport = 4096;

/// A link whose candidate is to move against its sponsor. The stamps tell whether either has moved
/// since, which makes the entry void.
struct Candidate {
  double priority;
  Slot slot, sponsor;
  std::uint32_t slot_stamp, sponsor_stamp;
  int axis;
  bool ahead;  // the candidate is the end at the higher index

  /// True where it waits behind another, for std heaps.
  bool operator<(const Candidate& other) const {
    if (priority != other.priority) return priority < other.priority;
    return slot != other.slot ? slot > other.slot : sponsor > other.sponsor;
  }
};

/// Working places of one brick's elements, in voxels from rest.
struct BrickCopy {
  std::array<Vec3d, kBrickVoxels> u;
  std::array<std::uint32_t, kBrickVoxels> stamp{};  // how often it moved
  BrickMask fixed{}, moved{};
};

class BallDrag {
 public:
  BallDrag(Body& body, const HeldVoxels& held, const BallParams& params, Progress* progress)
      : m_body(body),
        m_held(held),
        m_params(params),
        m_progress(progress),
        m_links(body),
        m_pages(body.elements.brick_count()) {
    double widest_mm = 0;
    for (int axis = 0; axis < 3; ++axis) widest_mm += m_links.rest_mm(axis) * kRounding;
    for (int axis = 0; axis < 3; ++axis) {
      const double tolerance_mm = params.tolerance * m_links.rest_mm(axis);
      m_tolerance_mm[std::size_t(axis)] = std::max(tolerance_mm - widest_mm, tolerance_mm / 2);
    }
  }

  void move_handles() {
    for (const HeldHandle& handle : m_held.handles) {
      std::size_t n = 0;
      handle.slots.for_each([&](Slot slot) {
        const std::array<std::int32_t, 3>& by = handle.by(n++);
        if (by[0] == 0 && by[1] == 0 && by[2] == 0) return;
        BrickCopy& page = page_of(slot);
        Vec3d& u = page.u[slot % kBrickVoxels];
        for (int c = 0; c < 3; ++c) u[c] += by[std::size_t(c)] / kFixedOne;
        mark_moved(page, slot);
      });
    }
    m_held.grabbed.for_each([&](Slot slot) { add_neighbours(slot); });
  }

  /// Works through the candidate list of section 4.2.2, on lengths.
  void propagate() {
    while (!m_queue.empty()) {
      if (m_report.moves % kMovesPerReport == 0) report(m_progress, 0);
      const Candidate candidate = pop();
      if (is_void(candidate)) continue;
      if (m_report.moves >= m_params.moves_per_element * std::max<std::int64_t>(1, m_moved)) {
        m_report.capped = true;
        return;
      }
      move(candidate);
      add_neighbours(candidate.slot);
    }
  }

  /// Rounds the places into the body; nothing is written unless all can be.
  void commit() {
    std::vector<std::pair<std::size_t, int>> changed;  // brick, coordinate
    for (const std::size_t b : m_touched) {
      for (int c = 0; c < 3; ++c) {
        if (changes(b, c)) changed.push_back({b, c});
      }
    }
    for (const auto& [b, c] : changed) {
      BrickValues& q = m_body.q[std::size_t(c)];
      if (q.brick_count() < m_body.elements.brick_count()) q.resize(m_body.elements.brick_count());
      q.touch(b);
    }
    m_report.moved = count_changed();
    for (const auto& [b, c] : changed) {
      std::int32_t* values = m_body.q[std::size_t(c)].touch(b);
      std::array<std::int32_t, kBrickVoxels> before;
      std::copy_n(values, kBrickVoxels, before.begin());
      for_each_active(m_pages[b]->moved,
                      [&, c = c, b = b](int offset) { values[offset] = rounded(b, offset, c); });
      m_body.drop_fractions(c, b, before.data());
    }
    if (!changed.empty()) m_body.links_known_valid = false;
  }

  BallReport finish() {
    for (const std::size_t b : m_touched) {
      for_each_active(m_pages[b]->moved, [&](int offset) {
        check_links_of(Slot(b * kBrickVoxels + std::size_t(offset)));
      });
    }
    m_report.bytes = m_links.bytes() + m_pages.capacity() * sizeof(m_pages[0]) +
                     m_touched.size() * sizeof(BrickCopy) + m_queue.capacity() * sizeof(Candidate);
    return m_report;
  }

 private:
  BrickCopy& page_of(Slot slot) {
    const std::size_t b = slot / kBrickVoxels;
    if (!m_pages[b]) load(b);
    return *m_pages[b];
  }

  void load(std::size_t b) {
    m_pages[b] = std::make_unique<BrickCopy>();
    BrickCopy& page = *m_pages[b];
    for (std::size_t n = 0; n < kBrickVoxels; ++n) {
      for (int c = 0; c < 3; ++c) {
        page.u[n][c] = m_body.q[std::size_t(c)].brick_or_zero(b)[n] / kFixedOne;
      }
    }
    for (const SlotSet* held : {&m_held.grabbed, m_held.fixed, &m_held.rest.anchored}) {
      const BrickMask* mask = held->find(b);
      if (mask == nullptr) continue;
      for_each_active(*mask, [&](int offset) { mask_set(page.fixed, offset); });
    }
    m_touched.push_back(b);
  }

  void mark_moved(BrickCopy& page, Slot slot) {
    const int offset = int(slot % kBrickVoxels);
    ++page.stamp[std::size_t(offset)];
    if (mask_test(page.moved, offset)) return;
    mask_set(page.moved, offset);
    ++m_moved;
  }

  bool has_moved(Slot slot) const {
    const auto& page = m_pages[slot / kBrickVoxels];
    return page && mask_test(page->moved, int(slot % kBrickVoxels));
  }
  bool is_fixed(Slot slot) { return mask_test(page_of(slot).fixed, int(slot % kBrickVoxels)); }
  const Vec3d& place(Slot slot) { return page_of(slot).u[slot % kBrickVoxels]; }
  std::uint32_t stamp(Slot slot) { return page_of(slot).stamp[slot % kBrickVoxels]; }
  bool is_void(const Candidate& candidate) {
    return stamp(candidate.slot) != candidate.slot_stamp ||
           stamp(candidate.sponsor) != candidate.sponsor_stamp;
  }

  /// The link from sponsor to candidate, in voxels.
  Vec3d link_of(const Candidate& candidate) {
    Vec3d link = place(candidate.slot) - place(candidate.sponsor);
    link[candidate.axis] += candidate.ahead ? 1 : -1;
    return link;
  }

  /// Adds links to neighbours, whose sponsor the mover is, except that fixed ones move it back.
  void add_neighbours(Slot mover) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool ahead : {false, true}) {
        Slot neighbour;
        if (!neighbour_slot(m_body.elements, m_body.cuts, mover, axis, ahead, neighbour)) continue;
        Candidate candidate{0, neighbour, mover, 0, 0, axis, ahead};
        if (is_fixed(neighbour)) candidate = {0, mover, neighbour, 0, 0, axis, !ahead};
        if (!is_fixed(candidate.slot)) add(candidate);
      }
    }
  }

  void add(Candidate candidate) {
    const double violation =
        BallLinks::excess_mm(m_links.length_mm(link_of(candidate)), range_of(candidate));
    if (violation <= m_tolerance_mm[std::size_t(candidate.axis)]) return;
    candidate.slot_stamp = stamp(candidate.slot);
    candidate.sponsor_stamp = stamp(candidate.sponsor);
    const bool by_size = m_params.order == BallOrder::largest_violation_first;
    candidate.priority = by_size ? violation : -double(m_added++);
    m_queue.push_back(candidate);
    std::push_heap(m_queue.begin(), m_queue.end());
    m_report.max_queue = std::max(m_report.max_queue, std::int64_t(m_queue.size()));
    if (m_queue.size() >= m_sweep_at) drop_void();
  }

  Candidate pop() {
    std::pop_heap(m_queue.begin(), m_queue.end());
    const Candidate candidate = m_queue.back();
    m_queue.pop_back();
    return candidate;
  }

  /// Keeps the queue below twice the links that wait.
  void drop_void() {
    m_queue.erase(std::remove_if(m_queue.begin(), m_queue.end(),
                                 [this](const Candidate& c) { return is_void(c); }),
                  m_queue.end());
    std::make_heap(m_queue.begin(), m_queue.end());
    m_sweep_at = std::max<std::size_t>(1024, 2 * m_queue.size());
  }

  BallLinks::Range range_of(const Candidate& candidate) const {
    return m_links.range(candidate.axis, m_body.classes[candidate.slot],
                         m_body.classes[candidate.sponsor]);
  }

  /// Moves a candidate (figure 4.19) onto the nearest allowed length, on the line to the sponsor.
  /// Where both coincide there is no line, and the link's direction at rest is taken.
  void move(const Candidate& candidate) {
    const BallLinks::Range range = range_of(candidate);
    Vec3d rest(0);
    rest[candidate.axis] = candidate.ahead ? 1 : -1;
    Vec3d link = link_of(candidate);
    double length = m_links.length_mm(link);
    const double allowed = std::clamp(length, range.least_mm, range.most_mm);
    if (!(length > 1e-9 * m_links.rest_mm(candidate.axis))) {
      link = rest;
      length = m_links.rest_mm(candidate.axis);
    }
    const Vec3d place_of_sponsor = place(candidate.sponsor);
    BrickCopy& page = page_of(candidate.slot);
    page.u[candidate.slot % kBrickVoxels] = place_of_sponsor + link * (allowed / length) - rest;
    mark_moved(page, candidate.slot);
    ++m_report.moves;
  }

  std::int32_t rounded(std::size_t b, int offset, int c) const {
    return std::int32_t(std::lround(m_pages[b]->u[std::size_t(offset)][c] * kFixedOne));
  }

  /// True where a coordinate of a brick changed. Throws InputError beyond the range.
  bool changes(std::size_t b, int c) const {
    bool found = false;
    for_each_active(m_pages[b]->moved, [&](int offset) {
      const double u = m_pages[b]->u[std::size_t(offset)][c];
      if (!(std::abs(u) * kFixedOne <= kMaxOffset)) {
        const Slot slot = Slot(b * kBrickVoxels + std::size_t(offset));
        throw InputError({"", "voxel " + voxel_text(voxel_of(m_body.elements, slot)),
                          "an offset of " + number_text(u) + " voxels along axis " + "ijk"[c],
                          "offsets within +-16383 voxels"});
      }
      found |= rounded(b, offset, c) != m_body.q[std::size_t(c)].brick_or_zero(b)[offset];
    });
    return found;
  }

  std::int64_t count_changed() const {
    std::int64_t count = 0;
    for (const std::size_t b : m_touched) {
      for_each_active(m_pages[b]->moved, [&](int offset) {
        bool changed = false;
        for (int c = 0; c < 3; ++c) {
          changed |= rounded(b, offset, c) != m_body.q[std::size_t(c)].brick_or_zero(b)[offset];
        }
        count += changed;
      });
    }
    return count;
  }

  /// Counts the links of an element that moved; one between two of them at its lower end.
  void check_links_of(Slot slot) {
    for (int axis = 0; axis < 3; ++axis) {
      for (const bool ahead : {false, true}) {
        Slot other;
        if (!neighbour_slot(m_body.elements, m_body.cuts, slot, axis, ahead, other)) continue;
        if (!ahead && has_moved(other)) continue;
        Vec3d link(0);
        link[axis] = ahead ? 1 : -1;
        for (int c = 0; c < 3; ++c) {
          const BrickValues& q = m_body.q[std::size_t(c)];
          link[c] += (double(q.at(other)) - q.at(slot)) / kFixedOne;
        }
        count_link(axis, BallLinks::excess_mm(
                             m_links.length_mm(link),
                             m_links.range(axis, m_body.classes[slot], m_body.classes[other])));
      }
    }
  }

  void count_link(int axis, double excess_mm) {
    const double excess = excess_mm / m_links.rest_mm(axis);
    ++m_report.links;
    m_report.violated += excess > m_params.tolerance;
    m_report.worst_excess_voxels = std::max(m_report.worst_excess_voxels, excess);
  }

  Body& m_body;
  const HeldVoxels& m_held;
  const BallParams& m_params;
  Progress* m_progress;
  const BallLinks m_links;
  std::array<double, 3> m_tolerance_mm;             // per axis, what is left for rounding taken off
  std::vector<std::unique_ptr<BrickCopy>> m_pages;  // per brick
  std::vector<std::size_t> m_touched;               // bricks with a page
  std::vector<Candidate> m_queue;                   // a heap
  std::size_t m_sweep_at = 1024;
  std::int64_t m_added = 0, m_moved = 0;
  BallReport m_report;
};

void refuse_push(const std::vector<Handle>& handles) {
  for (const Handle& handle : handles) {
    if (handle.kind != HandleKind::push) continue;
    throw InputError({"", "grab " + handle.region.name(), "a push handle",
                      "a two-sided handle, as ball limits know no other"});
  }
}

}  // namespace

void BallParams::validate() const {
  if (!(tolerance >= 1e-4 && tolerance <= 1)) {
    throw InputError({"", "tolerance", number_text(tolerance), "1e-4 to 1 rest lengths"});
  }
  if (moves_per_element < 1) {
    throw InputError({"", "moves_per_element", std::to_string(moves_per_element), "at least 1"});
  }
}

BallReport drag_ball(Body& body, const std::vector<Handle>& handles,
                     const std::vector<Region>& anchors, const BallParams& params,
                     Progress* progress) {
  Holds none;
  return drag_ball(body, handles, anchors, none, params, progress);
}

BallReport drag_ball(Body& body, const std::vector<Handle>& handles,
                     const std::vector<Region>& anchors, Holds& holds, const BallParams& params,
                     Progress* progress) {
  const Stopwatch clock;
  params.validate();
  refuse_push(handles);
  const FixedElements fixed = fix(body, anchors);
  HeldVoxels held = hold(body, handles, fixed, holds);
  held.rest = without_sides(held.rest, "held handles");
  Holds next = held.rest;
  next.anchored.add(held.grabbed);

  BallDrag drag(body, held, params, progress);
  drag.move_handles();
  drag.propagate();
  drag.commit();
  holds = std::move(next);
  BallReport result = drag.finish();
  result.milliseconds = clock.ms();
  return result;
}

}  // namespace supple
