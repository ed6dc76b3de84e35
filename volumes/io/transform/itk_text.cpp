// ITK's text transforms (.tfm, .txt): lines "Transform:", "Parameters:" and "FixedParameters:".
// Source: itk::TxtTransformIO, and the fixed parameters of itk::DisplacementFieldTransform and
// itk::BSplineTransform: size, origin, spacing, direction row by row.
#include <algorithm>

#include "volumes/base/error.h"
#include "volumes/io/transform/linear_transform.h"
#include "volumes/io/transform/text_transform.h"

namespace supple {

namespace {

constexpr std::size_t kMaxTransforms = 64;

struct Record {
  HeaderField type, parameters, fixed;
};

std::vector<Record> records_of(const std::string& path, const std::string& text) {
  std::vector<Record> records;
  LineReader lines(text);
  std::string line;
  for (int number = 1; lines.next(line); ++number) {
    line = trimmed(line);
    if (line.empty() || line[0] == '#') continue;
    const std::string place = path + ":" + std::to_string(number);
    const std::size_t colon = line.find(':');
    const std::string name = line.substr(0, colon);
    HeaderField field{place, name,
                      colon == std::string::npos ? "" : trimmed(line.substr(colon + 1))};
    if (name == "Transform") {
      if (records.size() == kMaxTransforms) field.fail("at most 64 transforms");
      records.push_back({field, {place, "Parameters", ""}, {place, "FixedParameters", ""}});
    } else if (!records.empty() && name == "Parameters") {
      records.back().parameters = std::move(field);
    } else if (!records.empty() && name == "FixedParameters") {
      records.back().fixed = std::move(field);
    } else {
      HeaderField{place, "line", line}.fail("Transform, Parameters or FixedParameters");
    }
  }
  if (records.empty()) throw InputError({path, "Transform", "none", "one at least"});
  return records;
}

/// "BSplineTransform" of "BSplineTransform_double_3_3", and what follows the dimensions.
std::string name_of(const HeaderField& type, std::string& rest) {
  for (const char* numbers : {"_double_3_3", "_float_3_3"}) {
    const std::size_t at = type.text.find(numbers);
    if (at == std::string::npos) continue;
    rest = type.text.substr(at + std::string(numbers).size());
    return type.text.substr(0, at);
  }
  type.fail("a transform from 3 to 3 dimensions");
}

Geometry grid_of(const Record& record) {
  const std::vector<double> n = finite_numbers(record.fixed, 18);
  return transform_grid(record.fixed, {n[0], n[1], n[2]}, {n[3], n[4], n[5]}, {n[6], n[7], n[8]},
                        {Vec3d(n[9], n[12], n[15]), {n[10], n[13], n[16]}, {n[11], n[14], n[17]}});
}

/// The chain, and what the grid of its only field becomes before the maps behind the field.
class ChainReader {
 public:
  TransformChain read(const std::vector<Record>& records) {
    std::string rest;
    const bool is_composite = name_of(records[0].type, rest) == "CompositeTransform";
    if (records.size() > 1 && !is_composite) {
      records[1].type.fail("one transform, or a CompositeTransform first");
    }
    // The last one of a composite is applied first.
    for (std::size_t n = records.size(); n-- > std::size_t(is_composite);) add(records[n]);
    if (m_chain.links.empty()) records[0].type.fail("transforms behind it");
    if (m_fields == 1 && m_splines == 0) m_chain.grid = m_grid;
    return std::move(m_chain);
  }

 private:
  void add(const Record& record) {
    std::string rest;
    const std::string name = name_of(record.type, rest);
    if (name == "DisplacementFieldTransform" ||
        name == "GaussianSmoothingOnUpdateDisplacementFieldTransform") {
      ++m_fields;
      const Geometry grid = grid_of(record);
      m_grid = moved(grid);
      m_chain.links.push_back({field_map(grid, vectors_of(grid, record.parameters, true))});
    } else if (name == "BSplineTransform") {
      ++m_splines;
      const int order = rest.empty() ? 3 : rest == "_1" ? 1 : rest == "_2" ? 2 : 0;
      if (order == 0) record.type.fail("order 1, 2 or 3");
      const Geometry grid = grid_of(record);
      m_chain.links.push_back(
          {bspline_map(grid, order, vectors_of(grid, record.parameters, false))});
    } else {
      const AffineMap map = linear_map(
          {record.type.file, "", name, numbers_of(record.fixed), numbers_of(record.parameters)});
      m_before = composed(map, m_before);
      m_chain.links.push_back({affine_map(map)});
    }
  }

  static std::vector<double> numbers_of(const HeaderField& field) {
    if (field.text.empty()) return {};
    return finite_numbers(field, field.numbers().size());
  }

  /// The grid whose points the maps so far put on those of `grid`.
  Geometry moved(const Geometry& grid) const {
    std::array<Vec3d, 3> axes = grid.axes_mm();
    for (Vec3d& axis : axes) axis = m_before.index_vector_from_world(axis);
    return {grid.dims(), m_before.index_from_world(grid.origin_lps_mm()), axes};
  }

  TransformChain m_chain;
  AffineMap m_before;
  Geometry m_grid;
  int m_fields = 0, m_splines = 0;
};

}  // namespace

TransformChain read_itk_transform(const std::string& path) {
  return ChainReader().read(records_of(path, transform_text(path)));
}

}  // namespace supple
