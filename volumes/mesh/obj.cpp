// Wavefront OBJ: only vertex positions and faces matter here.
#include <cmath>

#include "volumes/mesh/mesh_formats.h"

namespace supple {

namespace {

/// The vertex of "7", "7/1" or "7/1/3", counted from 0; negative where there is none.
int vertex_of(const MeshWords& words, std::string_view reference, std::size_t vertex_count) {
  const double number = words.number(reference.substr(0, reference.find('/')));
  const double index = number < 0 ? number + double(vertex_count) : number - 1;
  if (!(index >= 0 && index < 2147483647) || index != std::floor(index)) {
    words.fail(reference, "the number of a vertex");
  }
  return int(index);
}

}  // namespace

TriangleMesh read_obj(const std::string& path, const std::string& content) {
  TriangleMesh mesh;
  MeshWords words(path, content);
  std::vector<int> polygon;
  while (words.position() < content.size()) {
    const std::string_view keyword = words.next_on_line();
    if (keyword == "v") {
      Vec3d vertex;
      for (int a = 0; a < 3; ++a) vertex[a] = words.number(words.next_on_line());
      mesh.vertices_lps_mm.push_back(vertex);
    } else if (keyword == "f") {
      polygon.clear();
      for (auto word = words.next_on_line(); !word.empty(); word = words.next_on_line()) {
        polygon.push_back(vertex_of(words, word, mesh.vertices_lps_mm.size()));
      }
      if (polygon.size() < 3) words.fail("a face of fewer than 3 vertices", "3 or more");
      add_polygon(polygon, mesh);
    }
    words.skip_line();
  }
  return mesh;
}

}  // namespace supple
