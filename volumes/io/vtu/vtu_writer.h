// Arrays of VTK's XML unstructured grids (.vtu), binary, base64 inline, one after the other into a
// file. Format: VTK File Formats, vtk.org.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "volumes/base/vec.h"
#include "volumes/io/bytes/output_file.h"

namespace supple {

class VtuWriter {
 public:
  explicit VtuWriter(const std::string& path) : m_file(path) {}

  /// Points and cells: the corners of all cells, where each cell's end among them, and VTK's number
  /// of its type.
  void write_grid(const std::vector<Vec3d>& points_lps_mm, const std::vector<std::int32_t>& corners,
                  const std::vector<std::int64_t>& ends, const std::vector<std::uint8_t>& types);
  /// Arrays of points come first, then those of cells, each section once.
  void begin(const std::string& section) { m_file.write("<" + section + ">\n"); }
  void end(const std::string& section) { m_file.write("</" + section + ">\n"); }

  void write(const std::string& name, int components, const std::vector<float>& values);
  void write(const std::string& name, int components, const std::vector<std::int32_t>& values);

  /// Ends the document and brings it to its name.
  void commit();

 private:
  template <class T>
  void write_array(const std::string& type, const std::string& name, int components,
                   const std::vector<T>& values);

  OutputFile m_file;
};

}  // namespace supple
