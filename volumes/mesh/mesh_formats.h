// The readers behind read_mesh, one per format. They throw InputError for every fault of the
// content but indices and coordinates, which read_mesh checks for all.
#pragma once

#include <string>
#include <string_view>

#include "volumes/mesh/triangle_mesh.h"

namespace supple {

/// Words of a text with the line they stand in; errors name file and line.
class MeshWords {
 public:
  MeshWords(const std::string& path, std::string_view text) : m_path(path), m_text(text) {}

  /// The next word; empty at the end of the text.
  std::string_view next();
  /// The next word of this line; empty at its end.
  std::string_view next_on_line();
  void skip_line();

  /// The next word must be that; lower case.
  void expect(std::string_view word);
  double number(std::string_view word) const;
  double number() { return number(next()); }
  Vec3d vector();

  /// Offset of the first byte that was not taken.
  std::size_t position() const { return m_position; }
  [[noreturn]] void fail(std::string_view found, const std::string& expected) const;

 private:
  const std::string& m_path;
  std::string_view m_text;
  std::size_t m_position = 0;
  int m_line = 1;
};

/// A fan of triangles around the polygon's first vertex; fewer than three vertices make none.
void add_polygon(const std::vector<int>& polygon, TriangleMesh& mesh);

/// en.wikipedia.org/wiki/STL_(file_format). Vertices are not merged.
TriangleMesh read_stl(const std::string& path, const std::string& content);
/// G. Turk, The PLY polygon file format, 1994.
TriangleMesh read_ply(const std::string& path, const std::string& content);
/// Wavefront OBJ: lines `v` and `f`; negative indices count from the last vertex.
TriangleMesh read_obj(const std::string& path, const std::string& content);

}  // namespace supple
