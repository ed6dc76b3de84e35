#include "lib/mesh/tets/voxel_mask.h"

#include <cmath>
#include <numeric>

#include "lib/mesh/tets/voxel_lines.h"

namespace supple {

namespace {

/// Calls visit(voxel, n) for the voxels of a mask.
template <class Visit>
void for_each_voxel(const VoxelMask& mask, const Visit& visit) {
  const Vec3i dims = mask.dims();
  std::size_t n = 0;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i, ++n) {
        if (mask.inside[n] != 0) visit(mask.box.lo + Vec3i(i, j, k), n);
      }
    }
  }
}

VoxelMask part_of(const VoxelMask& mask, const std::vector<std::int32_t>& labels,
                  std::int32_t label, const IndexBox& box) {
  VoxelMask part{mask.geometry, box, {}};
  const Vec3i dims = part.dims(), from = box.lo - mask.box.lo, whole = mask.dims();
  part.inside.reserve(std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z));
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      const std::size_t row =
          (std::size_t(from.z + k) * std::size_t(whole.y) + std::size_t(from.y + j)) *
              std::size_t(whole.x) +
          std::size_t(from.x);
      for (int i = 0; i < dims.x; ++i) {
        const std::size_t n = row + std::size_t(i);
        part.inside.push_back(mask.inside[n] != 0 && labels[n] == label ? 1 : 0);
      }
    }
  }
  return part;
}

/// Flags of a box and a margin of one voxel.
class WideFlags {
 public:
  explicit WideFlags(const VoxelMask& mask) : m_mask(mask), m_dims(mask.dims() + Vec3i(2)) {
    m_flags.assign(std::size_t(m_dims.x) * std::size_t(m_dims.y) * std::size_t(m_dims.z), 0);
    for_each_inside([&](std::size_t n, std::uint8_t& flag) { flag = mask.inside[n]; });
  }

  void spread_by(const Vec3i& radius) { spread(m_dims, radius, m_flags); }
  void invert() {
    for_each_value(m_dims, [&](std::size_t n) { m_flags[n] ^= 1U; });
  }
  /// Keeps the voxels of a mask of the same box whose flag is as given.
  VoxelFlags of(const VoxelMask& mask, std::uint8_t wanted) {
    VoxelFlags kept(mask.inside.size());
    for_each_inside([&](std::size_t n, std::uint8_t& flag) {
      kept[n] = mask.inside[n] != 0 && flag == wanted ? 1 : 0;
    });
    return kept;
  }

 private:
  /// Calls visit(n, flag) for the voxels of the box itself.
  template <class Visit>
  void for_each_inside(const Visit& visit) {
    const Vec3i inner = m_mask.dims();
    std::size_t n = 0;
    for (int k = 0; k < inner.z; ++k) {
      for (int j = 0; j < inner.y; ++j) {
        std::uint8_t* row = Box<std::uint8_t>{m_dims, m_flags}.row(j + 1, k + 1) + 1;
        for (int i = 0; i < inner.x; ++i) visit(n++, row[i]);
      }
    }
  }

  const VoxelMask& m_mask;
  Vec3i m_dims;
  VoxelFlags m_flags;
};

/// Calls visit(part) for the voxels of every label, or for the whole without labels; adds what it
/// returns, flags of the part's box.
template <class Visit>
VoxelMask join_parts(const VoxelMask& mask, const VoxelLabel& label_of, const Visit& visit) {
  VoxelMask joined{mask.geometry, mask.box, VoxelFlags(mask.inside.size(), 0)};
  const auto add = [&](VoxelMask part) {
    part.inside = visit(part);
    for_each_voxel(part,
                   [&](const Vec3i& voxel, std::size_t) { joined.inside[mask.number(voxel)] = 1; });
  };
  if (!label_of) {
    add(mask);
  } else {
    for (const auto& [label, part] : masks_of_labels(mask, label_of)) add(part);
  }
  return joined;
}

}  // namespace

std::int64_t VoxelMask::count() const {
  return std::accumulate(inside.begin(), inside.end(), std::int64_t(0));
}

double VoxelMask::volume_mm3() const {
  return double(count()) * std::abs(geometry.determinant());
}

VoxelMask mask_of(const Geometry& geometry, const BrickTopology& voxels) {
  VoxelMask mask{geometry, voxels.active_bounds(), {}};
  const Vec3i dims = mask.dims();
  mask.inside.assign(std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z), 0);
  parallel_for(voxels.brick_count(), Grain{64}, [&](std::size_t b) {
    for_each_active(voxels.mask(b), [&](int offset) {
      const Vec3i at = voxels.origin(b) + brick_local(offset) - mask.box.lo;
      mask.inside[mask.number(mask.box.lo + at)] = 1;
    });
  });
  return mask;
}

std::map<std::int32_t, VoxelMask> masks_of_labels(const VoxelMask& mask,
                                                  const VoxelLabel& label_of) {
  std::vector<std::int32_t> labels(mask.inside.size());
  std::map<std::int32_t, IndexBox> boxes;
  for_each_voxel(mask, [&](const Vec3i& at, std::size_t n) {
    labels[n] = label_of(at);
    IndexBox& box = boxes.try_emplace(labels[n], IndexBox{at, at}).first->second;
    for (int a = 0; a < 3; ++a) {
      box.lo[a] = std::min(box.lo[a], at[a]);
      box.hi[a] = std::max(box.hi[a], at[a]);
    }
  });
  std::map<std::int32_t, VoxelMask> masks;
  for (const auto& [label, box] : boxes) masks[label] = part_of(mask, labels, label, box);
  return masks;
}

VoxelMask thin_voxels(const VoxelMask& mask, const VoxelLabel& label_of, double thinner_mm) {
  // A voxel is thin that no box of 2 r + 1 voxels within its part comes near to.
  const Vec3d size = mask.geometry.spacing_mm();
  Vec3i radius;
  for (int a = 0; a < 3; ++a) {
    radius[a] = std::max(0, int(std::ceil((thinner_mm / size[a] - 1) / 2 - 1e-9)));
  }
  return join_parts(mask, label_of, [&](const VoxelMask& part) {
    WideFlags flags(part);
    flags.invert();
    flags.spread_by(radius);
    flags.invert();
    flags.spread_by(radius + Vec3i(1));
    return flags.of(part, 0);
  });
}

VoxelMask without_rims(const VoxelMask& part, const VoxelMask& mask, const VoxelLabel& label_of,
                       double rim_mm) {
  const Vec3d size = mask.geometry.spacing_mm();
  Vec3i radius;
  for (int a = 0; a < 3; ++a) radius[a] = int(std::ceil(rim_mm / size[a] - 1e-9));
  return join_parts(mask, label_of, [&](const VoxelMask& label) {
    VoxelMask own = label, rest = label;
    for_each_voxel(label, [&](const Vec3i& voxel, std::size_t n) {
      (part.holds(voxel) ? rest : own).inside[n] = 0;
    });
    WideFlags near_rest(rest);
    near_rest.spread_by(radius);
    VoxelMask core = own;
    core.inside = near_rest.of(own, 0);
    WideFlags near_core(core);
    near_core.spread_by(radius);
    return near_core.of(own, 1);
  });
}

}  // namespace supple
