#include "tools/lab/bench/render/vdb_line_samplers.h"

#include <nanovdb/util/OpenToNanoVDB.h>
#include <nanovdb/util/SampleFromVoxels.h>
#include <openvdb/tools/Interpolation.h>

#include "volumes/grid/density_grid_vdb.h"

namespace supple {

namespace {

openvdb::Vec3SGrid::Ptr vdb_offsets(const VectorBricks& offsets) {
  openvdb::Vec3SGrid::Ptr grid = make_grid<openvdb::Vec3SGrid>(openvdb::Vec3f(0));
  for (std::size_t b = 0; b < offsets.topology.brick_count(); ++b) {
    const Vec3i& origin = offsets.topology.origin(b);
    auto* leaf = grid->tree().touchLeaf(openvdb::Coord(origin.x, origin.y, origin.z));
    for_each_active(offsets.topology.mask(b), [&](int offset) {
      const Vec3f& o = offsets.vectors.brick_or_zero(b)[offset];
      leaf->setValueOn(openvdb::Index(offset), openvdb::Vec3s(o.x, o.y, o.z));
    });
  }
  return grid;
}

class OpenVdbLines final : public LineSampler {
 public:
  OpenVdbLines(const DensityGrid& density, const VectorBricks* offsets)
      : m_density(density.vdb().grid),
        m_offsets(offsets != nullptr ? vdb_offsets(*offsets) : nullptr) {}

  double sum(const Vec3d& first, const Vec3d& step, int count) override {
    using openvdb::tools::BoxSampler;
    const auto densities = m_density->getConstUnsafeAccessor();
    double sum = 0;
    if (m_offsets == nullptr) {
      for (int n = 0; n < count; ++n) sum += BoxSampler::sample(densities, at(first, step, n));
      return sum;
    }
    const auto offsets = m_offsets->getConstUnsafeAccessor();
    for (int n = 0; n < count; ++n) {
      const openvdb::Vec3R x = at(first, step, n);
      const openvdb::Vec3R read_at = x + openvdb::Vec3R(BoxSampler::sample(offsets, x));
      sum += BoxSampler::sample(densities, read_at);
    }
    return sum;
  }

 private:
  static openvdb::Vec3R at(const Vec3d& first, const Vec3d& step, int n) {
    return {first.x + n * step.x, first.y + n * step.y, first.z + n * step.z};
  }

  openvdb::FloatGrid::ConstPtr m_density;
  openvdb::Vec3SGrid::ConstPtr m_offsets;
};

class NanoVdbLines final : public LineSampler {
 public:
  NanoVdbLines(const DensityGrid& density, const VectorBricks* offsets)
      : m_density(nanovdb::openToNanoVDB(*openvdb::gridPtrCast<openvdb::FloatGrid>(
            openvdb::ConstPtrCast<openvdb::FloatGrid>(density.vdb().grid)))) {
    if (offsets != nullptr) m_offsets = nanovdb::openToNanoVDB(*vdb_offsets(*offsets));
  }

  double sum(const Vec3d& first, const Vec3d& step, int count) override {
    const auto density = m_density.grid<float>()->getAccessor();
    const auto densities = nanovdb::createSampler<1>(density);
    double sum = 0;
    if (!m_offsets) {
      for (int n = 0; n < count; ++n) sum += densities(at(first, step, n));
      return sum;
    }
    const auto offset = m_offsets.grid<nanovdb::Vec3f>()->getAccessor();
    const auto offsets = nanovdb::createSampler<1>(offset);
    for (int n = 0; n < count; ++n) {
      const nanovdb::Vec3f x = at(first, step, n);
      sum += densities(x + offsets(x));
    }
    return sum;
  }

 private:
  static nanovdb::Vec3f at(const Vec3d& first, const Vec3d& step, int n) {
    return {float(first.x + n * step.x), float(first.y + n * step.y), float(first.z + n * step.z)};
  }

  nanovdb::GridHandle<> m_density, m_offsets;
};

}  // namespace

std::unique_ptr<LineSampler> openvdb_line_sampler(const DensityGrid& density,
                                                  const VectorBricks* offsets) {
  return std::make_unique<OpenVdbLines>(density, offsets);
}

std::unique_ptr<LineSampler> nanovdb_line_sampler(const DensityGrid& density,
                                                  const VectorBricks* offsets) {
  return std::make_unique<NanoVdbLines>(density, offsets);
}

}  // namespace supple
