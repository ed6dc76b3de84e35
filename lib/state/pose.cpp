#include "lib/state/pose.h"

#include "volumes/base/text.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/inversion/hidden_elements.h"

namespace supple {

namespace {

void warn_of(const InversionCertificate& certificate, Progress* progress) {
  const std::string where = certificate.of_part ? " in what is seen" : "";
  const std::int64_t folded = certificate.folded_cells - certificate.folded_air_cells;
  if (folded > 0) {
    warn(progress, with_count(folded, "cell") + " of material folded" + where +
                       ", smallest det F " + std::to_string(certificate.min_det) +
                       "; ties go to the shortest offset");
  }
  if (certificate.folded_air_cells > 0) {
    debug(progress, with_count(certificate.folded_air_cells, "cell") +
                        " folded in the air around the material");
  }
  if (certificate.overlapped_voxels > 0) {
    warn(progress, with_count(certificate.overlapped_voxels, "voxel") +
                       " covered by tissue from several places" + where +
                       "; the shortest offset is shown");
  }
  if (certificate.hidden_elements > 0) {
    warn(progress, with_count(certificate.hidden_elements, "element") +
                       " cannot be seen where they went, as other tissue is shown there" +
                       (certificate.of_part ? "; what is not seen was not looked at" : ""));
  }
  if (certificate.unresolved_voxels > 0) {
    warn(progress,
         with_count(certificate.unresolved_voxels, "voxel") + " could not be inverted" + where);
  }
}

}  // namespace

OffsetField invert_displacement(const State& state, const Displacement& extended,
                                Progress* progress,
                                const std::function<bool(const Vec3i& origin)>& wants) {
  InvertParams params;
  params.material = &state.elements;
  if (state.cuts.empty()) params.wants = wants;
  OffsetField offsets = invert_cut(extended, {state.elements, state.cuts}, params, progress);
  offsets.certificate.hidden_elements =
      count_hidden(extended, state.elements, offsets, params.wants);
  warn_of(offsets.certificate, progress);
  return offsets;
}

Pose invert_state(const State& state, Progress* progress) {
  Pose pose;
  pose.displacement = extended_displacement_of(state);
  pose.offsets = invert_displacement(state, pose.displacement, progress);
  return pose;
}

bool has_open_cuts(const State& state, const Displacement& extended) {
  return has_open_cut(extended, {state.elements, state.cuts});
}

Displacement on_elements(const Geometry& geometry, const BrickTopology& elements,
                         const Displacement* displacement) {
  Displacement result{geometry, {}};
  result.u.topology = elements;
  result.u.vectors.resize(elements.brick_count());
  if (displacement == nullptr) return result;
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    const std::int32_t same = displacement->u.topology.find(elements.origin(b));
    const Vec3f* const u = displacement->u.vectors.brick(std::size_t(same));
    if (u == nullptr) continue;
    Vec3f* const vectors = result.u.vectors.touch(b);
    for_each_active(elements.mask(b), [&](int offset) {
      if (mask_test(displacement->u.topology.mask(std::size_t(same)), offset)) {
        vectors[offset] = u[offset];
      }
    });
  }
  return result;
}

}  // namespace supple
