#include "lib/fem/voxel/cell_matrices.h"

#include <algorithm>
#include <vector>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

void add_scaled(const Matrix24& from, double factor, Matrix24& to) {
  for (int n = 0; n < 24; ++n) {
    for (int m = 0; m < 24; ++m) to[n][m] += factor * from[n][m];
  }
}

void clear_rows(std::uint32_t held, Matrix24& matrix) {
  for (int n = 0; n < 24; ++n) {
    if ((held >> n & 1) == 0) continue;
    matrix[n].fill(0);
    for (int m = 0; m < 24; ++m) matrix[m][n] = 0;
  }
}

int place_in_cell(std::uint16_t offset) {
  const Vec3i local = brick_local(offset);
  return (local.x & 1) * 4 + (local.y & 1) * 2 + (local.z & 1);
}

/// The parts of a matrix that a class has factors for.
struct MatrixParts {
  Matrix24 shear{}, bulk{}, mass{};

  MatrixParts() = default;
  explicit MatrixParts(const ElementMatrix& matrix)
      : shear(matrix.shear), bulk(matrix.bulk), mass(matrix.mass) {}
  MatrixParts(const MatrixParts& of_child, int child)
      : shear(on_parent(of_child.shear, child)),
        bulk(on_parent(of_child.bulk, child)),
        mass(on_parent(of_child.mass, child)) {}

  void add(const MatrixParts& other) {
    add_scaled(other.shear, 1, shear);
    add_scaled(other.bulk, 1, bulk);
    add_scaled(other.mass, 1, mass);
  }
  /// Adds the matrix of a class.
  void add_to(Matrix24& sum, const ModuliTable<double>& moduli, std::uint8_t of) const {
    add_scaled(shear, moduli.shear[of], sum);
    add_scaled(bulk, moduli.bulk[of], sum);
    if (moduli.inertia[of] != 0) add_scaled(mass, moduli.inertia[of], sum);
  }
};

/// Matrices of a voxel as seen from a cell that it is a child of.
struct ChildParts {
  MatrixParts own;
  std::vector<MatrixParts> of;

  explicit ChildParts(const ElementMatrix& matrix) : own(matrix) {
    for (int child = 0; child < 8; ++child) of.emplace_back(own, child);
  }
};

/// The matrix of one cell of level 1.
Matrix24 cell_matrix(const CellClasses& cells, std::size_t cell, const VoxelMaterial& material,
                     const ChildParts& parts) {
  Matrix24 sum{};
  for (int child = 0; child < 8; ++child) {
    if ((cells.present[cell] >> child & 1) == 0) continue;
    const std::uint8_t of = cells.of_child[cell][child];
    const std::uint32_t held =
        cells.constraint[cell] < 0 ? 0 : cells.held[cells.constraint[cell]][child];
    if (held == 0) {
      parts.of[std::size_t(child)].add_to(sum, material.moduli, of);
      continue;
    }
    Matrix24 own{};
    parts.own.add_to(own, material.moduli, of);
    clear_rows(held, own);
    add_scaled(on_parent(own, child), 1, sum);
  }
  return sum;
}

/// Elements by their parent.
struct ChildLists {
  std::vector<std::int32_t> begin, child;

  ChildLists(const HexMesh& mesh, const Coarsening& coarsening, std::int32_t parents)
      : begin(parents + 1, 0), child(mesh.offset.size()) {
    const auto for_each = [&](auto&& visit) {
      for (std::size_t b = 0; b < mesh.block_count(); ++b) {
        for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
          visit(e, coarsening.parent_of(b, e));
        }
      }
    };
    for_each([&](std::int32_t, std::int32_t parent) { ++begin[parent + 1]; });
    for (std::int32_t n = 0; n < parents; ++n) begin[n + 1] += begin[n];
    std::vector<std::int32_t> next(begin.begin(), begin.end() - 1);
    for_each([&](std::int32_t e, std::int32_t parent) { child[next[parent]++] = e; });
  }
};

}  // namespace

SymmetricMatrix24::SymmetricMatrix24(const Matrix24& whole) {
  double* to = m_upper.data();
  for (std::size_t row = 0; row < 24; ++row) {
    to = std::copy(whole[row].begin() + std::ptrdiff_t(row), whole[row].end(), to);
  }
}

Matrix24 SymmetricMatrix24::whole() const {
  Matrix24 out;
  for (std::size_t row = 0; row < 24; ++row) {
    for (std::size_t column = row; column < 24; ++column) {
      out[row][column] = out[column][row] = m_upper[place(row, column)];
    }
  }
  return out;
}

CellMatrices CellMatrices::of_voxels(const HexMesh& voxels, const VoxelMaterial& material,
                                     const HeldBits& held) {
  CellMatrices out;
  std::vector<std::size_t> free;
  for (std::int32_t e = 0; e < voxels.element_count(); ++e) {
    const bool is_free = held_corners(voxels.corners(e), held) != kAllCornersHeld;
    if (is_free) free.push_back(out.m_place.size());
    out.m_place.push_back(is_free ? std::int32_t(free.size() - 1) : -1);
  }
  out.m_matrices.resize(free.size());
  const MatrixParts parts(material.matrix);
  parallel_for(out.size(), [&](std::size_t n) {
    const std::size_t e = free[n];
    Matrix24 matrix{};
    parts.add_to(matrix, material.moduli, material.classes[e]);
    clear_rows(held_corners(voxels.corners(std::int32_t(e)), held), matrix);
    out.m_matrices[n] = SymmetricMatrix24(matrix);
  });
  return out;
}

CellMatrices CellMatrices::of_cells(const CellClasses& cells, const VoxelMaterial& material) {
  CellMatrices out;
  out.m_matrices.resize(cells.present.size());
  const ChildParts parts(material.matrix);
  parallel_for(out.size(), [&](std::size_t cell) {
    out.m_matrices[cell] = SymmetricMatrix24(cell_matrix(cells, cell, material, parts));
  });
  return out;
}

CellMatrices CellMatrices::of_large_cells(const HexMesh& cells_mesh, const Coarsening& coarsening,
                                          const CellClasses& cells, const VoxelMaterial& material,
                                          std::int32_t count) {
  CellMatrices out;
  out.m_matrices.resize(count);
  const ChildParts parts(material.matrix);
  // [place of the child][place of the voxel in it], and sums over a child of one class.
  std::vector<std::vector<MatrixParts>> tables(8);
  std::vector<MatrixParts> alike(8);
  for (std::size_t place = 0; place < 8; ++place) {
    for (const MatrixParts& part : parts.of) {
      alike[place].add(tables[place].emplace_back(part, int(place)));
    }
  }
  const ChildLists lists(cells_mesh, coarsening, count);
  parallel_for(out.size(), [&](std::size_t large) {
    Matrix24 sum{};
    for (std::int32_t n = lists.begin[large]; n < lists.begin[large + 1]; ++n) {
      const std::size_t cell = std::size_t(lists.child[n]);
      const std::size_t place = std::size_t(place_in_cell(cells_mesh.offset[cell]));
      const GroupKind kind = cells.kind(cell);
      if (kind == GroupKind::constrained) {
        add_scaled(on_parent(cell_matrix(cells, cell, material, parts), int(place)), 1, sum);
        continue;
      }
      if (kind == GroupKind::alike) {
        alike[place].add_to(sum, material.moduli, cells.of_child[cell][0]);
        continue;
      }
      for (std::size_t child = 0; child < 8; ++child) {
        if ((cells.present[cell] >> child & 1) == 0) continue;
        tables[place][child].add_to(sum, material.moduli, cells.of_child[cell][child]);
      }
    }
    out.m_matrices[large] = SymmetricMatrix24(sum);
  });
  return out;
}

CellMatrices CellMatrices::coarser(const HexMesh& mesh, const Coarsening& coarsening,
                                   std::int32_t count) const {
  CellMatrices out;
  out.m_matrices.resize(count);
  const ChildLists lists(mesh, coarsening, count);
  parallel_for(out.size(), [&](std::size_t large) {
    Matrix24 sum{};
    for (std::int32_t n = lists.begin[large]; n < lists.begin[large + 1]; ++n) {
      const std::size_t cell = std::size_t(lists.child[n]);
      add_scaled(on_parent(m_matrices[cell].whole(), place_in_cell(mesh.offset[cell])), 1, sum);
    }
    out.m_matrices[large] = SymmetricMatrix24(sum);
  });
  return out;
}

}  // namespace supple
