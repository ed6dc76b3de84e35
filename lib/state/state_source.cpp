#include "lib/state/state_source.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/parallel.h"
#include "volumes/base/sha256.h"
#include "volumes/base/text.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDigits = 64, kShownDigits = 16;

/// A path from the root. Links on the way are followed; the last one is not, as collections of data
/// may name their files by links.
fs::path from_root(const std::string& path) {
  fs::path whole = fs::absolute(path);
  if (whole.filename().empty()) whole = whole.parent_path();  // a slash at the end
  if (whole.filename() == "." || whole.filename() == "..") return fs::weakly_canonical(whole);
  return fs::weakly_canonical(whole.parent_path()) / whole.filename();
}

fs::path folder_of(const std::string& state_path) {
  return from_root(state_path).parent_path();
}

/// Returns the part behind the name of a file, such as a data set in it.
std::string within_file(const std::string& path) {
  return path.substr(file_part(path).size());
}

std::string relative_path(const std::string& path, const std::string& state_path) {
  const fs::path relative = from_root(file_part(path)).lexically_relative(folder_of(state_path));
  return relative.generic_string() + within_file(path);
}

/// The path from the folder of the state, as short as the one that was given for the state.
std::string path_from(const std::string& state_path, const std::string& relative) {
  const std::string path = (fs::path(state_path).parent_path() / relative).string();
  const fs::path file = file_part(path);
  // Names before ".." may be links, so that the shortest path leads elsewhere.
  std::error_code ignored;
  const fs::path shortest = file.lexically_normal();
  return (fs::equivalent(shortest, file, ignored) ? shortest : file).string() + within_file(path);
}

[[noreturn]] void refuse(const std::string& state_path, const StateSource& source,
                         const std::string& found, const std::string& expected) {
  throw InputError({state_path, "source " + source.path, found, expected});
}

std::string shown_digest(const std::string& sha256) {
  return "SHA-256 " + sha256.substr(0, kShownDigits) + "…";
}

/// Returns the first difference of two geometries.
std::pair<std::string, std::string> differing(const Geometry& found, const Geometry& expected) {
  const auto both = [](const std::string& what, const auto& a, const auto& b) {
    return std::pair<std::string, std::string>(what + " " + to_text(a), what + " " + to_text(b));
  };
  if (found.dims() != expected.dims()) return both("voxels", found.dims(), expected.dims());
  if (found.spacing_mm() != expected.spacing_mm()) {
    return both("spacing", found.spacing_mm(), expected.spacing_mm());
  }
  if (found.origin_lps_mm() != expected.origin_lps_mm()) {
    return both("origin", found.origin_lps_mm(), expected.origin_lps_mm());
  }
  return {"another direction of its axes", "that of the state"};
}

/// A bound within the numbers of JSON.
double finite(double bound) {
  constexpr double kMost = std::numeric_limits<double>::max();
  return std::isfinite(bound) ? bound : std::copysign(kMost, bound);
}

std::optional<int> whole_of(const Value& json, const char* name) {
  if (!json.contains(name)) return std::nullopt;
  return int(json.at(name).whole());
}

}  // namespace

std::string digest_of(const DensityGrid& density, const BrickTopology& elements) {
  constexpr std::size_t kBricksOfPart = 1024;
  const BrickTopology& bricks = density.bricks();
  std::vector<std::string> parts((bricks.brick_count() + kBricksOfPart - 1) / kBricksOfPart);
  parallel_for(parts.size(), [&](std::size_t part) {
    Sha256 hash;
    const std::size_t end = std::min((part + 1) * kBricksOfPart, bricks.brick_count());
    for (std::size_t b = part * kBricksOfPart; b < end; ++b) {
      const Vec3i& origin = bricks.origin(b);
      const std::int32_t in_elements = elements.find(origin);
      const BrickMask mask =
          in_elements < 0 ? BrickMask{} : elements.mask(std::size_t(in_elements));
      hash.update(&origin, sizeof origin);
      hash.update(bricks.mask(b).data(), sizeof(BrickMask));
      hash.update(mask.data(), sizeof mask);
      hash.update(density.values(b), kBrickVoxels * sizeof(float));
    }
    parts[part] = hash.hex();
  });
  Sha256 all;
  const float background = density.background();
  all.update(&background, sizeof background);
  for (const std::string& part : parts) all.update(part.data(), part.size());
  return all.hex();
}

std::shared_ptr<const StateSource> make_source(const VolumeHeader& header, const ReadOptions& read,
                                               double lo, double hi, int components,
                                               const DensityGrid& density,
                                               const BrickTopology& elements) {
  const bool is_series = header.format == "dicom" && fs::is_directory(header.path);
  const std::string path =
      is_series && !header.data_files.empty() ? header.data_files.front() : header.path;
  ReadOptions kept = read;
  kept.frames_found = nullptr;
  return std::make_shared<const StateSource>(
      StateSource{path, kept, lo, hi, components, digest_of(density, elements), density, elements});
}

std::string source_to_json(const StateSource& source, const std::string& state_path) {
  Value json = {{"path", relative_path(source.path, state_path)}};
  if (!source.read.raw.empty()) json["raw"] = source.read.raw;
  if (source.read.frame) json["frame"] = *source.read.frame;
  if (source.read.channel) json["channel"] = *source.read.channel;
  if (source.read.spacing_mm) json["spacing"] = *source.read.spacing_mm;
  json["active"] = std::array<double, 2>{finite(source.lo), finite(source.hi)};
  json["components"] = source.components;
  json["sha256"] = source.sha256;
  return json_text(json);
}

StateSource source_from_json(const std::string& text, const std::string& state_path) {
  try {
    const Value json = parse_json(text);
    StateSource source;
    source.path = path_from(state_path, json.at("path").text());
    if (json.contains("raw")) source.read.raw = json.at("raw").text();
    source.read.frame = whole_of(json, "frame");
    source.read.channel = whole_of(json, "channel");
    if (json.contains("spacing")) {
      const Value& spacing = json.at("spacing");
      source.read.spacing_mm =
          Vec3d(spacing.at(0).number(), spacing.at(1).number(), spacing.at(2).number());
    }
    source.lo = json.at("active").at(0).number();
    source.hi = json.at("active").at(1).number();
    source.components = int(json.at("components").whole());
    source.sha256 = json.at("sha256").text();
    if (source.sha256.size() != kDigits || source.components < 0) throw std::out_of_range("");
    return source;
  } catch (const std::exception&) {
    throw InputError(
        {state_path, "source", text.substr(0, kDigits), "path, densities and digest of a volume"});
  }
}

void open_source(StateSource& source, const Geometry& geometry, const std::string& state_path,
                 Progress* progress) {
  try {
    const auto file = open_volume(source.path, source.read, progress);
    if (!(file->header().geometry == geometry)) {
      const auto [found, expected] = differing(file->header().geometry, geometry);
      refuse(state_path, source, found, expected + ", as in the state");
    }
    ElementVolume loaded =
        load_elements(*file, source.lo, source.hi, source.components, 2, progress);
    source.density = std::move(loaded.volume.density);
    source.elements = std::move(loaded.elements);
  } catch (const InputError& error) {
    if (error.problem().file == state_path) throw;
    const Problem& problem = error.problem();
    refuse(state_path, source,
           problem.field.empty() ? problem.found : problem.field + " " + problem.found,
           "the volume to which the state refers");
  }
  stage(progress, "comparing the source");
  const std::string digest = digest_of(source.density, source.elements);
  if (digest != source.sha256) {
    source.density = {};
    source.elements = {};
    refuse(state_path, source, "densities with " + shown_digest(digest),
           shown_digest(source.sha256) + ", as the state was made of");
  }
}

}  // namespace supple
