#include "volumes/field/paths/sampling_path.h"

#include "volumes/base/parallel.h"
#include "volumes/field/paths/path_offsets.h"

namespace supple {

double PathFunction::depth_mm(const Vec3d&, int) const {
  return HUGE_VAL;
}

namespace {

OffsetField finish(const std::shared_ptr<PathOffsets>& offsets, const Geometry& geometry,
                   const InversionCertificate& certificate, Progress* progress) {
  if (progress != nullptr) progress->stage("sampling paths");
  OffsetField field{geometry, offsets->run(progress), certificate};
  if (!offsets->bricks().empty()) field.split = offsets;
  return field;
}

}  // namespace

OffsetField follow_path(const SamplingPath& path, const Geometry& geometry,
                        const BrickTopology& body, Progress* progress) {
  return finish(std::make_shared<PathOffsets>(path, geometry, body), geometry, {}, progress);
}

OffsetField follow_path(const SamplingPath& path, const OffsetField& moved, Progress* progress) {
  return finish(std::make_shared<PathOffsets>(path, moved), moved.geometry, moved.certificate,
                progress);
}

Displacement move_along(const SamplingPath& path, const Displacement& displacement) {
  Displacement result = displacement;
  const Geometry& geometry = result.geometry;
  const BrickTopology& where = result.u.topology;
  result.u.vectors.touch_all();
  parallel_for(where.brick_count(), [&](std::size_t b) {
    Vec3f* const vectors = result.u.vectors.touch(b);
    for_each_active(where.mask(b), [&](int offset) {
      Vec3f& u = vectors[offset];
      const Vec3d before =
          geometry.world_from_index(Vec3d(where.origin(b) + brick_local(offset)) + Vec3d(u));
      Vec3d now = before;
      for (const auto& function : path) {
        int piece = 0;
        while (piece + 1 < function->pieces() && function->depth_mm(now, piece) < 0) ++piece;
        now = function->forward(now, piece);
      }
      u += Vec3f(geometry.index_vector_from_world(now - before));
    });
  });
  return result;
}

}  // namespace supple
