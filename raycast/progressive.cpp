#include "raycast/progressive.h"

#include "raycast/march/march_pixels.h"

namespace supple {

namespace {

constexpr int kFirstSpacing = 8;

class Cancellation final : public Progress {
 public:
  explicit Cancellation(const std::atomic<bool>& flag) : m_flag(flag) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_flag; }

 private:
  const std::atomic<bool>& m_flag;
};

/// Every value taken from the pixel at the corner of its square; `count` values per pixel.
void repeat(std::vector<float>& values, int width, int spacing, std::size_t count) {
  for (std::size_t n = 0; n < values.size() / count; ++n) {
    const std::size_t x = n % width, y = n / width;
    const std::size_t from = (y - y % spacing) * width + x - x % spacing;
    for (std::size_t c = 0; c < count; ++c) values[count * n + c] = values[count * from + c];
  }
}

}  // namespace

ProgressiveRender::ProgressiveRender(const Renderer& renderer, const Camera& camera,
                                     const TransferFunction& transfer_function,
                                     const RenderSettings& settings)
    : m_camera(camera),
      m_context(renderer.prepare(camera, transfer_function, settings)),
      m_picture(settings.width, settings.height, settings.auxiliary) {}

ProgressiveRender::~ProgressiveRender() = default;

bool ProgressiveRender::refine() {
  if (finished()) return false;
  const int spacing = m_spacing == 0 ? kFirstSpacing : m_spacing / 2;
  Cancellation progress(m_cancelled);
  try {
    m_samples +=
        march_pixels(*m_context, m_camera, {spacing, m_spacing != 0}, m_picture, &progress);
  } catch (const Cancelled&) {
    return false;
  }
  m_spacing = spacing;
  return true;
}

FloatImage ProgressiveRender::picture() const {
  FloatImage picture = m_picture;
  if (m_spacing <= 1) return picture;
  repeat(picture.rgba, picture.width, m_spacing, 4);
  repeat(picture.depth_mm, picture.width, m_spacing, 1);
  repeat(picture.normal_lps, picture.width, m_spacing, 3);
  repeat(picture.offset_mm, picture.width, m_spacing, 1);
  return picture;
}

}  // namespace supple
