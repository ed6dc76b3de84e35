#include "lib/relax/cell_moduli.h"

#include <algorithm>
#include <cmath>

#include "lib/material/material.h"

namespace supple {

namespace {

/// Share of a cell: the inverse of the mean compliance of its corners that count, from the sum of
/// their compliances and their number; 1 where none counts.
double share_of(double compliance, double corners) {
  return corners > 0 ? corners / compliance : 1;
}

/// Sums over the eight elements around each place where a cell may be, by its lowest corner from -1
/// to 7. Sums at places without a brick mean nothing.
struct CornerSums {
  double of[9][9][9];
};

template <class ValueOf>
void sum_corners(const BricksAround& around, CornerSums& out, ValueOf&& value_of) {
  double rows[10][10][9];  // sums of two along k
  const auto side = [](int local) -> std::size_t { return local < 0 ? 0 : local > 7 ? 2 : 1; };
  for (int i = -1; i < 9; ++i) {
    for (int j = -1; j < 9; ++j) {
      const std::int32_t* bricks = &around[9 * side(i) + 3 * side(j)];
      const auto first = [&](int n) {
        return Slot(bricks[n]) * kBrickVoxels + Slot(64 * (i & 7) + 8 * (j & 7));
      };
      double values[10] = {};
      if (bricks[0] >= 0) values[0] = value_of(first(0) + 7);
      for (Slot k = 0; k < 8 && bricks[1] >= 0; ++k) values[k + 1] = value_of(first(1) + k);
      if (bricks[2] >= 0) values[9] = value_of(first(2));
      for (int k = 0; k < 9; ++k) rows[i + 1][j + 1][k] = values[k] + values[k + 1];
    }
  }
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      for (int k = 0; k < 9; ++k) {
        out.of[i][j][k] =
            (rows[i][j][k] + rows[i][j + 1][k]) + (rows[i + 1][j][k] + rows[i + 1][j + 1][k]);
      }
    }
  }
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
  const double* of_class = moduli.compliance.data();
  const bool has_pieces = body.rigid.number_of != nullptr;
  const auto counts = [&](Slot slot) { return !has_pieces || body.rigid.at(slot) < 0; };
  CornerSums compliance, corners;
  sum_corners(around, compliance,
              [&](Slot slot) { return counts(slot) ? of_class[body.classes[slot]] : 0; });
  if (has_pieces) sum_corners(around, corners, [&](Slot slot) { return counts(slot) ? 1.0 : 0.0; });
  // Cells side by side are mostly of one tissue.
  double last_compliance = 0, last_corners = 0, last_root = share_of(0, 0);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      double* row = brick.root_share + CellBrick::cell_row(i - 1, j - 1);
      for (int k = 0; k < 9; ++k) {
        double& root = row[CellBrick::place(k - 1)];
        if (root == 0) continue;
        const double own_corners = has_pieces ? corners.of[i][j][k] : 8;
        if (compliance.of[i][j][k] != last_compliance || own_corners != last_corners) {
          last_compliance = compliance.of[i][j][k];
          last_corners = own_corners;
          last_root = std::sqrt(share_of(last_compliance, last_corners));
        }
        root = last_root;
      }
    }
  }
}

}  // namespace supple
