#include "volumes/io/transform/transform_volume.h"

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/io/transform/transform_chain.h"

namespace supple {

namespace {

class TransformVectors : public VolumeFile {
 public:
  TransformVectors(const std::string& path, const Geometry& grid, TransformChain chain)
      : m_chain(std::move(chain)) {
    m_header.path = path;
    m_header.format = "transform";
    m_header.type = ValueType::float64;
    m_header.components = 3;
    m_header.geometry = grid;
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    parallel_for(dims.y, [&](int j) {
      double* vector = static_cast<double*>(out) + std::size_t(j) * std::size_t(dims.x) * 3;
      for (int i = 0; i < dims.x; ++i, vector += 3) {
        const Vec3d x = m_header.geometry.world_from_index(Vec3d(i, j, m_slices_read));
        const Vec3d offset = m_chain.at(x) - x;
        for (int c = 0; c < 3; ++c) vector[c] = offset[c];
      }
    });
    ++m_slices_read;
  }

 private:
  TransformChain m_chain;
  int m_slices_read = 0;
};

}  // namespace

TransformKind transform_kind(const std::string& head) {
  if (head.rfind("#Insight Transform File", 0) == 0) return TransformKind::itk;
  return head.find("(Transform \"") != std::string::npos ? TransformKind::elastix
                                                         : TransformKind::none;
}

TransformChain read_chain(const std::string& path, TransformKind kind) {
  return kind == TransformKind::itk ? read_itk_transform(path) : read_elastix_transform(path);
}

std::unique_ptr<VolumeFile> open_transform(const std::string& path, TransformKind kind,
                                           const Geometry* grid) {
  TransformChain chain = read_chain(path, kind);
  if (!chain.grid && grid == nullptr) {
    throw InputError({path, "grid", "a transform of all space", "a grid to evaluate it on"});
  }
  // A line of numbers may name any grid; no scanner has made larger volumes.
  constexpr long long kMostPoints = 1LL << 28;
  if (chain.grid && chain.grid->voxel_count() > kMostPoints) {
    throw InputError({path, "grid", std::to_string(chain.grid->voxel_count()) + " points",
                      "at most " + std::to_string(kMostPoints)});
  }
  const Geometry where = chain.grid ? *chain.grid : *grid;
  return transform_volume(path, where, std::move(chain));
}

std::unique_ptr<VolumeFile> transform_volume(const std::string& path, const Geometry& grid,
                                             TransformChain chain) {
  return std::make_unique<TransformVectors>(path, grid, std::move(chain));
}

}  // namespace supple
