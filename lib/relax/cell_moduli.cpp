#include "lib/relax/cell_moduli.h"

#include <algorithm>
#include <cmath>

#include "lib/material/material.h"

namespace supple {

namespace {

/// The mean of what counts, as a share of 1 over it.
double share_of(double compliance, double corners) {
  return corners > 0 ? corners / compliance : 1;
}

}  // namespace

CellModuli moduli_by_poisson(const Body& body) {
  const MaterialClasses classes(body.material);
  std::vector<double> kpa(kLastClass + 1);
  for (int of = 0; of <= kLastClass; ++of) {
    const double own =
        classes.physics(of, of).stiffness_kpa / (1 - 2 * classes.poisson_of_class(of));
    kpa[std::size_t(of)] = std::min(own, kMaxBulkModulusKpa);
  }
  double sum = 0, first = 0;
  std::size_t count = 0;
  bool is_even = true;
  for_each_element(body.elements, [&](Slot slot) {
    if (body.rigid.at(slot) >= 0) return;
    const double own = kpa[body.classes[slot]];
    if (count++ == 0) first = own;
    is_even = is_even && own == first;
    sum += own;
  });
  if (is_even) return {first, {}};
  CellModuli moduli{sum / double(count), {}};
  for (const double own : kpa) moduli.compliance.push_back(moduli.kpa / own);
  return moduli;
}

CellModuli moduli_of(const Body& body, const RelaxParams& params) {
  return params.poisson ? moduli_by_poisson(body) : CellModuli{params.bulk_modulus_kpa, {}};
}

double share_of_cell(const Body& body, const CellModuli& moduli,
                     const std::array<Slot, 8>& corners) {
  if (moduli.compliance.empty()) return 1;
  double sum = 0, count = 0;
  for (const Slot corner : corners) {
    if (body.rigid.at(corner) >= 0) continue;
    sum += moduli.compliance[body.classes[corner]];
    ++count;
  }
  return share_of(sum, count);
}

void find_shares(const Body& body, const CellModuli& moduli, const BricksAround& around,
                 CellBrick& brick) {
  if (moduli.compliance.empty()) return;
  // Of elements from -1 to 8, and whether they count.
  double compliance[10][10][10], counts[10][10][10];
  const auto side = [](int local) { return local < 0 ? 0 : local > 7 ? 2 : 1; };
  for (int i = -1; i < 9; ++i) {
    for (int j = -1; j < 9; ++j) {
      for (int k = -1; k < 9; ++k) {
        const std::int32_t there = around[std::size_t(9 * side(i) + 3 * side(j) + side(k))];
        double &value = compliance[i + 1][j + 1][k + 1], &count = counts[i + 1][j + 1][k + 1];
        value = count = 0;
        if (there < 0) continue;
        const Slot slot = slot_around(around, i, j, k);
        if (body.rigid.at(slot) >= 0) continue;
        value = moduli.compliance[body.classes[slot]];
        count = 1;
      }
    }
  }
  const auto sum_of = [](const double(&values)[10][10][10], int i, int j, int k) {
    double sum = 0;
    for (int n = 0; n < 8; ++n) sum += values[i + (n >> 2)][j + (n >> 1 & 1)][k + (n & 1)];
    return sum;
  };
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      double* row = brick.root_share + CellBrick::cell_row(i - 1, j - 1);
      for (int k = 0; k < 9; ++k) {
        double& root = row[CellBrick::place(k - 1)];
        if (root == 0) continue;
        root = std::sqrt(share_of(sum_of(compliance, i, j, k), sum_of(counts, i, j, k)));
      }
    }
  }
}

}  // namespace supple
