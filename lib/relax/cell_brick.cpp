#include "lib/relax/cell_brick.h"

#include <algorithm>

namespace supple {

namespace {

/// Rows of bits for i and j from -1 to 8: bit k + 1 of row [i + 1][j + 1].
struct BitRows {
  std::uint16_t rows[10][10];
};

/// Side of the brick where a local coordinate from -1 to 8 lies: -1 below, 0 inside, 1 above.
int side_of(int local) {
  return local < 0 ? -1 : local > 7;
}
int around_index(int di, int dj, int dk) {
  return 9 * (di + 1) + 3 * (dj + 1) + dk + 1;
}

/// Gathers the bits of a brick and around it; `mask_of(brick)` may be null where no bit is set.
template <class MaskOf>
BitRows gather_bits(const BricksAround& around, MaskOf&& mask_of) {
  const BrickMask* masks[27];
  for (std::size_t n = 0; n < 27; ++n) {
    masks[n] = around[n] >= 0 ? mask_of(std::size_t(around[n])) : nullptr;
  }
  BitRows out;
  for (int i = -1; i < 9; ++i) {
    for (int j = -1; j < 9; ++j) {
      unsigned bits = 0;
      for (int dk = -1; dk <= 1; ++dk) {
        const BrickMask* mask = masks[around_index(side_of(i), side_of(j), dk)];
        if (mask == nullptr) continue;
        const unsigned row = unsigned((*mask)[std::size_t(i & 7)] >> (8 * (j & 7))) & 0xff;
        bits |= dk < 0 ? row >> 7 : dk == 0 ? row << 1 : (row & 1) << 9;
      }
      out.rows[i + 1][j + 1] = std::uint16_t(bits);
    }
  }
  return out;
}

/// Removes the cells with a cut link along `axis`.
void remove_cut(int axis, const BitRows& cut, CellRows& cells) {
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      unsigned bits = cut.rows[i][j];
      if (axis != 0) bits |= cut.rows[i + 1][j];
      if (axis != 1) bits |= cut.rows[i][j + 1];
      if (axis == 2) bits |= cut.rows[i + 1][j + 1];
      if (axis != 2) bits |= bits >> 1;
      cells.rows[i][j] = std::uint16_t(cells.rows[i][j] & ~bits);
    }
  }
}

}  // namespace

BricksAround bricks_around(const BrickTopology& elements, std::size_t b) {
  const auto step = [&](std::int32_t brick, int axis, int d) {
    return brick < 0 || d == 0 ? brick : elements.neighbour(std::size_t(brick), 2 * axis + (d > 0));
  };
  BricksAround around;
  for (int di = -1; di <= 1; ++di) {
    const std::int32_t at_i = step(std::int32_t(b), 0, di);
    for (int dj = -1; dj <= 1; ++dj) {
      const std::int32_t at_j = step(at_i, 1, dj);
      for (int dk = -1; dk <= 1; ++dk) {
        around[std::size_t(around_index(di, dj, dk))] = step(at_j, 2, dk);
      }
    }
  }
  return around;
}

CellRows find_cells(const Body& body, const BricksAround& around) {
  const BitRows elements =
      gather_bits(around, [&](std::size_t b) { return &body.elements.mask(b); });
  CellRows cells;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      const unsigned pillars = elements.rows[i][j] & elements.rows[i + 1][j] &
                               elements.rows[i][j + 1] & elements.rows[i + 1][j + 1];
      cells.rows[i][j] = std::uint16_t(pillars & (pillars >> 1));
    }
  }
  const auto has_cuts = [&](std::int32_t b) {
    return b >= 0 && body.cuts.brick(std::size_t(b)) != nullptr;
  };
  if (!body.cuts.empty() && std::any_of(around.begin(), around.end(), has_cuts)) {
    for (int axis = 0; axis < 3; ++axis) {
      remove_cut(axis,
                 gather_bits(around,
                             [&](std::size_t b) -> const BrickMask* {
                               const auto* cuts = body.cuts.brick(b);
                               return cuts ? &(*cuts)[std::size_t(axis)] : nullptr;
                             }),
                 cells);
    }
  }
  for (const auto& rows : cells.rows) {
    for (const std::uint16_t row : rows) cells.any = cells.any || row != 0;
  }
  return cells;
}

void fill_cells(const std::array<BrickArray<double>, 3>& offsets, const BricksAround& around,
                const CellRows& cells, CellBrick& out) {
  for (std::size_t c = 0; c < 3; ++c) {
    const double* sources[27];
    for (std::size_t n = 0; n < 27; ++n) {
      sources[n] =
          around[n] >= 0 ? offsets[c].brick_or_zero(std::size_t(around[n])) : kZeroBrickOf<double>;
    }
    for (int i = -1; i < 9; ++i) {
      for (int j = -1; j < 9; ++j) {
        const double* const* source = sources + around_index(side_of(i), side_of(j), 0);
        const int first = 64 * (i & 7) + 8 * (j & 7);
        double* row = out.offsets[c] + CellBrick::node_row(i, j);
        row[CellBrick::place(-1)] = source[-1][first + 7];
        for (int k = 0; k < 8; ++k) row[CellBrick::place(k)] = source[0][first + k];
        row[CellBrick::place(8)] = source[1][first];
      }
    }
  }
  for (int i = -1; i < 8; ++i) {
    for (int j = -1; j < 8; ++j) {
      double* row = out.root_share + CellBrick::cell_row(i, j);
      const unsigned bits = cells.rows[i + 1][j + 1];
      for (int k = -1; k < 8; ++k) row[CellBrick::place(k)] = bits >> (k + 1) & 1;
      row[CellBrick::place(8)] = 0;
    }
  }
}

void take_offsets(const CellBrick& brick, int c, double* out) {
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const double* row = brick.offsets[std::size_t(c)] + CellBrick::node_row(i, j);
      for (int k = 0; k < 8; ++k) out[64 * i + 8 * j + k] = row[CellBrick::place(k)];
    }
  }
}

}  // namespace supple
