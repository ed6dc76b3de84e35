#include "tools/scene/pictures/picture_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>

#include "tools/scene/pictures/video.h"
#include "volumes/base/error.h"
#include "volumes/base/units.h"

namespace supple::tools {

namespace {

/// %d or %04d and the like, once.
const std::regex& frame_pattern() {
  static const std::regex pattern("%(0([1-9]))?d");
  return pattern;
}

/// A film is made frame by frame, its video of the files.
void check_film(const PictureOptions& options, const std::string& image, const std::string& place) {
  const auto refuse = [&](const char* field, const std::string& found,
                          const std::string& expected) {
    throw InputError({place, field, found, expected});
  };
  if (options.film == 0) {
    if (!options.video.empty()) refuse("video", options.video, "a scene with [film]");
    return;
  }
  if (options.turntable > 0) refuse("turntable", "a turntable in a film", "turn in camera_path");
  if (options.sequence > 0) refuse("sequence", "a sequence in a film", "a path of the handle");
  if (picture_kind(image) == PictureKind::video) {
    refuse("image", image, "numbered pictures, and video = \"" + image + "\" beside them");
  }
  if (options.video.empty()) return;
  if (!is_video_extension(std::filesystem::path(options.video).extension().string())) {
    refuse("video", options.video, "extension .mp4, .webm or .avi");
  }
  if (picture_kind(image) != PictureKind::png || options.bits != 8) {
    refuse("video", "a video of " + image, "PNG files of 8 bits");
  }
  require_video_encoder(options.video);
}

/// Motion and numbers have no picture of their own.
void check_channels(const PictureOptions& options, PictureKind kind, const std::string& place) {
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError({place, "aux", found, expected});
  };
  for (const char* channel : {"motion", "id"}) {
    if (!options.shows(channel)) continue;
    if (kind != PictureKind::exr) {
      refuse(std::string(channel) + " of what is no .exr", "an .exr, whose channels these are");
    }
    if (options.stereo != StereoMode::none) {
      refuse(std::string(channel) + " of a stereo pair", "no stereo");
    }
  }
  if (options.shows("motion") && options.film == 0 && options.turntable == 0) {
    refuse("motion of a single picture or a sequence", "a scene with [film], or a turntable");
  }
}

}  // namespace

bool has_frame_number(const std::string& name) {
  return std::regex_search(name, frame_pattern());
}

double PictureOptions::fraction_at(int n) const {
  constexpr double kTurn = 2 * kPi;
  if (sequence == 0) return 1;
  return swing ? std::sin(kTurn * n / sequence) : double(n) / (sequence - 1);
}

PictureKind picture_kind(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".png") return PictureKind::png;
  if (extension == ".exr") return PictureKind::exr;
  if (is_video_extension(extension)) return PictureKind::video;
  throw InputError({path, "output", extension.empty() ? "no extension" : "extension " + extension,
                    "extension .png or .exr, of a series also .mp4, .webm or .avi"});
}

Fields fields(PictureOptions& options) {
  return {
      Field("bits", options.bits, "Of a PNG: 8 or 16; 16 of an .exr: half floats")
          .range(8, 16)
          .shown_as("8|16")
          .for_slices(),
      Field("aux", options.aux,
            "Also IMAGE_depth.png, _normal.png, _offset.png (lengths in mm with a legend); .exr: "
            "motion and id, too")
          .one_of({"depth", "normal", "offset", "motion", "id"})
          .shown_as("NAMES"),
      Field("offset_max", options.offset_max_mm, "End of the offsets' colours")
          .unit("mm")
          .at_least(0)
          .otherwise("the longest offset"),
      Field("stereo", options.stereo, {"none", "side-by-side", "anaglyph"},
            "side-by-side, or anaglyph for red-cyan glasses")
          .shown_as("MODE"),
      Field("eye_separation", options.eye_separation_mm, "Of a stereo pair")
          .unit("mm")
          .at_least(0)
          .otherwise("1/30 of the distance to the target"),
      Field("turntable", options.turntable,
            "N pictures around the target: a_%03d.png, .mp4, .webm or .avi")
          .range(1, kMostFrames)
          .otherwise(""),
      Field("sequence", options.sequence, "N pictures from rest to the deformed state")
          .for_slices()
          .range(2, kMostFrames)
          .otherwise(""),
      Field("swing", options.swing, "Sequence of one oscillation, the state its largest swing")
          .for_slices(),
      Field("fps", options.frames_per_second, "Pictures a second of a video or of .exr")
          .for_slices()
          .range(0.1, 240)
          .shown_as("F"),
      Field("video", options.video, "Also a video (.mp4, .webm, .avi) of the PNG files of a film")
          .for_slices()
          .only_in_scenes()
          .shown_as("FILE"),
  };
}

void check_picture_options(const PictureOptions& options, const std::string& image,
                           const std::string& place) {
  const PictureKind kind = picture_kind(image);
  const auto refuse = [&](const char* field, const std::string& found,
                          const std::string& expected) {
    throw InputError({place, field, found, expected});
  };
  if (options.bits != 8 && options.bits != 16) {
    refuse("bits", std::to_string(options.bits), "8 or 16");
  }
  if (options.bits == 16 && kind == PictureKind::video) {
    refuse("bits", "16 of " + image, "a PNG or .exr");
  }
  check_film(options, image, place);
  check_channels(options, kind, place);
  if (options.turntable > 0 && options.sequence > 0) {
    refuse("sequence", "turntable and sequence", "one of both");
  }
  if (options.swing && options.sequence == 0)
    refuse("swing", "no sequence", "a sequence beside it");
  if (kind == PictureKind::video) {
    if (!options.is_series()) refuse("image", image, "a turntable or a sequence for a video");
    if (!options.aux.empty()) refuse("aux", "pictures beside a video", "a series of PNG files");
    require_video_encoder(image);
  } else if (options.is_series() && !has_frame_number(image)) {
    refuse("image", image, "the number of the picture in the name of a series, as in a_%03d.png");
  }
  if (!options.aux.empty() && options.stereo == StereoMode::anaglyph) {
    refuse("aux", "pictures beside an anaglyph", "side-by-side or no stereo");
  }
}

bool PictureOptions::shows(const std::string& channel) const {
  return std::find(aux.begin(), aux.end(), channel) != aux.end();
}

std::vector<std::string> PictureOptions::maps() const {
  std::vector<std::string> channels = aux;
  const auto is_no_map = [](const std::string& name) { return name == "motion" || name == "id"; };
  channels.erase(std::remove_if(channels.begin(), channels.end(), is_no_map), channels.end());
  return channels;
}

std::string frame_name(const std::string& image, int frame) {
  std::smatch match;
  if (!std::regex_search(image, match, frame_pattern())) return image;
  const std::size_t digits = match[2].matched ? std::size_t(std::stoi(match[2])) : 1;
  std::string number = std::to_string(frame);
  if (number.size() < digits) number.insert(0, digits - number.size(), '0');
  return match.prefix().str() + number + match.suffix().str();
}

std::string aux_name(const std::string& image, const std::string& channel) {
  const std::filesystem::path path(image);
  return (path.parent_path() / (path.stem().string() + "_" + channel + ".png")).string();
}

std::vector<std::string> frame_files(const PictureOptions& options, const std::string& image,
                                     int frame) {
  const std::string name = frame_name(image, frame);
  std::vector<std::string> files = {name};
  for (const std::string& channel : options.maps()) files.push_back(aux_name(name, channel));
  return files;
}

std::vector<std::string> picture_files(const PictureOptions& options, const std::string& image) {
  if (picture_kind(image) == PictureKind::video || !options.is_series()) {
    std::vector<std::string> files = {image};
    for (const std::string& channel : options.maps()) files.push_back(aux_name(image, channel));
    return files;
  }
  std::vector<std::string> files;
  for (int n = 0; n < options.frame_count(); ++n) {
    const std::vector<std::string> more = frame_files(options, image, n);
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

}  // namespace supple::tools
