// A thread that makes PNGs of settled pictures, so that events need not wait for it: of a view the
// newest alone, as the body is and at rest.
#pragma once

#include <condition_variable>
#include <thread>

#include "raycast/pictures/image.h"
#include "tools/viewer/pages.h"

namespace supple::tools {

class FrameEncoder {
 public:
  explicit FrameEncoder(Pages& pages);
  ~FrameEncoder();
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  /// Publishes it when it is encoded; `frame` says all else.
  void encode(FrameMessage frame, Image image);

 private:
  struct Settled {
    FrameMessage frame;
    Image image;
  };
  void run();

  Pages& m_pages;
  std::mutex m_guard;
  std::condition_variable m_changed;
  std::array<std::optional<Settled>, kPictureCount> m_waiting;
  bool m_ends = false;
  std::thread m_thread;
};

}  // namespace supple::tools
