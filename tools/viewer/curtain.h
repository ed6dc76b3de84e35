// Pictures of the body at rest beside those of the body as it is, in all four views, while the
// pages draw a curtain over them. They are made anew where they are seen otherwise, not where the
// body moves. Of the thread of the loop, but for interrupt().
#pragma once

#include <memory>
#include <mutex>

#include "tools/scene/live/rest_picture.h"
#include "tools/viewer/view_settings.h"

namespace supple::tools {

/// A picture of a view with the body at rest.
struct RestPane {
  int view = 0;
  bool is_settled = false;
  Image image;
  std::optional<PixelFrame> pixels;  // of slices
};

class Curtain {
 public:
  /// Refers to both.
  Curtain(LivePicture& picture, const ViewSettings& settings)
      : m_picture(picture), m_settings(settings) {}

  /// Notes that slices or the curtain itself are other ones; what the picture knows is found there.
  void seen_otherwise();
  /// Notes that what changed the picture's counts since leaves the view in space at rest as it was.
  void keep_space(const LivePicture::Counts& before);
  /// The picture that is to be drawn next; none where there is none now. Those that have settled
  /// come after the picture of the body as it is has settled.
  std::optional<RestPane> next(double budget_ms);
  /// Called from another thread: next() returns soon.
  void interrupt();
  /// The renderer at rest; throws InputError where no curtain is drawn.
  const Renderer& renderer();

 private:
  RestPicture& rest();
  std::optional<RestPane> next_in_space(double budget_ms);
  RestPane slice(int view);

  LivePicture& m_picture;
  const ViewSettings& m_settings;
  std::mutex m_guard;  // of the pointer alone
  std::unique_ptr<RestPicture> m_rest;
  LivePicture::Counts m_counts{-1, -1};  // of what was drawn last
  /// State of a picture, as in OpenScene: 0 up to date, 1 to be drawn exactly, 2 in haste and then
  /// exactly.
  std::array<int, kViewCount> m_stale{};
};

}  // namespace supple::tools
