#include <algorithm>
#include <cmath>
#include <string>

#include "raycast/microscope/microscope.h"
#include "raycast/microscope/vessel_tree.h"
#include "volumes/base/error.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

using PhotoRgb = std::array<double, 3>;  // of 255, as a photograph has it

constexpr int kLeastTexels = 16, kMostTexels = 8192;

/// Noise of 0 … 1 that is smooth between whole numbers, from a hash of them.
class SmoothNoise {
 public:
  explicit SmoothNoise(std::uint64_t seed) : m_seed(seed * 0x9e3779b97f4a7c15ull + 1) {}

  /// Octaves of it.
  double at(double x, double y, int octaves) const {
    double sum = 0, weight = 0.5, total = 0;
    for (int n = 0; n < octaves; ++n) {
      sum += weight * one(x, y, std::uint64_t(n));
      total += weight;
      weight /= 2, x = 2 * x + 17.3, y = 2 * y - 5.1;
    }
    return sum / total;
  }

 private:
  double corner(std::int64_t x, std::int64_t y, std::uint64_t octave) const {
    std::uint64_t h = m_seed + octave * 0xd1b54a32d192ed03ull;
    h ^= std::uint64_t(x) * 0xbf58476d1ce4e5b9ull;
    h = (h ^ h >> 29) * 0x94d049bb133111ebull;
    h ^= std::uint64_t(y) * 0x9e3779b97f4a7c15ull;
    h = (h ^ h >> 32) * 0xbf58476d1ce4e5b9ull;
    return double((h ^ h >> 31) >> 11) * 0x1p-53;
  }
  double one(double x, double y, std::uint64_t octave) const {
    const double left = std::floor(x), below = std::floor(y);
    const auto i = std::int64_t(left), j = std::int64_t(below);
    const auto ease = [](double t) { return t * t * (3 - 2 * t); };
    const double s = ease(x - left), t = ease(y - below);
    const double low = corner(i, j, octave) * (1 - s) + corner(i + 1, j, octave) * s;
    const double high = corner(i, j + 1, octave) * (1 - s) + corner(i + 1, j + 1, octave) * s;
    return low * (1 - t) + high * t;
  }

  std::uint64_t m_seed;
};

double smooth_step(double from, double to, double x) {
  const double t = std::clamp((x - from) / (to - from), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

double bell(double x, double width) {
  return std::exp(-(x / width) * (x / width));
}

PhotoRgb blend(const PhotoRgb& a, const PhotoRgb& b, double t) {
  return {a[0] + (b[0] - a[0]) * t, a[1] + (b[1] - a[1]) * t, a[2] + (b[2] - a[2]) * t};
}

PhotoRgb dimmed(const PhotoRgb& a, const PhotoRgb& by) {
  return {a[0] * (1 - by[0]), a[1] * (1 - by[1]), a[2] * (1 - by[2])};
}

/// Pigment and choroid: orange-red, mottled, with choroidal vessels shining through further out.
PhotoRgb background(const SmoothNoise& noise, double x, double y, double from_fovea) {
  const double outer = smooth_step(4, 19, from_fovea);
  PhotoRgb colour = blend({214, 104, 54}, {186, 80, 44}, outer);
  const double mottle = noise.at(x * 0.45, y * 0.45, 4) - 0.5;
  const double grain = noise.at(x * 7, y * 7, 2) - 0.5;
  const double warp = 2.2 * noise.at(x * 0.35 + 40, y * 0.35, 2);
  const double ridge = std::abs(2 * noise.at(x * 0.8 + warp, y * 0.8 - warp, 3) - 1);
  const double choroid = (1 - smooth_step(0.0, 0.45, ridge)) * (0.03 + 0.10 * outer);
  const double dark = 0.10 - 0.20 * mottle - 0.05 * grain;
  colour = dimmed(colour, {dark * 0.5, dark, dark});
  colour = blend(colour, {226, 122, 70}, choroid);
  const double macula = bell(from_fovea, 1.7), fovea = bell(from_fovea, 0.5);
  colour = dimmed(colour, {0.17 * macula + 0.10 * fovea, 0.30 * macula + 0.16 * fovea,
                           0.30 * macula + 0.16 * fovea});
  colour = blend(colour, {240, 190, 130}, 0.5 * bell(from_fovea, 0.07));
  // Beyond the retina: the dark band of the ciliary body.
  return blend(colour, {58, 30, 22}, smooth_step(21.5, 24, from_fovea));
}

/// Fibres of nerve around the disc: a pale sheen in fine streaks.
PhotoRgb nerve_fibres(const SmoothNoise& noise, const PhotoRgb& colour, double from_x,
                      double from_y, double from_disc) {
  const double angle = std::atan2(from_y, from_x);
  const double streaks = noise.at(30 * std::cos(angle), 30 * std::sin(angle) + from_disc * 0.4, 2);
  const double sheen = bell(from_disc - 0.9, 1.9) * (0.25 + 0.75 * std::abs(std::sin(angle)));
  return blend(colour, {236, 168, 112}, 0.30 * sheen * (0.35 + streaks));
}

PhotoRgb optic_disc(const PhotoRgb& colour, double from_x, double from_y) {
  const double away = std::hypot(from_x * 1.08, from_y * 0.98);
  const double rim = RetinaPlan::kDiscRadius;
  const double cup = std::hypot(from_x + 0.10, from_y);
  PhotoRgb around = dimmed(colour, {0.16 * bell(away - rim, 0.12), 0.22 * bell(away - rim, 0.12),
                                    0.22 * bell(away - rim, 0.12)});
  PhotoRgb disc = blend({243, 176, 118}, {250, 208, 150}, smooth_step(rim, 0.45, away));
  disc = blend(disc, {255, 236, 200}, smooth_step(0.46, 0.30, cup));
  return blend(around, disc, smooth_step(rim + 0.07, rim - 0.07, away));
}

PhotoRgb fundus_colour(const SmoothNoise& noise, const VesselMaps& vessels, double x, double y,
                       std::size_t texel) {
  const double from_fovea = std::hypot(x - RetinaPlan::kFoveaX, y - RetinaPlan::kFoveaY);
  const double disc_x = x - RetinaPlan::kDiscX, disc_y = y - RetinaPlan::kDiscY;
  const double from_disc = std::hypot(disc_x, disc_y);
  PhotoRgb colour = background(noise, x, y, from_fovea);
  if (from_disc < 8) colour = nerve_fibres(noise, colour, disc_x, disc_y, from_disc);
  if (from_disc < 2) colour = optic_disc(colour, disc_x, disc_y);
  colour = blend(colour, {124, 26, 20}, 0.80 * vessels.veins[texel]);
  colour = blend(colour, {176, 44, 28}, 0.82 * vessels.arteries[texel]);
  return blend(colour, {230, 120, 84}, 0.55 * vessels.reflexes[texel]);
}

}  // namespace

TextureImage make_fundus(int size, std::uint64_t seed) {
  if (size < kLeastTexels || size > kMostTexels) {
    throw InputError({"", "size of a fundus", std::to_string(size),
                      std::to_string(kLeastTexels) + " to " + std::to_string(kMostTexels)});
  }
  const VesselMaps vessels = paint_vessels(size, seed);
  const SmoothNoise noise(seed);
  TextureImage image;
  image.width = image.height = size;
  image.texels.resize(std::size_t(size) * size);
  parallel_for(size, Grain{8}, [&](int row) {
    for (int column = 0; column < size; ++column) {
      const double x = (column + 0.5 - size / 2.0) / vessels.texels_per_mm;
      const double y = (size / 2.0 - row - 0.5) / vessels.texels_per_mm;
      const std::size_t texel = std::size_t(row) * size + column;
      const PhotoRgb colour = fundus_colour(noise, vessels, x, y, texel);
      for (std::size_t c = 0; c < 3; ++c) {
        image.texels[texel][c] = std::uint8_t(std::lround(std::clamp(colour[c], 0.0, 255.0)));
      }
    }
  });
  return image;
}

}  // namespace supple
