// The inversion of cut bodies, at once or one after the other.
#include <algorithm>
#include <stdexcept>
#include <utility>

#include "volumes/field/cuts/cut_extension.h"
#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/inversion/source_cells.h"
#include "volumes/field/offset_field.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

/// The torn cells of a body, and the bricks of the output that they split.
struct CutFollower {
  /// `cells`: the bricks of u.
  CutFollower(const BrickTopology& cells_of_u, const BrickTopology& elements,
              const Geometry& geometry)
      : cells(cells_of_u),
        torn(cells),
        offsets(std::make_shared<CutOffsets>(cells, geometry)),
        inversion(cells, elements, geometry.dims()) {}

  /// Follows u on `cells` where it has moved; `body_changed`: where the body has, besides.
  void follow(const VectorBricks& u, const CutBody& body, const DisplacedBricks& moved,
              const BrickList& body_changed) {
    const BrickList torn_changed =
        torn.follow(u, body, numbers_of(moved), body_changed, kClosedCut);
    const BrickList faces_changed = offsets->faces().follow(torn, body, torn_changed);
    inversion.follow(u, torn, offsets->faces(), {moved, torn_changed, faces_changed});
  }
  /// Splits bricks after follow() and the inversion of the rest; returns those that read others.
  std::vector<Vec3i> split(const VectorBricks& u, const VectorBrickFinder& lattice,
                           const std::vector<Vec3i>& touched, Progress* progress) {
    std::vector<Vec3i> others =
        inversion.split(u, torn, offsets->faces(), lattice, touched, progress);
    offsets->set_bricks(inversion.bricks());
    return others;
  }
  /// Adds what was split to a field of what is whole.
  void join_to(OffsetField& field) const {
    if (torn.empty()) return;
    field.o = inversion.joined(field.o);
    field.overlaps = inversion.overlaps(field.overlaps);
    field.split = offsets;
  }
  void count(OffsetField& field) const {
    if (torn.empty()) return;
    inversion.count(torn, field.certificate);
    field.certificate.overlapped_voxels = field.overlaps.active_count();
  }

  BrickTopology cells;
  TornCells torn;
  std::shared_ptr<CutOffsets> offsets;
  CutInversion inversion;
};

}  // namespace

Displacement extend_past_cuts(Displacement displacement, const BrickTopology& target,
                              const CutElements& body) {
  Displacement extended = extend(std::move(displacement), target);
  if (body.cuts.empty()) return extended;
  extend_beside_cuts(extended.u,
                     CutBody(extended.u, body.elements, body.cuts, extended.geometry.dims()));
  return extended;
}

bool has_open_cut(const Displacement& displacement, const CutElements& body) {
  if (body.cuts.empty()) return false;
  const Vec3i& dims = displacement.geometry.dims();
  const CutBody cut(displacement.u, body.elements, body.cuts, dims);
  TornCells torn(cut.cells());
  torn.follow(thickened(displacement.u, dims), cut, all_bricks(cut.cells()), {}, kClosedCut);
  return !torn.empty();
}

OffsetField invert_cut(const Displacement& displacement, const CutElements& body,
                       const InvertParams& params, Progress* progress) {
  if (body.cuts.empty()) return invert(displacement, params, progress);
  if (progress != nullptr) progress->stage("inverting");
  const Vec3i& dims = displacement.geometry.dims();
  Displacement thick{displacement.geometry, thickened(displacement.u, dims)};
  CutFollower follower(thick.u.topology, body.elements, displacement.geometry);
  {
    const CutBody cut(displacement.u, body.elements, body.cuts, dims);
    follower.follow(thick.u, cut, all_moved(follower.cells), {});
  }
  if (follower.torn.empty()) return invert(displacement, params, progress);
  thick.u.topology = follower.inversion.whole();
  OffsetField field = invert(thick, params, progress);
  thick.u.topology = follower.cells;
  follower.split(thick.u, finder_of(field.o), {}, progress);
  follower.join_to(field);
  follower.count(field);
  return field;
}

/// Without cuts the displacement that is given is followed; else it is extended beside them, in a
/// copy.
struct IncrementalCutInversion::Impl {
  struct Cut {
    Cut(const Displacement& displacement, const BrickTopology& elements)
        : body(displacement.u.topology, elements, displacement.geometry.dims()),
          extension(body.voxels(), elements),
          extended(displacement),
          follower(body.voxels(), elements, displacement.geometry) {}

    CutBody body;
    CutExtension extension;
    Displacement extended;
    CutFollower follower;
  };

  Impl(const BrickTopology& cut_elements, const InvertParams& invert_params)
      : elements(cut_elements), params(invert_params) {}

  std::vector<Vec3i> follow(const Displacement& displacement, const BrickList& changed);
  std::vector<Vec3i> follow_cuts(const Displacement& displacement, const BrickList& changed);

  const BrickTopology& elements;
  InvertParams params;
  std::unique_ptr<IncrementalInversion> inversion;  // of what is whole
  std::unique_ptr<Cut> cut;                         // null: no links are cut
  LinkCuts cuts;
  bool has_other_cuts = false;
  Work work;
};

std::vector<Vec3i> IncrementalCutInversion::Impl::follow_cuts(const Displacement& displacement,
                                                              const BrickList& changed) {
  BrickList given = changed;
  const bool is_new = !cut;
  if (is_new) {
    cut = std::make_unique<Cut>(displacement, elements);
    given = all_bricks(displacement.u.topology);
  }
  if (std::exchange(has_other_cuts, false)) cut->body.set_cuts(cuts);
  VectorBricks& u = cut->extended.u;
  const CutBody::Changes changes = cut->body.follow(displacement.u, given);
  const DisplacedBricks moved =
      cut->extension.follow(u, displacement.u, cut->body, changes, changed);
  CutFollower& follower = cut->follower;
  follower.follow(u, cut->body, is_new ? all_moved(u.topology) : moved,
                  unite(changes.links, changes.parted));
  u.topology = follower.inversion.whole();
  BrickList others = unite(numbers_of(moved), follower.inversion.whole_changed());
  if (is_new) others = unite(others, changed);
  const std::vector<Vec3i> touched = inversion->update(cut->extended, others);
  u.topology = follower.cells;
  const std::int64_t gathered = follower.inversion.gathered();
  std::vector<Vec3i> read_others = follower.split(u, inversion->finder(), touched, nullptr);
  work = {cut->extension.filled(), follower.inversion.gathered() - gathered,
          std::int64_t(touched.size())};
  if (!cut->body.has_cuts()) cut.reset();
  return read_others;
}

std::vector<Vec3i> IncrementalCutInversion::Impl::follow(const Displacement& displacement,
                                                         const BrickList& changed) {
  if (cut || !cuts.empty()) return follow_cuts(displacement, changed);
  has_other_cuts = false;
  const std::vector<Vec3i> touched = inversion->update(displacement, changed);
  work = {0, 0, std::int64_t(touched.size())};
  return touched;
}

IncrementalCutInversion::IncrementalCutInversion(const Displacement& displacement,
                                                 const CutElements& body,
                                                 const InvertParams& params, Progress* progress)
    : m_impl(std::make_unique<Impl>(body.elements, params)) {
  m_impl->inversion = std::make_unique<IncrementalInversion>(displacement, params, progress);
  set_cuts(body.cuts);
  if (!body.cuts.empty()) update(displacement, {});
}
IncrementalCutInversion::~IncrementalCutInversion() = default;

void IncrementalCutInversion::set_cuts(const LinkCuts& cuts) {
  if (cuts == m_impl->cuts) return;
  m_impl->cuts = cuts;
  m_impl->has_other_cuts = true;
}

std::vector<Vec3i> IncrementalCutInversion::update(const Displacement& displacement,
                                                   const std::vector<std::int32_t>& changed) {
  return m_impl->follow(displacement, changed);
}

VectorBrickFinder IncrementalCutInversion::finder() const {
  const VectorBrickFinder lattice = m_impl->inversion->finder();
  if (split() == nullptr) return lattice;
  return [lattice, &split = m_impl->cut->follower.inversion](const Vec3i& origin) {
    const SplitBrick* const brick = split.find(origin);
    return brick == nullptr ? lattice(origin) : brick->nodes();
  };
}

std::shared_ptr<const SplitOffsets> IncrementalCutInversion::split() const {
  if (!m_impl->cut || m_impl->cut->follower.torn.empty()) return nullptr;
  return m_impl->cut->follower.offsets;
}

OffsetField IncrementalCutInversion::offsets() const {
  OffsetField field = m_impl->inversion->offsets();
  if (m_impl->cut) m_impl->cut->follower.join_to(field);
  return field;
}

OffsetField IncrementalCutInversion::field(const Displacement& displacement) const {
  OffsetField field = offsets();
  if (!m_impl->cut) {
    field.certificate = m_impl->inversion->certificate(displacement);
    return field;
  }
  Impl::Cut& cut = *m_impl->cut;
  cut.extended.u.topology = cut.follower.inversion.whole();
  field.certificate = m_impl->inversion->certificate(cut.extended);
  cut.extended.u.topology = cut.follower.cells;
  cut.follower.count(field);
  return field;
}

const IncrementalCutInversion::Work& IncrementalCutInversion::work() const {
  return m_impl->work;
}

}  // namespace supple
