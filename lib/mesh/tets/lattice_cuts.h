// Cuts of the edges of a lattice by borders of labels, after vertices near these have moved.
#pragma once

#include "lib/mesh/tets/lattice_tets.h"

namespace supple {

/// A cut edge, as part of it from `p`, which is the lower number, to `q`.
struct EdgeCut {
  std::int32_t p, q;
  double part;
  bool is_there;
};

class LatticeCuts {
 public:
  LatticeCuts(const LabelField& field, const BccLattice& lattice, const LatticeTets& tets);

  /// Finds cuts, moves vertices onto them where they are too near, and holds others apart.
  void run();

  const std::vector<EdgeCut>& cuts() const { return m_cuts; }
  /// The cut between two vertices; -1: none.
  std::int32_t cut_between(std::int32_t p, std::int32_t q) const;
  std::int64_t warped() const { return std::int64_t(m_sets.size()); }
  std::int64_t held_apart() const { return m_held_apart; }

  LabelNumber label(std::int32_t vertex) const { return m_labels[std::size_t(vertex)]; }
  bool has_moved(std::int32_t vertex) const { return m_moved[std::size_t(vertex)] >= 0; }
  /// The labels that meet at a vertex; its own where it has not moved.
  LabelSet labels_at(std::int32_t vertex) const {
    const std::int32_t moved = m_moved[std::size_t(vertex)];
    return moved >= 0 ? m_sets[std::size_t(moved)] : LabelSet(label(vertex));
  }
  /// The place of a vertex in the lattice's units.
  const Vec3d& place(std::int32_t vertex) const { return m_places[std::size_t(vertex)]; }
  Vec3d place(const EdgeCut& cut) const {
    return place(cut.p) + (place(cut.q) - place(cut.p)) * cut.part;
  }
  Vec3d index_at(const Vec3d& place) const { return m_lattice.index_at(place * m_per_unit); }

 private:
  /// A vertex at the end of a cut edge, seen from its other end.
  struct End {
    std::int32_t cut;
    bool is_p;
  };
  void find_labels();
  void find_edges();
  void link();
  double cut_part(const EdgeCut& cut) const;
  double threshold(const EdgeCut& cut) const;
  bool warp_vertex(std::int32_t vertex);
  bool move(std::int32_t vertex, const Vec3d& to, const LabelSet& labels);
  bool settle(std::int32_t vertex);
  bool keeps_shape(std::int32_t vertex, const Vec3d& to) const;
  bool find_junction(const LabelSet& labels, double reach, Vec3d& place) const;
  bool touch(std::int32_t vertex, std::int32_t other, const Vec3d& at);

  const LabelField& m_field;
  const BccLattice& m_lattice;
  const LatticeTets& m_tets;
  double m_per_unit;
  bool m_is_proven;  // one label, uniform
  double m_guard_cosine;
  std::int64_t m_held_apart = 0;
  std::vector<Vec3d> m_places;
  std::vector<LabelNumber> m_labels;
  std::vector<std::int32_t> m_moved;  // index of m_sets, or -1
  std::vector<LabelSet> m_sets;
  std::vector<EdgeCut> m_cuts;            // ascending by p, then q
  std::vector<std::int32_t> m_first_cut;  // per vertex, of those whose p it is
  std::vector<std::int32_t> m_first_end, m_first_tet, m_tets_of;
  std::vector<End> m_ends;
};

}  // namespace supple
