#include "lib/fem/voxel/hex_mesh.h"

#include <algorithm>

#include "lib/fem/voxel/corner_sets.h"
#include "lib/fem/voxel/voxel_nodes.h"

namespace supple {

namespace {

constexpr int kAxisBit[3] = {4, 2, 1};
/// Levels end there: the factorisation of so many nodes takes some 100 ms.
constexpr NodeIndex kCoarsestNodes = 600;
/// Parts of the time of coarsening after which elements are grouped, and corners joined.
constexpr double kGrouping = 0.3, kJoining = 0.8;

/// Makes one node per set of corners.
void number_nodes(HexMesh& mesh, CornerSets& sets, const StagePart& stage) {
  NodeIndex nodes = 0;
  std::vector<Corners> corners(mesh.offset.size());
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    stage.done(b, mesh.block_count());
    mesh.node_begin.push_back(nodes);
    const auto for_all_corners = [&](auto&& visit) {
      for (std::int32_t e = mesh.element_begin[b]; e < mesh.element_begin[b + 1]; ++e) {
        for (int c = 0; c < 8; ++c) {
          const std::uint32_t corner = 8 * std::uint32_t(e) + c;
          visit(corner, sets.find(corner));
        }
      }
    };
    OwnNodes own;
    for_all_corners([&](std::uint32_t corner, std::uint32_t first) {
      if (first == corner) own.add(mesh, corner);
    });
    nodes = own.number(corners, nodes);
    for_all_corners([&](std::uint32_t corner, std::uint32_t first) {
      corners[corner / 8][corner % 8] = corners[first / 8][first % 8];
    });
  }
  mesh.node_begin.push_back(nodes);
  mesh.set_corners(corners);
}

void add_block(HexMesh& mesh, const Vec3i& origin) {
  const int colour = (origin.x >> 3 & 1) * 4 + (origin.y >> 3 & 1) * 2 + (origin.z >> 3 & 1);
  mesh.of_colour[colour].push_back(std::int32_t(mesh.origin.size()));
  mesh.origin.push_back(origin);
}

}  // namespace

void OwnNodes::add(const HexMesh& mesh, std::uint32_t corner) {
  m_nodes.emplace_back(lattice_place(mesh.offset[corner / 8], int(corner % 8)), corner);
}

NodeIndex OwnNodes::number(std::vector<Corners>& corners, NodeIndex first) {
  std::sort(m_nodes.begin(), m_nodes.end());
  for (const auto& [place, corner] : m_nodes) corners[corner / 8][corner % 8] = first++;
  return first;
}

void HexMesh::set_corners(const std::vector<Corners>& corners) {
  tables = NodeTables(element_begin, offset, corners);
  for (std::int32_t e = 0, block = 0; e < element_count(); e += std::int32_t(kHintStep)) {
    while (element_begin[std::size_t(block) + 1] <= e) ++block;
    block_hint.push_back(block);
  }
}

std::size_t HexMesh::bytes() const {
  return origin.capacity() * (sizeof(Vec3i) + 12) + offset.capacity() * sizeof(offset[0]) +
         block_hint.capacity() * sizeof(block_hint[0]) + tables.bytes();
}

std::size_t Coarsening::bytes() const {
  return first_element.capacity() * 4 + parent.bytes() + node_parent.bytes() +
         node_place.capacity();
}

HexMesh hex_mesh(const Body& body, const TouchingRule& rule, const Progress* progress) {
  const BrickTopology& elements = body.elements;
  if (elements.active_count() == 0 || elements.active_count() > kMostElements) {
    throw InputError({"", "finite elements", std::to_string(elements.active_count()) + " voxels",
                      "1 to " + std::to_string(kMostElements)});
  }
  HexMesh mesh;
  mesh.geometry = body.geometry;
  mesh.offset.reserve(std::size_t(elements.active_count()));
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    add_block(mesh, elements.origin(b));
    mesh.element_begin.push_back(mesh.element_count());
    for_each_active(elements.mask(b),
                    [&](int offset) { mesh.offset.push_back(std::uint16_t(offset)); });
  }
  mesh.element_begin.push_back(mesh.element_count());
  poll(progress);
  number_voxel_nodes(body, rule, mesh, progress);
  return mesh;
}

std::int32_t element_at(const HexMesh& mesh, std::size_t block, int offset) {
  if (block >= mesh.block_count()) return -1;
  const auto begin = mesh.offset.begin() + mesh.element_begin[block];
  const auto end = mesh.offset.begin() + mesh.element_begin[block + 1];
  const auto place = std::lower_bound(begin, end, std::uint16_t(offset));
  return place == end || *place != offset ? -1 : std::int32_t(place - mesh.offset.begin());
}

Vec3d corner_position(const HexMesh& mesh, std::int32_t block, int offset, int corner) {
  const Vec3i cell = mesh.origin[block] + brick_local(offset);
  return mesh.geometry.world_from_index({cell.x + (corner >> 2 & 1) - 0.5,
                                         cell.y + (corner >> 1 & 1) - 0.5,
                                         cell.z + (corner & 1) - 0.5});
}

namespace {

/// Writes the rest positions of the nodes of a block from `first` on, which is that of its first.
void put_node_positions(const HexMesh& mesh, std::size_t block, Vec3d* first) {
  const NodeIndex begin = mesh.node_begin[block];
  for (std::int32_t e = mesh.element_begin[block]; e < mesh.element_begin[block + 1]; ++e) {
    const Corners corners = mesh.corners_in(block, e);
    for (int c = 0; c < 8; ++c) {
      if (corners[c] < begin) continue;
      first[corners[c] - begin] =
          corner_position(mesh, std::int32_t(block), mesh.offset[std::size_t(e)], c);
    }
  }
}

}  // namespace

std::vector<Vec3d> node_positions(const HexMesh& mesh) {
  std::vector<Vec3d> positions(mesh.node_count());
  for (std::size_t b = 0; b < mesh.block_count(); ++b) {
    put_node_positions(mesh, b, positions.data() + mesh.node_begin[b]);
  }
  return positions;
}

std::vector<Vec3d> node_positions(const HexMesh& mesh, const std::vector<NodeIndex>& nodes) {
  std::vector<Vec3d> positions, of_block;
  positions.reserve(nodes.size());
  for (auto node = nodes.begin(); node != nodes.end();) {
    const auto end = std::upper_bound(mesh.node_begin.begin(), mesh.node_begin.end(), *node);
    const NodeIndex begin = end[-1];
    of_block.resize(std::size_t(*end - begin));
    put_node_positions(mesh, std::size_t(end - mesh.node_begin.begin()) - 1, of_block.data());
    for (; node != nodes.end() && *node < *end; ++node) {
      positions.push_back(of_block[std::size_t(*node - begin)]);
    }
  }
  return positions;
}

Islands find_islands(const HexMesh& mesh) {
  CornerSets sets(mesh.node_count());
  for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
    const Corners corners = mesh.corners(e);
    for (int c = 1; c < 8; ++c) sets.join(corners[0], corners[c]);
  }
  Islands islands;
  islands.of_node.resize(mesh.node_count());
  for (NodeIndex n = 0; n < mesh.node_count(); ++n) {
    const std::uint32_t first = sets.find(n);
    islands.of_node[n] = first == std::uint32_t(n) ? islands.count++ : islands.of_node[first];
  }
  islands.of_element.resize(mesh.offset.size());
  for (std::int32_t e = 0; e < mesh.element_count(); ++e) {
    islands.of_element[e] = islands.of_node[mesh.corners(e)[0]];
  }
  return islands;
}

// ---- Coarsening

namespace {

/// The elements of the blocks that form one coarse block, in the order of the coarse cells.
struct CellChildren {
  std::vector<std::int32_t> element;
  std::array<std::int32_t, kBrickVoxels + 1> begin;
};

Vec3i cell_of(const HexMesh& mesh, std::size_t block, std::int32_t element) {
  return mesh.origin[block] + brick_local(mesh.offset[element]);
}
Vec3i halved(const Vec3i& cell) {
  return {cell.x >> 1, cell.y >> 1, cell.z >> 1};
}
int place_in_parent(const Vec3i& cell) {
  return (cell.x & 1) * 4 + (cell.y & 1) * 2 + (cell.z & 1);
}

void sort_into_cells(const HexMesh& fine, const std::vector<std::int32_t>& blocks,
                     CellChildren& out) {
  out.begin.fill(0);
  const auto for_each = [&](auto&& visit) {
    for (const std::int32_t b : blocks) {
      for (std::int32_t e = fine.element_begin[b]; e < fine.element_begin[b + 1]; ++e) {
        visit(brick_offset(halved(cell_of(fine, b, e))), e);
      }
    }
  };
  for_each([&](int cell, std::int32_t) { ++out.begin[cell + 1]; });
  for (int cell = 0; cell < kBrickVoxels; ++cell) out.begin[cell + 1] += out.begin[cell];
  out.element.resize(out.begin[kBrickVoxels]);
  std::array<std::int32_t, kBrickVoxels + 1> next = out.begin;
  for_each([&](int cell, std::int32_t e) { out.element[next[cell]++] = e; });
}

bool share_a_node(const Corners& a, const Corners& b) {
  for (const NodeIndex n : a) {
    for (const NodeIndex m : b) {
      if (n == m) return true;
    }
  }
  return false;
}

/// Gives the children of one cell to `coarse` elements from `next` on: one per group of children
/// that share nodes. `places` are the children's in the cell. Returns the next free number.
std::int32_t group_children(const HexMesh& fine, const std::int32_t* children, int count,
                            const std::uint8_t* places, std::int32_t next,
                            std::vector<std::int32_t>& parent) {
  // Nearly always all meet at the middle of the cell.
  const auto at_middle = [&](int n) { return fine.corners(children[n])[7 - places[n]]; };
  bool meet = true;
  for (int n = 1; n < count; ++n) meet = meet && at_middle(n) == at_middle(0);
  if (meet) {
    for (int n = 0; n < count; ++n) parent[children[n]] = next;
    return next + 1;
  }
  CornerSets groups(count);
  for (int n = 1; n < count; ++n) {
    for (int m = 0; m < n; ++m) {
      if (share_a_node(fine.corners(children[n]), fine.corners(children[m]))) groups.join(n, m);
    }
  }
  for (int n = 0; n < count; ++n) {
    const std::uint32_t first = groups.find(n);
    parent[children[n]] = first == std::uint32_t(n) ? next++ : parent[children[first]];
  }
  return next;
}

/// Joins the corners that two neighbouring coarse elements have in common, by their cells.
void join_common_corners(std::int32_t a, const Vec3i& cell_a, std::int32_t b, const Vec3i& cell_b,
                         CornerSets& sets) {
  const Vec3i step = cell_b - cell_a;
  for (int c = 0; c < 8; ++c) {
    int there = c;
    bool is_common = true;
    for (int axis = 0; axis < 3; ++axis) {
      if (step[axis] == 0) continue;
      is_common = is_common && ((c & kAxisBit[axis]) != 0) == (step[axis] > 0);
      there ^= kAxisBit[axis];
    }
    if (is_common) sets.join(8 * std::uint32_t(a) + c, 8 * std::uint32_t(b) + there);
  }
}

/// Coarse elements around one node of the fine mesh share corners; each node notes the first.
void join_around_nodes(const HexMesh& fine, const std::vector<std::int32_t>& parents,
                       const std::vector<Vec3i>& coarse_cells, std::vector<std::int32_t>& first_of,
                       std::vector<std::uint8_t>& place_of, CornerSets& sets,
                       const StagePart& stage) {
  first_of.assign(fine.node_count(), -1);
  place_of.resize(fine.node_count());
  std::int32_t last_a = -1, last_b = -1;
  for (std::size_t block = 0; block < fine.block_count(); ++block) {
    stage.done(block, fine.block_count());
    for (std::int32_t e = fine.element_begin[block]; e < fine.element_begin[block + 1]; ++e) {
      const std::int32_t parent = parents[e];
      const int place = place_in_parent(cell_of(fine, block, e));
      const Corners corners = fine.corners_in(block, e);
      for (int c = 0; c < 8; ++c) {
        const NodeIndex node = corners[c];
        const std::int32_t first = first_of[node];
        if (first < 0) {
          first_of[node] = parent;
          place_of[node] =
              std::uint8_t(9 * ((place >> 2 & 1) + (c >> 2 & 1)) +
                           3 * ((place >> 1 & 1) + (c >> 1 & 1)) + (place & 1) + (c & 1));
        } else if (first != parent && (first != last_a || parent != last_b)) {
          join_common_corners(first, coarse_cells[first], parent, coarse_cells[parent], sets);
          last_a = first;
          last_b = parent;
        }
      }
    }
  }
}

}  // namespace

Parents::Parents(std::vector<std::int32_t> parents, const std::vector<std::int32_t>& begin,
                 const std::vector<std::int32_t>& first) {
  m_near.reserve(parents.size());
  for (std::size_t b = 0; b < first.size(); ++b) {
    for (std::int32_t n = begin[b]; n < begin[b + 1]; ++n) {
      const std::int32_t near = parents[std::size_t(n)] - first[b];
      if (near > 0xffff) {
        m_near = std::vector<std::uint16_t>();
        m_far = std::move(parents);
        return;
      }
      m_near.push_back(std::uint16_t(near));
    }
  }
}

HexMesh coarsen(const HexMesh& fine, Coarsening& coarsening, const StagePart& stage) {
  HexMesh coarse;
  coarse.geometry = fine.geometry;
  coarse.level = fine.level + 1;
  // Blocks of the coarse mesh and those that lie in them.
  BrickIndex index;
  std::vector<std::vector<std::int32_t>> children_of;
  for (std::size_t b = 0; b < fine.block_count(); ++b) {
    const Vec3i half = halved(fine.origin[b]);
    const Vec3i origin(half.x & ~7, half.y & ~7, half.z & ~7);
    const std::int32_t known = index.find(origin);
    const std::size_t block = known >= 0 ? std::size_t(known) : index.add(origin);
    if (block == children_of.size()) {
      children_of.emplace_back();
      add_block(coarse, origin);
    }
    children_of[block].push_back(std::int32_t(b));
  }
  // Elements: groups of children per cell.
  std::vector<std::int32_t> parents(fine.offset.size());
  std::vector<Vec3i> cells;
  CellChildren children;
  std::vector<std::uint8_t> places;
  for (std::size_t block = 0; block < coarse.block_count(); ++block) {
    stage.part(0, kGrouping).done(block, coarse.block_count());
    coarse.element_begin.push_back(coarse.element_count());
    sort_into_cells(fine, children_of[block], children);
    places.resize(children.element.size());
    // Children lie in order of their block and offset; the place in the cell is that of the voxel.
    for (int cell = 0; cell < kBrickVoxels; ++cell) {
      const std::int32_t begin = children.begin[cell], end = children.begin[cell + 1];
      if (begin == end) continue;
      for (std::int32_t n = begin; n < end; ++n) {
        places[n] = std::uint8_t(place_in_parent(brick_local(fine.offset[children.element[n]])));
      }
      const std::int32_t next = group_children(fine, &children.element[begin], end - begin,
                                               &places[begin], coarse.element_count(), parents);
      while (coarse.element_count() < next) {
        coarse.offset.push_back(std::uint16_t(cell));
        cells.push_back(coarse.origin[block] + brick_local(cell));
      }
    }
  }
  coarse.element_begin.push_back(coarse.element_count());
  CornerSets sets(8 * coarse.offset.size());
  std::vector<std::int32_t> parents_of_nodes;
  join_around_nodes(fine, parents, cells, parents_of_nodes, coarsening.node_place, sets,
                    stage.part(kGrouping, kJoining));
  coarsening.first_element.resize(fine.block_count());
  for (std::size_t block = 0; block < coarse.block_count(); ++block) {
    for (const std::int32_t b : children_of[block]) {
      coarsening.first_element[std::size_t(b)] = coarse.element_begin[block];
    }
  }
  coarsening.parent = Parents(std::move(parents), fine.element_begin, coarsening.first_element);
  coarsening.node_parent =
      Parents(std::move(parents_of_nodes), fine.node_begin, coarsening.first_element);
  number_nodes(coarse, sets, stage.part(kJoining, 1));
  return coarse;
}

MeshLevels::MeshLevels(HexMesh voxels, Progress* progress) {
  stage(progress, "making meshes");
  meshes.push_back(std::move(voxels));
  // A coarser mesh has about one of eight elements.
  for (double left = 1; meshes.back().node_count() > kCoarsestNodes; left /= 8) {
    Coarsening coarsening;
    HexMesh coarse = coarsen(meshes.back(), coarsening, {progress, 1 - left, left * 7 / 8});
    // Pieces that do not become fewer are factorised as they are.
    if (coarse.node_count() > 0.8 * meshes.back().node_count()) break;
    coarsenings.push_back(std::move(coarsening));
    meshes.push_back(std::move(coarse));
  }
}

std::size_t MeshLevels::bytes() const {
  std::size_t sum = 0;
  for (const HexMesh& mesh : meshes) sum += mesh.bytes();
  for (const Coarsening& coarsening : coarsenings) sum += coarsening.bytes();
  return sum;
}

}  // namespace supple
