// Transform parameter files of elastix: lines "(Key value value ...)", strings in quotes.
// Source: elastix' manual, chapter 6, and its files: directions are column by column, and a point
// goes through the initial transform first.
#include <filesystem>
#include <map>

#include "volumes/base/error.h"
#include "volumes/io/transform/linear_transform.h"
#include "volumes/io/transform/text_transform.h"

namespace supple {

namespace {

constexpr int kMaxInitial = 16;  // transforms in a row

class Parameters {
 public:
  explicit Parameters(const std::string& path) : m_path(path) {
    const std::string text = transform_text(path);
    LineReader lines(text);
    std::string line;
    for (int number = 1; lines.next(line); ++number) {
      line = trimmed(line);
      if (line.empty() || line.rfind("//", 0) == 0) continue;
      const std::size_t name_end = line.find(' '), end = line.rfind(')');
      if (line[0] != '(' || name_end == std::string::npos || end == std::string::npos ||
          end < name_end) {
        HeaderField{path + ":" + std::to_string(number), "line", line}.fail("(Key values)");
      }
      m_values[line.substr(1, name_end - 1)] = trimmed(line.substr(name_end, end - name_end));
    }
  }

  bool has(const std::string& key) const { return m_values.count(key) != 0; }

  HeaderField field(const std::string& key) const {
    const auto found = m_values.find(key);
    return {m_path, key, found == m_values.end() ? "" : found->second};
  }

  /// The word of a key without its quotes.
  HeaderField word(const std::string& key, const std::string& fallback = "") const {
    HeaderField found = field(key);
    if (!has(key)) found.text = fallback;
    if (found.text.size() > 1 && found.text.front() == '"' && found.text.back() == '"') {
      found.text = found.text.substr(1, found.text.size() - 2);
    }
    return found;
  }

  Vec3d vector(const std::string& key) const {
    const std::vector<double> numbers = finite_numbers(field(key), 3);
    return {numbers[0], numbers[1], numbers[2]};
  }

  /// The grid of the keys that begin with `prefix`.
  Geometry grid(const std::string& prefix) const {
    const std::vector<double> columns = finite_numbers(field(prefix + "Direction"), 9);
    const auto column = [&](std::size_t n) {
      return Vec3d(columns[3 * n], columns[3 * n + 1], columns[3 * n + 2]);
    };
    const std::array<Vec3d, 3> direction = {column(0), column(1), column(2)};
    const Vec3d spacing = vector(prefix + "Spacing"), first = vector(prefix + "Index");
    Vec3d origin = vector(prefix + "Origin");
    for (int a = 0; a < 3; ++a) origin += direction[std::size_t(a)] * (first[a] * spacing[a]);
    return transform_grid(field(prefix + "Size"), vector(prefix + "Size"), origin, spacing,
                          direction);
  }

 private:
  std::string m_path;
  std::map<std::string, std::string> m_values;
};

void require(const HeaderField& word, const std::string& expected) {
  if (word.text != expected) word.fail(expected);
}

std::unique_ptr<PointMap> spline_of(const Parameters& file) {
  require(file.word("UseCyclicTransform", "false"), "false");
  const HeaderField order = file.word("BSplineTransformSplineOrder", "3");
  const std::int64_t value = order.integer();
  if (value < 1 || value > 3) order.fail("1, 2 or 3");
  const Geometry grid = file.grid("Grid");
  return bspline_map(grid, int(value), vectors_of(grid, file.field("TransformParameters"), false));
}

std::unique_ptr<PointMap> map_of(const Parameters& file) {
  const HeaderField type = file.word("Transform");
  require(file.word("FixedImageDimension"), "3");
  require(file.word("MovingImageDimension"), "3");
  require(file.word("UseBinaryFormatForTransformationParameters", "false"), "false");
  const std::string& name = type.text;
  if (name == "BSplineTransform" || name == "RecursiveBSplineTransform") return spline_of(file);
  static const std::map<std::string, std::string> kItkNames = {
      {"TranslationTransform", "TranslationTransform"},
      {"EulerTransform", "Euler3DTransform"},
      {"SimilarityTransform", "Similarity3DTransform"},
      {"AffineTransform", "AffineTransform"}};
  const auto known = kItkNames.find(name);
  if (known == kItkNames.end()) {
    type.fail(
        "TranslationTransform, EulerTransform, SimilarityTransform, AffineTransform or "
        "BSplineTransform");
  }
  ItkTransform transform{type.file, "", known->second, {}, {}};
  const HeaderField parameters = file.field("TransformParameters");
  transform.parameters = finite_numbers(parameters, parameters.numbers().size());
  if (name != "TranslationTransform") {
    const Vec3d centre = file.vector("CenterOfRotationPoint");
    const bool is_zyx = file.word("ComputeZYX", "false").text == "true";
    transform.fixed = {centre.x, centre.y, centre.z, double(is_zyx)};
  }
  return affine_map(linear_map(transform));
}

void read_links(const std::string& path, int depth, TransformChain& chain) {
  const Parameters file(path);
  const bool is_older = file.has("InitialTransformParametersFileName");
  const HeaderField initial = file.word(
      is_older ? "InitialTransformParametersFileName" : "InitialTransformParameterFileName",
      "NoInitialTransform");
  if (initial.text != "NoInitialTransform") {
    if (depth == kMaxInitial) initial.fail("at most 16 initial transforms");
    const std::string beside =
        (std::filesystem::path(path).parent_path() / std::filesystem::path(initial.text).filename())
            .string();
    if (!std::filesystem::is_regular_file(beside)) initial.fail("the file of that name beside it");
    read_links(beside, depth + 1, chain);
  }
  const HeaderField combine = file.word("HowToCombineTransforms", "Compose");
  if (combine.text != "Compose" && combine.text != "Add") combine.fail("Compose or Add");
  chain.links.push_back({map_of(file), combine.text == "Add"});
  if (depth == 0) chain.grid = file.grid("");
}

}  // namespace

TransformChain read_elastix_transform(const std::string& path) {
  TransformChain chain;
  read_links(path, 0, chain);
  return chain;
}

}  // namespace supple
