#include "volumes/io/format/streamed_volume.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "volumes/base/error.h"

namespace supple {

namespace {

class PartsSource : public ByteSource {
 public:
  explicit PartsSource(std::shared_ptr<const DataParts> parts) : m_parts(std::move(parts)) {}

  void read(void* out, std::size_t size) override {
    auto* bytes = static_cast<char*>(out);
    while (size > 0) {
      open_next();
      const auto chunk = std::size_t(std::min<std::int64_t>(std::int64_t(size), m_left));
      m_source->read(bytes, chunk);
      consume(std::int64_t(chunk));
      bytes += chunk;
      size -= chunk;
    }
  }

  /// Parts that are left out entirely are not even opened.
  void skip(std::int64_t size) override {
    while (size > 0) {
      if (m_source == nullptr && size >= m_parts->at(m_next).range.size) {
        size -= (*m_parts)[m_next++].range.size;
        continue;
      }
      open_next();
      const std::int64_t chunk = std::min(size, m_left);
      m_source->skip(chunk);
      consume(chunk);
      size -= chunk;
    }
  }

  void finish() override {
    if (m_source != nullptr) m_source->finish();
    m_source.reset();
  }

 private:
  void open_next() {
    if (m_source != nullptr) return;
    const DataPart& part = m_parts->at(m_next++);
    m_source = open_checked(std::make_shared<InputFile>(part.path), part.range);
    m_left = part.range.size;
  }

  void consume(std::int64_t size) {
    m_left -= size;
    if (m_left == 0) finish();
  }

  std::shared_ptr<const DataParts> m_parts;
  std::size_t m_next = 0;                // the first part that was not opened yet
  std::unique_ptr<ByteSource> m_source;  // of the part before it, while bytes are left in it
  std::int64_t m_left = 0;
};

}  // namespace

std::unique_ptr<ByteSource> open_parts(std::shared_ptr<const DataParts> parts) {
  return std::make_unique<PartsSource>(std::move(parts));
}

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the readers assume a little-endian host");

std::uint8_t swapped(std::uint8_t value) {
  return value;
}
std::uint16_t swapped(std::uint16_t value) {
  return __builtin_bswap16(value);
}
std::uint32_t swapped(std::uint32_t value) {
  return __builtin_bswap32(value);
}
std::uint64_t swapped(std::uint64_t value) {
  return __builtin_bswap64(value);
}

/// Values a number of values apart.
struct Run {
  char* begin;
  std::int64_t stride;
};

template <class Word>
void copy_words(const Run& from, const Run& to, std::int64_t count, bool swap) {
  for (std::int64_t n = 0; n < count; ++n) {
    Word word;
    std::memcpy(&word, from.begin + n * from.stride * std::int64_t(sizeof word), sizeof word);
    if (swap) word = swapped(word);
    std::memcpy(to.begin + n * to.stride * std::int64_t(sizeof word), &word, sizeof word);
  }
}

/// Copies `count` values of `width` bytes, in the other byte order where `swap`.
void copy_values(int width, const Run& from, const Run& to, std::int64_t count, bool swap) {
  switch (width) {
    case 1:
      return copy_words<std::uint8_t>(from, to, count, swap);
    case 2:
      return copy_words<std::uint16_t>(from, to, count, swap);
    case 4:
      return copy_words<std::uint32_t>(from, to, count, swap);
    default:
      return copy_words<std::uint64_t>(from, to, count, swap);
  }
}

/// Sizes of the five axes and the distances, in values, of neighbours along them.
struct Strides {
  std::array<std::int64_t, 5> size;
  std::array<std::int64_t, 5> stride;

  explicit Strides(const StreamLayout& layout) {
    const Vec3i& dims = layout.header.geometry.dims();
    size = {layout.header.components, dims.x, dims.y, dims.z, layout.frames};
    std::int64_t values = 1;
    for (const StoredAxis axis : layout.order) {
      stride[std::size_t(axis)] = values;
      values *= size[std::size_t(axis)];
    }
  }
  std::int64_t size_of(StoredAxis axis) const { return size[std::size_t(axis)]; }
  std::int64_t operator[](StoredAxis axis) const { return stride[std::size_t(axis)]; }
  /// The axis lies between the slices, not within them.
  bool is_outer(StoredAxis axis) const {
    return (*this)[axis] >= (*this)[StoredAxis::k] * size_of(StoredAxis::k);
  }
};

class StreamedVolume : public VolumeFile {
 public:
  StreamedVolume(StreamLayout layout, const std::shared_ptr<const DataParts>& parts)
      : m_strides(layout), m_swap(layout.big_endian) {
    m_header = std::move(layout.header);
    m_width = bytes_of(m_header.type);
    // The frame, and components that lie apart, are places in the file where slices begin; what
    // lies within a block of values up to the next slice is picked from there.
    using Axis = StoredAxis;
    const bool outer_frame = m_strides.is_outer(Axis::frame);
    const bool outer_components = m_header.components > 1 && m_strides.is_outer(Axis::component);
    m_first_in_block = outer_frame ? 0 : layout.frame * m_strides[Axis::frame];
    const std::int64_t first = outer_frame ? layout.frame * m_strides[Axis::frame] : 0;
    for (int c = 0; c < (outer_components ? m_header.components : 1); ++c) {
      m_sources.push_back(open_parts(parts));
      m_sources.back()->skip((first + c * m_strides[Axis::component]) * m_width);
    }
    const Vec3i& dims = m_header.geometry.dims();
    const bool in_order = m_header.components == 1 || (m_strides[Axis::component] == 1 &&
                                                       m_strides[Axis::i] == m_header.components);
    const std::int64_t block = m_strides[Axis::k];
    if (!in_order || block != std::int64_t(dims.x) * dims.y * m_header.components) {
      m_block.resize(std::size_t(block) * m_width);
    }
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    if (m_slices_read >= dims.z) {
      throw Error(m_header.path + ": more slices were asked for than the volume has");
    }
    for (std::size_t s = 0; s < m_sources.size(); ++s) {
      if (m_block.empty()) {
        m_sources[s]->read(out, std::size_t(m_strides[StoredAxis::k]) * m_width);
      } else {
        m_sources[s]->read(m_block.data(), m_block.size());
        gather(int(s), static_cast<char*>(out));
      }
    }
    if (m_swap && m_block.empty()) {
      const Run all{static_cast<char*>(out), 1};
      copy_values(m_width, all, all, std::int64_t(dims.x) * dims.y * m_header.components, true);
    }
    // The last source is the furthest in the file.
    if (++m_slices_read == dims.z) m_sources.back()->finish();
  }

  void skip_slices(int count) override {
    for (const auto& source : m_sources) {
      source->skip(std::int64_t(count) * m_strides[StoredAxis::k] * m_width);
    }
    m_slices_read += count;
  }

 private:
  /// Copies what the slice wants of the block; component `s` where components lie apart.
  void gather(int s, char* out) {
    const Vec3i& dims = m_header.geometry.dims();
    const int components = m_header.components, last = m_sources.size() > 1 ? s + 1 : components;
    for (int c = s; c < last; ++c) {
      const std::int64_t first =
          m_first_in_block + (m_sources.size() > 1 ? 0 : c * m_strides[StoredAxis::component]);
      for (int j = 0; j < dims.y; ++j) {
        const Run from{m_block.data() + (first + j * m_strides[StoredAxis::j]) * m_width,
                       m_strides[StoredAxis::i]};
        const Run to{out + (std::int64_t(j) * dims.x * components + c) * m_width, components};
        copy_values(m_width, from, to, dims.x, m_swap);
      }
    }
  }

  Strides m_strides;
  bool m_swap;
  int m_width = 1;
  std::vector<std::unique_ptr<ByteSource>> m_sources;  // one, or one per component
  std::int64_t m_first_in_block = 0;
  std::vector<char> m_block;  // empty: blocks are slices
  int m_slices_read = 0;
};

std::unique_ptr<VolumeFile> open_checked_parts(DataParts parts, StreamLayout layout) {
  return std::make_unique<StreamedVolume>(std::move(layout),
                                          std::make_shared<const DataParts>(std::move(parts)));
}

}  // namespace

std::int64_t claimed_bytes(const StreamLayout& layout) {
  const std::int64_t frame = stored_bytes(layout.header);
  if (double(frame) * double(layout.frames) > 9e18) {
    throw InputError({layout.header.path, "sizes",
                      std::to_string(layout.frames) + " frames of " + bytes_text(frame),
                      "less than 2^63 bytes"});
  }
  return frame * layout.frames;
}

std::unique_ptr<VolumeFile> open_stream(const DataFiles& files, StreamLayout layout) {
  layout.range.size = claimed_bytes(layout) / files.count;
  layout.range.text_type = layout.header.type;
  DataParts parts;
  for (std::int64_t n = 0; n < files.count; ++n) {
    const auto file = std::make_shared<InputFile>(files.path_of(n));
    ByteRange range = layout.range;
    if (files.adapt) files.adapt(*file, range);
    check_range(file, range);
    parts.push_back({file->path(), range});
    layout.header.data_files.push_back(file->path());
  }
  return open_checked_parts(std::move(parts), std::move(layout));
}

std::unique_ptr<VolumeFile> open_stream(std::shared_ptr<const InputFile> data,
                                        StreamLayout layout) {
  DataFiles files;
  files.path_of = [&data](std::int64_t) { return data->path(); };
  return open_stream(files, std::move(layout));
}

}  // namespace supple
