#include "tools/lab/bench/peers/peer_head.h"

#include <vector>

#include "lib/session/handles/handles.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "volumes/base/parallel.h"
#include "volumes/io/volume_writer.h"
#include "volumes/phantom/phantom.h"

namespace supple::tools {

namespace {

constexpr float kAir = -1000;  // HU
constexpr Vec3i kPeerSize(kPeerHeadSize);

std::size_t index_of(const Vec3i& voxel) {
  return (std::size_t(voxel.z) * kPeerSize.y + std::size_t(voxel.y)) * kPeerSize.x +
         std::size_t(voxel.x);
}

/// Densities, i fastest. Head phantoms look along +j; here that is posterior.
std::vector<float> turned_head(const Phantom& phantom) {
  std::vector<float> values(std::size_t(kPeerSize.x) * kPeerSize.y * kPeerSize.z);
  parallel_for(kPeerSize.z, [&](int k) {
    for (int j = 0; j < kPeerSize.y; ++j) {
      for (int i = 0; i < kPeerSize.x; ++i) {
        values[index_of({i, j, k})] = phantom.density(i, kPeerSize.y - 1 - j, k);
      }
    }
  });
  return values;
}

}  // namespace

Geometry peer_geometry() {
  const Vec3d spacing = head_phantom(kPeerSize).geometry.spacing_mm();
  return {kPeerSize,
          spacing * (-0.5 * (kPeerHeadSize - 1)),
          {Vec3d(spacing.x, 0, 0), Vec3d(0, spacing.y, 0), Vec3d(0, 0, spacing.z)}};
}

PeerHead make_peer_head() {
  const Phantom phantom = head_phantom(kPeerSize);
  const std::vector<float> values = turned_head(phantom);
  const BrickTopology tissue =
      block_topology(kPeerSize, [&](const Vec3i& voxel) { return values[index_of(voxel)] > kAir; });
  const auto fill = [&](std::size_t b, float* out) {
    for_each_active(tissue.mask(b), [&](int offset) {
      out[offset] = values[index_of(tissue.origin(b) + brick_local(offset))];
    });
  };
  return {peer_geometry(), fill_density_grid(tissue, fill, kAir)};
}

void write_peer_head(const std::string& path, const PeerHead& head) {
  const Vec3i& dims = head.geometry.dims();
  write_volume(path, head.geometry, ValueType::int16, [&](int k, float* out) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) *out++ = head.density.at({i, j, k});
    }
  });
}

Camera peer_camera(const Geometry& geometry) {
  return default_camera(geometry, 1);
}

TransferFunction peer_function() {
  TransferFunction function = preset("Bone");
  function.full_shading_gradient = 0;
  return function;
}

RenderSettings peer_settings(bool shaded) {
  RenderSettings settings;
  settings.width = settings.height = kPeerImageSize;
  if (!shaded) settings.lighting.model = ShadingModel::none;
  Light at_camera;
  at_camera.direction = Vec3d(0, 0, 1);
  settings.lighting.lights = {at_camera};
  return settings;
}

}  // namespace supple::tools
