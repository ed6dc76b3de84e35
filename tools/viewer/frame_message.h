// Pictures on their way to a page: JPEG while it moves, PNG once it is settled, behind a small head
// (README.md).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "volumes/base/vec.h"

namespace supple::tools {

constexpr int kViewCount = 4;
constexpr int kPictureCount = 2 * kViewCount;                 // as the body is, and at rest
extern const std::array<const char*, kViewCount> kViewNames;  // 3d, axial, coronal, sagittal

/// The LPS place of a picture's first pixel, and what one pixel to the right and down is.
struct PixelFrame {
  Vec3d first_lps_mm, right_mm, down_mm;
};

struct FrameMessage {
  std::uint64_t stamp = 0;   // ascends with what is shown; of two the later is newer
  std::uint64_t number = 0;  // of the last message that it shows
  int view = 0;
  bool is_at_rest = false;  // beside the picture of the body as it is, for a curtain
  bool is_png = false, is_settled = false;
  int width = 0, height = 0;  // of the view
  double ms = 0;              // since the event
  std::optional<PixelFrame> pixels;
  std::vector<std::uint8_t> picture;

  /// Which of kPictureCount pictures it is.
  std::size_t slot() const {
    return std::size_t(view) + (is_at_rest ? std::size_t(kViewCount) : 0);
  }
};

/// `event`: `number` as the page counts.
std::vector<std::uint8_t> head_of(const FrameMessage& frame, std::uint32_t event,
                                  std::uint32_t frame_number);

}  // namespace supple::tools
