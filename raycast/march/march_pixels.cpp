#include "raycast/march/march_pixels.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

#include "raycast/march/blue_noise.h"
#include "volumes/base/parallel.h"

namespace supple {

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
