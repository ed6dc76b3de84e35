#include "tools/pictures/picture_options.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <regex>

#include "tools/pictures/video.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

constexpr int kMaxFrames = 10000;
const std::vector<std::string> kAux = {"depth", "normal", "offset"};

/// %d or %04d and the like, once.
const std::regex& frame_pattern() {
  static const std::regex pattern("%(0([1-9]))?d");
  return pattern;
}

bool has_frame_number(const std::string& name) {
  return std::regex_search(name, frame_pattern());
}

StereoMode stereo_mode(const std::string& name) {
  return name == "anaglyph" ? StereoMode::anaglyph : StereoMode::side_by_side;
}

std::string one_of(const std::vector<std::string>& names) {
  std::string text = "one of";
  for (const std::string& name : names) text += " " + name;
  return text;
}

void check_ranges(const PictureOptions& options, const std::string& place) {
  const auto require = [&](bool good, const char* field, double found, const std::string& allowed) {
    if (!good) throw InputError({place, field, number_text(found), allowed});
  };
  require(options.bits == 8 || options.bits == 16, "bits", options.bits, "8 or 16");
  require(options.offset_max_mm >= 0 && std::isfinite(options.offset_max_mm), "offset_max",
          options.offset_max_mm, "0 mm or more");
  require(options.eye_separation_mm >= 0 && std::isfinite(options.eye_separation_mm),
          "eye_separation", options.eye_separation_mm, "0 mm or more");
  const std::string frames = std::to_string(kMaxFrames) + " pictures";
  require(options.turntable >= 0 && options.turntable <= kMaxFrames, "turntable", options.turntable,
          "1 to " + frames);
  require(options.sequence >= 0 && options.sequence != 1 && options.sequence <= kMaxFrames,
          "sequence", options.sequence, "2 to " + frames);
  const double fps = options.frames_per_second;
  require(fps >= 0.1 && fps <= 240, "fps", fps, "0.1 to 240 pictures a second");
  for (const std::string& channel : options.aux) {
    if (std::find(kAux.begin(), kAux.end(), channel) != kAux.end()) continue;
    throw InputError({place, "aux", "'" + channel + "'", one_of(kAux)});
  }
}

}  // namespace

PictureKind picture_kind(const std::string& path) {
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".png") return PictureKind::png;
  if (extension == ".exr") return PictureKind::exr;
  if (is_video_extension(extension)) return PictureKind::video;
  throw InputError({path, "output", extension.empty() ? "no extension" : "extension " + extension,
                    "extension .png or .exr, of a series also .mp4, .webm or .avi"});
}

PictureOptions read_picture_options(TomlTable& table) {
  PictureOptions options;
  const auto whole = [&](const char* key, int& value) {
    const auto number = table.integer(key);
    if (!number) return;
    if (*number < 1 || *number > kMaxFrames) {
      table.fail(key, std::to_string(*number), "1 to " + std::to_string(kMaxFrames));
    }
    value = int(*number);
  };
  whole("bits", options.bits);
  whole("turntable", options.turntable);
  whole("sequence", options.sequence);
  options.aux = table.strings("aux").value_or(options.aux);
  options.offset_max_mm = table.number("offset_max").value_or(options.offset_max_mm);
  options.eye_separation_mm = table.number("eye_separation").value_or(options.eye_separation_mm);
  options.frames_per_second = table.number("fps").value_or(options.frames_per_second);
  if (const auto stereo = table.string("stereo")) {
    if (*stereo != "side-by-side" && *stereo != "anaglyph") {
      table.fail("stereo", "\"" + *stereo + "\"", "\"side-by-side\" or \"anaglyph\"");
    }
    options.stereo = stereo_mode(*stereo);
  }
  return options;
}

void add_picture_options(CLI::App& app, PictureOptions& options) {
  app.add_option("--bits", options.bits, "Of a PNG: 8 (default) or 16")->option_text("B");
  app.add_option("--aux", options.aux,
                 "Also IMAGE_depth.png, _normal.png, _offset.png (lengths in mm with a legend)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->option_text("depth,normal,offset");
  app.add_option("--offset-max", options.offset_max_mm,
                 "End of the offsets' colours (default: the longest offset)")
      ->option_text("MM");
  app.add_option_function<std::string>(
         "--stereo", [&options](const std::string& name) { options.stereo = stereo_mode(name); },
         "A stereo pair: side-by-side, or anaglyph for red-cyan glasses")
      ->check(CLI::IsMember({"side-by-side", "anaglyph"}))
      ->option_text("MODE");
  app.add_option("--eye-separation", options.eye_separation_mm,
                 "Of a stereo pair (default: 1/30 of the distance to the target)")
      ->option_text("MM");
  app.add_option("--turntable", options.turntable,
                 "N pictures around the target, as a_%03d.png or a video (.mp4, .webm, .avi)")
      ->option_text("N");
  app.add_option("--sequence", options.sequence, "N pictures from rest to the deformed state")
      ->option_text("N");
  app.add_option("--fps", options.frames_per_second, "Pictures a second of a video, 25 by default")
      ->option_text("F");
}

void check_picture_options(const PictureOptions& options, const std::string& image,
                           const std::string& place) {
  check_ranges(options, place);
  const PictureKind kind = picture_kind(image);
  const auto refuse = [&](const char* field, const std::string& found,
                          const std::string& expected) {
    throw InputError({place, field, found, expected});
  };
  if (options.bits == 16 && kind != PictureKind::png) refuse("bits", "16 of " + image, "a PNG");
  if (options.turntable > 0 && options.sequence > 0) {
    refuse("sequence", "turntable and sequence", "one of both");
  }
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

std::vector<std::string> picture_files(const PictureOptions& options, const std::string& image) {
  if (picture_kind(image) == PictureKind::video || !options.is_series()) {
    std::vector<std::string> files = {image};
    for (const std::string& channel : options.aux) files.push_back(aux_name(image, channel));
    return files;
  }
  std::vector<std::string> files;
  for (int n = 0; n < options.frame_count(); ++n) {
    const std::string name = frame_name(image, n);
    files.push_back(name);
    for (const std::string& channel : options.aux) files.push_back(aux_name(name, channel));
  }
  return files;
}

}  // namespace supple::tools
