#include "lib/session/handles/handle_places.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/values_at.h"

namespace supple {

namespace {

std::optional<float> density_at(const Vec3i& voxel, const State& state,
                                const DensitySource& source) {
  if (state.density.bricks().is_active(voxel)) return state.density.at(voxel);
  if (source.path.empty()) return std::nullopt;
  return values_at(*open_volume(source.path, source.read), {voxel}).front();
}

/// The density and which side of the elements' range it is on.
std::string density_text(float density, const MaterialTable& material) {
  if (std::isnan(density)) return "no finite density, outside of";
  const double lo = material.active_lo, hi = material.active_hi;
  const std::string text = "density " + number_text(density);
  if (density < lo) return text + ", below";
  if (density > hi) return text + ", above";
  return text + ", in a piece that components leaves out of";
}

}  // namespace

HandlePlace place_of(const Region& region, const Body& body, const State& state) {
  const SlotSet slots = elements_of(body, region, "grab");
  HandlePlace place;
  place.name = region.name();
  slots.for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const float density = state.density.at(voxel);
    const bool is_first = place.elements++ == 0;
    place.least_density = is_first ? density : std::min(place.least_density, density);
    place.largest_density = is_first ? density : std::max(place.largest_density, density);
    place.centre_index += Vec3d(voxel);
    if (!state.labels.empty()) place.labels.insert(state.labels.at(slot));
  });
  place.centre_index /= double(place.elements);
  place.centre_lps_mm = body.geometry.world_from_index(place.centre_index);
  return place;
}

void require_element(const Region& region, const std::string& role, const Body& body,
                     const State& state, const DensitySource& source) {
  const IndexBox* box = region.box();
  const bool is_voxel = box != nullptr && box->lo == box->hi;
  if (!is_voxel || body.elements.is_active(box->lo)) return;
  const auto density = density_at(box->lo, state, source);
  if (!density) return;
  const MaterialTable& material = body.material;
  throw InputError({"", role + " " + region.name(),
                    density_text(*density, material) + " the elements' " +
                        number_text(material.active_lo) + " to " + number_text(material.active_hi),
                    "a voxel of the body; " + nearest_text(body, box->lo)});
}

}  // namespace supple
