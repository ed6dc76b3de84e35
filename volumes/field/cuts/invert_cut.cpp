// The inversion of cut bodies, at once or one after the other.
#include <algorithm>
#include <functional>
#include <utility>

#include "volumes/field/cuts/cut_inversion.h"
#include "volumes/field/displacement.h"
#include "volumes/field/inversion/source_cells.h"

namespace supple {

Displacement extend_past_cuts(Displacement displacement, const BrickTopology& target,
                              const CutElements& body) {
  Displacement extended = extend(std::move(displacement), target);
  if (body.cuts.empty()) return extended;
  extend_beside_cuts(extended.u,
                     CutBody(extended.u, body.elements, body.cuts, extended.geometry.dims()));
  return extended;
}

namespace {

/// Turns the offsets of what is whole, and those of u itself where nothing is torn, to those of a
/// cut body. `invert_whole` is asked once.
OffsetField invert_apart(const Displacement& displacement, const CutBody& cut,
                         const std::function<OffsetField(const Displacement&)>& invert_whole,
                         Progress* progress) {
  const Vec3i& dims = displacement.geometry.dims();
  const VectorBricks u = thickened(displacement.u, dims);
  const std::vector<TornCell> torn = torn_cells(u, cut, kClosedCut);
  if (torn.empty()) return invert_whole(displacement);

  CutFaces faces(torn, cut, displacement.geometry, kClosedCut);
  CutInversion inversion(u, torn, faces, cut.elements(), dims);
  OffsetField field = invert_whole({displacement.geometry, inversion.whole_part()});
  std::vector<CutBrick> bricks = inversion.split_bricks(field, progress);
  field.o = inversion.joined(field.o, bricks);
  inversion.find_interpolated(field.o, bricks);
  field.split = std::make_shared<const CutOffsets>(std::move(bricks), std::move(faces), dims);
  return field;
}

/// Bricks, by number in `now`, that hold other voxels or vectors than those of `before`, which has
/// the same bricks.
std::vector<std::int32_t> differing_bricks(const VectorBricks& before, const VectorBricks& now) {
  std::vector<std::int32_t> differing;
  for (std::size_t b = 0; b < now.topology.brick_count(); ++b) {
    const Vec3f* const was = before.vectors.brick_or_zero(b);
    const Vec3f* const is = now.vectors.brick_or_zero(b);
    const bool is_moved = was != is && !std::equal(is, is + kBrickVoxels, was);
    if (is_moved || before.topology.mask(b) != now.topology.mask(b)) {
      differing.push_back(std::int32_t(b));
    }
  }
  return differing;
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
  if (progress != nullptr) progress->stage("inverting");
  const auto invert_whole = [&](const Displacement& whole) {
    return invert(whole, params, progress);
  };
  const CutBody cut(displacement.u, body.elements, body.cuts, displacement.geometry.dims());
  return invert_apart(displacement, cut, invert_whole, progress);
}

struct IncrementalCutInversion::Impl {
  Impl(const CutElements& cut_body, const InvertParams& invert_params)
      : body(cut_body), params(invert_params) {}

  CutElements body;
  InvertParams params;
  OffsetField field;
  VectorBricks whole;  // what the lattice holds
  std::unique_ptr<IncrementalInversion> inversion;

  /// Follows `part` of u, which is whole.
  OffsetField follow(const Displacement& part, Progress* progress);
};

OffsetField IncrementalCutInversion::Impl::follow(const Displacement& part, Progress* progress) {
  if (is_flat(part.geometry.dims())) return invert(part, params, progress);
  if (!inversion || !has_same_bricks(whole.topology, part.u.topology)) {
    inversion = std::make_unique<IncrementalInversion>(part, params, progress);
  } else {
    inversion->update(part, differing_bricks(whole, part.u));
  }
  whole = part.u;
  return inversion->field(part);
}

IncrementalCutInversion::IncrementalCutInversion(const Displacement& displacement,
                                                 const CutElements& body,
                                                 const InvertParams& params, Progress* progress)
    : m_impl(std::make_unique<Impl>(body, params)) {
  update(displacement, progress);
}
IncrementalCutInversion::~IncrementalCutInversion() = default;

void IncrementalCutInversion::update(const Displacement& displacement, Progress* progress) {
  const auto follow = [&](const Displacement& part) { return m_impl->follow(part, progress); };
  const CutElements& body = m_impl->body;
  if (body.cuts.empty()) {
    m_impl->field = follow(displacement);
    return;
  }
  const CutBody cut(displacement.u, body.elements, body.cuts, displacement.geometry.dims());
  Displacement extended = displacement;
  extend_beside_cuts(extended.u, cut);
  m_impl->field = invert_apart(extended, cut, follow, progress);
}

const OffsetField& IncrementalCutInversion::field() const {
  return m_impl->field;
}

}  // namespace supple
