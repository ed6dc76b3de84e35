#include "volumes/io/nrrd/nrrd_segments.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "volumes/base/error.h"
#include "volumes/grid/labels.h"

namespace supple {

namespace {

/// N of "SegmentN_Name"; -1 for other keys.
int segment_number(const std::string& key, const std::string& what) {
  const std::string prefix = "Segment", suffix = "_" + what;
  if (key.size() <= prefix.size() + suffix.size() || key.rfind(prefix, 0) != 0) return -1;
  const char* end = key.data() + key.size() - suffix.size();
  if (end != suffix) return -1;
  int number = -1;
  const auto result = std::from_chars(key.data() + prefix.size(), end, number);
  return result.ec == std::errc() && result.ptr == end ? number : -1;
}

int integer_of(const NrrdHeader& header, const std::string& key, int fallback, int lowest,
               int highest) {
  const auto found = header.keys.find(key);
  if (found == header.keys.end()) return fallback;
  const HeaderField field{header.path, key, found->second};
  const std::int64_t value = field.integer();
  if (value < lowest || value > highest) {
    field.fail(std::to_string(lowest) + " to " + std::to_string(highest));
  }
  return int(value);
}

class MergedLayers : public VolumeFile {
 public:
  MergedLayers(std::unique_ptr<VolumeFile> file, std::vector<NrrdSegment> segments)
      : m_file(std::move(file)), m_segments(std::move(segments)) {
    m_header = m_file->header();
    m_header.components = 1;
    m_header.type = ValueType::uint16;
    m_header.slope = 1;
    m_header.intercept = 0;
    m_header.warnings.push_back(std::to_string(layers()) +
                                " layers of segments: where several segments hold a voxel the "
                                "last of them counts");
    m_row.resize(columns() * layers());
    m_stored.resize(row_bytes() * std::size_t(m_header.geometry.dims().y));
  }

  void read_slice(void* out) override {
    m_file->read_slice(m_stored.data());
    auto* labels = static_cast<std::uint16_t*>(out);
    for (int j = 0; j < m_header.geometry.dims().y; ++j, labels += columns()) {
      scale_values_of(m_file->header().type)(&m_stored[std::size_t(j) * row_bytes()], m_row.size(),
                                             1, 0, m_row.data());
      for (std::size_t i = 0; i < columns(); ++i) {
        labels[i] = 0;
        for (const NrrdSegment& segment : m_segments) {
          const double value = m_row[i * layers() + std::size_t(segment.layer)];
          if (value == segment.value) labels[i] = std::uint16_t(segment.label);
        }
      }
    }
  }

 private:
  std::size_t layers() const { return std::size_t(m_file->header().components); }
  std::size_t columns() const { return std::size_t(m_header.geometry.dims().x); }
  std::size_t row_bytes() const {
    return m_row.size() * std::size_t(bytes_of(m_file->header().type));
  }

  std::unique_ptr<VolumeFile> m_file;
  std::vector<NrrdSegment> m_segments;
  std::vector<char> m_stored;
  std::vector<double> m_row;
};

}  // namespace

std::vector<NrrdSegment> nrrd_segments(const NrrdHeader& header, int layers) {
  std::map<int, std::string> names;
  bool has_layers = false;
  for (const auto& [key, text] : header.keys) {
    const int number = segment_number(key, "Name");
    if (number >= 0) names[number] = text;
    has_layers = has_layers || segment_number(key, "Layer") >= 0;
  }
  std::vector<NrrdSegment> segments;
  std::set<std::int32_t> values;
  for (const auto& [number, name] : names) {
    const std::string prefix = "Segment" + std::to_string(number) + "_";
    NrrdSegment segment{name};
    segment.value = integer_of(header, prefix + "LabelValue", 1, 1, kMaxLabel);
    segment.layer = integer_of(header, prefix + "Layer",
                               has_layers ? 0 : std::min(number, layers - 1), 0, layers - 1);
    values.insert(segment.value);
    segments.push_back(segment);
  }
  for (std::size_t n = 0; n < segments.size(); ++n) {
    const bool is_own = layers == 1 || values.size() == segments.size();
    segments[n].label = is_own ? segments[n].value : std::int32_t(n + 1);
  }
  return segments;
}

std::unique_ptr<VolumeFile> with_layers_merged(std::unique_ptr<VolumeFile> file,
                                               std::vector<NrrdSegment> segments) {
  if (segments.empty() || file->header().components == 1) return file;
  return std::make_unique<MergedLayers>(std::move(file), std::move(segments));
}

}  // namespace supple
