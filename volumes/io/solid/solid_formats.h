// The formats behind write_solid_mesh() and read_solid_mesh(), and what they share.
#pragma once

#include <charconv>
#include <string>
#include <vector>

#include "volumes/base/progress.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/solid/solid_mesh.h"

namespace supple {

void write_solid_vtu(const std::string& path, const SolidMesh& mesh, Progress* progress);
void write_solid_inp(const std::string& path, const SolidMesh& mesh, Progress* progress);
void write_solid_feb(const std::string& path, const SolidMesh& mesh, Progress* progress);
void write_solid_msh(const std::string& path, const SolidMesh& mesh, Progress* progress);

SolidMesh read_solid_vtu(const std::string& path);
SolidMesh read_solid_inp(const std::string& path);

/// Text on its way to a file, in pieces of about a megabyte.
class SolidText {
 public:
  explicit SolidText(const std::string& path) : m_file(path) {}

  SolidText& operator<<(const std::string& text) {
    m_text += text;
    return flush_if_long();
  }
  SolidText& operator<<(const char* text) {
    m_text += text;
    return flush_if_long();
  }
  SolidText& operator<<(std::int64_t number) {
    char digits[24];
    m_text.append(digits, std::to_chars(digits, digits + sizeof digits, number).ptr);
    return *this;
  }
  SolidText& operator<<(std::int32_t number) { return *this << std::int64_t(number); }
  SolidText& operator<<(std::size_t number) { return *this << std::int64_t(number); }
  /// Writes 13 significant digits: at most 20 characters, which is all that CalculiX reads.
  SolidText& operator<<(double number) {
    char digits[40];
    const auto end =
        std::to_chars(digits, digits + sizeof digits, number, std::chars_format::general, 13);
    m_text.append(digits, end.ptr);
    return *this;
  }
  /// Writes numbers of a row, each plus `first`.
  template <class Row>
  SolidText& row(const Row& numbers, const char* between, std::int32_t first) {
    for (std::size_t n = 0; n < numbers.size(); ++n) {
      if (n > 0) m_text += between;
      *this << numbers[n] + first;
    }
    return *this;
  }
  SolidText& row(const Vec3d& v, const char* between) {
    return *this << v.x << between << v.y << between << v.z;
  }
  void commit() {
    m_file.write(m_text);
    m_file.close();
    m_file.commit();
  }

 private:
  SolidText& flush_if_long() {
    if (m_text.size() < (std::size_t(1) << 20)) return *this;
    m_file.write(m_text);
    m_text.clear();
    return *this;
  }

  OutputFile m_file;
  std::string m_text;
};

/// Elements of one region and one material; -1: of none.
struct SolidGroup {
  std::int32_t region, material;
  std::vector<std::size_t> tets, hexes;  // places in the mesh's lists
};
/// The groups of a mesh in the order of region and material.
std::vector<SolidGroup> solid_groups(const SolidMesh& mesh);

/// The name of a region: "region_N".
std::string region_name(std::int32_t region);

/// The name with letters, digits and '_' alone.
std::string word_of(const std::string& name);

}  // namespace supple
