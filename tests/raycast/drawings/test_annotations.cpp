// Writing over pictures: the patient's sides, lengths, and pixels that are drawn.
#include <cmath>

#include <gtest/gtest.h>

#include "raycast/drawings/annotations.h"
#include "raycast/pictures/background.h"
#include "volumes/base/error.h"

namespace supple {
namespace {

constexpr PictureArea kWholePicture{0, 0, 320, 320};

template <class Write>
Overlay written(const Write& write) {
  Overlay overlay;
  Annotations annotations(overlay, kWholePicture, 10, Ground::dark);
  write(annotations);
  return overlay;
}

std::vector<OverlayText> words_in(const Overlay& overlay) {
  std::vector<OverlayText> words;
  for (const OverlayShape& shape : overlay) {
    if (const auto* text = std::get_if<OverlayText>(&shape)) words.push_back(*text);
  }
  return words;
}

TEST(UnitAnnotations, SidesAreNamedNearestFirst) {
  EXPECT_EQ(orientation_letters({1, 0, 0}), "L");
  EXPECT_EQ(orientation_letters({-2, 0, 0}), "R");
  EXPECT_EQ(orientation_letters({0, 3, 0}), "P");
  EXPECT_EQ(orientation_letters({0, -1, 0}), "A");
  EXPECT_EQ(orientation_letters({0, 0, 0.1}), "S");
  EXPECT_EQ(orientation_letters({0, 0, -1}), "I");
  EXPECT_EQ(orientation_letters({-0.6, -0.8, 0}), "AR");
  EXPECT_EQ(orientation_letters({0.5, 0.6, -0.7}), "IPL");
  // 11 and 12 degrees from an axis.
  const auto tilted = [](double degrees) {
    const double angle = degrees * 3.14159265358979 / 180;
    return Vec3d(std::cos(angle), 0, std::sin(angle));
  };
  EXPECT_EQ(orientation_letters(tilted(11)), "L");
  EXPECT_EQ(orientation_letters(tilted(12)), "LS");
}

/// Every letter stands at the edge towards which its direction is seen to point.
TEST(PropertyAnnotations, LettersStandWhereTheirSidesAreSeen) {
  for (const Vec3d& from : {Vec3d(0, -1, 0), {0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0.5, -0.7, 0.3}}) {
    Camera camera;
    camera.position_lps_mm = from * 100.0;
    camera.target_lps_mm = {0, 0, 0};
    const CameraFrame frame = camera_frame(camera);
    const auto words = words_in(written([&](Annotations& a) { a.letters(frame.right, frame.up); }));
    ASSERT_EQ(words.size(), 4u);
    for (const OverlayText& word : words) {
      const std::string sides = "LRPASI";
      const std::size_t side = sides.find(word.text.front());
      Vec3d direction(0);
      direction[int(side / 2)] = side % 2 == 0 ? 1 : -1;
      double x = 0, y = 0;
      ASSERT_TRUE(project_to_pixel(camera, 320, 320, direction, x, y));
      const double towards = (word.at[0] - 160) * (x - 160) + (word.at[1] - 160) * (y - 160);
      EXPECT_GT(towards, 0) << word.text;
    }
  }
}

TEST(UnitAnnotations, ScaleBarsHaveRoundLengths) {
  EXPECT_EQ(round_length(99), 50);
  EXPECT_EQ(round_length(50), 50);
  EXPECT_EQ(round_length(49), 20);
  EXPECT_EQ(round_length(1000), 1000);
  EXPECT_DOUBLE_EQ(round_length(0.019), 0.01);
}

/// The bar's ends, taken back to the patient, lie as far apart as it says.
TEST(PropertyAnnotations, TheScaleBarIsAsLongAsItSays) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    Camera camera;
    camera.projection = projection;
    camera.position_lps_mm = {30, -200, 70};
    camera.target_lps_mm = {-4, 5, 6};
    camera.height_mm = 240;
    const double pixel_mm = mm_per_pixel(camera, 320);
    const Overlay overlay = written([&](Annotations& a) { a.scale_bar(pixel_mm, ""); });
    const auto& bar = std::get<OverlayLine>(overlay.front()).points;
    const auto at_target = [&](const PixelPoint& p) {
      const Ray ray = camera_ray(camera, 320, 320, p[0], p[1]);
      const Vec3d forward = camera_frame(camera).forward;
      const double t =
          (camera.target_lps_mm - ray.origin_lps_mm).dot(forward) / ray.direction_lps.dot(forward);
      return ray.origin_lps_mm + ray.direction_lps * t;
    };
    const double length = (at_target(bar[1]) - at_target(bar[2])).length();
    EXPECT_EQ(words_in(overlay).front().text, number_text(std::round(length)) + " mm");
    EXPECT_NEAR(length, std::round(length), 1e-9);
  }
}

TEST(UnitAnnotations, TheCubeShowsTheSideThatIsSeen) {
  const std::pair<Vec3d, std::string> cases[] = {
      {{0, -1, 0}, "A"}, {{0, 1, 0}, "P"}, {{1, 0, 0}, "L"}, {{-1, 0, 0}, "R"}};
  for (const auto& [from, side] : cases) {
    Camera camera;
    camera.position_lps_mm = from * 100.0;
    camera.target_lps_mm = {0, 0, 0};
    const auto words = words_in(written([&](Annotations& a) { a.cube(camera_frame(camera)); }));
    ASSERT_EQ(words.size(), 1u) << side;
    EXPECT_EQ(words.front().text, side);
    EXPECT_NEAR(words.front().along[0], 1, 1e-12);  // not mirrored, upright
    EXPECT_NEAR(words.front().down[1], 1, 1e-12);
  }
  Camera corner;
  corner.position_lps_mm = {100, -100, 80};
  corner.target_lps_mm = {0, 0, 0};
  std::string seen;
  for (const OverlayText& word :
       words_in(written([&](Annotations& a) { a.cube(camera_frame(corner)); }))) {
    seen += word.text;
    EXPECT_GT(word.along[0] * word.down[1] - word.along[1] * word.down[0], 0) << "mirrored";
  }
  EXPECT_EQ(seen, "LAS");
}

TEST(UnitAnnotations, ArrowsEndWhereTheyPoint) {
  const Overlay overlay = written([](Annotations& a) { a.arrow({10, 20}, {40, 60}); });
  ASSERT_EQ(overlay.size(), 2u);
  const auto& shaft = std::get<OverlayLine>(overlay[0]).points;
  EXPECT_EQ(shaft.front(), (PixelPoint{10, 20}));
  EXPECT_EQ(shaft.back(), (PixelPoint{40, 60}));
  // The head's other corners lie behind its tip, as far on either side.
  const auto& head = std::get<OverlayFace>(overlay[1]).corners;
  EXPECT_EQ(head[0], (PixelPoint{40, 60}));
  double across = 0;
  for (std::size_t n = 1; n < 3; ++n) {
    const double x = head[n][0] - 40, y = head[n][1] - 60;
    EXPECT_LT(0.6 * x + 0.8 * y, 0);
    across += 0.8 * x - 0.6 * y;
  }
  EXPECT_NEAR(across, 0, 1e-12);
  EXPECT_TRUE(written([](Annotations& a) { a.arrow({5, 5}, {5.5, 5}); }).empty());
}

/// Ink is found where it was asked for, and nowhere else.
TEST(UnitOverlay, ShapesCoverThePixelsThatTheyLieOn) {
  FloatImage picture(64, 48);
  draw_overlay(picture, {OverlayFace{{{8, 8}, {24, 8}, {24, 40}, {8, 40}}, {1, 0, 0}},
                         OverlayLine{{{40.5, 4.5}, {40.5, 44.5}}, 1, {0, 1, 0}, {}}});
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      const float* rgba = &picture.rgba[4 * (std::size_t(y) * 64 + x)];
      const bool in_face = x >= 9 && x < 23 && y >= 9 && y < 39;
      const bool near_face = x >= 6 && x < 26 && y >= 6 && y < 42;
      if (in_face) {
        EXPECT_EQ(rgba[0], 1) << x << " " << y;
      }
      if (x == 40 && y >= 5 && y < 44) {
        EXPECT_GT(rgba[1], 0.9f) << y;
      }
      if (!near_face && std::abs(x - 40) > 2) {
        EXPECT_EQ(rgba[3], 0) << x << " " << y;
      }
      for (int c = 0; c < 3; ++c) EXPECT_LE(rgba[c], rgba[3] + 1e-6f);
    }
  }
}

TEST(UnitOverlay, TextIsHeldWhereItIsAskedFor) {
  const auto ink_box = [](const OverlayText& text) {
    FloatImage picture(200, 100);
    draw_overlay(picture, {text});
    std::array<int, 4> box = {200, 100, -1, -1};
    for (int y = 0; y < 100; ++y) {
      for (int x = 0; x < 200; ++x) {
        if (picture.rgba[4 * (std::size_t(y) * 200 + x) + 3] < 0.5f) continue;
        box = {std::min(box[0], x), std::min(box[1], y), std::max(box[2], x), std::max(box[3], y)};
      }
    }
    return box;
  };
  OverlayText text;
  text.text = "HIH";
  text.at = {100, 50};
  text.height = 20;
  const auto right_below = ink_box(text);
  EXPECT_NEAR(right_below[0], 100, 4);
  EXPECT_NEAR(right_below[1], 50, 3);
  EXPECT_NEAR(right_below[3] - right_below[1], 20, 4);
  text.hold = {1, 1};
  const auto left_above = ink_box(text);
  EXPECT_NEAR(left_above[2], 100, 4);
  EXPECT_NEAR(left_above[3], 50, 3);
  // Turned by a quarter: as tall as it was wide.
  text.hold = {0.5, 0.5};
  text.along = {0, 1};
  text.down = {-1, 0};
  const auto turned = ink_box(text);
  EXPECT_NEAR(turned[3] - turned[1], right_below[2] - right_below[0], 3);
  EXPECT_NEAR(turned[0] + turned[2], 200, 6);
}

TEST(UnitBackground, IsSeenAsFarAsThePictureIsTransparent) {
  FloatImage picture(3, 1);
  picture.rgba = {0, 0, 0, 0, 0.25f, 0, 0, 0.5f, 0, 1, 0, 1};
  put_over(parse_background("#0000FF"), picture);
  const std::vector<float> expected = {0, 0, 1, 1, 0.25f, 0, 0.5f, 1, 0, 1, 0, 1};
  EXPECT_EQ(picture.rgba, expected);
  EXPECT_FALSE(picture.has_alpha);
}

TEST(UnitBackground, CheckersAlternateAndTransparencyStays) {
  FloatImage picture(64, 64), untouched(64, 64);
  put_over(parse_background("checker"), picture);
  put_over(parse_background("transparent"), untouched);
  EXPECT_EQ(untouched.rgba, FloatImage(64, 64).rgba);
  EXPECT_TRUE(untouched.has_alpha);
  const auto grey = [&](int x, int y) { return picture.rgba[4 * (std::size_t(y) * 64 + x)]; };
  EXPECT_NE(grey(0, 0), grey(4, 0));
  EXPECT_NE(grey(0, 0), grey(0, 4));
  EXPECT_EQ(grey(0, 0), grey(4, 4));
  EXPECT_EQ(grey(0, 0), grey(3, 3));
}

TEST(UnitBackground, UnknownColoursAreNamed) {
  EXPECT_THROW(parse_background("#12345"), InputError);
  EXPECT_THROW(parse_background("mauve"), InputError);
  for (const std::string& name : background_names()) EXPECT_NO_THROW(parse_background(name));
  EXPECT_TRUE(is_light(parse_background("white")));
  EXPECT_FALSE(is_light(parse_background("blue")));
}

}  // namespace
}  // namespace supple
