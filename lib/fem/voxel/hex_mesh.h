// Hexahedra and their nodes: the voxels of a body, or the cells of a coarser level of its
// multigrid hierarchy. Elements lie in blocks of 8^3 cells; blocks have one of eight colours by the
// parity of their coordinates, and blocks of one colour share no node, so that threads may add to
// nodes colour by colour in an order that is always the same.
//
// Each block owns a contiguous range of nodes, those that its elements met first, in the order of
// their places on the lattice.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "lib/body/body.h"
#include "lib/body/slot_set.h"
#include "lib/fem/elastic_law.h"
#include "lib/fem/voxel/node_tables.h"
#include "volumes/base/progress.h"

namespace supple {

/// Corners of elements come as 32-bit numbers.
constexpr std::int64_t kMostElements = std::int64_t(1) << 28;

/// Blocks of each colour, ascending.
using BlocksByColour = std::array<std::vector<std::int32_t>, 8>;

struct HexMesh {
  Geometry geometry;  // of the voxels, also for coarser levels
  int level = 0;      // cells are 2^level voxels wide

  // Per block.
  std::vector<Vec3i> origin;                // smallest cell, a multiple of 8
  std::vector<std::int32_t> element_begin;  // one more than blocks
  std::vector<NodeIndex> node_begin;        // likewise: the nodes that its elements met first
  BlocksByColour of_colour;

  // Per element: ascending cells within a block.
  std::vector<std::uint16_t> offset;  // of the cell in its block, as brick_offset()

  NodeTables tables;
  std::vector<std::int32_t> block_hint;  // per 64 elements: the block of the first of them

  /// Corners of an element, or of one that is known to lie in this block, which is found sooner.
  Corners corners(std::int32_t element) const { return corners_in(block_of(element), element); }
  Corners corners_in(std::size_t block, std::int32_t element) const {
    return tables.corners(block, element, offset[std::size_t(element)]);
  }
  std::size_t block_of(std::int32_t element) const {
    auto block = std::size_t(block_hint[std::size_t(element) / kHintStep]);
    while (element_begin[block + 1] <= element) ++block;
    return block;
  }

  Vec3i cell_of(std::int32_t element) const {
    return origin[block_of(element)] + brick_local(offset[std::size_t(element)]);
  }

  /// Takes over the corners of all elements, once the other vectors are filled.
  void set_corners(const std::vector<Corners>& corners);

  static constexpr std::size_t kHintStep = 64;
  std::int32_t element_count() const { return std::int32_t(offset.size()); }
  NodeIndex node_count() const { return node_begin.empty() ? 0 : node_begin.back(); }
  std::size_t block_count() const { return origin.size(); }
  std::size_t bytes() const;
};

/// The nodes of one block, found corner by corner, and then numbered by their places on the
/// lattice; several of a place as they were found.
class OwnNodes {
 public:
  /// `corner`: 8 element + corner of the first element that has the node.
  void add(const HexMesh& mesh, std::uint32_t corner);
  /// Numbers them in `corners` from `first` on; returns the next free number.
  NodeIndex number(std::vector<Corners>& corners, NodeIndex first);

 private:
  std::vector<std::pair<int, std::uint32_t>> m_nodes;  // place on the lattice, corner
};

/// Rule by which voxels that touch by an edge or a corner alone are joined.
struct TouchingRule {
  Touching touching = Touching::apart;
  std::vector<bool> apart = {};  // per element: apart even so; or empty
};

/// Makes one element per voxel; block b is brick b of the body. Voxels that touch by an edge or a
/// corner alone share its nodes where they are joined, except at corners where a cut parts
/// elements. Throws InputError for no elements or too many, Cancelled.
HexMesh hex_mesh(const Body& body, const TouchingRule& rule = {},
                 const Progress* progress = nullptr);

/// Coarse elements of the elements or nodes of a mesh. A block of the mesh lies in one coarse
/// block, of which they are counted from the first: half the memory, unless one has more than
/// 65536.
class Parents {
 public:
  Parents() = default;
  /// `begin`: of each block's elements or nodes; `first`: of each block, of its coarse block.
  Parents(std::vector<std::int32_t> parents, const std::vector<std::int32_t>& begin,
          const std::vector<std::int32_t>& first);

  std::int32_t operator()(std::int32_t first, std::int32_t n) const {
    return m_far.empty() ? first + m_near[std::size_t(n)] : m_far[std::size_t(n)];
  }
  std::size_t bytes() const { return m_near.capacity() * 2 + m_far.capacity() * 4; }

 private:
  std::vector<std::uint16_t> m_near;
  std::vector<std::int32_t> m_far;
};

/// Places of the elements and nodes of a mesh in those of the next coarser one.
struct Coarsening {
  std::vector<std::int32_t> first_element;  // per block of the finer mesh: of its coarse block
  Parents parent;                           // coarse element, per element
  Parents node_parent;                      // per node: a coarse element around it
  std::vector<std::uint8_t> node_place;     // and where: 9 i + 3 j + k in half edges, each 0 ... 2

  /// Parent of an element and of a node of a block, which is the one that owns the node.
  std::int32_t parent_of(std::size_t block, std::int32_t element) const {
    return parent(first_element[block], element);
  }
  std::int32_t parent_of_node(std::size_t block, NodeIndex node) const {
    return node_parent(first_element[block], node);
  }
  std::size_t bytes() const;
};

/// A part of a stage: what is done of it is told as so much of the stage.
struct StagePart {
  Progress* progress = nullptr;
  double begin = 0, size = 1;

  /// Throws Cancelled.
  void done(std::size_t count, std::size_t of) const {
    report(progress, begin + size * double(count) / double(of));
  }
  StagePart part(double from, double to) const {
    return {progress, begin + from * size, (to - from) * size};
  }
};

/// Cells of twice the width. A cell has an element wherever it has children, and one for each
/// group of children that share no node; elements of neighbouring cells share the corners of their
/// common face, edge or corner when any of their children share a node. So nodes of thin shells
/// and on both sides of gaps stay apart on all levels.
HexMesh coarsen(const HexMesh& fine, Coarsening& coarsening, const StagePart& stage = {});

/// Meshes of all levels, finest first, and how each lies in the next.
struct MeshLevels {
  std::vector<HexMesh> meshes;
  std::vector<Coarsening> coarsenings;  // one fewer

  /// Throws Cancelled.
  explicit MeshLevels(HexMesh voxels, Progress* progress = nullptr);
  std::size_t bytes() const;
};

/// The element of a cell of a block; -1 where there is none.
std::int32_t element_at(const HexMesh& mesh, std::size_t block, int offset);

/// Rest position in LPS mm of a corner of an element of the voxel mesh.
Vec3d corner_position(const HexMesh& mesh, std::int32_t block, int offset, int corner);
/// Rest positions of all nodes, or of these alone, which ascend.
std::vector<Vec3d> node_positions(const HexMesh& mesh);
std::vector<Vec3d> node_positions(const HexMesh& mesh, const std::vector<NodeIndex>& nodes);

/// Connected pieces, numbered by their first element.
struct Islands {
  std::vector<std::int32_t> of_element, of_node;
  std::int32_t count = 0;
};
Islands find_islands(const HexMesh& mesh);

}  // namespace supple
