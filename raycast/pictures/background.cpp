#include "raycast/pictures/background.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

struct NamedColour {
  const char* name;
  Rgb rgb;
};
const std::vector<NamedColour>& named_colours() {
  static const std::vector<NamedColour> table = {
      {"black", {0, 0, 0}},          {"white", {1, 1, 1}},           {"grey", {0.5, 0.5, 0.5}},
      {"darkgrey", {0.2, 0.2, 0.2}}, {"lightgrey", {0.8, 0.8, 0.8}}, {"blue", {0.1, 0.2, 0.45}},
      {"green", {0.1, 0.4, 0.2}},    {"red", {0.6, 0.1, 0.1}}};
  return table;
}

constexpr float kDarkSquare = 0.4f, kLightSquare = 0.6f;

}  // namespace

std::vector<std::string> background_names() {
  std::vector<std::string> names;
  for (const NamedColour& colour : named_colours()) names.emplace_back(colour.name);
  return names;
}

Background parse_background(const std::string& text) {
  if (text == "transparent") return {};
  if (text == "checker") return {Background::Kind::checker, {}};
  if (const auto rgb = parse_colour(text)) return {Background::Kind::colour, *rgb};
  for (const NamedColour& colour : named_colours()) {
    if (text == colour.name) return {Background::Kind::colour, colour.rgb};
  }
  throw InputError({"", "background", "\"" + text + "\"",
                    "transparent, checker, #RRGGBB, " + listed(background_names(), "or")});
}

bool is_light(const Background& background) {
  const Rgb& rgb = background.rgb;
  return background.kind == Background::Kind::colour &&
         0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2] > 0.5;
}

void put_over(const Background& background, FloatImage& picture) {
  if (background.kind == Background::Kind::transparent) return;
  const std::size_t square = std::size_t(std::max(4, picture.height / 32));
  for (std::size_t n = 0; n < picture.pixel_count(); ++n) {
    const std::size_t x = n % std::size_t(picture.width), y = n / std::size_t(picture.width);
    float* rgba = &picture.rgba[4 * n];
    const float behind = 1 - std::min(rgba[3], 1.0f);
    const float grey = (x / square + y / square) % 2 == 0 ? kLightSquare : kDarkSquare;
    for (std::size_t c = 0; c < 3; ++c) {
      rgba[c] +=
          behind * (background.kind == Background::Kind::checker ? grey : float(background.rgb[c]));
    }
    rgba[3] = 1;
  }
  picture.has_alpha = false;
}

}  // namespace supple
