// EXR files by the OpenEXR library.
#include <cerrno>
#include <cmath>
#include <cstring>
#include <deque>
#include <fstream>
#include <limits>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfFramesPerSecond.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>

#include "raycast/pictures/image.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

/// The straight colours made linear, premultiplied again.
std::vector<float> linear_rgba(const FloatImage& picture) {
  std::vector<float> linear(picture.rgba);
  for (std::size_t n = 0; n < linear.size(); n += 4) {
    const float alpha = linear[n + 3];
    if (!(alpha > 0)) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      linear[n + c] = linear_from_srgb(linear[n + c] / alpha) * alpha;
    }
  }
  return linear;
}

std::vector<float> with_default(std::vector<float> values, float none) {
  for (float& value : values) {
    if (std::isnan(value)) value = none;
  }
  return values;
}

/// The channels of one file and the memory behind them.
class Channels {
 public:
  Channels(const FloatImage& picture, Imf::Header& header, bool is_half)
      : m_width(std::size_t(picture.width)),
        m_height(std::size_t(picture.height)),
        m_header(header),
        m_half(is_half) {
    m_rgba = linear_rgba(picture);
    const char* names[] = {"R", "G", "B", "A"};
    for (std::size_t c = 0; c < (picture.has_alpha ? 4 : 3); ++c) add(names[c], &m_rgba[c], 4);
    if (!picture.has_auxiliary()) return;
    m_depth = with_default(picture.depth_mm, std::numeric_limits<float>::infinity());
    m_normal = with_default(picture.normal_lps, 0);
    m_offset = with_default(picture.offset_mm, 0);
    add("Z", m_depth.data(), 1, true);
    const char* axes[] = {"N.X", "N.Y", "N.Z"};
    for (std::size_t c = 0; c < 3; ++c) add(axes[c], &m_normal[c], 3);
    add("offset", m_offset.data(), 1);
    m_forward = picture.forward_px;
    m_backward = picture.backward_px;
    m_id = picture.id;
    const char* motions[] = {"forward.u", "forward.v", "backward.u", "backward.v"};
    for (std::size_t c = 0; c < 4; ++c) {
      std::vector<float>& motion = c < 2 ? m_forward : m_backward;
      if (!motion.empty()) add(motions[c], &motion[c % 2], 2);
    }
    if (!m_id.empty()) add("id", m_id.data(), 1, true);
  }
  const Imf::FrameBuffer& buffer() const { return m_buffer; }

 private:
  /// `exact`: never in 16 bits, which hold numbers up to 2048 and lengths to three digits.
  void add(const char* name, float* first, std::size_t stride, bool exact = false) {
    const bool is_half = m_half && !exact;
    m_header.channels().insert(name, Imf::Channel(is_half ? Imf::HALF : Imf::FLOAT));
    if (is_half) return add_half(name, first, stride);
    const std::size_t bytes = stride * sizeof(float);
    m_buffer.insert(name,
                    Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(first), bytes, bytes * m_width));
  }
  void add_half(const char* name, const float* first, std::size_t stride) {
    std::vector<half>& values = m_halves.emplace_back(m_width * m_height);
    for (std::size_t n = 0; n < values.size(); ++n) values[n] = half(first[n * stride]);
    m_buffer.insert(name, Imf::Slice(Imf::HALF, reinterpret_cast<char*>(values.data()),
                                     sizeof(half), sizeof(half) * m_width));
  }

  std::size_t m_width, m_height;
  Imf::Header& m_header;
  bool m_half;
  std::deque<std::vector<half>> m_halves;
  Imf::FrameBuffer m_buffer;
  std::vector<float> m_rgba, m_depth, m_normal, m_offset, m_forward, m_backward, m_id;
};

Imath::M44f matrix_of(const RowMatrix& rows) {
  Imath::M44f matrix;
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) matrix[r][c] = float(rows[std::size_t(4 * r + c)]);
  }
  return matrix;
}

/// Attributes of OpenEXR's standard.
void add_attributes(const ExrFacts& facts, Imf::Header& header) {
  if (!facts.comment.empty()) Imf::addComments(header, facts.comment);
  if (facts.camera.size() == 2) {
    Imf::addWorldToCamera(header, matrix_of(facts.camera[0]));
    Imf::addWorldToNDC(header, matrix_of(facts.camera[1]));
  }
  if (facts.frames_per_second > 0) {
    Imf::addFramesPerSecond(header, Imf::guessExactFps(facts.frames_per_second));
  }
}

}  // namespace

void write_exr(const AtomicFile& target, const FloatImage& picture, const ExrFacts& facts) {
  const std::string& path = target.final_path();
  Imf::Header header(picture.width, picture.height);
  header.compression() = Imf::ZIP_COMPRESSION;
  add_attributes(facts, header);
  const Channels channels(picture, header, facts.half);
  errno = 0;
  std::ofstream file(target.path(), std::ios::binary);
  try {
    Imf::StdOFStream stream(file, path.c_str());
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(channels.buffer());
    output.writePixels(picture.height);
  } catch (const std::exception& error) {
    throw SystemError(path + ": cannot write: " + error.what());
  }
  // The library's destructor writes the table of lines and swallows errors.
  file.close();
  if (!file) throw SystemError(path + ": cannot write: " + std::strerror(errno));
}

}  // namespace supple
