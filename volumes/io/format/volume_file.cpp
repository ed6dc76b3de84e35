// Frames, channels and spacings that the user chooses, for all readers.
#include <cmath>
#include <cstring>
#include <vector>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/formats.h"

namespace supple {

namespace {

class ChannelVolume : public VolumeFile {
 public:
  ChannelVolume(std::unique_ptr<VolumeFile> file, int channel)
      : m_file(std::move(file)), m_channel(channel) {
    m_header = m_file->header();
    m_header.components = 1;
    m_header.warp_direction.clear();
    m_header.vectors_in_ras = false;
    m_slice.resize(voxels() * width() * components());
  }

  void read_slice(void* out) override {
    m_file->read_slice(m_slice.data());
    const std::size_t stride = width() * components();
    const char* from = m_slice.data() + m_channel * width();
    for (std::size_t n = 0; n < voxels(); ++n) {
      std::memcpy(static_cast<char*>(out) + n * width(), from + n * stride, width());
    }
  }

  void skip_slices(int count) override { m_file->skip_slices(count); }

 private:
  std::size_t voxels() const {
    return std::size_t(m_header.geometry.dims().x) * m_header.geometry.dims().y;
  }
  std::size_t width() const { return std::size_t(bytes_of(m_header.type)); }
  std::size_t components() const { return std::size_t(m_file->header().components); }

  std::unique_ptr<VolumeFile> m_file;
  std::size_t m_channel;
  std::vector<char> m_slice;
};

std::string up_to(std::int64_t count) {
  return count == 1 ? "0, the only one" : "0 to " + std::to_string(count - 1);
}

}  // namespace

int chosen_frame(const ReadOptions& options, std::int64_t count, const std::string& path,
                 const std::string& field) {
  if (options.frames_found != nullptr) *options.frames_found = count;
  if (!options.frame) {
    if (count == 1 || options.frames_found != nullptr) return 0;
    throw InputError({path, field, std::to_string(count) + " frames", "frame " + up_to(count)});
  }
  if (*options.frame < 0 || *options.frame >= count) {
    throw InputError({path, "frame", std::to_string(*options.frame), up_to(count)});
  }
  return *options.frame;
}

double own_spacing(double spacing, const ReadOptions& options) {
  const bool is_length = spacing > 0 && std::isfinite(spacing);
  return !is_length && options.spacing_mm ? 1 : spacing;
}

std::unique_ptr<VolumeFile> open_channel(std::unique_ptr<VolumeFile> file, int channel) {
  const int count = file->header().components;
  if (channel < 0 || channel >= count) {
    throw InputError({file->header().path, "channel", std::to_string(channel), up_to(count)});
  }
  if (count == 1) return file;
  return std::make_unique<ChannelVolume>(std::move(file), channel);
}

void VolumeFile::set_spacing(const Vec3d& spacing_mm) {
  const Geometry& old = m_header.geometry;
  std::array<Vec3d, 3> axes = old.direction();
  for (int a = 0; a < 3; ++a) {
    if (!(spacing_mm[a] > 0)) {
      throw InputError({m_header.path, "spacing", number_text(spacing_mm[a]), "lengths in mm"});
    }
    axes[a] *= spacing_mm[a];
  }
  m_header.geometry = make_geometry(m_header.path, old.dims(), old.origin_lps_mm(), axes);
}

void VolumeFile::skip_slices(int count) {
  std::vector<char> slice(std::size_t(stored_bytes(m_header) / m_header.geometry.dims().z));
  for (int n = 0; n < count; ++n) read_slice(slice.data());
}

std::int64_t stored_bytes(const VolumeHeader& header) {
  return header.geometry.voxel_count() * header.components * bytes_of(header.type);
}

void require_scalars(const VolumeHeader& header) {
  if (header.components == 1) return;
  throw InputError({header.path, "values",
                    std::to_string(header.components) + " components per voxel",
                    "a scalar volume, or channel 0 to " + std::to_string(header.components - 1) +
                        "; vectors are read as a warp"});
}

void require_unused(const ReadOptions& options, const std::string& path) {
  const auto refuse = [&](bool is_set, const char* name) {
    if (is_set) throw InputError({path, name, "a state file", "a volume"});
  };
  refuse(!options.raw.empty(), "raw");
  refuse(options.frame.has_value(), "frame");
  refuse(options.channel.has_value(), "channel");
  refuse(options.spacing_mm.has_value(), "spacing");
}

}  // namespace supple
