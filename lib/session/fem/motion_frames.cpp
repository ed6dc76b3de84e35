#include "lib/session/fem/motion_frames.h"

#include <fstream>
#include <stdexcept>

#include "volumes/base/error.h"

namespace supple {

MotionFrames::MotionFrames() : m_path(m_folder / "frames") {}

void MotionFrames::add(const std::vector<Vec3f>& displacement_mm) {
  std::ofstream file(m_path, std::ios::binary | std::ios::app);
  file.write(reinterpret_cast<const char*>(displacement_mm.data()),
             std::streamsize(displacement_mm.size() * sizeof(Vec3f)));
  file.close();
  if (!file) throw SystemError(m_path + ": cannot write frame " + std::to_string(m_count));
  m_elements = displacement_mm.size();
  ++m_count;
}

std::vector<Vec3f> MotionFrames::at(std::size_t frame) const {
  if (frame >= m_count) throw std::out_of_range("frame " + std::to_string(frame));
  std::vector<Vec3f> displacement_mm(m_elements);
  const std::size_t bytes = m_elements * sizeof(Vec3f);
  std::ifstream file(m_path, std::ios::binary);
  file.seekg(std::streamoff(frame * bytes));
  file.read(reinterpret_cast<char*>(displacement_mm.data()), std::streamsize(bytes));
  if (!file) throw SystemError(m_path + ": cannot read frame " + std::to_string(frame));
  return displacement_mm;
}

}  // namespace supple
