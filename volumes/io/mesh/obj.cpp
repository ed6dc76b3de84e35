// Wavefront OBJ: only vertex positions, normals, faces and lines matter here.
#include <algorithm>
#include <cmath>

#include "volumes/io/mesh/mesh_formats.h"

namespace supple {

namespace {

/// "7" of "7", "7/1" or "7/1/3", counted from 0; negative indices count from the last one.
int index_of(const MeshWords& words, std::string_view reference, std::string_view number,
             std::size_t count) {
  const double value = words.number(number);
  const double index = value < 0 ? value + double(count) : value - 1;
  if (!(index >= 0 && index < 2147483647) || index != std::floor(index)) {
    words.fail(reference, "the number of a vertex");
  }
  return int(index);
}

/// "3" of "7/1/3" or "7//3"; empty where there is no normal.
std::string_view normal_of(std::string_view reference) {
  const std::size_t first = reference.find('/');
  const std::size_t second =
      first == std::string_view::npos ? first : reference.find('/', first + 1);
  return second == std::string_view::npos ? std::string_view() : reference.substr(second + 1);
}

/// Normals of a file and which vertices they are used with.
struct Normals {
  struct Use {
    int normal, vertex;
    bool operator<(const Use& other) const {
      return normal != other.normal ? normal < other.normal : vertex < other.vertex;
    }
    bool operator==(const Use& other) const {
      return normal == other.normal && vertex == other.vertex;
    }
  };
  std::vector<VectorSlot> slots;
  std::vector<Vec3d> directions;
  std::vector<Use> uses;

  void add_to(MeshSlots& all) {
    std::sort(uses.begin(), uses.end());
    uses.erase(std::unique(uses.begin(), uses.end()), uses.end());
    std::size_t use = 0;
    for (std::size_t n = 0; n < slots.size(); ++n) {
      std::vector<int> corners;
      for (; use < uses.size() && uses[use].normal == int(n); ++use) {
        corners.push_back(uses[use].vertex);
      }
      all.add_normal(slots[n], directions[n], corners);
    }
  }
};

/// The rest of a line with three numbers.
Vec3d read_vector(MeshWords& words, VectorSlot& slot) {
  Vec3d v;
  for (int a = 0; a < 3; ++a) {
    const std::string_view word = words.next_on_line();
    v[a] = words.number(word);
    slot[std::size_t(a)] = words.slot_of(word);
  }
  return v;
}

}  // namespace

TriangleMesh read_obj(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines) {
  TriangleMesh mesh;
  MeshWords words(path, content);
  Normals normals;
  std::vector<int> polygon;
  VectorSlot slot;
  while (words.position() < content.size()) {
    const std::string_view keyword = words.next_on_line();
    if (keyword == "v") {
      mesh.vertices_lps_mm.push_back(read_vector(words, slot));
      if (slots != nullptr) slots->positions.push_back(slot);
    } else if (keyword == "vn" && slots != nullptr) {
      normals.directions.push_back(read_vector(words, slot));
      normals.slots.push_back(slot);
    } else if (keyword == "f") {
      polygon.clear();
      for (auto word = words.next_on_line(); !word.empty() && word[0] != '#';
           word = words.next_on_line()) {
        polygon.push_back(
            index_of(words, word, word.substr(0, word.find('/')), mesh.vertices_lps_mm.size()));
        const std::string_view normal = normal_of(word);
        if (slots == nullptr || normal.empty()) continue;
        normals.uses.push_back(
            {index_of(words, word, normal, normals.slots.size()), polygon.back()});
      }
      if (polygon.size() < 3) words.fail("a face of fewer than 3 vertices", "3 or more");
      add_polygon(polygon, mesh);
    } else if (keyword == "l" && lines != nullptr) {
      polygon.clear();
      for (auto word = words.next_on_line(); !word.empty() && word[0] != '#';
           word = words.next_on_line()) {
        polygon.push_back(
            index_of(words, word, word.substr(0, word.find('/')), mesh.vertices_lps_mm.size()));
      }
      if (polygon.size() < 2) words.fail("a line of fewer than 2 vertices", "2 or more");
      add_polyline(polygon, *lines);
    }
    words.skip_line();
  }
  if (slots != nullptr) normals.add_to(*slots);
  return mesh;
}

}  // namespace supple
