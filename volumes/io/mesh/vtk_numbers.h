// The numbers of a legacy VTK file: text, or big-endian behind the line that announces them.
#pragma once

#include "volumes/io/mesh/mesh_formats.h"

namespace supple::vtk {

enum class VtkKind { bit, integer, real, string };

struct VtkType {
  VtkKind kind;
  std::size_t bytes;
};

constexpr VtkType kByte = {VtkKind::integer, 1};
constexpr VtkType kInt = {VtkKind::integer, 4};
constexpr VtkType kText = {VtkKind::real, 4};

class VtkNumbers {
 public:
  VtkNumbers(const std::string& content, MeshWords& words) : m_content(content), m_words(words) {}

  void set_binary(bool is_binary) { m_is_binary = is_binary; }
  bool is_binary() const { return m_is_binary; }

  /// The next word of the line.
  VtkType read_type();
  /// Throws unless the file can hold that many numbers; as text one takes two bytes.
  void require(std::size_t count, VtkType type);
  /// `slot`, where given, receives where it stands.
  double read_number(VtkType type, NumberSlot* slot = nullptr);
  Vec3d read_vector(VtkType type, VectorSlot& slot);
  /// Passes over that many values of any type.
  void skip(std::size_t count, VtkType type);

 private:
  void skip_strings(std::size_t count);

  const std::string& m_content;
  MeshWords& m_words;
  bool m_is_binary = false;
};

}  // namespace supple::vtk
