#include "tools/viewer/frame_message.h"

#include <cstring>

namespace supple::tools {

const std::array<const char*, kViewCount> kViewNames = {"3d", "axial", "coronal", "sagittal"};

namespace {

template <class T>
void append(std::vector<std::uint8_t>& bytes, T value) {
  const std::size_t at = bytes.size();
  bytes.resize(at + sizeof(T));
  std::memcpy(&bytes[at], &value, sizeof(T));  // x86-64 is little-endian, as the head
}

}  // namespace

std::vector<std::uint8_t> head_of(const FrameMessage& frame, std::uint32_t event,
                                  std::uint32_t frame_number) {
  std::vector<std::uint8_t> head = {'S', 'V', 'F', '1'};
  append(head, event);
  append(head, frame_number);
  append(head, std::uint8_t(frame.view));
  append(head, std::uint8_t(frame.is_png));
  append(head, std::uint8_t(frame.is_settled));
  append(head, std::uint8_t(frame.is_at_rest));
  append(head, std::uint16_t(frame.width));
  append(head, std::uint16_t(frame.height));
  append(head, float(frame.ms));
  if (frame.pixels) {
    for (const Vec3d& v :
         {frame.pixels->first_lps_mm, frame.pixels->right_mm, frame.pixels->down_mm}) {
      for (int a = 0; a < 3; ++a) append(head, v[a]);
    }
  }
  return head;
}

}  // namespace supple::tools
