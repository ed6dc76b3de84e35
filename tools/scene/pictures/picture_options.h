// Options for making and filing the pictures of a view: kinds of files, pictures beside the main
// one, stereo, turntables and sequences.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "volumes/base/fields.h"

namespace supple::tools {

enum class StereoMode { none, side_by_side, anaglyph };
enum class PictureKind { png, exr, video };

struct PictureOptions {
  int bits = 8;                  // of a PNG: 8 or 16
  std::vector<std::string> aux;  // beside the colours: depth, normal, offset; motion, id
  double offset_max_mm = 0;      // end of the offsets' map; 0: the longest offset of all
  StereoMode stereo = StereoMode::none;
  double eye_separation_mm = 0;  // 0: one thirtieth of the distance to the target
  int turntable = 0;             // pictures of a full turn; 0: none
  int sequence = 0;              // pictures from rest to the deformed state; 0: none
  bool swing = false;            // of a whole oscillation about rest instead
  double frames_per_second = 25;
  std::string video;  // of the numbered pictures of a film
  int film = 0;       // frames of the scene's film; 0: none

  bool is_series() const { return turntable > 0 || sequence > 0 || film > 0; }
  /// True if `aux` has the name.
  bool shows(const std::string& channel) const;
  /// Names of `aux` that become pictures beside the main one.
  std::vector<std::string> maps() const;
  int frame_count() const { return std::max({1, turntable, sequence, film}); }
  /// Fraction of the displacement in picture n: 1 but in a sequence.
  double fraction_at(int n) const;
};

constexpr int kMostFrames = 10000;

/// Finds it by the extension. Throws InputError for another than .png, .exr, .mp4, .webm and .avi.
PictureKind picture_kind(const std::string& path);

/// Keys of a [[view]].
Fields fields(PictureOptions& options);

/// Throws InputError naming `place`: values out of range, settings that do not go together, a name
/// that does not fit; SystemError: a video without the program ffmpeg.
void check_picture_options(const PictureOptions& options, const std::string& image,
                           const std::string& place);

/// True if there is a place for a number, %d or %04d and the like.
bool has_frame_number(const std::string& name);
/// Makes "name_%04d.png" with a number; the name itself when it has no %d.
std::string frame_name(const std::string& image, int frame);
/// Makes "name_depth.png" of "name.png" and "depth"; always a PNG.
std::string aux_name(const std::string& image, const std::string& channel);
/// The files of one picture of a series.
std::vector<std::string> frame_files(const PictureOptions& options, const std::string& image,
                                     int frame);
/// Lists every file that the pictures of one view become.
std::vector<std::string> picture_files(const PictureOptions& options, const std::string& image);

}  // namespace supple::tools
