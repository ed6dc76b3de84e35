#include "lib/fem/voxel/voxel_nodes.h"

#include <memory>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// A block with one voxel around it.
constexpr int kWide = kBrickDim + 2;
constexpr int kWideStride[3] = {kWide * kWide, kWide, 1};

int wide_place(const Vec3i& local) {
  return (local.x + 1) * kWideStride[0] + (local.y + 1) * kWideStride[1] + local.z + 1;
}

/// The elements of a block and around it.
struct CornerVoxels {
  std::array<std::int32_t, kWide * kWide * kWide> element;  // -1: none
  /// Bits per axis: the link to the next voxel along it is cut. Only where has_cuts.
  std::array<std::uint8_t, kWide * kWide * kWide> cut;
  bool has_cuts = false;

  void find(const Body& body, const HexMesh& mesh, std::size_t block) {
    element.fill(-1);
    has_cuts = false;
    const Vec3i origin = body.elements.origin(block);
    for (int n = 0; n < 27; ++n) {
      const Vec3i step(n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1);
      const std::int32_t other = body.elements.find(origin + step * kBrickDim);
      if (other >= 0) take(body, mesh, std::size_t(other), step * kBrickDim);
    }
  }

 private:
  void take(const Body& body, const HexMesh& mesh, std::size_t brick, const Vec3i& shift) {
    const LinkCuts::BrickCuts* cuts = body.cuts.brick(brick);
    if (cuts != nullptr && !has_cuts) {
      cut.fill(0);
      has_cuts = true;
    }
    std::int32_t next = mesh.element_begin[brick];
    for_each_active(body.elements.mask(brick), [&](int offset) {
      const std::int32_t number = next++;
      const Vec3i local = brick_local(offset) + shift;
      for (int axis = 0; axis < 3; ++axis) {
        if (local[axis] < -1 || local[axis] > kBrickDim) return;
      }
      const int place = wide_place(local);
      element[place] = number;
      for (int axis = 0; cuts != nullptr && axis < 3; ++axis) {
        if (mask_test((*cuts)[axis], offset)) cut[place] = std::uint8_t(cut[place] | 1 << axis);
      }
    });
  }
};

/// Links of eight voxels around a corner, numbered by bits as corners are: per axis the lower
/// voxels of links, as bits.
struct Links {
  std::array<std::uint8_t, 3> lower;
};
constexpr int kAxisBitOf[3] = {4, 2, 1};

/// The voxels joined to voxel `own`, itself included.
std::uint8_t piece_of(const Links& links, int own) {
  unsigned piece = 1u << own, before = 0;
  while (piece != before) {
    before = piece;
    for (int axis = 0; axis < 3; ++axis) {
      const int bit = kAxisBitOf[axis];
      piece |= (piece & links.lower[axis]) << bit;
      piece |= (piece >> bit) & links.lower[axis];
    }
  }
  return std::uint8_t(piece);
}

/// Links between all voxels of a set.
Links links_of(unsigned present) {
  constexpr unsigned kLower[3] = {0x0f, 0x33, 0x55};
  Links links;
  for (int axis = 0; axis < 3; ++axis) {
    links.lower[axis] = std::uint8_t(present & present >> kAxisBitOf[axis] & kLower[axis]);
  }
  return links;
}

/// piece_of() without cuts: [voxels that are there][own].
std::array<std::array<std::uint8_t, 8>, 256> uncut_pieces() {
  std::array<std::array<std::uint8_t, 8>, 256> pieces{};
  for (unsigned present = 0; present < 256; ++present) {
    for (int own = 0; own < 8; ++own) pieces[present][own] = piece_of(links_of(present), own);
  }
  return pieces;
}
const std::array<std::array<std::uint8_t, 8>, 256> kUncutPieces = uncut_pieces();

/// True if a link that is cut has its ends in different pieces.
bool parts_pieces(const Links& links, const Links& uncut) {
  for (int axis = 0; axis < 3; ++axis) {
    const unsigned cut = uncut.lower[axis] & ~unsigned(links.lower[axis]);
    for (int low = 0; low < 8; ++low) {
      if ((cut >> low & 1) == 0) continue;
      if ((piece_of(links, low) >> (low | kAxisBitOf[axis]) & 1) == 0) return true;
    }
  }
  return false;
}

/// The first element of the piece that has corner `c` of the element at `place`, as 8 element +
/// corner.
std::uint32_t first_corner(const CornerVoxels& around, const TouchingRule& rule, int place, int c) {
  // Voxel `bits` around the corner, where the element is voxel 7 - c.
  const int lowest = place + (c >> 2 & 1) * kWideStride[0] + (c >> 1 & 1) * kWideStride[1] +
                     (c & 1) - kWideStride[0] - kWideStride[1] - 1;
  const auto at = [&](int bits) {
    return lowest + (bits >> 2 & 1) * kWideStride[0] + (bits >> 1 & 1) * kWideStride[1] +
           (bits & 1);
  };
  unsigned present = 0;
  for (int bits = 0; bits < 8; ++bits) present |= unsigned(around.element[at(bits)] >= 0) << bits;
  unsigned piece = kUncutPieces[present][7 - c];
  bool is_joined = rule.touching == Touching::joined;
  if (around.has_cuts) {
    const Links uncut = links_of(present);
    Links links = uncut;
    for (int bits = 0; bits < 8; ++bits) {
      if ((present >> bits & 1) == 0) continue;
      for (int axis = 0; axis < 3; ++axis) {
        if ((around.cut[at(bits)] >> axis & 1) == 0) continue;
        links.lower[axis] = std::uint8_t(links.lower[axis] & ~(1u << bits));
      }
    }
    piece = piece_of(links, 7 - c);
    is_joined = is_joined && !parts_pieces(links, uncut);
  }
  if (is_joined) {
    unsigned joined = present;
    for (int bits = 0; !rule.apart.empty() && bits < 8; ++bits) {
      const bool is_there = (present >> bits & 1) != 0;
      if (is_there && rule.apart[std::size_t(around.element[at(bits)])]) joined &= ~(1u << bits);
    }
    if ((joined >> (7 - c) & 1) != 0) piece = joined;
  }
  std::uint32_t first = ~0u;
  for (int bits = 0; bits < 8; ++bits) {
    if ((piece >> bits & 1) == 0) continue;
    first = std::min(first, 8 * std::uint32_t(around.element[at(bits)]) + (7 - bits));
  }
  return first;
}

template <class Visit>
void for_all_blocks(const HexMesh& mesh, const Visit& visit) {
  parallel_for(std::size_t(mesh.block_count()), Grain{8}, visit);
}

/// A corner that another element met first, until that one's number is known.
NodeIndex as_reference(std::uint32_t corner) {
  return NodeIndex(-1 - std::int64_t(corner));
}
std::uint32_t referred(NodeIndex reference) {
  return std::uint32_t(-1 - std::int64_t(reference));
}

}  // namespace

void number_voxel_nodes(const Body& body, const TouchingRule& rule, HexMesh& mesh,
                        const Progress* progress) {
  std::vector<Corners> corners(mesh.offset.size());
  mesh.node_begin.assign(mesh.block_count() + 1, 0);
  for_all_blocks(mesh, [&](std::size_t b) {
    CornerVoxels around;
    around.find(body, mesh, b);
    OwnNodes own;
    for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
      const int place = wide_place(brick_local(mesh.offset[e]));
      for (int c = 0; c < 8; ++c) {
        const std::uint32_t first = first_corner(around, rule, place, c);
        corners[e][c] = as_reference(first);
        if (first == 8 * std::uint32_t(e) + c) own.add(mesh, first);
      }
    }
    mesh.node_begin[b + 1] = own.number(corners, 0);
  });
  poll(progress);
  for (std::size_t b = 0; b < mesh.block_count(); ++b) mesh.node_begin[b + 1] += mesh.node_begin[b];
  const auto for_all_corners = [&](auto&& visit) {
    for_all_blocks(mesh, [&](std::size_t b) {
      for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
        for (NodeIndex& node : corners[e]) visit(node, mesh.node_begin[b]);
      }
    });
  };
  for_all_corners([](NodeIndex& node, NodeIndex begin) {
    if (node >= 0) node += begin;
  });
  // Nodes that were referred to are numbers already and stay what they are.
  for_all_corners([&](NodeIndex& node, NodeIndex) {
    if (node < 0) node = corners[referred(node) / 8][referred(node) % 8];
  });
  poll(progress);
  mesh.set_corners(corners);
}

std::int32_t element_across(const HexMesh& mesh, const BrickIndex& index, std::size_t block,
                            std::int32_t element, int axis, bool is_high) {
  Vec3i cell = mesh.origin[block] + brick_local(mesh.offset[std::size_t(element)]);
  cell[axis] += is_high ? 1 : -1;
  const std::int32_t there = index.find(cell);
  if (there < 0) return -1;
  const std::int32_t other = element_at(mesh, std::size_t(there), brick_offset(cell));
  if (other < 0) return -1;
  const Corners own = mesh.corners_in(block, element);
  const Corners beside = mesh.corners_in(std::size_t(there), other);
  for (int c = 0; c < 8; ++c) {
    if (((c & kAxisBitOf[axis]) != 0) != is_high) continue;
    if (own[c] != beside[c ^ kAxisBitOf[axis]]) return -1;
  }
  return other;
}

}  // namespace supple
