#include "volumes/io/tiff/tiff_metadata.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/length_units.h"

namespace supple {

namespace {

using Keys = std::map<std::string, std::string>;

/// The lines "key=value" of an ImageJ description; other lines say nothing here.
Keys keys_of(const std::string& description) {
  Keys keys;
  LineReader lines(description);
  for (std::string line; lines.next(line);) {
    const std::size_t equals = line.find('=');
    if (equals == std::string::npos) continue;
    keys.emplace(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
  }
  return keys;
}

std::int64_t count_of(const std::string& path, const Keys& keys, const char* name) {
  const auto found = keys.find(name);
  if (found == keys.end()) return 1;
  const HeaderField field{path, std::string("ImageDescription, ") + name, found->second};
  const std::int64_t count = field.integer();
  if (count < 1 || count > 0x7fffffff) field.fail("1 to 2147483647");
  return count;
}

/// Strides of the order in which ImageJ counts; "czt" unless the description says otherwise.
void set_order(const std::string& path, const Keys& keys, TiffLayout& layout) {
  const auto found = keys.find("order");
  std::string order = found == keys.end() ? "czt" : lower_case(found->second);
  if (order == "default") order = "czt";
  const std::map<char, std::pair<std::int64_t, std::int64_t*>> axes = {
      {'c', {layout.channels, &layout.channel_stride}},
      {'z', {layout.slices, &layout.slice_stride}},
      {'t', {layout.frames, &layout.frame_stride}}};
  std::string sorted = order;
  std::sort(sorted.begin(), sorted.end());
  if (sorted != "ctz") {
    HeaderField{path, "ImageDescription, order", order}.fail("the letters c, z and t");
  }
  std::int64_t stride = 1;
  for (const char letter : order) {
    *axes.at(letter).second = stride;
    stride *= axes.at(letter).first;
  }
}

/// Pages, or images of a run behind the only page, must be as many as the description says.
void match_counts(const TiffPages& pages, const Keys& keys, TiffLayout& layout) {
  const std::string& path = pages.file().path();
  const auto count = std::int64_t(pages.count());
  const std::int64_t images = keys.count("images") ? count_of(path, keys, "images") : count;
  // Samples that lie together in a pixel may be declared as channels (Bio-Formats, RGB).
  if (layout.channels == pages.format().samples &&
      double(count) == double(layout.slices) * double(layout.frames)) {
    layout.channels = 1;
  }
  const double described = double(layout.slices) * double(layout.channels) * double(layout.frames);
  if (described == 1) layout.slices = count > 1 ? count : images;  // a stack of no named axes
  const double planes = double(layout.slices) * double(layout.channels) * double(layout.frames);
  if (planes == double(count)) return;
  if (count > 1 || planes != double(images)) {
    throw InputError({path, "ImageDescription",
                      number_text(planes) + " images (channels x slices x frames)",
                      std::to_string(count > 1 ? count : images) +
                          (count > 1 ? " as there are pages" : " as \"images\" says")});
  }
  layout.is_run = true;
}

/// A run's values are plain, in one piece, and inside the file.
void check_run(const TiffPages& pages, const TiffLayout& layout) {
  const std::string& path = pages.file().path();
  if (!pages.first_byte()) {
    throw InputError({path, "TIFF pages", "1, compressed or scattered",
                      number_text(double(layout.slices * layout.channels * layout.frames)) +
                          " pages, or uncompressed values in one piece"});
  }
  const double bytes = double(layout.slices) * double(layout.channels) * double(layout.frames) *
                       double(pages.format().bytes());
  if (double(*pages.first_byte()) + bytes <= double(pages.file().size())) return;
  throw InputError({path, "file length", std::to_string(pages.file().size()) + " bytes",
                    number_text(double(*pages.first_byte()) + bytes) +
                        " bytes for the images of ImageDescription"});
}

/// The shape of an array that tifffile noted, slowest axis first: the axes before those of a page
/// are frames and slices. One page of several is the head of a run ("truncate"). A shape that does
/// not fit, as after an edit, says nothing.
void read_shape(const TiffPages& pages, TiffLayout& layout) {
  const Value shape = json_or_null(pages.description())["shape"];
  if (!shape.is_list()) return;
  const TiffPage& page = pages.format();
  const double rest = double(page.width) * double(page.height) * page.samples;
  double values = 1, before = 1, last = 1;
  for (const Value& size : shape.items()) {
    if (!size.is_whole() || size.whole() <= 0) return;
    values *= size.number();
  }
  for (std::size_t n = 0; n < shape.size() && values > rest; ++n) {
    before *= last;
    last = shape[n].number();
    values /= last;
  }
  const auto count = double(pages.count());
  const bool is_run = count == 1 && before * last > 1;
  if (values != rest || before * last > 2147483647.0 || (before * last != count && !is_run)) return;
  layout.slices = std::int64_t(last);
  layout.frames = std::int64_t(before);
  layout.frame_stride = layout.slices;
  layout.is_run = is_run;
  if (is_run) check_run(pages, layout);
}

double positive_or(double value, double fallback) {
  return std::isfinite(value) && value > 0 ? value : fallback;
}

/// Voxels in mm: resolutions count pixels per unit of the description, spacing is in that unit.
void read_spacing(const TiffPages& pages, const Keys& keys, TiffLayout& layout) {
  const TiffResolution& resolution = pages.resolution();
  const bool is_default = resolution.unit == 2 && resolution.x == 72 && resolution.y == 72;
  Vec3d spacing(1, 1, 1);
  if (!is_default) {
    spacing.x = 1 / positive_or(resolution.x, 1);
    spacing.y = 1 / positive_or(resolution.y, 1);
  }
  const auto depth = keys.find("spacing");
  if (depth != keys.end()) {
    const HeaderField field{pages.file().path(), "ImageDescription, spacing", depth->second};
    spacing.z = positive_or(std::abs(field.number()), 1);
  }
  const auto named = keys.find("unit");
  const std::string unit = named != keys.end()                                       ? named->second
                           : resolution.unit == 2 && !is_default && resolution.x > 0 ? "inch"
                           : resolution.unit == 3 && resolution.x > 0                ? "cm"
                                                                                     : "";
  layout.spacing_mm = spacing;
  // "yunit" and "zunit" stand there where they differ from "unit", which is that of x.
  const char* const names[] = {"unit", "yunit", "zunit"};
  std::string unknown;
  for (int a = 0; a < 3; ++a) {
    const auto own = keys.find(names[a]);
    const std::string& of_axis = own != keys.end() ? own->second : unit;
    const std::optional<double> factor = mm_per_unit(of_axis);
    if (!factor && spacing != Vec3d(1, 1, 1)) unknown = of_axis.empty() ? " " : of_axis;
    layout.spacing_mm[a] *= factor.value_or(1);
  }
  if (!unknown.empty()) {
    layout.warnings.push_back("unit \"" + printable(trimmed(unknown)) +
                              "\" of ImageDescription is no length; voxel sizes count as mm");
  }
}

/// Densities by a straight line c0 + c1 x of the stored values, as ImageJ keeps signed values and
/// Hounsfield units in unsigned ones. Other functions are told and not applied.
void read_calibration(const TiffPages& pages, const Keys& keys, TiffLayout& layout) {
  const auto function = keys.find("cf");
  if (function == keys.end()) return;
  const std::string& path = pages.file().path();
  const auto number = [&](const char* name, double fallback) {
    const auto found = keys.find(name);
    if (found == keys.end()) return fallback;
    return HeaderField{path, std::string("ImageDescription, ") + name, found->second}.number();
  };
  const std::int64_t code = HeaderField{path, "ImageDescription, cf", function->second}.integer();
  constexpr std::int64_t kStraightLine = 0, kNone = 20;
  if (code == kNone) return;
  if (code != kStraightLine) {
    layout.warnings.push_back("calibration function " + std::to_string(code) +
                              " of ImageJ is not applied: values are those that are stored");
    return;
  }
  layout.intercept = number("c0", 0);
  layout.slope = number("c1", 1);
}

void read_affine(const TiffPages& pages, const Keys& keys, TiffLayout& layout) {
  const auto found = keys.find(kTiffAffineKey);
  if (found == keys.end()) return;
  const HeaderField field{pages.file().path(), kTiffAffineKey, found->second};
  const std::vector<double> numbers = field.numbers();
  if (numbers.size() != 12) field.fail("twelve numbers");
  // Another program may have changed the sizes since; then its word counts.
  for (int a = 0; a < 3; ++a) {
    const Vec3d axis(numbers[3 * a], numbers[3 * a + 1], numbers[3 * a + 2]);
    const double said = layout.spacing_mm[a];
    if (!(std::abs(axis.length() - said) <= 1e-5 * said)) return;
  }
  layout.affine = numbers;
}

}  // namespace

std::int64_t TiffLayout::page_of(std::int64_t slice, std::int64_t channel,
                                 std::int64_t frame) const {
  const std::int64_t n = slice * slice_stride + channel * channel_stride + frame * frame_stride;
  return pages.empty() ? n : std::int64_t(pages[std::size_t(n)]);
}

TiffLayout imagej_layout(const TiffPages& pages) {
  const std::string& path = pages.file().path();
  const Keys keys = keys_of(pages.description());
  TiffLayout layout;
  layout.palette_is_display = true;
  layout.slices = count_of(path, keys, "slices");
  layout.channels = count_of(path, keys, "channels");
  layout.frames = count_of(path, keys, "frames");
  match_counts(pages, keys, layout);
  if (layout.is_run) check_run(pages, layout);
  set_order(path, keys, layout);
  read_spacing(pages, keys, layout);
  read_calibration(pages, keys, layout);
  read_affine(pages, keys, layout);
  return layout;
}

TiffLayout plain_layout(const TiffPages& pages) {
  TiffLayout layout;
  layout.slices = std::int64_t(pages.count());
  read_shape(pages, layout);
  const TiffResolution& resolution = pages.resolution();
  const double mm = resolution.unit == 2 ? 25.4 : resolution.unit == 3 ? 10 : 0;
  const bool is_said =
      mm > 0 && positive_or(resolution.x, 0) > 0 && positive_or(resolution.y, 0) > 0;
  if (!is_said) return layout;
  if (resolution.unit == 2 && resolution.x == resolution.y &&
      (resolution.x == 72 || resolution.x == 96)) {
    layout.warnings.push_back(
        "a resolution of " + number_text(resolution.x) +
        " dpi is a screen's and no measure; voxels are 1 mm (spacing can be given)");
    return layout;
  }
  layout.spacing_mm = {mm / resolution.x, mm / resolution.y, 1};
  if (layout.slices > 1) {
    layout.warnings.push_back(
        "the distance of slices is not recorded; it counts as 1 mm "
        "(spacing can be given)");
  }
  return layout;
}

TiffLayout tiff_layout(const TiffPages& pages) {
  const std::string& text = pages.description();
  if (text.compare(0, 7, "ImageJ=") == 0 || text.compare(0, 7, "SCIFIO=") == 0) {
    return imagej_layout(pages);
  }
  const std::size_t end = text.find_last_not_of(" \t\r\n");
  const bool is_ome = text.compare(0, 1, "<") == 0 && end != std::string::npos && end >= 4 &&
                      text.compare(end - 3, 4, "OME>") == 0;
  return is_ome ? ome_layout(pages) : plain_layout(pages);
}

}  // namespace supple
