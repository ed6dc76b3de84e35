#include "lib/mesh/tets/cleaving.h"

#include <map>

#include "lib/mesh/tets/lattice_cuts.h"
#include "lib/mesh/tets/tet_fan.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// The least weight of a corner in the place of a point of a face.
constexpr double kLeastWeight = 0.15;
constexpr std::size_t kTetsPerBlock = 1024;

/// A point in a face of the lattice, under the numbers of its corners, ascending; or within a
/// tetrahedron, under its own and -1.
struct ExtraPoint {
  std::array<std::int32_t, 3> key;
  Vec3d place;
  LabelSet labels;
};

/// Elements of a block of tetrahedra. Points are numbered: vertices, cuts, then those of the block.
struct Block {
  std::vector<std::array<std::int32_t, 4>> tets;
  std::vector<LabelNumber> labels;
  std::vector<ExtraPoint> extras;
};

class Cleaver {
 public:
  Cleaver(const LabelField& field, const BccLattice& lattice, const LatticeTets& tets)
      : m_field(field), m_lattice(lattice), m_tets(tets), m_cuts(field, lattice, tets) {}

  SolidMesh run(CleaveReport* report, Progress* progress);

 private:
  std::int32_t cut_number(std::int32_t cut) const {
    return std::int32_t(m_tets.places.size()) + cut;
  }
  std::int32_t first_extra() const { return cut_number(std::int32_t(m_cuts.cuts().size())); }
  Vec3d place_of(std::int32_t point, const Block& block) const;
  LabelSet labels_of(std::int32_t point, const Block& block) const;
  void cleave_tet(std::int32_t number, Block& block) const;
  ExtraPoint point_in_face(std::array<std::int32_t, 3> corners) const;
  std::int32_t tip_of(const TetPoints& points, std::int32_t number, Block& block) const;
  LabelNumber label_of(const std::array<std::int32_t, 4>& tet, const Block& block) const;
  void gather(std::vector<Block>& blocks, SolidMesh& mesh, CleaveReport* report) const;

  const LabelField& m_field;
  const BccLattice& m_lattice;
  const LatticeTets& m_tets;
  LatticeCuts m_cuts;
};

Vec3d Cleaver::place_of(std::int32_t point, const Block& block) const {
  if (point >= first_extra()) return block.extras[std::size_t(point - first_extra())].place;
  if (point < cut_number(0)) return m_cuts.place(point);
  return m_cuts.place(m_cuts.cuts()[std::size_t(point - cut_number(0))]);
}

LabelSet Cleaver::labels_of(std::int32_t point, const Block& block) const {
  if (point >= first_extra()) return block.extras[std::size_t(point - first_extra())].labels;
  if (point < cut_number(0)) return m_cuts.labels_at(point);
  const EdgeCut& cut = m_cuts.cuts()[std::size_t(point - cut_number(0))];
  LabelSet labels = m_cuts.labels_at(cut.p);
  labels.add(m_cuts.labels_at(cut.q));
  return labels;
}

/// Returns the point of a face where three labels meet, as linear distances have it, but not too
/// near to its edges.
ExtraPoint Cleaver::point_in_face(std::array<std::int32_t, 3> corners) const {
  std::sort(corners.begin(), corners.end());
  ExtraPoint point{corners, Vec3d(0), {}};
  Vec3d middle(0);
  for (const std::int32_t corner : corners) middle += m_cuts.place(corner) / 3;
  LabelNumber labels[3];
  for (std::size_t c = 0; c < 3; ++c) {
    const LabelSet own = m_cuts.labels_at(corners[c]);
    labels[c] = m_field.best(own, m_cuts.index_at(middle));
    point.labels.add(own);
  }
  // Weights of the corners, at which the levels differ by (rows) from the first label's.
  double at[3][3];
  for (std::size_t c = 0; c < 3; ++c) {
    m_field.levels(labels, 3, m_cuts.index_at(m_cuts.place(corners[c])), at[c]);
  }
  const Vec3d first(at[0][1] - at[0][0], at[1][1] - at[1][0], at[2][1] - at[2][0]);
  const Vec3d second(at[0][2] - at[0][0], at[1][2] - at[1][0], at[2][2] - at[2][0]);
  Vec3d weights = first.cross(second);
  const double sum = weights.x + weights.y + weights.z;
  weights = std::abs(sum) > 1e-12 ? weights / sum : Vec3d(1.0 / 3);
  double kept = 0;
  for (int c = 0; c < 3; ++c) kept += weights[c] = std::clamp(weights[c], kLeastWeight, 1.0);
  for (std::size_t c = 0; c < 3; ++c) {
    point.place += m_cuts.place(corners[c]) * (weights[int(c)] / kept);
  }
  return point;
}

/// The tip for a tetrahedron with points in its faces: one of these, or their mean, whichever makes
/// the better angles.
std::int32_t Cleaver::tip_of(const TetPoints& points, std::int32_t number, Block& block) const {
  std::vector<std::int32_t> candidates;
  ExtraPoint mean{{number, -1, -1}, Vec3d(0), {}};
  for (const std::int32_t point : points.in_face) {
    if (point >= 0) candidates.push_back(point);
  }
  for (const std::int32_t point : candidates) {
    mean.place += place_of(point, block) / double(candidates.size());
  }
  if (candidates.size() == 1) {
    // Between it and the middle.
    for (const std::int32_t corner : points.corners) mean.place += m_cuts.place(corner) / 4;
    mean.place /= 2;
  }
  for (const std::int32_t corner : points.corners) mean.labels.add(m_cuts.labels_at(corner));
  block.extras.push_back(mean);
  candidates.push_back(first_extra() + std::int32_t(block.extras.size()) - 1);
  std::int32_t best = -1;
  double best_cosine = 2;
  for (const std::int32_t tip : candidates) {
    double cosine = -1;
    fan(points, tip, [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
      const TetAngles angles(
          {place_of(a, block), place_of(b, block), place_of(c, block), place_of(d, block)});
      cosine = std::max({cosine, angles.largest_cosine, -angles.least_cosine});
    });
    if (!(cosine < best_cosine)) continue;
    best_cosine = cosine;
    best = tip;
  }
  if (best != candidates.back()) block.extras.pop_back();
  return best;
}

/// The label of an element: that of a vertex which has not moved, else the one at which all of its
/// points are; outside goes before others.
LabelNumber Cleaver::label_of(const std::array<std::int32_t, 4>& tet, const Block& block) const {
  LabelSet common, any;
  std::array<LabelSet, 4> sets;
  Vec3d middle(0);
  for (std::size_t c = 0; c < 4; ++c) {
    if (tet[c] < cut_number(0) && !m_cuts.has_moved(tet[c])) return m_cuts.label(tet[c]);
    sets[c] = labels_of(tet[c], block);
    any.add(sets[c]);
    middle += place_of(tet[c], block) / 4;
  }
  for (const LabelNumber label : sets[0]) {
    if (sets[1].holds(label) && sets[2].holds(label) && sets[3].holds(label)) common.add(label);
  }
  if (common.holds(0)) return 0;
  if (common.size() == 1) return *common.begin();
  return m_field.best(common.size() > 0 ? common : any, m_cuts.index_at(middle));
}

void Cleaver::cleave_tet(std::int32_t number, Block& block) const {
  const auto add = [&](std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
    const std::array<std::int32_t, 4> tet{a, b, c, d};
    const LabelNumber label = label_of(tet, block);
    if (label == 0) return;
    block.tets.push_back(tet);
    block.labels.push_back(label);
  };
  TetPoints points;
  points.corners = m_tets.tets[std::size_t(number)];
  const auto& corners = points.corners;
  bool is_cut = false;
  for (std::size_t e = 0; e < 6; ++e) {
    const std::int32_t p = corners[std::size_t(kTetEdges[e][0])],
                       q = corners[std::size_t(kTetEdges[e][1])];
    if (m_cuts.label(p) == m_cuts.label(q)) continue;
    const std::int32_t cut = m_cuts.cut_between(p, q);
    if (cut < 0) continue;
    is_cut = true;
    points.cuts[e] = cut_number(cut);
    const std::uint64_t rank =
        edge_rank(m_tets.places[std::size_t(p)], m_tets.places[std::size_t(q)]);
    points.ranks[e] = rank << 32U | std::uint32_t(cut);
  }
  if (!is_cut) return add(corners[0], corners[1], corners[2], corners[3]);
  bool has_point = false;
  for (int f = 0; f < 4; ++f) {
    const int a = f == 0 ? 1 : 0, b = f <= 1 ? 2 : 1, c = f == 3 ? 2 : 3;
    const auto cut_of = [&](int i, int j) { return points.cuts[std::size_t(kEdgeBetween[i][j])]; };
    if (cut_of(a, b) < 0 || cut_of(a, c) < 0 || cut_of(b, c) < 0) continue;
    has_point = true;
    points.in_face[std::size_t(f)] = first_extra() + std::int32_t(block.extras.size());
    block.extras.push_back(
        point_in_face({corners[std::size_t(a)], corners[std::size_t(b)], corners[std::size_t(c)]}));
  }
  fan(points, has_point ? tip_of(points, number, block) : points.first_cut(-1), add);
}

/// Numbers the nodes that elements use: vertices, cuts, then points of faces and within.
void Cleaver::gather(std::vector<Block>& blocks, SolidMesh& mesh, CleaveReport* report) const {
  std::map<std::array<std::int32_t, 3>, std::int32_t> extra_numbers;
  std::vector<Vec3d> extra_places;
  for (Block& block : blocks) {
    std::vector<std::int32_t> number_of;
    for (const ExtraPoint& extra : block.extras) {
      const auto [found, is_new] =
          extra_numbers.try_emplace(extra.key, first_extra() + std::int32_t(extra_places.size()));
      if (is_new) extra_places.push_back(extra.place);
      number_of.push_back(found->second);
    }
    for (auto& tet : block.tets) {
      for (std::int32_t& point : tet) {
        if (point >= first_extra()) point = number_of[std::size_t(point - first_extra())];
      }
    }
    mesh.tets.insert(mesh.tets.end(), block.tets.begin(), block.tets.end());
    for (const LabelNumber label : block.labels) {
      mesh.region_of.push_back(m_field.labels()[label - 1U]);
    }
    block = {};
  }
  std::vector<std::int32_t> node_of(std::size_t(first_extra()) + extra_places.size(), -1);
  for (const auto& tet : mesh.tets) {
    for (const std::int32_t point : tet) node_of[std::size_t(point)] = 0;
  }
  const Block none;
  for (std::size_t point = 0; point < node_of.size(); ++point) {
    if (node_of[point] < 0) continue;
    node_of[point] = std::int32_t(mesh.nodes_lps_mm.size());
    const std::size_t extra = point - std::size_t(first_extra());
    const Vec3d place = point < std::size_t(first_extra()) ? place_of(std::int32_t(point), none)
                                                           : extra_places[extra];
    mesh.nodes_lps_mm.push_back(m_lattice.lps_at(place / double(m_tets.per_half)));
  }
  for (auto& tet : mesh.tets) {
    for (std::int32_t& point : tet) point = node_of[std::size_t(point)];
  }
  if (report == nullptr) return;
  *report = {std::int64_t(m_tets.places.size()), m_cuts.warped(),
             std::int64_t(m_cuts.cuts().size()), m_cuts.held_apart(),
             std::int64_t(extra_places.size())};
}

SolidMesh Cleaver::run(CleaveReport* report, Progress* progress) {
  stage(progress, "meshing");
  m_cuts.run();
  poll(progress);
  const std::size_t count = m_tets.tets.size();
  std::vector<Block> blocks((count + kTetsPerBlock - 1) / kTetsPerBlock);
  parallel_for(blocks.size(), [&](std::size_t b) {
    const std::size_t end = std::min(count, (b + 1) * kTetsPerBlock);
    for (std::size_t n = b * kTetsPerBlock; n < end; ++n) {
      cleave_tet(std::int32_t(n), blocks[b]);
    }
  });
  poll(progress);
  SolidMesh mesh;
  gather(blocks, mesh, report);
  return mesh;
}

}  // namespace

SolidMesh cleave(const LabelField& field, const BccLattice& lattice, const LatticeTets& tets,
                 CleaveReport* report, Progress* progress) {
  return Cleaver(field, lattice, tets).run(report, progress);
}

}  // namespace supple
