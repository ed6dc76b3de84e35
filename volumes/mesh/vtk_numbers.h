// The numbers of a legacy VTK file: text, or big-endian behind the line that announces them.
#pragma once

#include "volumes/mesh/mesh_formats.h"

namespace supple::vtk {

enum class Kind { bit, integer, real, string };

struct Type {
  Kind kind;
  std::size_t bytes;
};

constexpr Type kByte = {Kind::integer, 1};
constexpr Type kInt = {Kind::integer, 4};
constexpr Type kText = {Kind::real, 4};

class VtkNumbers {
 public:
  VtkNumbers(const std::string& content, MeshWords& words) : m_content(content), m_words(words) {}

  void set_binary(bool is_binary) { m_is_binary = is_binary; }
  bool is_binary() const { return m_is_binary; }

  /// The next word of the line.
  Type read_type();
  /// Throws unless the file can hold that many numbers; as text one takes two bytes.
  void require(std::size_t count, Type type);
  /// `slot`, where given, receives where it stands.
  double read_number(Type type, NumberSlot* slot = nullptr);
  Vec3d read_vector(Type type, VectorSlot& slot);
  /// Past that many values of any type.
  void skip(std::size_t count, Type type);

 private:
  void skip_strings(std::size_t count);

  const std::string& m_content;
  MeshWords& m_words;
  bool m_is_binary = false;
};

}  // namespace supple::vtk
