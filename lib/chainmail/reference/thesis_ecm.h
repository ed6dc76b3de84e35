// Enhanced ChainMail as the thesis prints it (section 4.2.2): nodes and chains linked by pointers,
// one candidate list ordered by constraint violation, a node moved against its sponsor, moveX,
// moveY and moveZ in turn. For one grabbed node in a valid body.
//
// Scalar = int64 works exactly in 2^-16 voxel and gives the bits of drag(); Scalar = float is the
// thesis' arithmetic, which rounds. Cost: some thousand ns per moved node.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "lib/chainmail/reference/reference_lattice.h"

namespace supple::reference {

template <class Scalar>
class ThesisEcm {
 public:
  ThesisEcm(const ReferenceLattice& lattice, const Offsets& start);
  ThesisEcm(const ThesisEcm&) = delete;
  ThesisEcm& operator=(const ThesisEcm&) = delete;

  /// Moves a node (counted from the lattice's origin) by 2^-16 voxel along i, j, k. Throws Error
  /// after `max_moves` moves of nodes, since a literal two-sided rule need not end.
  void move(const Vec3i& node, const std::array<std::int32_t, 3>& by_q,
            std::int64_t max_moves = INT64_MAX);

  Offsets offsets() const;
  /// Largest length of the candidate list so far ("max. Cand.List"), and nodes moved.
  std::size_t max_candidates() const { return m_max_candidates; }
  std::int64_t moves() const { return m_moves; }

 private:
  struct Chain;
  struct Node {
    std::array<Scalar, 3> position;
    std::array<Chain*, 6> chains{};  // -i, +i, -j, +j, -k, +k; null where there is no neighbour
  };
  struct Chain {
    Node* node0;  // at the lower index
    Node* node1;
    std::array<Scalar, 3> min_constraint, max_constraint;  // of node1 - node0
  };
  struct Candidate;
  class CandidateList;

  void link_nodes(const ReferenceLattice& lattice);
  void move_coordinate(Node& sponsor, int coordinate, Scalar displacement, std::int64_t max_moves);
  /// How far `node` must move to satisfy the chain against its sponsor at the other end.
  static Scalar correction(const Chain& chain, const Node& node, int coordinate);
  void insert_neighbours(Node& sponsor, int coordinate, CandidateList& list);

  ReferenceLattice m_box;     // origin and dims only
  std::vector<Node> m_nodes;  // one per voxel of the box
  std::vector<Chain> m_chains;
  std::size_t m_max_candidates = 0;
  std::int64_t m_moves = 0;
};

extern template class ThesisEcm<std::int64_t>;
extern template class ThesisEcm<float>;

}  // namespace supple::reference
