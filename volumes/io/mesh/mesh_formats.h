// The readers behind read_mesh, one per format. They throw InputError for every fault of the
// content but indices and coordinates, which read_mesh checks for all.
#pragma once

#include <string>
#include <string_view>

#include "volumes/io/mesh/mesh_contents.h"
#include "volumes/io/mesh/mesh_slots.h"
#include "volumes/io/mesh/triangle_mesh.h"

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

  /// Takes the next word, which must be `word`; lower case.
  void expect(std::string_view word);
  double number(std::string_view word) const;
  double number() { return number(next()); }
  Vec3d vector();
  /// A whole number from 0 to 2^31 - 2.
  std::int64_t count(std::string_view word) const;

  /// The place in this text of a word taken from it.
  NumberSlot slot_of(std::string_view word, NumberCode code = NumberCode::text) const {
    return {std::size_t(word.data() - m_text.data()), std::uint32_t(word.size()), code};
  }
  /// Three numbers of this text, and where they stand.
  Vec3d vector(VectorSlot& slots);
  /// Passes over binary data.
  void skip_bytes(std::size_t count) { m_position += count; }

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

/// Lines of a network, each by its ends.
using MeshLines = std::vector<std::array<int, 2>>;

/// The lines of a polyline.
void add_polyline(const std::vector<int>& polyline, MeshLines& lines);

/// The readers; `slots`, where given, receives where coordinates and normals stand, `lines` the
/// lines. en.wikipedia.org/wiki/STL_(file_format). Vertices are not merged.
TriangleMesh read_stl(const std::string& path, const std::string& content, MeshSlots* slots);
/// G. Turk, The PLY polygon file format, 1994.
TriangleMesh read_ply(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines);
/// Wavefront OBJ: lines `v`, `vn`, `f` and `l`; negative indices count from the last vertex.
TriangleMesh read_obj(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines);
/// Legacy VTK, versions 1 to 5, text or binary: polygonal data and unstructured grids, whose flat
/// cells are the surface, and structured grids, which have none.
TriangleMesh read_vtk(const std::string& path, const std::string& content, MeshSlots* slots,
                      MeshLines* lines);

/// Counts the cells of a legacy VTK file, and lists its arrays.
void add_vtk_contents(const std::string& path, const std::string& content, MeshContents& contents);

/// The whole file. Throws InputError above 16 GB.
std::string read_mesh_content(const std::string& path);
/// Parses by the extension, indices and coordinates checked, LPS; there may be no triangle.
TriangleMesh parse_mesh(const std::string& path, const std::string& content, MeshSlots* slots,
                        MeshLines* lines = nullptr);
/// True if the head of the file says that its frame is RAS.
bool says_ras(const std::string& content);

}  // namespace supple
