#include "tools/viewer/frame_encoder.h"

#include <algorithm>

#include "raycast/pictures/image.h"

namespace supple::tools {

namespace {

/// Quick: over loopback and ssh bytes are cheaper than milliseconds.
constexpr int kPngLevel = 1;

}  // namespace

FrameEncoder::FrameEncoder(Pages& pages) : m_pages(pages), m_thread([this] { run(); }) {}

FrameEncoder::~FrameEncoder() {
  {
    const std::lock_guard lock(m_guard);
    m_ends = true;
  }
  m_changed.notify_one();
  m_thread.join();
}

void FrameEncoder::encode(FrameMessage frame, Image image) {
  {
    const std::lock_guard lock(m_guard);
    m_waiting[frame.slot()] = Settled{std::move(frame), std::move(image)};
  }
  m_changed.notify_one();
}

void FrameEncoder::run() {
  const auto is_there = [](const std::optional<Settled>& settled) { return settled.has_value(); };
  while (true) {
    std::optional<Settled> next;
    {
      std::unique_lock lock(m_guard);
      m_changed.wait(lock, [&] {
        return m_ends || std::any_of(m_waiting.begin(), m_waiting.end(), is_there);
      });
      if (m_ends) return;
      std::optional<Settled>& first = *std::find_if(m_waiting.begin(), m_waiting.end(), is_there);
      next.emplace(std::move(*first));
      first.reset();
    }
    next->frame.is_png = true;
    try {
      next->frame.picture = png_bytes(next->image, kPngLevel);
      m_pages.publish(std::move(next->frame));
    } catch (const std::exception&) {
      // Without memory for it the page keeps the picture before; the session goes on.
    }
  }
}

}  // namespace supple::tools
