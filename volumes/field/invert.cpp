#include "volumes/field/invert.h"

#include <algorithm>
#include <deque>

#include <tbb/parallel_for.h>

#include "volumes/field/inversion.h"
#include "volumes/field/inversion_certificate.h"
#include "volumes/field/output_bricks.h"
#include "volumes/field/ring_fill.h"

namespace supple {

namespace {

bool is_flat(const Vec3i& dims) {
  return std::min({dims.x, dims.y, dims.z}) == 1;
}

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
  add_residuals(measure_residuals(u, field.o, inversion.folded()), field.certificate);
  report(progress, 1);
  return field;
}

/// The output bricks in the order of their origins, each wherever its memory happens to be, so that
/// bricks come and go without moving the others.
struct IncrementalInversion::Impl {
  struct Brick {
    BrickMask mask;
    BrickResiduals residuals;
    std::array<Vec3f, kBrickVoxels> vectors;
  };

  Impl(const Displacement& displacement, const InvertParams& invert_params)
      : geometry(displacement.geometry),
        params(invert_params),
        inversion(geometry.dims(), params) {}

  void solve_all(const Displacement& displacement, Progress* progress);
  void replace(const std::vector<Vec3i>& touched, const VectorBricks& u,
               const VectorBricks& offsets);
  void put(const VectorBricks& offsets, std::size_t b, const BrickResiduals& residuals,
           std::vector<std::pair<Vec3i, Brick*>>& out);
  const Brick* find(const Vec3i& origin) const;

  Geometry geometry;
  InvertParams params;
  Inversion inversion;
  std::vector<std::pair<Vec3i, Brick*>> bricks;  // sorted
  std::deque<Brick> memory;
  std::vector<Brick*> free;
  ResidualHistogram residuals;
};

void IncrementalInversion::Impl::solve_all(const Displacement& displacement, Progress* progress) {
  for (const auto& [origin, brick] : bricks) free.push_back(brick);
  bricks.clear();
  const VectorBricks offsets = inversion.solve(displacement.u, progress);
  std::vector<BrickResiduals> of_bricks;
  residuals = measure_residuals(displacement.u, offsets, inversion.folded(), &of_bricks);
  for (std::size_t b = 0; b < offsets.topology.brick_count(); ++b) {
    put(offsets, b, of_bricks[b], bricks);
  }
}

void IncrementalInversion::Impl::put(const VectorBricks& offsets, std::size_t b,
                                     const BrickResiduals& of_brick,
                                     std::vector<std::pair<Vec3i, Brick*>>& out) {
  if (free.empty()) {
    memory.emplace_back();
    free.push_back(&memory.back());
  }
  Brick* brick = free.back();
  free.pop_back();
  brick->mask = offsets.topology.mask(b);
  brick->residuals = of_brick;
  std::copy_n(offsets.vectors.begin() + std::ptrdiff_t(b * kBrickVoxels), kBrickVoxels,
              brick->vectors.begin());
  out.emplace_back(offsets.topology.origin(b), brick);
}

/// The touched bricks make way for those that were solved anew, which may be fewer or more.
void IncrementalInversion::Impl::replace(const std::vector<Vec3i>& touched, const VectorBricks& u,
                                         const VectorBricks& offsets) {
  std::vector<BrickResiduals> of_bricks;
  residuals.join(measure_residuals(u, offsets, inversion.folded(), &of_bricks));
  std::vector<std::pair<Vec3i, Brick*>> kept, added;
  kept.reserve(bricks.size());
  std::size_t next = 0;
  for (const auto& [origin, brick] : bricks) {
    while (next < touched.size() && voxel_less(touched[next], origin)) ++next;
    if (next < touched.size() && touched[next] == origin) {
      residuals.remove(brick->residuals);
      free.push_back(brick);
    } else {
      kept.emplace_back(origin, brick);
    }
  }
  for (std::size_t b = 0; b < offsets.topology.brick_count(); ++b) {
    put(offsets, b, of_bricks[b], added);
  }
  bricks.resize(kept.size() + added.size());
  std::merge(kept.begin(), kept.end(), added.begin(), added.end(), bricks.begin(),
             [](const auto& a, const auto& b) { return voxel_less(a.first, b.first); });
  float max = 0;
  for (const auto& [origin, brick] : bricks) max = std::max(max, brick->residuals.max);
  residuals.set_max(max);
}

const IncrementalInversion::Impl::Brick* IncrementalInversion::Impl::find(
    const Vec3i& origin) const {
  const auto found = std::lower_bound(
      bricks.begin(), bricks.end(), origin,
      [](const auto& entry, const Vec3i& wanted) { return voxel_less(entry.first, wanted); });
  return found == bricks.end() || found->first != origin ? nullptr : found->second;
}

IncrementalInversion::IncrementalInversion(const Displacement& displacement,
                                           const InvertParams& params, Progress* progress)
    : m_impl(std::make_unique<Impl>(displacement, params)) {
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
    m_impl->replace(touched, displacement.u, offsets);
    return touched;
  }
  for (const auto& [origin, brick] : m_impl->bricks) touched.push_back(origin);
  m_impl->solve_all(displacement, nullptr);
  for (const auto& [origin, brick] : m_impl->bricks) touched.push_back(origin);
  sort_unique(touched);
  return touched;
}

InversionCertificate IncrementalInversion::certificate() const {
  InversionCertificate certificate = m_impl->inversion.certificate();
  add_residuals(m_impl->residuals, certificate);
  return certificate;
}

VectorBricks IncrementalInversion::bricks(const std::vector<Vec3i>& origins) const {
  std::vector<Vec3i> found_origins;
  std::vector<BrickMask> masks;
  std::vector<const Impl::Brick*> found;
  for (const Vec3i& origin : origins) {
    const Impl::Brick* brick = m_impl->find(origin);
    if (brick == nullptr) continue;
    found.push_back(brick);
    found_origins.push_back(origin);
    masks.push_back(brick->mask);
  }
  VectorBricks result{BrickTopology(std::move(found_origins), std::move(masks)), {}};
  result.vectors.resize(found.size() * kBrickVoxels);
  tbb::parallel_for(std::size_t(0), found.size(), [&](std::size_t n) {
    std::copy(found[n]->vectors.begin(), found[n]->vectors.end(),
              result.vectors.begin() + std::ptrdiff_t(n * kBrickVoxels));
  });
  return result;
}

OffsetField IncrementalInversion::field() const {
  std::vector<Vec3i> origins;
  for (const auto& [origin, brick] : m_impl->bricks) origins.push_back(origin);
  return {m_impl->geometry, bricks(origins), certificate()};
}

VectorBricks extrapolate_into_bricks(const VectorBricks& offsets, int rings) {
  return fill_rings(offsets, touching_bricks(offsets.topology), rings);
}

}  // namespace supple
