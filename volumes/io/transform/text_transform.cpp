#include "volumes/io/transform/text_transform.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/io/bytes/input_file.h"

namespace supple {

std::string transform_text(const std::string& path) {
  constexpr std::int64_t kMaxBytes = std::int64_t(1) << 30;
  const InputFile file(path);
  if (file.size() > kMaxBytes) {
    throw InputError(
        {path, "file length", std::to_string(file.size()) + " bytes", "at most 1 GiB of text"});
  }
  return file.head(std::size_t(file.size()));
}

std::vector<double> finite_numbers(const HeaderField& field, std::size_t count) {
  if (field.text.empty()) field.fail(std::to_string(count) + " numbers");
  std::vector<double> numbers = field.numbers();
  const bool finite = std::all_of(numbers.begin(), numbers.end(),
                                  [](double number) { return std::isfinite(number); });
  if (numbers.size() == count && finite) return numbers;
  throw InputError(
      {field.file, field.name,
       std::to_string(numbers.size()) + " numbers" + (finite ? "" : ", not all finite"),
       std::to_string(count) + " finite numbers"});
}

Geometry transform_grid(const HeaderField& field, const Vec3d& sizes, const Vec3d& origin_lps_mm,
                        const Vec3d& spacing_mm, const std::array<Vec3d, 3>& direction) {
  Vec3i dims;
  std::array<Vec3d, 3> axes = direction;
  for (int a = 0; a < 3; ++a) {
    if (!(sizes[a] >= 1 && sizes[a] < 2147483648.0) || sizes[a] != std::floor(sizes[a])) {
      throw InputError({field.file, field.name, "size " + number_text(sizes[a]),
                        "whole numbers from 1 to 2147483647"});
    }
    if (!(spacing_mm[a] > 0)) {
      throw InputError(
          {field.file, field.name, "spacing " + number_text(spacing_mm[a]), "lengths above 0"});
    }
    dims[a] = int(sizes[a]);
    axes[std::size_t(a)] *= spacing_mm[a];
  }
  return make_geometry(field.file, dims, origin_lps_mm, axes);
}

std::vector<Vec3d> vectors_of(const Geometry& grid, const HeaderField& field, bool interleaved) {
  // The numbers are there before anything is allocated for them.
  const double claimed = 3.0 * double(grid.voxel_count());
  if (claimed > double(field.text.size())) {
    throw InputError({field.file, field.name, "fewer numbers", number_text(claimed) + " numbers"});
  }
  const auto points = std::size_t(grid.voxel_count());
  const std::vector<double> numbers = finite_numbers(field, 3 * points);
  std::vector<Vec3d> vectors(points);
  for (std::size_t n = 0; n < points; ++n) {
    for (std::size_t c = 0; c < 3; ++c) {
      vectors[n][int(c)] = numbers[interleaved ? 3 * n + c : c * points + n];
    }
  }
  return vectors;
}

}  // namespace supple
