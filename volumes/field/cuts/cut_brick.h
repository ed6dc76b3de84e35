// A brick of the output through which a cut goes, and the pieces of material that reach the cells
// in it. Beside the cut samples are inverted one by one; cells that only whole pieces of one side
// reach are interpolated between their nodes, as in bricks without a cut. Cost: 320 bytes per piece
// and 9 kB; 0.02 µs per place between nodes, 0.2 µs elsewhere.
#pragma once

#include <vector>

#include "volumes/field/brick_nodes.h"
#include "volumes/field/cuts/cut_piece.h"

namespace supple {

class CutBrick {
 public:
  explicit CutBrick(const Vec3i& origin) : m_origin(origin) {}

  void add(const CutPiece& piece) { m_pieces.push_back(piece); }
  /// After the last piece was added: which of them reach which cell, and the nodes.
  void finish(const Vec3i& dims);

  const Vec3i& origin() const { return m_origin; }
  const std::vector<CutPiece>& pieces() const { return m_pieces; }
  const PieceMap& map(int piece) const { return m_maps[std::size_t(piece)]; }

  /// The offset at x, tissue before air, then the smallest, and which piece it is; -1 in the void.
  int find(const Vec3d& x, const Vec3i& dims, Vec3d& offset) const {
    return find_in(std::size_t(brick_offset(floor_voxel(x))), x, dims, offset);
  }
  /// The same at a voxel of the brick; false in the void.
  bool find_node(const Vec3i& local, const Vec3i& dims, Vec3d& offset) const;
  /// The offset between nodes; false in cells that are not all of one side.
  bool interpolate(const Vec3d& x, Vec3d& offset) const;
  /// Carries on what is between the nodes of the cell of x, or of the nearest of this brick; false
  /// where a node has no offset.
  bool carry_on(const Vec3d& x, Vec3d& offset) const;
  /// (I + grad o)^T g and (I + grad o) d with the derivatives of that.
  Vec3d pull_back(const Vec3d& x, const Vec3d& gradient) const;
  Vec3d way_of(const Vec3d& x, const Vec3d& way) const;
  /// Whether tissue lies at x that comes from elsewhere than what find() gives.
  bool is_overlapped(const Vec3d& x, const Vec3i& dims) const;

 private:
  bool source_of(int piece, const Vec3d& x, Vec3d& X) const;
  void find_reaching();
  void find_nodes(const Vec3i& dims);
  bool is_single(std::size_t cell) const;
  int find_in(std::size_t cell, const Vec3d& x, const Vec3i& dims, Vec3d& offset) const;
  NodeDerivatives derivatives(const Vec3d& x) const;
  template <class Visit>
  void for_found(std::size_t cell, const Vec3d& x, const Vec3i& dims, Visit&& visit) const;

  Vec3i m_origin;
  std::vector<CutPiece> m_pieces;
  std::vector<PieceMap> m_maps;          // of the pieces
  std::vector<std::int32_t> m_begin;     // per cell, where its pieces begin below; and the end
  std::vector<std::int32_t> m_reaching;  // numbers of pieces
  BrickMask m_single{};  // cells whose places have one piece each: no side ends in them, none folds
  BrickMask m_plain{};   // those of them of which all nodes have an offset
  std::vector<float> m_nodes;  // as gather_nodes() has them; of single cells
};

}  // namespace supple
