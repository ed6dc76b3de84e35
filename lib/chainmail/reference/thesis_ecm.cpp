#include "lib/chainmail/reference/thesis_ecm.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "volumes/base/error.h"

namespace supple::reference {

namespace {

Vec3i unit(int axis) {
  return {axis == 0, axis == 1, axis == 2};
}

}  // namespace

template <class Scalar>
struct ThesisEcm<Scalar>::Candidate {
  Scalar violation;
  std::int64_t order;  // of insertion, among equal violations
  Node* node;
  const Chain* chain;  // to the sponsor

  bool operator<(const Candidate& other) const {
    return violation != other.violation ? violation > other.violation : order < other.order;
  }
};

/// The ordered candidate list: a binary tree with the largest constraint violation first.
template <class Scalar>
class ThesisEcm<Scalar>::CandidateList {
 public:
  void insert(Scalar violation, Node* node, const Chain* chain) {
    m_tree.insert({violation, m_inserted++, node, chain});
    m_max_size = std::max(m_max_size, m_tree.size());
  }
  bool empty() const { return m_tree.empty(); }
  Candidate pop_first() {
    const Candidate first = *m_tree.begin();
    m_tree.erase(m_tree.begin());
    return first;
  }
  std::size_t max_size() const { return m_max_size; }

 private:
  std::multiset<Candidate> m_tree;
  std::int64_t m_inserted = 0;
  std::size_t m_max_size = 0;
};

template <class Scalar>
ThesisEcm<Scalar>::ThesisEcm(const ReferenceLattice& lattice, const Offsets& start)
    : m_nodes(lattice.size()) {
  m_box.origin = lattice.origin;
  m_box.dims = lattice.dims;
  for (std::size_t n = 0; n < m_nodes.size(); ++n) {
    const Vec3i voxel = lattice.node(n);
    for (int c = 0; c < 3; ++c) {
      m_nodes[n].position[c] = Scalar(std::int64_t(voxel[c]) * (1 << kFixedBits) + start[c][n]);
    }
  }
  link_nodes(lattice);
}

template <class Scalar>
void ThesisEcm<Scalar>::link_nodes(const ReferenceLattice& lattice) {
  m_chains.reserve(3 * lattice.size());
  for (std::size_t n = 0; n < m_nodes.size(); ++n) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!lattice.is_linked(lattice.node(n), axis)) continue;
      const Vec3i next = lattice.node(n) + unit(axis);
      Node& other = m_nodes[lattice.index(next)];
      Chain chain{&m_nodes[n], &other, {}, {}};
      const LinkSlack& slack = lattice.slacks[n][axis];
      for (int c = 0; c < 3; ++c) {
        // An unlimited link gets limits that no offset within the range reaches.
        const auto limit = [](std::int32_t units) {
          return units < kUnlimitedSlack ? std::int64_t(units) : std::int64_t(1) << 33;
        };
        const std::int64_t rest = c == axis ? 1 << kFixedBits : 0;
        chain.min_constraint[c] = Scalar(rest - limit(slack.lower[c]));
        chain.max_constraint[c] = Scalar(rest + limit(slack.upper[c]));
      }
      m_chains.push_back(chain);
      m_nodes[n].chains[2 * axis + 1] = &m_chains.back();
      other.chains[2 * axis] = &m_chains.back();
    }
  }
}

template <class Scalar>
void ThesisEcm<Scalar>::move(const Vec3i& node, const std::array<std::int32_t, 3>& by_q,
                             std::int64_t max_moves) {
  for (int c = 0; c < 3; ++c) {
    move_coordinate(m_nodes[m_box.index(node)], c, Scalar(by_q[c]), max_moves);
  }
}

/// Follows the pseudo code of section 4.2.2.
template <class Scalar>
void ThesisEcm<Scalar>::move_coordinate(Node& sponsor, int coordinate, Scalar displacement,
                                        std::int64_t max_moves) {
  if (displacement == Scalar(0)) return;
  CandidateList list;
  sponsor.position[coordinate] += displacement;
  insert_neighbours(sponsor, coordinate, list);
  std::int64_t moves = 0;
  while (!list.empty()) {
    const Candidate candidate = list.pop_first();
    const Scalar step = correction(*candidate.chain, *candidate.node, coordinate);
    if (step == Scalar(0)) continue;
    if (++moves > max_moves) throw Error("thesis ECM: no end after the allowed number of moves");
    candidate.node->position[coordinate] += step;
    insert_neighbours(*candidate.node, coordinate, list);
  }
  m_moves += moves;
  m_max_candidates = std::max(m_max_candidates, list.max_size());
}

template <class Scalar>
Scalar ThesisEcm<Scalar>::correction(const Chain& chain, const Node& node, int coordinate) {
  const Scalar length = chain.node1->position[coordinate] - chain.node0->position[coordinate];
  const Scalar allowed =
      std::clamp(length, chain.min_constraint[coordinate], chain.max_constraint[coordinate]);
  return &node == chain.node1 ? allowed - length : length - allowed;
}

template <class Scalar>
void ThesisEcm<Scalar>::insert_neighbours(Node& sponsor, int coordinate, CandidateList& list) {
  for (const Chain* chain : sponsor.chains) {
    if (chain == nullptr) continue;
    Node* neighbour = chain->node0 == &sponsor ? chain->node1 : chain->node0;
    const Scalar violation = std::abs(correction(*chain, *neighbour, coordinate));
    if (violation > Scalar(0)) list.insert(violation, neighbour, chain);
  }
}

template <class Scalar>
Offsets ThesisEcm<Scalar>::offsets() const {
  Offsets offsets = m_box.at_rest();
  for (std::size_t n = 0; n < m_nodes.size(); ++n) {
    const Vec3i voxel = m_box.node(n);
    for (int c = 0; c < 3; ++c) {
      const Scalar rest = Scalar(std::int64_t(voxel[c]) * (1 << kFixedBits));
      offsets[c][n] = std::int32_t(std::llround(double(m_nodes[n].position[c] - rest)));
    }
  }
  return offsets;
}

template class ThesisEcm<std::int64_t>;
template class ThesisEcm<float>;

}  // namespace supple::reference
