// STL: triangles with a normal each. Text files start with "solid"; some binary ones do, too, so
// that the length decides, and in files that were cut a byte of 0, which no text has.
#include <cstdint>
#include <cstring>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/mesh/mesh_formats.h"

namespace supple {

namespace {

// Binary: 80 bytes of text, count as uint32, then per triangle 12 floats and 2 bytes.
constexpr std::size_t kCountAt = 80;
constexpr std::size_t kFirstAt = 84;
constexpr std::size_t kTriangleBytes = 50;

std::uint64_t binary_size(const std::string& content) {
  std::uint32_t count = 0;
  std::memcpy(&count, content.data() + kCountAt, sizeof count);
  return kFirstAt + std::uint64_t(count) * kTriangleBytes;
}

void add_triangle(const std::array<Vec3d, 3>& corners, TriangleMesh& mesh) {
  const int first = int(mesh.vertices_lps_mm.size());
  mesh.vertices_lps_mm.insert(mesh.vertices_lps_mm.end(), corners.begin(), corners.end());
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Twelve floats in a row: the normal and the corners.
void add_slots(std::size_t at, const TriangleMesh& mesh, const Vec3d& normal, MeshSlots& slots) {
  const int first = int(mesh.vertices_lps_mm.size()) - 3;
  const auto slot = [&](std::size_t vector) {
    VectorSlot result;
    for (std::size_t a = 0; a < 3; ++a) {
      result[a] = {at + 12 * vector + 4 * a, 4, NumberCode::float32_little};
    }
    return result;
  };
  slots.add_normal(slot(0), normal, {first, first + 1, first + 2}, true);
  for (std::size_t corner = 1; corner <= 3; ++corner) slots.positions.push_back(slot(corner));
}

TriangleMesh read_binary(const std::string& content, MeshSlots* slots) {
  TriangleMesh mesh;
  for (std::size_t at = kFirstAt; at < content.size(); at += kTriangleBytes) {
    float values[12];
    std::memcpy(values, content.data() + at, sizeof values);
    add_triangle({Vec3d(values[3], values[4], values[5]), Vec3d(values[6], values[7], values[8]),
                  Vec3d(values[9], values[10], values[11])},
                 mesh);
    const Vec3d normal(values[0], values[1], values[2]);
    if (slots != nullptr) add_slots(at, mesh, normal, *slots);
  }
  return mesh;
}

TriangleMesh read_text(const std::string& path, const std::string& content, MeshSlots* slots) {
  TriangleMesh mesh;
  MeshWords words(path, content);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (lower_case(std::string(word)) != "solid") words.fail(word, "solid");
    words.skip_line();  // its name
    while (true) {
      word = words.next();
      if (lower_case(std::string(word)) == "endsolid") break;
      if (lower_case(std::string(word)) != "facet") words.fail(word, "facet or endsolid");
      words.expect("normal");
      std::array<VectorSlot, 4> at;
      const Vec3d normal = words.vector(at[0]);
      words.expect("outer");
      words.expect("loop");
      std::array<Vec3d, 3> corners;
      for (std::size_t n = 0; n < 3; ++n) {
        words.expect("vertex");
        corners[n] = words.vector(at[n + 1]);
      }
      words.expect("endloop");
      words.expect("endfacet");
      add_triangle(corners, mesh);
      if (slots == nullptr) continue;
      const auto& triangle = mesh.triangles.back();
      slots->add_normal(at[0], normal, {triangle.begin(), triangle.end()}, true);
      slots->positions.insert(slots->positions.end(), at.begin() + 1, at.end());
    }
    words.skip_line();
  }
  return mesh;
}

}  // namespace

TriangleMesh read_stl(const std::string& path, const std::string& content, MeshSlots* slots) {
  const bool has_count = content.size() >= kFirstAt;
  if (has_count && binary_size(content) == content.size()) return read_binary(content, slots);
  const std::size_t text = content.find_first_not_of(" \t\r\n");
  const bool is_cut = has_count && content.find('\0') != std::string::npos;
  if (!is_cut && text != std::string::npos && lower_case(content.substr(text, 5)) == "solid") {
    return read_text(path, content, slots);
  }
  throw InputError({path, "STL", std::to_string(content.size()) + " bytes",
                    has_count ? std::to_string(binary_size(content)) + " bytes by its own count"
                              : "text that starts with solid, or at least 84 bytes"});
}

}  // namespace supple
