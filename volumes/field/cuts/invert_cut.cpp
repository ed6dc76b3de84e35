// The inversion of cut bodies, at once or one after the other.
#include <algorithm>
#include <functional>

#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/displacement.h"
#include "volumes/field/inversion/source_cells.h"

namespace supple {

Displacement extend_past_cuts(const Displacement& displacement, const BrickTopology& target,
                              const CutElements& body) {
  Displacement extended = extend(displacement, target);
  if (body.cuts.empty()) return extended;
  extend_beside_cuts(extended.u,
                     CutBody(extended.u, body.elements, body.cuts, displacement.geometry.dims()));
  return extended;
}

namespace {

/// Turns the offsets of what is whole, and those of u itself where nothing is torn, to those of a
/// cut body. `invert_whole` is asked once.
OffsetField invert_apart(const Displacement& displacement, const CutElements& body,
                         const std::function<OffsetField(const Displacement&)>& invert_whole,
                         Progress* progress) {
  const Vec3i& dims = displacement.geometry.dims();
  const VectorBricks u = thickened(displacement.u, dims);
  const CutBody cut(displacement.u, body.elements, body.cuts, dims);
  const std::vector<TornCell> torn = torn_cells(u, cut, kClosedCut);
  if (torn.empty()) return invert_whole(displacement);

  CutFaces faces(torn, cut, displacement.geometry, kClosedCut);
  CutInversion inversion(u, torn, faces, body.elements, dims);
  OffsetField field = invert_whole({displacement.geometry, inversion.whole_part()});
  std::vector<CutBrick> bricks = inversion.split_bricks(field, progress);
  field.o = inversion.joined(field.o, bricks);
  inversion.find_interpolated(field.o, bricks);
  field.split = std::make_shared<const CutOffsets>(std::move(bricks), std::move(faces), dims);
  return field;
}

/// Bricks of `now` that differ from those of `before`, by number in `now`.
std::vector<std::int32_t> remasked(const BrickTopology& before, const BrickTopology& now) {
  std::vector<std::int32_t> bricks;
  for (std::size_t b = 0; b < now.brick_count(); ++b) {
    if (before.mask(b) != now.mask(b)) bricks.push_back(std::int32_t(b));
  }
  return bricks;
}

bool has_same_bricks(const BrickTopology& a, const BrickTopology& b) {
  if (a.brick_count() != b.brick_count()) return false;
  for (std::size_t n = 0; n < a.brick_count(); ++n) {
    if (a.origin(n) != b.origin(n)) return false;
  }
  return true;
}

}  // namespace

OffsetField invert_cut(const Displacement& displacement, const CutElements& body,
                       const InvertParams& params, Progress* progress) {
  if (body.cuts.empty()) return invert(displacement, params, progress);
  const auto invert_whole = [&](const Displacement& whole) {
    return invert(whole, params, progress);
  };
  return invert_apart(displacement, body, invert_whole, progress);
}

struct IncrementalCutInversion::Impl {
  Impl(const CutElements& cut_body, const InvertParams& invert_params)
      : body(cut_body), params(invert_params) {}

  CutElements body;
  InvertParams params;
  OffsetField field;
  BrickTopology whole;  // voxels of what the lattice holds
  std::unique_ptr<IncrementalInversion> inversion;

  /// Follows `part` of u, whose `changed` bricks differ from those of the last one in vectors.
  OffsetField follow(const Displacement& part, const Displacement& displacement,
                     const std::vector<std::int32_t>& changed, Progress* progress);
};

OffsetField IncrementalCutInversion::Impl::follow(const Displacement& part,
                                                  const Displacement& displacement,
                                                  const std::vector<std::int32_t>& changed,
                                                  Progress* progress) {
  if (is_flat(displacement.geometry.dims())) return invert(part, params, progress);
  const BrickTopology& voxels = part.u.topology;
  if (!inversion || !has_same_bricks(whole, voxels)) {
    inversion = std::make_unique<IncrementalInversion>(part, params, progress);
  } else {
    std::vector<std::int32_t> differing = remasked(whole, voxels);
    for (const std::int32_t b : changed) {
      const std::int32_t here = voxels.find(displacement.u.topology.origin(std::size_t(b)));
      if (here >= 0) differing.push_back(here);
    }
    std::sort(differing.begin(), differing.end());
    differing.erase(std::unique(differing.begin(), differing.end()), differing.end());
    inversion->update(part, differing);
  }
  whole = voxels;
  return inversion->field();
}

IncrementalCutInversion::IncrementalCutInversion(const Displacement& displacement,
                                                 const CutElements& body,
                                                 const InvertParams& params, Progress* progress)
    : m_impl(std::make_unique<Impl>(body, params)) {
  update(displacement, {}, progress);
}
IncrementalCutInversion::~IncrementalCutInversion() = default;

void IncrementalCutInversion::update(const Displacement& displacement,
                                     const std::vector<std::int32_t>& changed, Progress* progress) {
  const auto follow = [&](const Displacement& part) {
    return m_impl->follow(part, displacement, changed, progress);
  };
  m_impl->field = m_impl->body.cuts.empty()
                      ? follow(displacement)
                      : invert_apart(displacement, m_impl->body, follow, progress);
}

const OffsetField& IncrementalCutInversion::field() const {
  return m_impl->field;
}

}  // namespace supple
