#include "raycast/march/march_pixels.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <limits>
#include <mutex>
#include <random>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr int kSide = 64, kPixels = kSide * kSide;
constexpr int kReach = 7;       // pixels; beyond, the energy of a point is nothing
constexpr double kSigma = 1.5;  // Ulichney's choice
constexpr int kFirstPoints = kPixels / 10;

/// Points on a torus and the energy that they spread around them.
class Points {
 public:
  Points() {
    for (int n = 0; n < kBox * kBox; ++n) {
      const int x = n % kBox - kReach, y = n / kBox - kReach;
      m_kernel[n] = std::exp(-(x * x + y * y) / (2 * kSigma * kSigma));
    }
  }
  bool has(int pixel) const { return m_has[pixel]; }
  void add(int pixel) { set(pixel, true); }
  void remove(int pixel) { set(pixel, false); }

  /// The point with the most energy around it.
  int tightest_cluster() const { return extreme(true, -1); }
  /// The empty pixel with the least energy around it.
  int largest_void() const { return extreme(false, 1); }

 private:
  static constexpr int kBox = 2 * kReach + 1;

  void set(int pixel, bool present) {
    m_has[pixel] = present;
    for (int n = 0; n < kBox * kBox; ++n) {
      const int x = (pixel % kSide + n % kBox - kReach + kSide) % kSide;
      const int y = (pixel / kSide + n / kBox - kReach + kSide) % kSide;
      m_energy[y * kSide + x] += present ? m_kernel[n] : -m_kernel[n];
    }
  }
  int extreme(bool present, double sign) const {
    int best = -1;
    for (int pixel = 0; pixel < kPixels; ++pixel) {
      if (m_has[pixel] != present) continue;
      if (best < 0 || sign * m_energy[pixel] < sign * m_energy[best]) best = pixel;
    }
    return best;
  }

  std::array<double, kBox * kBox> m_kernel;
  std::array<double, kPixels> m_energy{};
  std::array<bool, kPixels> m_has{};
};

/// An even spread of few points: clusters move into voids until that changes nothing.
Points first_pattern() {
  Points points;
  std::mt19937 random(1);
  for (int count = 0; count < kFirstPoints;) {
    const int pixel = int(random() % kPixels);
    if (points.has(pixel)) continue;
    points.add(pixel);
    ++count;
  }
  while (true) {
    const int from = points.tightest_cluster();
    points.remove(from);
    const int to = points.largest_void();
    points.add(to);
    if (to == from) return points;
  }
}

using Tile = std::array<std::uint16_t, kPixels>;

Tile make_tile() {
  Tile rank{};
  const Points first = first_pattern();
  Points fewer = first;
  for (int n = kFirstPoints - 1; n >= 0; --n) {
    const int pixel = fewer.tightest_cluster();
    fewer.remove(pixel);
    rank[pixel] = std::uint16_t(n);
  }
  Points more = first;
  for (int n = kFirstPoints; n < kPixels; ++n) {
    const int pixel = more.largest_void();
    more.add(pixel);
    rank[pixel] = std::uint16_t(n);
  }
  return rank;
}

}  // namespace

float blue_noise(int x, int y) {
  static const Tile tile = make_tile();
  return (float(tile[(y & (kSide - 1)) * kSide + (x & (kSide - 1))]) + 0.5f) / kPixels;
}

namespace {

constexpr int kTile = 16;

/// Progress from many threads: one at a time reports, any may cancel.
class SharedProgress {
 public:
  SharedProgress(Progress* progress, std::int64_t total) : m_progress(progress), m_total(total) {}
  void done(std::int64_t count) {
    const std::int64_t now = m_done += count;
    if (m_progress == nullptr) return;
    if (m_progress->cancelled()) throw Cancelled();
    const std::unique_lock lock(m_mutex, std::try_to_lock);
    if (lock) report(m_progress, double(now) / double(m_total));
  }

 private:
  Progress* m_progress;
  std::int64_t m_total;
  std::atomic<std::int64_t> m_done{0};
  std::mutex m_mutex;
};

/// A premultiplied, sRGB-encoded colour as `factor` times as much light shows it.
Float4 exposed(Float4 colour, float factor) {
  const float alpha = colour[3];
  if (factor == 1 || alpha <= 0) return colour;
  for (int c = 0; c < 3; ++c) {
    colour[c] = alpha * srgb_from_linear(factor * linear_from_srgb(colour[c] / alpha));
  }
  return colour;
}

float rounded_up(double value) {
  return std::nextafter(float(value), std::numeric_limits<float>::infinity());
}

/// One pixel of a picture, marched.
class PixelMarch {
 public:
  PixelMarch(const RenderContext& context, const Camera& camera, FloatImage& picture,
             PixelMarks* marks)
      : m_marcher(context),
        m_jitter(context.settings.jitter),
        m_light(float(std::exp2(context.settings.lighting.exposure_stops))),
        m_rays(camera, picture.width, picture.height),
        m_forward(camera_frame(camera).forward),
        m_picture(picture),
        m_marks(marks) {}

  bool is_there(int x, int y) const {
    return m_marks != nullptr && !m_marks->is_there.empty() && m_marks->is_there[number(x, y)];
  }

  void march(int x, int y) {
    const Ray ray = m_rays.at(x + 0.5, y + 0.5);
    const Float4 sum = exposed(m_marcher.march(ray, m_jitter ? blue_noise(x, y) : 0), m_light);
    const std::size_t n = number(x, y);
    if (m_marks != nullptr) m_marks->opaque_from_mm[n] = rounded_up(m_marcher.opaque_from());
    for (std::size_t c = 0; c < 4; ++c) m_picture.rgba[4 * n + c] = sum[c];
    SeenSurface seen;
    if (!m_picture.has_auxiliary() || !m_marcher.surface(seen)) return;
    m_picture.depth_mm[n] = float(seen.distance_mm * ray.direction_lps.dot(m_forward));
    for (int c = 0; c < 3; ++c) m_picture.normal_lps[3 * n + c] = seen.normal_lps[c];
    m_picture.offset_mm[n] = seen.offset_mm;
    if (!m_picture.surface.empty()) m_picture.surface[n] = seen.surface;
  }
  std::int64_t samples() const { return m_marcher.samples(); }

 private:
  std::size_t number(int x, int y) const { return std::size_t(y) * m_picture.width + x; }

  Marcher m_marcher;
  bool m_jitter;
  float m_light;  // factor of exposure
  CameraRays m_rays;
  Vec3d m_forward;
  FloatImage& m_picture;
  PixelMarks* m_marks;
};

}  // namespace

std::int64_t march_pixels(const RenderContext& context, const Camera& camera,
                          const PixelLattice& lattice, FloatImage& picture, Progress* progress,
                          PixelMarks* marks) {
  const int spacing = lattice.spacing;
  const int columns = (picture.width + spacing - 1) / spacing;
  const int rows = (picture.height + spacing - 1) / spacing;
  SharedProgress shared(progress, std::int64_t(columns) * rows);
  std::atomic<std::int64_t> samples{0};
  parallel_tiles(rows, columns, Grain{kTile}, [&](const PixelTile& tile) {
    PixelMarch march(context, camera, picture, marks);
    for (int row = tile.row_begin; row < tile.row_end; ++row) {
      for (int column = tile.column_begin; column < tile.column_end; ++column) {
        const int x = column * spacing, y = row * spacing;
        if (!lattice.has(x, y) && !march.is_there(x, y)) march.march(x, y);
      }
      shared.done(tile.column_end - tile.column_begin);
    }
    samples += march.samples();
  });
  return samples;
}

}  // namespace supple
