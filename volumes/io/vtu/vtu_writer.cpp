#include "volumes/io/vtu/vtu_writer.h"

#include <cstring>

#include "volumes/base/text.h"

namespace supple {

namespace {

/// A length in bytes and the bytes, as one run of base64.
std::string counted_base64(const void* data, std::size_t size) {
  const std::uint64_t length = size;
  std::string bytes(sizeof length + size, '\0');
  std::memcpy(&bytes[0], &length, sizeof length);
  if (size > 0) std::memcpy(&bytes[sizeof length], data, size);
  return base64_of(bytes);
}

}  // namespace

template <class T>
void VtuWriter::write_array(const std::string& type, const std::string& name, int components,
                            const std::vector<T>& values) {
  m_file.write("<DataArray type=\"" + type + "\" Name=\"" + name + "\" NumberOfComponents=\"" +
               std::to_string(components) + "\" format=\"binary\">\n" +
               counted_base64(values.data(), values.size() * sizeof(T)) + "\n</DataArray>\n");
}

void VtuWriter::write_grid(const std::vector<Vec3d>& points_lps_mm,
                           const std::vector<std::int32_t>& corners,
                           const std::vector<std::int64_t>& ends,
                           const std::vector<std::uint8_t>& types) {
  m_file.write(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece "
      "NumberOfPoints=\"" +
      std::to_string(points_lps_mm.size()) + "\" NumberOfCells=\"" + std::to_string(ends.size()) +
      "\">\n<Points>\n");
  write_array("Float64", "Points", 3, points_lps_mm);
  m_file.write("</Points>\n<Cells>\n");
  write_array("Int32", "connectivity", 1, corners);
  write_array("Int64", "offsets", 1, ends);
  write_array("UInt8", "types", 1, types);
  m_file.write("</Cells>\n");
}

void VtuWriter::write(const std::string& name, int components, const std::vector<float>& values) {
  write_array("Float32", name, components, values);
}

void VtuWriter::write(const std::string& name, int components,
                      const std::vector<std::int32_t>& values) {
  write_array("Int32", name, components, values);
}

void VtuWriter::commit() {
  m_file.write("</Piece>\n</UnstructuredGrid>\n</VTKFile>\n");
  m_file.close();
  m_file.commit();
}

}  // namespace supple
