#include "lib/relax/excess_energy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/body/slot_set.h"
#include "lib/relax/brick_springs.h"
#include "lib/relax/cluster_pull.h"
#include "lib/relax/stiff_clusters.h"

namespace supple {

namespace {

constexpr double kStopped = kTightSlack * kFinePerUnit;

class Excess {
 public:
  Excess(const Body& body, const LinkTable& table, const Movable& elements,
         const BrickArray<double>& now, const std::vector<std::uint32_t>& bricks)
      : m_body(body),
        m_table(table),
        m_elements(elements),
        m_now(now),
        m_bricks(bricks),
        m_stiffness(kStiffRatio * stiffness_range(body, table, bricks).least),
        m_force(body.elements.brick_count()),
        m_is_loaded(body.elements.brick_count()) {}

  double twice(const std::vector<Bound>& at_least, const std::vector<Bound>& at_most) {
    find_forces();
    add_clusters(at_least, at_most);
    add_singles(at_least, at_most);
    const double work = range() * m_net;
    const double s = (std::sqrt(m_give) + std::sqrt(m_give + 4 * work)) / 2;
    return s * s;
  }

 private:
  const LinkValues& values(int kind, Slot low, Slot high) const {
    return m_table.values(kind, m_body.classes[low], m_body.classes[high]);
  }
  bool is_tight(int kind, Slot low, Slot high) const {
    const LinkValues& link = values(kind, low, high);
    const double apart = m_now.at(high) - m_now.at(low);
    return std::min(link.upper * kFinePerUnit - apart, link.lower * kFinePerUnit + apart) <=
           kStopped;
  }

  void find_forces() {
    for (const std::uint32_t b : m_bricks) {
      for_each_link(m_body, m_table.links(), b, [&](int kind, Slot low, Slot high) {
        const LinkValues& link = values(kind, low, high);
        const double rest = rest_of_link(m_body, kind, m_table.coordinate(), low) * kFinePerUnit;
        const double pull =
            link.stiffness * pulled_stretch(link, m_now.at(high) - m_now.at(low) - rest);
        if (pull == 0) return;
        m_force.set(low, m_force.at(low) + pull);
        m_force.set(high, m_force.at(high) - pull);
      });
    }
  }

  void add_clusters(const std::vector<Bound>& at_least, const std::vector<Bound>& at_most) {
    const Joins stiff = joined_from(m_body, m_table, m_elements, m_stiffness);
    const Joins joins = [&](int kind, Slot low, Slot high) {
      if (!m_elements.moves(low) || !m_elements.moves(high)) return false;
      const bool is_rigid = m_table.is_rigid(kind, m_body.classes[low], m_body.classes[high]);
      if (is_rigid || is_tight(kind, low, high)) {
        m_is_loaded.set(low, 1);
        return true;
      }
      if (!stiff(kind, low, high)) return false;
      m_joined = std::min(m_joined, double(values(kind, low, high).stiffness));
      return true;
    };
    const Clusters clusters = find_clusters(m_body, m_table, m_bricks, joins);
    for (std::size_t c = 0; c < clusters.count(); ++c) {
      const ClusterPull pull = pull_of_cluster(clusters, c, m_now, at_least, at_most, 1);
      if ((pull.force > 0 ? pull.rise : pull.sink) > kStopped) m_net += std::abs(pull.force);
      add_inside(clusters, c);
    }
  }

  /// Adds the forces between a cluster's elements to m_give, and takes its elements out of m_force.
  void add_inside(const Clusters& clusters, std::size_t cluster) {
    const std::uint32_t first = clusters.first[cluster], end = clusters.first[cluster + 1];
    const double count = end - first;
    double sum = 0, inside = 0;
    bool is_loaded = false;
    for (std::uint32_t n = first; n < end; ++n) sum += m_force.at(clusters.members[n]);
    for (std::uint32_t n = first; n < end; ++n) {
      const Slot slot = clusters.members[n];
      inside += std::abs(m_force.at(slot) - sum / count);
      is_loaded = is_loaded || m_is_loaded.at(slot) != 0;
      m_force.set(slot, 0);
    }
    if (!is_loaded) m_give += count * inside * inside / m_joined;
  }

  void add_singles(const std::vector<Bound>& at_least, const std::vector<Bound>& at_most) {
    for (const std::uint32_t b : m_bricks) {
      const double* forces = m_force.brick(b);
      if (forces == nullptr) continue;
      for_each_active(m_body.elements.mask(b), [&](int offset) {
        const Slot slot = Slot(b * kBrickVoxels) + Slot(offset);
        const double force = forces[offset];
        if (force == 0 || !m_elements.moves(slot)) return;
        if (!is_stopped(slot, force > 0, force > 0 ? at_most : at_least)) m_net += std::abs(force);
      });
    }
  }

  /// True where a bound, or the limit of a link to a held element, stops the element that way.
  bool is_stopped(Slot slot, bool upwards, const std::vector<Bound>& bounds) const {
    const auto bound =
        std::lower_bound(bounds.begin(), bounds.end(), slot,
                         [](const Bound& entry, Slot wanted) { return entry.slot < wanted; });
    if (bound != bounds.end() && bound->slot == slot &&
        std::abs(bound->value * kFinePerUnit - m_now.at(slot)) <= kStopped) {
      return true;
    }
    bool stopped = false;
    for_each_neighbour(m_body, m_table.links(), slot, [&](int kind, bool to_next, Slot other) {
      const Slot low = to_next ? slot : other, high = to_next ? other : slot;
      const LinkValues& link = values(kind, low, high);
      const double apart = m_now.at(high) - m_now.at(low);
      const double slack = to_next == upwards ? link.lower * kFinePerUnit + apart
                                              : link.upper * kFinePerUnit - apart;
      stopped = stopped || slack <= kStopped;
    });
    return stopped;
  }

  /// Range of all offsets, with that of elements at rest, 0.
  double range() const {
    double least = 0, most = 0;
    for (const std::uint32_t b : m_bricks) {
      const double* values = m_now.brick_or_zero(b);
      const auto [low, high] = std::minmax_element(values, values + kBrickVoxels);
      least = std::min(least, *low);
      most = std::max(most, *high);
    }
    return most - least;
  }

  const Body& m_body;
  const LinkTable& m_table;
  const Movable& m_elements;
  const BrickArray<double>& m_now;
  const std::vector<std::uint32_t>& m_bricks;
  double m_stiffness;                                         // of links that join, at least, N/m
  double m_joined = std::numeric_limits<double>::infinity();  // the softest of them
  BrickArray<double> m_force;                                 // N/m (2^-32 voxel)
  BrickArray<std::int16_t> m_is_loaded;                       // joined upwards by a limit
  double m_net = 0;                                           // sum of net forces
  double m_give = 0;                                          // what inner forces may make of s
};

}  // namespace

double excess_energy(const Body& body, const LinkTable& table, const Movable& elements,
                     const BrickArray<double>& now, const std::vector<Bound>& at_least,
                     const std::vector<Bound>& at_most, const std::vector<std::uint32_t>& bricks) {
  return Excess(body, table, elements, now, bricks).twice(at_least, at_most);
}

}  // namespace supple
