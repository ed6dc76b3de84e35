#include "raycast/drawings/slice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "volumes/base/error.h"
#include "volumes/base/parallel.h"

namespace supple {

namespace {

/// Grey value and label of one pixel; whether it lies in the box and in the material.
struct SlicePixel {
  std::uint8_t grey = 0;
  bool is_inside = false;  // the volume's box
  bool at_rest = false;    // the material at rest holds its nearest voxel
  std::int64_t label = 0;
};

bool is_in_box(const Geometry& geometry, const Vec3d& index) {
  for (int a = 0; a < 3; ++a) {
    if (!(index[a] >= -0.5 && index[a] <= geometry.dims()[a] - 0.5)) return false;
  }
  return true;
}

/// Densities along the line of sight through a place.
class ThickSlice {
 public:
  ThickSlice(const Geometry& geometry, const Geometry& slice, const SliceStyle& style)
      : m_geometry(geometry), m_mode(style.slab) {
    const Vec3d spacing = geometry.spacing_mm();
    const double step_mm = std::min({spacing.x, spacing.y, spacing.z});
    m_count = std::max(1, int(std::ceil(style.thickness_mm / step_mm - 1e-9)));
    m_step = geometry.index_vector_from_world(slice.direction()[2] * style.thickness_mm) / m_count;
  }

  /// Gathers the densities; false where all of the line lies outside the box.
  bool gather(const Vec3d& middle, const DensityAt& density, double& gathered) const {
    int inside = 0;
    for (int n = 0; n < m_count; ++n) {
      const Vec3d place = middle + m_step * (n - 0.5 * (m_count - 1));
      if (!is_in_box(m_geometry, place)) continue;
      const double value = density(place);
      if (m_mode == SlabMode::mean) {
        gathered = inside == 0 ? value : gathered + value;
      } else if (inside == 0 || (value > gathered) == (m_mode == SlabMode::maximum)) {
        gathered = value;
      }
      ++inside;
    }
    if (m_mode == SlabMode::mean && inside > 1) gathered /= inside;
    return inside > 0;
  }

 private:
  const Geometry& m_geometry;
  SlabMode m_mode;
  int m_count;
  Vec3d m_step;  // index frame
};

/// Lines of tissue that lay along the grid axes at rest, a length apart.
class RestGrid {
 public:
  RestGrid(const Geometry& geometry, const Geometry& slice, double grid_mm) {
    int across = 0;  // the axis along which the slice does not reach far
    const Vec3d normal = slice.direction()[2];
    for (int a = 1; a < 3; ++a) {
      const auto nearness = [&](int axis) {
        return std::abs(geometry.direction()[std::size_t(axis)].dot(normal));
      };
      if (nearness(a) > nearness(across)) across = a;
    }
    m_axes = {(across + 1) % 3, (across + 2) % 3};
    for (std::size_t n = 0; n < 2; ++n) {
      m_per_voxel[n] = geometry.spacing_mm()[m_axes[n]] / grid_mm;
    }
  }

  /// How much of a pixel the lines cover, 0 to 1: they are a pixel wide. `across` and `down`: the
  /// place at rest of the next pixels.
  double coverage(const Vec3d& at_rest, const Vec3d& across, const Vec3d& down) const {
    double most = 0;
    for (std::size_t n = 0; n < 2; ++n) {
      const int axis = m_axes[n];
      const double line = at_rest[axis] * m_per_voxel[n];
      const double per_pixel =
          std::hypot(across[axis] - at_rest[axis], down[axis] - at_rest[axis]) * m_per_voxel[n];
      // Neighbours across a tear say nothing of the distance between lines.
      if (!(per_pixel > 0) || per_pixel > 0.5) continue;
      most = std::max(most, 1 - std::abs(line - std::round(line)) / per_pixel);
    }
    return most;
  }

 private:
  std::array<int, 2> m_axes;
  std::array<double, 2> m_per_voxel;  // lines
};

/// Draws one slice.
class SliceDrawing {
 public:
  SliceDrawing(const Geometry& geometry, const Geometry& slice, const SliceStyle& style)
      : m_geometry(geometry),
        m_slice(slice),
        m_style(style),
        m_slab(geometry, slice, style),
        m_width(slice.dims().x),
        m_height(slice.dims().y),
        m_pixels(std::size_t(m_width) * m_height) {}

  Image draw(const DensityAt& density) {
    parallel_for(m_height, [&](int y) {
      for (int x = 0; x < m_width; ++x) look(x, y, density);
    });
    Image image(m_width, m_height);
    for (int y = 0; y < m_height; ++y) {
      for (int x = 0; x < m_width; ++x) {
        if (!pixel(x, y).is_inside) continue;
        std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * m_width + x)];
        std::fill_n(rgba, 3, pixel(x, y).grey);
        rgba[3] = 255;
      }
    }
    if (m_style.paint) m_style.paint(image);
    for (int y = 0; y < m_height; ++y) {
      for (int x = 0; x < m_width; ++x) {
        std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * m_width + x)];
        if (is_rim(x, y, [](const SlicePixel& p) { return std::int64_t(p.at_rest); })) {
          std::copy_n(m_style.outline.data(), 3, rgba);
        }
        if (is_rim(x, y, [](const SlicePixel& p) { return p.label; })) {
          std::copy_n(label_colour(pixel(x, y).label).data(), 3, rgba);
        }
      }
    }
    if (m_style.grid_mm > 0) draw_grid(image);
    return image;
  }

 private:
  const SlicePixel& pixel(int x, int y) const { return m_pixels[std::size_t(y) * m_width + x]; }
  Vec3d index_at(int x, int y) const {
    return m_geometry.index_from_world(m_slice.world_from_index(Vec3d(x, y, 0)));
  }
  bool rest_place(const Vec3d& index, Vec3d& at_rest) const {
    at_rest = index;
    return !m_style.rest_place || m_style.rest_place(index, at_rest);
  }

  void look(int x, int y, const DensityAt& density) {
    SlicePixel& pixel = m_pixels[std::size_t(y) * m_width + x];
    const Vec3d index = index_at(x, y);
    double value = 0;
    pixel.is_inside = m_slab.gather(index, density, value);
    if (!pixel.is_inside) return;
    const double share = (value - m_style.grey_lo) / (m_style.grey_hi - m_style.grey_lo);
    pixel.grey = std::uint8_t(std::lround(std::clamp(share, 0.0, 1.0) * 255));
    pixel.at_rest =
        m_style.rest != nullptr && m_style.rest->is_active(floor_voxel(index + Vec3d(0.5)));
    Vec3d at_rest;
    if (m_style.label && rest_place(index, at_rest)) pixel.label = m_style.label(at_rest);
  }

  /// True if `what` is not 0 at the pixel and differs at a neighbour, or that is off the picture.
  template <class What>
  bool is_rim(int x, int y, const What& what) const {
    const std::int64_t own = what(pixel(x, y));
    if (own == 0) return false;
    const auto differs = [&](int nx, int ny) {
      return nx < 0 || ny < 0 || nx >= m_width || ny >= m_height || what(pixel(nx, ny)) != own;
    };
    return differs(x - 1, y) || differs(x + 1, y) || differs(x, y - 1) || differs(x, y + 1);
  }

  void draw_grid(Image& image) const {
    const RestGrid lines(m_geometry, m_slice, m_style.grid_mm);
    parallel_for(m_height, [&](int y) {
      for (int x = 0; x < m_width; ++x) {
        Vec3d here, across, down;
        if (!pixel(x, y).is_inside || !rest_place(index_at(x, y), here) ||
            !rest_place(index_at(x + 1, y), across) || !rest_place(index_at(x, y + 1), down)) {
          continue;
        }
        const double covered = lines.coverage(here, across, down);
        std::uint8_t* rgba = &image.rgba[4 * (std::size_t(y) * m_width + x)];
        for (std::size_t c = 0; c < 3; ++c) {
          rgba[c] = std::uint8_t(std::lround(rgba[c] + covered * (m_style.grid[c] - rgba[c])));
        }
      }
    });
  }

  const Geometry& m_geometry;
  const Geometry& m_slice;
  const SliceStyle& m_style;
  ThickSlice m_slab;
  int m_width, m_height;
  std::vector<SlicePixel> m_pixels;
};

constexpr double kGoldenTurn = 0.618033988749895;

}  // namespace

void SliceStyle::validate() const {
  if (!std::isfinite(grey_lo) || !std::isfinite(grey_hi) || !(grey_lo < grey_hi)) {
    throw InputError({"", "window", number_text(grey_lo) + "," + number_text(grey_hi),
                      "two densities, the lower one first"});
  }
  for (const auto& [name, length] : {std::pair("thickness", thickness_mm), {"grid", grid_mm}}) {
    if (length >= 0 && std::isfinite(length)) continue;
    throw InputError({"", name, number_text(length) + " mm", "0 mm or more"});
  }
}

std::array<std::uint8_t, 3> label_colour(std::int64_t label) {
  const double turn = double(label) * kGoldenTurn;
  const double hue = 6 * (turn - std::floor(turn));
  std::array<std::uint8_t, 3> rgb;
  for (int c = 0; c < 3; ++c) {
    // A triangle wave of the hue circle, never darker than a fifth.
    const double from_peak = std::abs(std::remainder(hue - 2 * c, 6));
    rgb[std::size_t(c)] = std::uint8_t(std::lround(255 * std::clamp(2 - from_peak, 0.2, 1.0)));
  }
  return rgb;
}

Image draw_slice(const Geometry& geometry, const Geometry& slice, const DensityAt& density,
                 const SliceStyle& style) {
  style.validate();
  return SliceDrawing(geometry, slice, style).draw(density);
}

Image tiled(const std::vector<Image>& images, int columns, int gap,
            std::vector<TilePlace>* places) {
  const int count = int(images.size()), rows = (count + columns - 1) / columns;
  // Pixels at which columns and rows begin, each with one more for the end.
  std::vector<int> lefts(std::size_t(std::min(columns, count)) + 1, 0);
  std::vector<int> tops(std::size_t(rows) + 1, 0);
  const auto column_of = [&](int n) { return std::size_t(n % columns); };
  const auto row_of = [&](int n) { return std::size_t(n / columns); };
  for (int n = 0; n < count; ++n) {
    lefts[column_of(n) + 1] = std::max(lefts[column_of(n) + 1], images[std::size_t(n)].width + gap);
    tops[row_of(n) + 1] = std::max(tops[row_of(n) + 1], images[std::size_t(n)].height + gap);
  }
  for (std::vector<int>* starts : {&lefts, &tops}) {
    std::partial_sum(starts->begin(), starts->end(), starts->begin());
  }
  Image all(lefts.back() - gap, tops.back() - gap);
  for (int n = 0; n < count; ++n) {
    const Image& image = images[std::size_t(n)];
    const TilePlace place = {lefts[column_of(n)], tops[row_of(n)]};
    if (places != nullptr) places->push_back(place);
    for (int y = 0; y < image.height; ++y) {
      const std::size_t row = std::size_t(place.top + y) * all.width + place.left;
      std::copy_n(&image.rgba[4 * std::size_t(y) * image.width], 4 * image.width,
                  &all.rgba[4 * row]);
    }
  }
  return all;
}

}  // namespace supple
