// Annotations of medical pictures: letters of the patient's sides, a scale bar, an orientation
// cube, words, a legend of colours, cross-hairs and arrows. Their contents and places are decided
// here; raycast/pictures/overlay.h draws them.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "raycast/pictures/colour_map.h"
#include "raycast/pictures/overlay.h"
#include "raycast/scene/camera.h"

namespace supple {

/// A part of a picture, in pixels.
struct PictureArea {
  double left = 0, top = 0, width = 0, height = 0;
};

/// Ground that inks must be legible on: pale ink with a dark halo, or the reverse.
enum class Ground { dark, light };

/// The patient's side that a direction points to, as DICOM's Patient Orientation (C.7.6.1.1.1) says
/// it, with S and I for head and feet: the nearest of R L A P S I, then those whose share of the
/// unit vector is above 0.2 (about 12 degrees), in descending order: "L", "LA", "SAR".
std::string orientation_letters(const Vec3d& direction_lps);

/// The largest of 1, 2 and 5 times a power of ten that is not above `longest`.
double round_length(double longest);

/// mm that a pixel of the picture spans: everywhere in an orthographic picture, in the plane
/// through the target of a perspective one.
double mm_per_pixel(const Camera& camera, int height);

/// Writes over one area of a picture: adds shapes to an overlay.
class Annotations {
 public:
  Annotations(Overlay& overlay, const PictureArea& area, double letter_height, Ground ground);

  /// Suits an area: 1/32 of its shorter side, at least 9 pixels.
  static double letter_height_for(const PictureArea& area);

  /// Writes the patient's sides in the middle of each edge. `right` and `up`: of the picture, LPS.
  void letters(const Vec3d& right, const Vec3d& up);
  /// A bar of a round length, at most a quarter of the width, in the bottom left corner; `remark`
  /// follows its length in mm.
  void scale_bar(double pixel_mm, const std::string& remark);
  /// A cube in the bottom right corner, seen as the patient is, with the letters of its sides.
  void cube(const CameraFrame& frame);
  /// Room that drawings take from the edges of an area, in heights of letters.
  static constexpr double kLettersReach = 2, kScaleBarReach = 3, kCubeReach = 6;
  static constexpr double kWordsReach = 0.75, kLineReach = 1.425;  // and so much for every line
  static constexpr double kLegendReach = 8.25;

  /// Lines of words in the top left corner.
  void words(const std::vector<std::string>& lines);
  /// A bar of colours at the right edge with ticks, `title` above: the n-th of so many, from above.
  void legend(const ScalarRange& range, const std::function<Rgb(double value)>& colour,
              const std::string& title, int n = 0, int count = 1);
  /// Two lines through a point that leave its surroundings free.
  void crosshair(const PixelPoint& at);
  /// Draws an arrow from where something was to where it is; one under a pixel is left out.
  void arrow(const PixelPoint& from, const PixelPoint& to);

 private:
  void line(const std::vector<PixelPoint>& points, double width);
  void text(const std::string& words, const PixelPoint& at, const PixelPoint& hold, double height);
  void letter(const Vec3d& direction, const PixelPoint& at, const PixelPoint& hold);

  Overlay& m_overlay;
  PictureArea m_area;
  double m_height;       // of letters, pixels
  double m_word_height;  // of words
  Rgb m_word_ink, m_letter_ink, m_halo;
};

}  // namespace supple
