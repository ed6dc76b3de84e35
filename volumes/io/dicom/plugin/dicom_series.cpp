#include "volumes/io/dicom/plugin/dicom_series.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "volumes/base/error.h"
#include "volumes/io/dicom/dicom.h"

namespace supple {

namespace {

struct SeriesEntry {
  SeriesMember first;
  std::vector<std::string> files;
};
using SeriesByUid = std::map<std::string, SeriesEntry>;

struct Folder {
  SeriesByUid series;
  std::vector<Problem> damaged;  // DICOM files that cannot be parsed
};

std::string name_of_file(const std::string& path) {
  return std::filesystem::path(path).filename().string();
}

/// Regular files of the folder, by name; nothing else is opened, since pipes can block.
std::vector<std::string> regular_files(const std::string& folder) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::error_code unknown;
    if (!entry.is_regular_file(unknown) || entry.file_size(unknown) < kDicomHead) continue;
    files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Folder contents_of(const std::vector<std::string>& files) {
  Folder folder;
  for (const std::string& path : files) {
    const InputFile input(path);
    if (is_gzipped_dicom(input)) {
      folder.damaged.push_back(
          {path, "format", "a gzipped DICOM file", "the file unpacked (gunzip)"});
    }
    if (!is_dicom(input.head(kDicomHead))) continue;
    try {
      DicomFile file = read_attributes(path);
      const std::optional<SeriesMember> member = series_member(file);
      if (!member) continue;
      const auto place = folder.series.try_emplace(member->series_uid, SeriesEntry{*member, {}});
      place.first->second.files.push_back(path);
    } catch (const InputError& error) {
      folder.damaged.push_back(error.problem());
    }
  }
  return folder;
}

/// "2 files \"T1 axial\" (…1.7.42, such as a.dcm)".
std::string description_of(const SeriesEntry& entry) {
  constexpr std::size_t kTail = 12;
  const std::string& uid = entry.first.series_uid;
  return std::to_string(entry.files.size()) + " files \"" +
         printable(entry.first.description.substr(0, 30)) + "\" (UID ..." +
         printable(uid.size() > kTail ? uid.substr(uid.size() - kTail) : uid) + ", such as " +
         printable(name_of_file(entry.files.front())) + ")";
}

std::vector<std::string> only_series(const std::string& path, const Folder& folder) {
  const SeriesByUid& series = folder.series;
  if (series.empty() && !folder.damaged.empty()) throw InputError(folder.damaged.front());
  if (series.empty()) throw InputError({path, "DICOM files", "none with an image", "a series"});
  if (series.size() == 1) return series.begin()->second.files;
  constexpr int kListed = 3;
  std::string found = std::to_string(series.size()) + " series";
  int listed = 0;
  for (const auto& [uid, entry] : series) {
    if (listed == kListed) found += ", ...";
    if (listed++ >= kListed) break;
    found += (listed == 1 ? ": " : ", ") + description_of(entry);
  }
  throw InputError({path, "DICOM series", found, "one: name a file of it in place of the folder"});
}

std::vector<std::string> same_series(const std::string& path, const std::string& uid,
                                     const Folder& folder) {
  const auto found = folder.series.find(uid);
  return found == folder.series.end() ? std::vector<std::string>{path} : found->second.files;
}

/// Copies of one instance under several names count once.
void add_image(DicomFile& file, const ReadOptions& options, std::set<std::string>& instances,
               DicomSeries& series) {
  DicomImage image = read_image(file, options);
  if (!image.instance_uid.empty() && !instances.insert(image.instance_uid).second) {
    series.warnings.push_back(printable(name_of_file(image.path)) +
                              " is a copy of another slice; it is left out");
    return;
  }
  series.images.push_back(std::move(image));
}

/// Scouts lie across the slices that were planned on them; some scanners put them into the series.
void leave_out_scouts(const std::string& path, DicomSeries& series) {
  std::vector<DicomImage> slices, scouts;
  for (DicomImage& image : series.images) {
    (image.is_scout ? scouts : slices).push_back(std::move(image));
  }
  const auto named = [&](const DicomImage& image) { return image.path == path; };
  if (slices.empty() || std::any_of(scouts.begin(), scouts.end(), named)) {
    slices.swap(scouts);
  } else {
    for (const DicomImage& scout : scouts) {
      series.warnings.push_back(printable(name_of_file(scout.path)) +
                                " is left out: ImageType LOCALIZER, a scout of the series");
    }
  }
  for (std::size_t n = 0; n < slices.size(); ++n) {
    for (ImagePlane& plane : slices[n].planes) plane.image = n;
  }
  series.images = std::move(slices);
}

std::string numbers_text(std::initializer_list<double> numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : "\\") + number_text(number);
  return text;
}

std::string orientation_text(const ImagePlane& plane) {
  const Vec3d &row = plane.row, &column = plane.column;
  return numbers_text({row.x, row.y, row.z, column.x, column.y, column.z});
}

/// Compares one value of two images.
struct SeriesComparison {
  const DicomImage& first;
  const DicomImage& other;

  void require(bool same, const char* field, const std::string& expected,
               const std::string& found) const {
    if (same) return;
    throw InputError(
        {other.path, field, found,
         expected + " as in " + printable(name_of_file(first.path)) + " of the same series"});
  }
  void require(const char* field, int expected, int found) const {
    require(expected == found, field, std::to_string(expected), std::to_string(found));
  }
};

void check_plane(const SeriesComparison& compare, const ImagePlane& a, const ImagePlane& b) {
  constexpr double kTolerance = 1e-3;
  const bool same_spacing = std::abs(a.row_mm - b.row_mm) <= kTolerance * a.row_mm &&
                            std::abs(a.column_mm - b.column_mm) <= kTolerance * a.column_mm;
  compare.require(same_spacing, "PixelSpacing", numbers_text({a.row_mm, a.column_mm}),
                  numbers_text({b.row_mm, b.column_mm}));
  const bool same_directions =
      (a.row - b.row).length() <= kTolerance && (a.column - b.column).length() <= kTolerance;
  compare.require(same_directions, "ImageOrientationPatient", orientation_text(a),
                  orientation_text(b));
}

/// The first of the images that are like most others in size and orientation.
std::size_t usual_image(const DicomSeries& series) {
  std::map<std::string, std::vector<std::size_t>> alike;
  for (std::size_t n = 0; n < series.images.size(); ++n) {
    const DicomImage& image = series.images[n];
    alike[std::to_string(image.format.rows) + " " + std::to_string(image.format.columns) + " " +
          orientation_text(image.planes.front())]
        .push_back(n);
  }
  std::size_t usual = 0, most = 0;
  for (const auto& [kind, images] : alike) {
    if (images.size() < most || (images.size() == most && images.front() > usual)) continue;
    most = images.size();
    usual = images.front();
  }
  return usual;
}

}  // namespace

DicomSeries find_series(const std::string& path, const ReadOptions& options) {
  DicomSeries series;
  series.path = path;
  std::vector<std::string> files = {path};
  Folder folder;
  if (std::filesystem::is_directory(path)) {
    folder = contents_of(regular_files(path));
    files = only_series(path, folder);
  } else {
    DicomFile file = read_attributes(path);
    const std::optional<SeriesMember> member = series_member(file);
    if (!member) throw InputError({path, "Rows and Columns", "nothing", "a DICOM image"});
    if (!member->multi_frame && !member->series_uid.empty()) {
      const std::string parent = std::filesystem::path(path).parent_path().string();
      folder = contents_of(regular_files(parent.empty() ? "." : parent));
      files = same_series(path, member->series_uid, folder);
    }
  }
  std::set<std::string> instances;
  for (const std::string& name : files) {
    DicomFile file = read_attributes(name);
    add_image(file, options, instances, series);
  }
  leave_out_scouts(path, series);
  for (const Problem& problem : folder.damaged) {
    series.warnings.push_back(printable(name_of_file(problem.file)) +
                              " is left out: " + problem.field + ": " + printable(problem.found));
  }
  return series;
}

void check_alike(const DicomSeries& series) {
  const DicomImage& first = series.images[usual_image(series)];
  for (const DicomImage& other : series.images) {
    const SeriesComparison compare{first, other};
    const PixelFormat &a = first.format, &b = other.format;
    compare.require("Rows", a.rows, b.rows);
    compare.require("Columns", a.columns, b.columns);
    compare.require("BitsAllocated", a.bits_allocated, b.bits_allocated);
    compare.require("PixelRepresentation", a.is_signed, b.is_signed);
    const auto photometric = [](const PixelFormat& format) {
      return std::string(format.inverted ? "MONOCHROME1" : "MONOCHROME2");
    };
    compare.require(a.inverted == b.inverted, "PhotometricInterpretation", photometric(a),
                    photometric(b));
    for (const ImagePlane& plane : other.planes) check_plane(compare, first.planes.front(), plane);
  }
}

}  // namespace supple
