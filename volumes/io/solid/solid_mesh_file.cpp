#include "volumes/io/solid/solid_mesh_file.h"

#include <cctype>
#include <filesystem>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/solid/solid_formats.h"

namespace supple {

namespace {

struct SolidFormat {
  const char* extension;
  void (*write)(const std::string& path, const SolidMesh& mesh, Progress* progress);
  SolidMesh (*read)(const std::string& path);  // null: only written
};
constexpr SolidFormat kSolidFormats[] = {{".vtu", write_solid_vtu, read_solid_vtu},
                                         {".inp", write_solid_inp, read_solid_inp},
                                         {".feb", write_solid_feb, nullptr},
                                         {".msh", write_solid_msh, nullptr}};

const SolidFormat* format_of(const std::string& path) {
  const std::string extension = lower_case(std::filesystem::path(path).extension().string());
  for (const SolidFormat& format : kSolidFormats) {
    if (extension == format.extension) return &format;
  }
  return nullptr;
}

}  // namespace

bool is_solid_mesh_name(const std::string& path) {
  return format_of(path) != nullptr;
}

void write_solid_mesh(const std::string& path, const SolidMesh& mesh, Progress* progress) {
  const SolidFormat* format = format_of(path);
  if (format == nullptr) {
    throw InputError({path, "extension", std::filesystem::path(path).extension().string(),
                      ".vtu, .inp, .feb or .msh"});
  }
  stage(progress, "writing");
  format->write(path, mesh, progress);
}

SolidMesh read_solid_mesh(const std::string& path) {
  const SolidFormat* format = format_of(path);
  if (format == nullptr || format->read == nullptr) {
    throw InputError(
        {path, "extension", std::filesystem::path(path).extension().string(), ".vtu or .inp"});
  }
  SolidMesh mesh = format->read(path);
  if (mesh.element_count() == 0) {
    throw InputError({path, "elements", "none that is solid", "tetrahedra or hexahedra"});
  }
  return mesh;
}

std::vector<SolidGroup> solid_groups(const SolidMesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, SolidGroup> groups;
  for (std::size_t e = 0; e < mesh.element_count(); ++e) {
    const std::int32_t region = mesh.region_of.empty() ? 1 : mesh.region_of[e];
    const std::int32_t material = mesh.material_of.empty() ? -1 : mesh.material_of[e];
    SolidGroup& group = groups[{region, material}];
    group.region = region;
    group.material = material;
    const bool is_tet = e < mesh.tets.size();
    (is_tet ? group.tets : group.hexes).push_back(is_tet ? e : e - mesh.tets.size());
  }
  std::vector<SolidGroup> list;
  for (auto& [key, group] : groups) list.push_back(std::move(group));
  return list;
}

std::string region_name(std::int32_t region) {
  return "region_" + std::to_string(region);
}

std::string word_of(const std::string& name) {
  std::string word = name;
  for (char& c : word) {
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  }
  return word;
}

}  // namespace supple
