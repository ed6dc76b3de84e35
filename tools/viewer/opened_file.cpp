#include "tools/viewer/opened_file.h"

#include <algorithm>
#include <filesystem>

#include "lib/material/presets.h"
#include "lib/state/state.h"
#include "tools/scene/file/live_event.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

namespace {

/// Heads are scanned within 220 to 300 mm, trunks within 350 and more.
constexpr double kWidestHeadMm = 320;

std::string absolute_path(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

struct AssumedMaterial {
  const char* preset;
  std::string text;
};

/// Tells if values are Hounsfield units, and what says so.
struct FoundUnits {
  bool are_hounsfield;
  std::string by;
};

FoundUnits units_of(VolumeFile& file, Progress* progress) {
  const std::string& modality = file.header().modality;
  if (modality == "CT" || modality == "MR")
    return {modality == "CT", "its modality is " + modality};
  const VolumeStatistics statistics = digest_volume(file, progress).statistics;
  const bool are_hounsfield = are_hounsfield_units(statistics.min);
  return {are_hounsfield, are_hounsfield ? "densities are HU" : "densities are not HU"};
}

AssumedMaterial assumed_material(VolumeFile& file, Progress* progress) {
  const FoundUnits found = units_of(file, progress);
  if (!found.are_hounsfield) {
    return {"mr-brain",
            "no material is given and " + found.by +
                ": mr-brain is assumed; what is darker than the threshold between background and "
                "tissue is left out, and so is all but the largest connected part"};
  }
  const Geometry& geometry = file.header().geometry;
  const Vec3d spacing = geometry.spacing_mm();
  const double width = std::max(geometry.dims().x * spacing.x, geometry.dims().y * spacing.y);
  const char* preset = width > kWidestHeadMm ? "ct-body" : "ct-head";
  return {preset, "no material is given and " + found.by + ", " +
                      std::to_string(int(std::lround(width))) + " mm wide: " + preset +
                      " is assumed; air below -300 HU is left out, and so is all but the largest "
                      "connected part, such as the headrest; bone is rigid"};
}

}  // namespace

OpenedFile opened_file(const std::string& path, const std::string& material,
                       const std::string& preset, Progress* progress) {
  if (std::filesystem::path(path).extension() == ".toml") return {Table::read(path), "", false, ""};
  std::string assumed, modality;
  const auto file = is_state_file(path) ? nullptr : open_volume(path, {});
  if (file) modality = file->header().modality;
  Value json = {{"volume", {{"path", absolute_path(path)}}}};
  if (find_tissue_preset(material) != nullptr) {
    json["material"]["preset"] = material;
  } else if (material.empty() && file) {
    const AssumedMaterial found = assumed_material(*file, progress);
    json["material"]["preset"] = found.preset;
    assumed = found.text;
  } else if (!material.empty() && material != kUniform) {
    json["material"]["table"] = absolute_path(material);
  }
  json["view"].push_back({{"image", "live.png"}});
  if (!preset.empty()) json["view"][0]["preset"] = preset;
  return {Table(json, path), assumed, true, modality};
}

void require_within(Table& root, const Folders& folders) {
  root.admit_inputs([folders](const std::string& path) {
    folders.input(std::filesystem::absolute(path).string());
  });
}

}  // namespace supple::tools
