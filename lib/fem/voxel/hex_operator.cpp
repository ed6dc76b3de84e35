#include "lib/fem/voxel/hex_operator.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/voxel/block_field.h"

namespace supple {

// ---- Kernels from reference matrices

namespace {

/// The mass in modes, where it is diagonal and alike for all components.
template <class T>
void take_mass(const Matrix24& in_modes, T* mass) {
  for (int mode = 0; mode < 8; ++mode) mass[mode] = T(in_modes[3 * mode][3 * mode]);
}

}  // namespace

template <class T>
VoxelKernel<T>::VoxelKernel(const ElementMatrix& matrix)
    : is_pointwise(matrix.dilatation == Dilatation::pointwise) {
  const Matrix24 shear = in_modes(matrix.shear), bulk = in_modes(matrix.bulk);
  for (int n = 0; n < 9; ++n) {
    for (int m = 0; m < 9; ++m) {
      shear_linear[n][m] = T(shear[3 + n][3 + m]);
      shear_bilinear[n][m] = T(shear[12 + n][12 + m]);
      bulk_bilinear[n][m] = T(bulk[12 + n][12 + m]);
      if (n >= 3 || m >= 3) continue;
      shear_trilinear[n][m] = T(shear[21 + n][21 + m]);
      bulk_trilinear[n][m] = T(bulk[21 + n][21 + m]);
    }
    // H b / 8: only linear modes have a mean gradient.
    double sum = 0;
    for (int c = 0; c < 8; ++c) {
      const bool is_high = (kModes[1 + n / 3] & c) != 0;
      sum += (is_high ? 1 : -1) * matrix.gradient[3 * c + n % 3];
    }
    gradient[n] = T(std::sqrt(matrix.volume_mm3) * sum / 8);
  }
  take_mass(in_modes(matrix.mass), mass);
}

template <class T>
AlikeKernel<T>::AlikeKernel(const ElementMatrix& matrix) {
  Matrix24 shear{}, bulk{}, masses{};
  for (int child = 0; child < 8; ++child) {
    const Matrix24 by_shear = in_modes(on_parent(matrix.shear, child));
    const Matrix24 by_bulk = in_modes(on_parent(matrix.bulk, child));
    const Matrix24 by_mass = in_modes(on_parent(matrix.mass, child));
    for (int n = 0; n < 24; ++n) {
      for (int m = 0; m < 24; ++m) {
        shear[n][m] += by_shear[n][m];
        bulk[n][m] += by_bulk[n][m];
        masses[n][m] += by_mass[n][m];
      }
    }
  }
  take_mass(masses, mass);
  const auto odd = [](int n) { return n < 9 ? 3 + n : 12 + n; };
  for (int n = 0; n < 12; ++n) {
    for (int m = 0; m < 12; ++m) {
      shear_odd[n][m] = T(shear[odd(n)][odd(m)]);
      bulk_odd[n][m] = T(bulk[odd(n)][odd(m)]);
      if (n >= 9 || m >= 9) continue;
      shear_even[n][m] = T(shear[12 + n][12 + m]);
      bulk_even[n][m] = T(bulk[12 + n][12 + m]);
    }
  }
}

// ---- What the groups hold

namespace {

constexpr int kChildBytes = 8 * kGroup + 8;

std::vector<GroupKind> kinds_of(const CellClasses& cells) {
  std::vector<GroupKind> kinds(cells.present.size());
  for (std::size_t n = 0; n < kinds.size(); ++n) kinds[n] = cells.kind(n);
  return kinds;
}

std::array<std::array<float, 24>, 8> diagonals(const Matrix24& matrix, bool is_coarse) {
  std::array<std::array<float, 24>, 8> out{};
  for (int child = 0; child < (is_coarse ? 8 : 1); ++child) {
    const Matrix24 on = is_coarse ? on_parent(matrix, child) : matrix;
    for (int n = 0; n < 24; ++n) out[child][n] = float(on[n][n]);
  }
  return out;
}

template <class T>
const ModuliTable<T>& moduli_in(const VoxelMaterial& material) {
  if constexpr (std::is_same_v<T, float>) {
    return material.moduli_single;
  } else {
    return material.moduli;
  }
}

}  // namespace

HexOperator::HexOperator(const HexMesh& mesh, const VoxelMaterial& material)
    : m_mesh(&mesh),
      m_material(&material),
      m_is_coarse(false),
      m_has_inertia(material.moduli.has_inertia()),
      m_groups(group_elements(mesh, std::vector<GroupKind>(mesh.offset.size()))),
      m_voxel_single(material.matrix),
      m_voxel(material.matrix),
      m_alike_single(material.matrix),
      m_alike(material.matrix),
      m_shear_diagonal(diagonals(material.matrix.shear, false)),
      m_bulk_diagonal(diagonals(material.matrix.bulk, false)),
      m_mass_diagonal(diagonals(material.matrix.mass, false)) {
  m_classes.resize(m_groups.element.size());
  for (std::size_t n = 0; n < m_classes.size(); ++n) {
    if (m_groups.element[n] >= 0) m_classes[n] = material.classes[m_groups.element[n]];
  }
  for (std::size_t g = 0; g < m_groups.groups.size(); ++g) {
    m_groups.groups[g].lanes = std::uint32_t(g * kGroup);
  }
  std::vector<std::int32_t>().swap(m_groups.element);
}

HexOperator::HexOperator(const HexMesh& mesh, const CellClasses& cells,
                         const VoxelMaterial& material)
    : m_mesh(&mesh),
      m_material(&material),
      m_is_coarse(true),
      m_has_inertia(material.moduli.has_inertia()),
      m_groups(group_elements(mesh, kinds_of(cells))),
      m_voxel_single(material.matrix),
      m_voxel(material.matrix),
      m_alike_single(material.matrix),
      m_alike(material.matrix),
      m_shear_diagonal(diagonals(material.matrix.shear, true)),
      m_bulk_diagonal(diagonals(material.matrix.bulk, true)),
      m_mass_diagonal(diagonals(material.matrix.mass, true)) {
  m_held_of.resize(m_groups.groups.size());
  for (std::size_t g = 0; g < m_groups.groups.size(); ++g) {
    ElementGroup& group = m_groups.groups[g];
    const std::int32_t* elements = &m_groups.element[g * kGroup];
    group.lanes = std::uint32_t(m_classes.size());
    m_classes.resize(m_classes.size() + (group.kind == GroupKind::alike ? kGroup : kChildBytes));
    std::uint8_t* classes = &m_classes[group.lanes];
    m_held_of[g] = std::uint32_t(m_held.size());
    if (group.kind == GroupKind::constrained) m_held.resize(m_held.size() + 8 * kGroup);
    for (int lane = 0; lane < kGroup; ++lane) {
      if (elements[lane] < 0) continue;
      const std::size_t cell = std::size_t(elements[lane]);
      if (group.kind == GroupKind::alike) {
        classes[lane] = cells.of_child[cell][0];
        continue;
      }
      for (int child = 0; child < 8; ++child) {
        if ((cells.present[cell] >> child & 1) == 0) continue;
        classes[kGroup * child + lane] = cells.of_child[cell][child];
        classes[8 * kGroup + child] = std::uint8_t(classes[8 * kGroup + child] | 1 << lane);
        if (cells.constraint[cell] < 0) continue;
        m_held[m_held_of[g] + kGroup * child + lane] = cells.held[cells.constraint[cell]][child];
      }
    }
  }
  std::vector<std::int32_t>().swap(m_groups.element);
}

std::size_t HexOperator::bytes() const {
  return m_groups.bytes() + m_classes.capacity() + (m_held.capacity() + m_held_of.capacity()) * 4;
}

// ---- The product

template <class T>
LaneMaterial<T> HexOperator::material_of_lanes(const std::uint8_t* classes,
                                               unsigned present) const {
  const ModuliTable<T>& moduli = moduli_in<T>(*m_material);
  LaneMaterial<T> of;
  of.has_inertia = m_has_inertia;
  for (int lane = 0; lane < kGroup; ++lane) {
    const bool is_there = (present >> lane & 1) != 0;
    of.shear[lane] = is_there ? moduli.shear[classes[lane]] : 0;
    of.bulk[lane] = is_there ? moduli.bulk[classes[lane]] : 0;
    if (m_has_inertia) of.inertia[lane] = is_there ? moduli.inertia[classes[lane]] : 0;
  }
  return of;
}

template <class T>
ChildLanes<T> HexOperator::children_of(const ElementGroup& group) const {
  ChildLanes<T> children;
  const std::uint8_t* classes = &m_classes[group.lanes];
  for (int child = 0; child < 8; ++child) {
    children.child[child] =
        material_of_lanes<T>(classes + kGroup * child, classes[8 * kGroup + child]);
  }
  if (group.kind == GroupKind::constrained) {
    children.held = &m_held[m_held_of[std::size_t(&group - m_groups.groups.data())]];
  }
  return children;
}

template <class T>
void HexOperator::apply_group(const ElementGroup& group, ElementLanes<T>* x) const {
  if (group.kind != GroupKind::alike) {
    if constexpr (std::is_same_v<T, float>) {
      apply_mixed(m_voxel_single, children_of<T>(group), x);
    } else {
      apply_mixed(m_voxel, children_of<T>(group), x);
    }
    return;
  }
  const LaneMaterial<T> of = material_of_lanes<T>(&m_classes[group.lanes], group.present);
  if constexpr (std::is_same_v<T, float>) {
    m_is_coarse ? apply_alike(m_alike_single, of, x) : apply_voxel(m_voxel_single, of, x);
  } else {
    m_is_coarse ? apply_alike(m_alike, of, x) : apply_voxel(m_voxel, of, x);
  }
}

namespace {

template <class T>
struct BlockProduct {
  BlockProduct(const HexMesh& mesh, const ElementGroups& groups)
      : in(mesh, groups), out(mesh, groups) {}

  BlockField<T> in, out;
};

}  // namespace

template <class X, class T, class Compute>
void HexOperator::for_each_group(const X* x, T* y, T sign, const GroupsAtNodes* groups,
                                 Compute&& compute) const {
  for_blocks_by_colour<BlockProduct<T>>(
      *m_mesh, m_groups, groups == nullptr ? m_mesh->of_colour : groups->blocks,
      [&](std::int32_t block, BlockProduct<T>& product) {
        if (m_groups.group_begin[block] == m_groups.group_begin[block + 1]) return;
        alignas(64) ElementLanes<T> corners[24];
        if (x != nullptr) product.in.load(block, x);
        product.out.clear(block);
        for (auto g = m_groups.group_begin[block]; g < m_groups.group_begin[block + 1]; ++g) {
          if (groups != nullptr && !groups->is_one[g]) continue;
          const ElementGroup& group = m_groups.groups[g];
          if (x != nullptr) product.in.read_corners(group, corners);
          compute(group, corners);
          product.out.add_corners(group, corners);
        }
        product.out.add_to(block, sign, y);
      });
}

template <class X, class T>
void HexOperator::accumulate(const X* x, T* y, T sign, const GroupsAtNodes* groups) const {
  for_each_group(x, y, sign, groups, [this](const ElementGroup& group, ElementLanes<T>* corners) {
    apply_group<T>(group, corners);
  });
}

void HexOperator::add(const float* x, double* y) const {
  accumulate(x, y, 1.0);
}
void HexOperator::add(const double* x, double* y) const {
  accumulate(x, y, 1.0);
}
void HexOperator::add(const float* x, float* y) const {
  accumulate(x, y, 1.0F);
}
void HexOperator::subtract(const double* x, double* y) const {
  accumulate(x, y, -1.0);
}
void HexOperator::subtract(const float* x, float* y) const {
  accumulate(x, y, -1.0F);
}
void HexOperator::subtract(const float* x, float* y, const GroupsAtNodes& groups) const {
  accumulate(x, y, -1.0F, &groups);
}

// ---- Parts of it

std::size_t GroupsAtNodes::bytes() const {
  std::size_t sum = is_one.capacity() / 8;
  for (const std::vector<std::int32_t>& of_colour : blocks) sum += of_colour.capacity() * 4;
  return sum;
}

GroupsAtNodes HexOperator::groups_at(const std::vector<bool>& is_node) const {
  GroupsAtNodes out;
  out.is_one.resize(m_groups.groups.size());
  std::size_t count = 0;
  for (std::size_t colour = 0; colour < out.blocks.size(); ++colour) {
    for (const std::int32_t block : m_mesh->of_colour[colour]) {
      const NodeIndex* nodes = m_mesh->tables.nodes(std::size_t(block));
      const std::size_t before = count;
      for (auto g = m_groups.group_begin[block]; g < m_groups.group_begin[block + 1]; ++g) {
        out.is_one[g] = m_groups.any_corner(m_groups.groups[g], [&](std::size_t place) {
          return nodes[place] >= 0 && is_node[std::size_t(nodes[place])];
        });
        if (out.is_one[g]) ++count;
      }
      if (count > before) out.blocks[colour].push_back(block);
    }
  }
  out.share = double(count) / double(std::max<std::size_t>(1, out.is_one.size()));
  return out;
}

// ---- The diagonal

void HexOperator::group_diagonal(const ElementGroup& group, ElementLanes<float>* out) const {
  if (group.kind == GroupKind::constrained) {
    const ChildLanes<float> children = children_of<float>(group);
    for (int n = 0; n < 24; ++n) {
      ElementLanes<float> unit[24] = {};
      unit[n] += 1;
      apply_mixed(m_voxel_single, children, unit);
      out[n] = unit[n];
    }
    return;
  }
  for (int n = 0; n < 24; ++n) out[n] = ElementLanes<float>{};
  for (int child = 0; child < (m_is_coarse ? 8 : 1); ++child) {
    const std::uint8_t* classes = &m_classes[group.lanes];
    const LaneMaterial<float> of =
        group.kind == GroupKind::alike
            ? material_of_lanes<float>(classes, group.present)
            : material_of_lanes<float>(classes + kGroup * child, classes[8 * kGroup + child]);
    for (int n = 0; n < 24; ++n) {
      out[n] += of.shear * m_shear_diagonal[child][n] + of.bulk * m_bulk_diagonal[child][n];
      if (m_has_inertia) out[n] += of.inertia * m_mass_diagonal[child][n];
    }
  }
}

std::vector<float> HexOperator::diagonal() const {
  std::vector<float> diagonal(3 * std::size_t(m_mesh->node_count()), 0.0f);
  for_each_group<float, float>(nullptr, diagonal.data(), 1.0f, nullptr,
                               [this](const ElementGroup& group, ElementLanes<float>* corners) {
                                 group_diagonal(group, corners);
                               });
  return diagonal;
}

}  // namespace supple
