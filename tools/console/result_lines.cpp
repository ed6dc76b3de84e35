#include "tools/console/result_lines.h"

#include <cstdio>

#include "tools/scene/run/reports.h"
#include "volumes/base/json.h"

namespace supple::tools {

void print_places(const std::vector<HandlePlace>& places) {
  for (const HandlePlace& place : places) {
    const Vec3d& voxel = place.centre_index;
    const Vec3d& lps = place.centre_lps_mm;
    std::printf("grab %-10s %lld %s voxel %.4g,%.4g,%.4g, LPS %.4g, %.4g, %.4g mm, density %.4g",
                place.name.c_str(), static_cast<long long>(place.elements),
                place.elements == 1 ? "element at" : "elements around", voxel.x, voxel.y, voxel.z,
                lps.x, lps.y, lps.z, double(place.least_density));
    if (place.largest_density > place.least_density) {
      std::printf(" to %.4g", double(place.largest_density));
    }
    std::string labels;
    for (const std::int32_t label : place.labels) {
      labels += (labels.empty() ? ", label " : ", ") +
                (label == 0 ? std::string("none") : std::to_string(label));
    }
    std::printf("%s\n", labels.c_str());
  }
}

void print_reactions(const std::vector<HandleReaction>& reactions) {
  for (const HandleReaction& held : reactions) {
    const Vec3d& n = held.reaction.force_n;
    const auto& taut = held.reaction.taut;
    std::printf("pull at %-15s %.4g, %.4g, %.4g N (LPS)%s\n", held.name.c_str(), n.x, n.y, n.z,
                taut[0] || taut[1] || taut[2] ? ", or more: links at their limits join it to "
                                                "something else that is held"
                                              : "");
  }
}

void print_dense_report(const std::string& path, const Geometry& grid, std::int64_t lost_voxels,
                        const InversionCertificate& certificate) {
  const Vec3i& dims = grid.dims();
  const Value json = {{"output", path},
                      {"dims", {dims.x, dims.y, dims.z}},
                      {"lost_voxels", lost_voxels},
                      {"certificate", to_value(certificate)}};
  std::printf("%s\n", json_text(json, 2).c_str());
}

std::string people_text(const Value& value) {
  if (value.is_text()) return value.text();
  if (value.is_number() && !value.is_whole()) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value.number());
    return text;
  }
  if (!value.is_list()) return json_text(value);
  std::string list;
  for (const Value& part : value.items()) list += (list.empty() ? "" : ", ") + people_text(part);
  return "[" + list + "]";
}

}  // namespace supple::tools
