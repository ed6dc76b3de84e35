#include "tests/lib/bone_fixtures.h"

#include <cmath>
#include <fstream>
#include <vector>

#include "lib/material/material.h"
#include "lib/material/presets.h"
#include "volumes/io/volume_writer.h"

namespace supple::test {

namespace {

void write_volume(const std::string& path, const Vec3i& dims, const std::vector<short>& voxels,
                  const std::string& spaces) {
  std::ofstream(path + ".raw", std::ios::binary)
      .write(reinterpret_cast<const char*>(voxels.data()),
             std::streamsize(voxels.size() * sizeof(short)));
  write_text(path + ".nhdr",
             "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: " +
                 std::to_string(dims.x) + " " + std::to_string(dims.y) + " " +
                 std::to_string(dims.z) + "\nspace directions: " + spaces +
                 "\nspace origin: (0,0,0)\nendian: little\nencoding: raw\ndata file: " +
                 path.substr(path.rfind('/') + 1) + ".raw\n");
}

ChosenPart bone_in(const std::string& name, const IndexBox& box, const Vec3i& seed) {
  ChosenPart part;
  part.name = name;
  part.selection = Selection();
  part.selection->box = box;
  part.selection->density = {300, 3100};
  part.selection->piece_at = seed;
  return part;
}

}  // namespace

SessionOptions bone_options() {
  SessionOptions options;
  options.keeps_undo = true;
  options.material = parse_material(find_tissue_preset("ct-head")->table, "ct-head");
  options.material->relaxes = false;
  return options;
}

std::string write_wavy_joint(const TemporaryFolder& folder, bool has_third_bone) {
  const Vec3i dims(44, 32, 32);
  std::vector<short> voxels;
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) {
        const double right_of_joint = i - 15.5 - 4 * std::sin(j * 0.6);
        const bool is_third = i >= 33 && i < 36 && j >= 8 && j < 24 && k >= 14 && k < 17;
        const bool is_bone =
            right_of_joint < -2 || (right_of_joint > 2 && i < 28) || (has_third_bone && is_third);
        voxels.push_back(is_bone ? 800 : 60);
      }
    }
  }
  voxels[0] = -1000;
  write_volume(folder / "wavy", dims, voxels, "(1,0,0) (0,1,0) (0,0,1)");
  return folder / "wavy.nhdr";
}

Step wavy_drag(const Vec3d& by_mm) {
  Step request;
  request.rigid.joint_mm = 8;
  request.rigid.parts = {bone_in("m", {{0, 0, 0}, {30, 31, 31}}, {24, 16, 16})};
  request.drags.push_back({Region(Vec3i(24, 16, 16)), by_mm});
  request.fix = {{{3, 16, 16}, {3, 16, 16}}, {{43, 0, 0}, {43, 31, 31}}};
  return request;
}

std::string write_jaw_crop(const std::string& raw, const TemporaryFolder& folder) {
  const Vec3i lo(84, 150, 0), dims(89, 91, 41);
  std::ifstream file(raw, std::ios::binary);
  std::vector<short> voxels(std::size_t(dims.x) * dims.y * dims.z);
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      file.seekg(2 * ((std::streamoff(lo.z + k) * 256 + lo.y + j) * 256 + lo.x));
      file.read(reinterpret_cast<char*>(&voxels[(std::size_t(k) * dims.y + j) * dims.x]),
                2 * dims.x);
    }
  }
  write_volume(folder / "jaw", dims, voxels, "(0.957031,0,0) (0,-0.957031,0) (0,0,1.5)");
  return folder / "jaw.nhdr";
}

Step jaw_step() {
  Step request;
  request.rigid.joint_mm = 20;
  request.rigid.parts = {bone_in("jaw", {{4, 4, 0}, {84, 85, 20}}, {44, 61, 12})};
  request.fix = {{{0, 0, 39}, {88, 90, 40}}};
  return request;
}

Step jaw_drag(const Vec3d& by_mm) {
  Step request;
  request.drags.push_back({Region(Vec3i(44, 61, 12)), by_mm});
  return request;
}

}  // namespace supple::test
