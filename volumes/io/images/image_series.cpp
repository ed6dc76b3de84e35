// A folder's hidden files, folders and files with other extensions are passed over. Numbers that
// are missing are a warning. In-plane spacing is that of the first image; the distance of slices is
// 1 mm. Cost: one image and one slice at a time; the names of all files.
#include "volumes/io/images/image_series.h"

#include <algorithm>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

namespace fs = std::filesystem;

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// "name%04d.tif" taken apart; width 0 where the numbers are not padded.
struct Pattern {
  std::string before, after;
  std::size_t width = 0;
  bool zeros = false;
};

bool parse_pattern(const std::string& name, Pattern& pattern) {
  const std::size_t start = name.find('%');
  if (start == std::string::npos) return false;
  std::size_t at = start + 1;
  pattern.zeros = at < name.size() && name[at] == '0';
  const std::size_t digits = at;
  while (at < name.size() && is_digit(name[at])) ++at;
  if (at >= name.size() || name[at] != 'd' || at - digits > 3) return false;
  pattern.width = at > digits ? std::size_t(std::stoi(name.substr(digits, at - digits))) : 0;
  pattern.before = name.substr(0, start);
  pattern.after = name.substr(at + 1);
  return pattern.after.find('%') == std::string::npos;
}

bool matches(const Pattern& pattern, const std::string& name) {
  const std::size_t around = pattern.before.size() + pattern.after.size();
  if (name.size() <= around || name.compare(0, pattern.before.size(), pattern.before) != 0 ||
      name.compare(name.size() - pattern.after.size(), std::string::npos, pattern.after) != 0) {
    return false;
  }
  std::string number = name.substr(pattern.before.size(), name.size() - around);
  if (number.size() < pattern.width) return false;
  const bool is_padded = number.size() == pattern.width;
  if (!pattern.zeros && is_padded) number.erase(0, number.find_first_not_of(' '));
  const bool is_plain = number.size() == 1 || (!number.empty() && number[0] != '0');
  return std::all_of(number.begin(), number.end(), is_digit) && !number.empty() &&
         (is_plain || (pattern.zeros && is_padded));
}

/// A run of digits of a name without leading zeros, so that longer means larger.
std::string number_at(const std::string& name, std::size_t& at) {
  while (at + 1 < name.size() && name[at] == '0' && is_digit(name[at + 1])) ++at;
  const std::size_t first = at;
  while (at < name.size() && is_digit(name[at])) ++at;
  return name.substr(first, at - first);
}

/// Orders names by the numbers inside them, as people sort: s2 before s10.
bool comes_before(const std::string& a, const std::string& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_digit(a[i]) && is_digit(b[j])) {
      const std::string m = number_at(a, i), n = number_at(b, j);
      if (m.size() != n.size()) return m.size() < n.size();
      if (m != n) return m < n;
    } else if (a[i] != b[j]) {
      return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
    } else {
      ++i;
      ++j;
    }
  }
  if (i < a.size() || j < b.size()) return i == a.size();
  return a < b;  // s1 and s01
}

bool is_tiff_name(const std::string& name) {
  const std::string extension = lower_case(fs::path(name).extension().string());
  return extension == ".tif" || extension == ".tiff";
}
bool is_image_name(const std::string& name) {
  return is_tiff_name(name) || lower_case(fs::path(name).extension().string()) == ".png";
}

std::vector<std::string> names_in(const std::string& folder, const Pattern* pattern) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end;
       !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    const bool wanted =
        pattern != nullptr ? matches(*pattern, name) : name[0] != '.' && is_image_name(name);
    std::error_code ignored;
    if (wanted && fs::is_regular_file(entry->path(), ignored)) names.push_back(name);
  }
  if (error) throw_open_error(folder, error.value());
  std::sort(names.begin(), names.end(), comes_before);
  return names;
}

/// The last number in a name, which counts the slices; -1 where there is none or a very long one.
std::int64_t slice_number(const std::string& name) {
  const std::string stem = fs::path(name).stem().string();
  std::size_t end = stem.size();
  while (end > 0 && !is_digit(stem[end - 1])) --end;
  std::size_t first = end;
  while (first > 0 && is_digit(stem[first - 1])) --first;
  if (first == end || end - first > 18) return -1;
  return std::stoll(stem.substr(first, end - first));
}

/// Says which numbers are missing where the names otherwise count evenly; "" for an even count.
std::string missing_numbers(const std::vector<std::string>& names) {
  std::vector<std::int64_t> numbers;
  for (const std::string& name : names) numbers.push_back(slice_number(name));
  std::int64_t step = 0, missing = 0;
  for (std::size_t n = 1; n < numbers.size(); ++n) {
    const std::int64_t difference = numbers[n] - numbers[n - 1];
    if (numbers[n - 1] < 0 || difference <= 0) return "";
    step = step == 0 ? difference : std::min(step, difference);
  }
  std::string first;
  for (std::size_t n = 1; n < numbers.size(); ++n) {
    const std::int64_t gap = (numbers[n] - numbers[n - 1]) / step - 1;
    if (gap > 0 && first.empty()) first = names[n - 1] + " and " + names[n];
    missing += gap;
  }
  if (missing == 0) return "";
  return std::to_string(missing) + (missing == 1 ? " slice is" : " slices are") +
         " missing by the files' numbers, the first between " + printable(first) +
         "; the others are stacked without a gap";
}

std::unique_ptr<VolumeFile> open_image(const std::string& path) {
  return is_tiff_name(path) ? open_tiff(path, {}) : open_png(path);
}

std::string words_for(const VolumeHeader& header) {
  const Vec3i& dims = header.geometry.dims();
  return std::to_string(dims.x) + " x " + std::to_string(dims.y) + " " + numpy_name(header.type) +
         (header.components > 1 ? " with " + std::to_string(header.components) + " components"
                                : "") +
         (header.slope != 1 ? ", MinIsWhite" : "");
}

class SeriesVolume : public VolumeFile {
 public:
  SeriesVolume(const std::string& path, std::string folder, std::vector<std::string> names)
      : m_folder(std::move(folder)), m_names(std::move(names)) {
    const std::unique_ptr<VolumeFile> first = open_slice(0);
    m_header = first->header();
    m_header.path = path;
    for (std::size_t n = 0; n < m_names.size(); ++n) m_header.data_files.push_back(path_of(n));
    m_looks = words_for(m_header);
    const Vec3i dims(m_header.geometry.dims().x, m_header.geometry.dims().y, int(m_names.size()));
    m_header.geometry =
        make_geometry(path, dims, m_header.geometry.origin_lps_mm(), m_header.geometry.axes_mm());
    const Vec3d spacing = m_header.geometry.spacing_mm();
    if (dims.z > 1 && spacing.z == 1 && (spacing.x != 1 || spacing.y != 1)) {
      m_header.warnings.push_back(
          "the distance of slices is not recorded; it counts as 1 mm (spacing can be given)");
    }
    const std::string missing = missing_numbers(m_names);
    if (!missing.empty()) m_header.warnings.push_back(missing);
  }

  void read_slice(void* out) override {
    if (m_slice >= m_names.size()) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    const std::unique_ptr<VolumeFile> image = open_slice(m_slice++);
    const std::string looks = words_for(image->header());
    if (looks != m_looks) {
      throw InputError(
          {image->header().path, "image", looks, m_looks + " as in " + printable(m_names.front())});
    }
    image->read_slice(out);
  }

  void skip_slices(int count) override { m_slice += std::size_t(count); }

 private:
  std::string path_of(std::size_t n) const { return (fs::path(m_folder) / m_names[n]).string(); }

  std::unique_ptr<VolumeFile> open_slice(std::size_t n) const {
    const std::string path = path_of(n);
    std::unique_ptr<VolumeFile> image = open_image(path);
    const int pages = image->header().geometry.dims().z;
    if (pages != 1) {
      throw InputError({path, "TIFF pages", std::to_string(pages), "one image, as a slice"});
    }
    return image;
  }

  std::string m_folder;
  std::vector<std::string> m_names;
  std::string m_looks;
  std::size_t m_slice = 0;
};

}  // namespace

bool is_series_pattern(const std::string& path) {
  Pattern pattern;
  std::error_code ignored;
  return parse_pattern(fs::path(path).filename().string(), pattern) && !fs::exists(path, ignored);
}

std::unique_ptr<VolumeFile> open_image_series(const std::string& path, const ReadOptions& options) {
  Pattern pattern;
  const bool by_pattern = is_series_pattern(path);
  if (by_pattern) parse_pattern(fs::path(path).filename().string(), pattern);
  const std::string folder = by_pattern ? fs::path(path).parent_path().string() : path;
  std::vector<std::string> names = names_in(folder, by_pattern ? &pattern : nullptr);
  if (names.empty()) {
    const char* found = by_pattern ? "no file of such a name" : "a directory without images";
    throw InputError({path, "series", found, "TIFF or PNG files, one per slice"});
  }
  for (const std::string& name : names) {
    if (is_image_name(name) && is_tiff_name(name) == is_tiff_name(names.front())) continue;
    throw InputError({path, "series",
                      printable(names.front() == name ? name : names.front() + " and " + name),
                      "TIFF files or PNG files alone"});
  }
  chosen_frame(options, 1, path, "frames");
  return std::make_unique<SeriesVolume>(path, folder, std::move(names));
}

}  // namespace supple
