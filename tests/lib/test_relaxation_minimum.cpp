// How near relaxation comes to the least energy that the limits allow, found by another method.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "lib/body/lattice.h"
#include "lib/model/relax_model.h"
#include "tests/lib/test_bodies.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr std::int32_t kVoxel = 65536;

/// min sum k d^2 / 2 over one coordinate of a body, -lower <= d <= upper on every link and `held`
/// nodes where they are: augmented Lagrangian (Rockafellar 1974), each round by Gauss-Seidel.
class QuadraticProgram {
 public:
  QuadraticProgram(const Body& body, std::size_t c, const SlotSet& held) : m_held(held) {
    const Vec3d h = body.geometry.spacing_mm();
    for_each_element(body.elements, [&](Slot slot) {
      m_x.resize(std::max<std::size_t>(m_x.size(), slot + 1));
      m_x[slot] = body.q[c].at(slot) / kFixedOne;
    });
    m_at.resize(m_x.size());
    for (std::size_t b = 0; b < body.elements.brick_count(); ++b) {
      for_each_link(body.elements, body.cuts, b, [&](int axis, Slot low, Slot high) {
        const double k = h[(axis + 1) % 3] * h[(axis + 2) % 3] / h[axis];
        const std::uint8_t first = body.classes[low], second = body.classes[high];
        m_at[low].push_back(m_links.size());
        m_at[high].push_back(m_links.size());
        m_links.push_back({low, high, k, body.slacks.upper(axis, int(c), first, second) / kFixedOne,
                           body.slacks.lower(axis, int(c), first, second) / kFixedOne, 0});
      });
    }
  }

  /// Energy in N/m voxel^2; the worst excess of a limit in voxels.
  double minimise(int rounds, double& excess) {
    for (int round = 0; round < rounds; ++round) {
      for (int sweep = 0; sweep < 20; ++sweep) {
        for (Slot slot = 0; slot < m_x.size(); ++slot) {
          if (!m_at[slot].empty() && !m_held.contains(slot)) step(slot);
        }
      }
      for (Link& link : m_links) link.multiplier = kPenalty * link.k * beyond(link);
    }
    double energy = 0;
    excess = 0;
    for (const Link& link : m_links) {
      const double d = m_x[link.high] - m_x[link.low];
      energy += link.k * d * d / 2;
      excess = std::max({excess, d - link.upper, -link.lower - d});
    }
    return energy;
  }

 private:
  static constexpr double kPenalty = 20;
  struct Link {
    Slot low, high;
    double k, upper, lower, multiplier;
  };
  double beyond(const Link& link) const {
    const double d = m_x[link.high] - m_x[link.low] + link.multiplier / (kPenalty * link.k);
    return d > link.upper ? d - link.upper : d < -link.lower ? d + link.lower : 0;
  }
  void step(Slot slot) {
    double force = 0, stiffness = 0;
    for (const std::size_t n : m_at[slot]) {
      const Link& link = m_links[n];
      const double pull = link.k * (m_x[link.high] - m_x[link.low] + kPenalty * beyond(link));
      force += slot == link.low ? pull : -pull;
      stiffness += link.k * (1 + kPenalty);
    }
    m_x[slot] += 1.8 * force / stiffness;
  }

  const SlotSet& m_held;
  std::vector<double> m_x;
  std::vector<std::vector<std::size_t>> m_at;  // links of a slot
  std::vector<Link> m_links;
};

}  // namespace

TEST(PropertyRelaxation, ItComesNearTheLeastEnergyThatTheLimitsAllow) {
  std::mt19937 random(41);
  std::vector<double> gaps;
  for (int n = 0; n < 40; ++n) {
    const Block block = random_block(random, {9, 8, 6});
    Body body = body_of(block);
    Holds holds;
    for (int handle = 0; handle < 2; ++handle) {
      const Vec3i voxel = block.voxel(random_element(random, block));
      drag(body, {{voxel, {std::int32_t(random() % (4u * kVoxel)) - 2 * kVoxel, 0, 0}}}, {}, holds);
    }
    if (body.q[0].empty()) continue;
    double excess = 0;
    const double least = QuadraticProgram(body, 0, holds.still).minimise(1000, excess);
    if (excess > 1e-5 || least < 1e-2) continue;
    RelaxParams params;
    params.passes = 5000;
    params.tolerance_voxels = 1e-9;
    const double h = body.geometry.spacing_mm().x;
    const double found = relax(body, {}, holds, params).energy_after / (h * h);
    EXPECT_GE(found, least * (1 - 1e-3));
    gaps.push_back(found / least - 1);
  }
  ASSERT_GE(gaps.size(), 20u);
  std::sort(gaps.begin(), gaps.end());
  EXPECT_LE(gaps[gaps.size() * 9 / 10], 0.001);
  EXPECT_LE(gaps.back(), 0.05);
}
