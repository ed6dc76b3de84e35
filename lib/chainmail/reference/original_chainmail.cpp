#include "lib/chainmail/reference/original_chainmail.h"

#include <algorithm>
#include <deque>

namespace supple::reference {

namespace {

/// A list's direction: the step from the sponsor to the candidate.
struct Heading {
  int axis;
  int step;
};
constexpr std::array<Heading, 6> kHeadings = {{{0, 1}, {0, -1}, {1, 1}, {1, -1}, {2, 1}, {2, -1}}};

class Lists {
 public:
  Lists(const ReferenceLattice& lattice, Offsets& offsets)
      : m_lattice(lattice), m_offsets(offsets) {}

  void add_neighbour(const Vec3i& node, int list) {
    Vec3i candidate = node;
    const Heading& heading = kHeadings[list];
    candidate[heading.axis] += heading.step;
    if (m_lattice.is_linked(heading.step > 0 ? node : candidate, heading.axis))
      m_lists[list].push_back(candidate);
  }

  /// Checks each candidate against the neighbour it came from until the list is empty. A moved one
  /// adds the neighbours ahead of it and those across, as far as their lists are still to come.
  void process(int list, OriginalReport& report) {
    auto& candidates = m_lists[list];
    while (!candidates.empty()) {
      const Vec3i node = candidates.front();
      candidates.pop_front();
      ++report.processed;
      if (!satisfy(node, kHeadings[list])) continue;
      ++report.moved;
      add_neighbour(node, list);
      for (int other = 0; other < 6; ++other) {
        if (kHeadings[other].axis > kHeadings[list].axis) add_neighbour(node, other);
      }
    }
  }

 private:
  /// Stretch and shear constraints against the sponsor (step 1 a, b); true when the node moved.
  bool satisfy(const Vec3i& node, const Heading& heading) {
    Vec3i sponsor = node;
    sponsor[heading.axis] -= heading.step;
    const std::size_t here = m_lattice.index(node), there = m_lattice.index(sponsor);
    const LinkSlack& slack = m_lattice.slacks[std::min(here, there)][heading.axis];
    bool moved = false;
    for (int c = 0; c < 3; ++c) {
      const std::int64_t base = m_offsets[c][there];
      const std::int64_t ahead = heading.step > 0 ? slack.upper[c] : slack.lower[c];
      const std::int64_t behind = heading.step > 0 ? slack.lower[c] : slack.upper[c];
      const std::int64_t highest = ahead >= kUnlimitedSlack ? INT32_MAX : base + ahead;
      const std::int64_t lowest = behind >= kUnlimitedSlack ? INT32_MIN : base - behind;
      const std::int32_t allowed =
          std::int32_t(std::clamp<std::int64_t>(m_offsets[c][here], lowest, highest));
      moved |= allowed != m_offsets[c][here];
      m_offsets[c][here] = allowed;
    }
    return moved;
  }

  const ReferenceLattice& m_lattice;
  Offsets& m_offsets;
  std::array<std::deque<Vec3i>, 6> m_lists;
};

}  // namespace

OriginalReport original_chainmail(const ReferenceLattice& lattice, const Vec3i& node,
                                  const std::array<std::int32_t, 3>& by_q, Offsets& offsets) {
  OriginalReport report;
  Lists lists(lattice, offsets);
  for (int c = 0; c < 3; ++c) offsets[c][lattice.index(node)] += by_q[c];
  for (int list = 0; list < 6; ++list) lists.add_neighbour(node, list);
  for (int list = 0; list < 6; ++list) lists.process(list, report);
  return report;
}

Body original_chainmail(const Body& body, const Vec3i& voxel,
                        const std::array<std::int32_t, 3>& by_q) {
  const ReferenceLattice lattice = lattice_of(body);
  Offsets offsets = offsets_of(body, lattice);
  original_chainmail(lattice, voxel - lattice.origin, by_q, offsets);
  return with_offsets(body, lattice, offsets);
}

}  // namespace supple::reference
