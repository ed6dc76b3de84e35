#include "volumes/field/inversion/invert.h"

#include <algorithm>
#include <deque>
#include <stdexcept>

#include "volumes/base/parallel.h"
#include "volumes/field/inversion/inversion.h"
#include "volumes/field/inversion/inversion_certificate.h"
#include "volumes/field/inversion/reachable_bricks.h"
#include "volumes/field/ring_fill.h"
#include "volumes/grid/voxel_sets.h"

namespace supple {

namespace {

void add_residuals(const ResidualHistogram& residuals, InversionCertificate& certificate) {
  certificate.residual_max = residuals.max();
  certificate.residual_p999 = residuals.percentile(0.999);
}

}  // namespace

OffsetField invert(const Displacement& displacement, const InvertParams& params,
                   Progress* progress) {
  if (progress != nullptr) progress->stage("inverting");
  const Vec3i& dims = displacement.geometry.dims();
  VectorBricks thick;
  if (is_flat(dims)) thick = thickened(displacement.u, dims);
  const VectorBricks& u = is_flat(dims) ? thick : displacement.u;
  Inversion inversion(dims, params);
  OffsetField field{displacement.geometry, inversion.solve(u, progress), {}};
  field.certificate = inversion.certificate();
  field.overlaps = inversion.overlaps();
  add_residuals(measure_residuals(u, dims, field.o, inversion.folded()), field.certificate);
  report(progress, 1);
  return field;
}

/// Output bricks lie wherever their memory happens to be, so that they come and go without moving
/// the others.
struct IncrementalInversion::Impl {
  struct Brick {
    BrickMask mask;
    bool is_measured = false;
    BrickResiduals residuals;    // where it is measured
    std::vector<Vec3f> vectors;  // empty: none other than 0
  };

  Impl(const Displacement& displacement, const InvertParams& invert_params)
      : geometry(displacement.geometry),
        params(invert_params),
        inversion(geometry.dims(), params) {}

  void solve_all(const Displacement& displacement, Progress* progress);
  void replace(const std::vector<Vec3i>& touched, const VectorBricks& offsets);
  void take_over(const VectorBricks& offsets);
  void give_up(Brick*& brick);
  void measure(const VectorBricks& u);
  VectorBrickView find(const Vec3i& origin) const;
  /// Origins of the bricks, ascending.
  std::vector<Vec3i> origins() const;

  Geometry geometry;
  InvertParams params;
  Inversion inversion;
  BrickIndex index;            // every brick that ever held offsets
  std::vector<Brick*> bricks;  // null: holds none
  std::deque<Brick> memory;
  std::vector<Brick*> free;
  ResidualHistogram residuals;  // of the bricks that are measured
};

void IncrementalInversion::Impl::solve_all(const Displacement& displacement, Progress* progress) {
  for (Brick*& brick : bricks) give_up(brick);
  take_over(inversion.solve(displacement.u, progress));
}

void IncrementalInversion::Impl::give_up(Brick*& brick) {
  if (brick == nullptr) return;
  if (brick->is_measured) residuals.remove(brick->residuals);
  brick->is_measured = false;
  brick->vectors = {};
  free.push_back(brick);
  brick = nullptr;
}

void IncrementalInversion::Impl::take_over(const VectorBricks& offsets) {
  const std::size_t count = offsets.topology.brick_count();
  std::vector<Brick*> taken(count);
  for (std::size_t b = 0; b < count; ++b) {
    if (free.empty()) {
      memory.emplace_back();
      free.push_back(&memory.back());
    }
    taken[b] = free.back();
    free.pop_back();
    const std::size_t n = index.add(offsets.topology.origin(b));
    bricks.resize(index.count());
    bricks[n] = taken[b];
  }
  parallel_for(count, [&](std::size_t b) {
    taken[b]->mask = offsets.topology.mask(b);
    const Vec3f* const vectors = offsets.vectors.brick(b);
    if (vectors != nullptr) taken[b]->vectors.assign(vectors, vectors + kBrickVoxels);
  });
}

/// The touched bricks make way for those that were solved anew, which may be fewer or more.
void IncrementalInversion::Impl::replace(const std::vector<Vec3i>& touched,
                                         const VectorBricks& offsets) {
  for (const Vec3i& origin : touched) {
    const std::int32_t n = index.find(origin);
    if (n >= 0) give_up(bricks[std::size_t(n)]);
  }
  take_over(offsets);
}

/// The residuals of all bricks that were solved since they were last asked for.
void IncrementalInversion::Impl::measure(const VectorBricks& u) {
  std::vector<std::size_t> fresh;
  std::vector<Vec3i> fresh_origins;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    if (bricks[n] == nullptr || bricks[n]->is_measured) continue;
    fresh.push_back(n);
    fresh_origins.push_back(index.origin(n));
  }
  const FoldedCells folded = fresh.empty() ? FoldedCells() : inversion.folded();
  std::vector<BrickResiduals> of_bricks = measure_bricks(
      u, geometry.dims(), fresh_origins, [this](const Vec3i& origin) { return find(origin); },
      folded);
  for (std::size_t n = 0; n < fresh.size(); ++n) {
    Brick& brick = *bricks[fresh[n]];
    brick.residuals = std::move(of_bricks[n]);
    brick.is_measured = true;
    residuals.add(brick.residuals);
  }
  float max = 0;
  for (const Brick* brick : bricks) {
    if (brick != nullptr) max = std::max(max, brick->residuals.max);
  }
  residuals.set_max(max);
}

VectorBrickView IncrementalInversion::Impl::find(const Vec3i& origin) const {
  const std::int32_t n = index.find(origin);
  if (n < 0 || bricks[std::size_t(n)] == nullptr) return {};
  const Brick& brick = *bricks[std::size_t(n)];
  return {&brick.mask, brick.vectors.empty() ? kZeroBrickOf<Vec3f> : brick.vectors.data()};
}

std::vector<Vec3i> IncrementalInversion::Impl::origins() const {
  std::vector<Vec3i> found;
  for (std::size_t n = 0; n < bricks.size(); ++n) {
    if (bricks[n] != nullptr) found.push_back(index.origin(n));
  }
  sort_unique(found);
  return found;
}

IncrementalInversion::IncrementalInversion(const Displacement& displacement,
                                           const InvertParams& params, Progress* progress)
    : m_impl(std::make_unique<Impl>(displacement, params)) {
  if (params.wants) throw std::logic_error("an incremental inversion of a part");
  if (is_flat(displacement.geometry.dims())) {
    throw InputError({"", "displacement", "a volume of one slice", "a volume with cells"});
  }
  if (progress != nullptr) progress->stage("inverting");
  m_impl->solve_all(displacement, progress);
}
IncrementalInversion::~IncrementalInversion() = default;

std::vector<Vec3i> IncrementalInversion::update(const Displacement& displacement,
                                                const std::vector<std::int32_t>& changed) {
  std::vector<Vec3i> touched;
  VectorBricks offsets;
  if (m_impl->inversion.solve_changed(displacement.u, changed, touched, offsets)) {
    m_impl->replace(touched, offsets);
    return touched;
  }
  touched = m_impl->origins();
  m_impl->solve_all(displacement, nullptr);
  for (const Vec3i& origin : m_impl->origins()) touched.push_back(origin);
  sort_unique(touched);
  return touched;
}

InversionCertificate IncrementalInversion::certificate(const Displacement& displacement) const {
  m_impl->measure(displacement.u);
  InversionCertificate certificate = m_impl->inversion.certificate();
  add_residuals(m_impl->residuals, certificate);
  return certificate;
}

VectorBrickFinder IncrementalInversion::finder() const {
  return [impl = m_impl.get()](const Vec3i& origin) { return impl->find(origin); };
}

OffsetField IncrementalInversion::offsets() const {
  const std::vector<Vec3i> origins = m_impl->origins();
  std::vector<BrickMask> masks;
  for (const Vec3i& origin : origins) masks.push_back(*m_impl->find(origin).mask);
  OffsetField field{m_impl->geometry,
                    {BrickTopology(origins, std::move(masks)), {}},
                    {},
                    nullptr,
                    m_impl->inversion.overlaps()};
  field.o.vectors.resize(origins.size());
  for (std::size_t n = 0; n < origins.size(); ++n) {
    const Vec3f* const vectors = m_impl->find(origins[n]).vectors;
    if (vectors == kZeroBrickOf<Vec3f>) continue;
    std::copy_n(vectors, kBrickVoxels, field.o.vectors.touch(n));
  }
  return field;
}

OffsetField IncrementalInversion::field(const Displacement& displacement) const {
  OffsetField field = offsets();
  field.certificate = certificate(displacement);
  return field;
}

VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings) {
  return fill_rings(offsets, touching_bricks(offsets.topology), rings, RingFill::means);
}

}  // namespace supple
