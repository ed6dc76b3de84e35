// Pictures of a live session. While it moves: a small picture at once, whose size follows from what
// the last ones cost, so that a promised time is met; samples solve for themselves or the inverse
// is brought up to date, whichever is likely to be sooner. At rest: the picture of `supple render`,
// bit for bit, in passes between which events may come.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "lib/session/session.h"
#include "raycast/pictures/image.h"
#include "tools/console/console.h"
#include "tools/scene/view.h"

namespace supple::tools {

/// What the last first_pixels() did.
struct LiveCost {
  double prepare_ms = 0;      // from the solver's offsets to what rays read
  double frame_ms = 0;        // what a frame takes whatever its size
  double march_ms = 0;        // what grows with it
  int width = 0, height = 0;  // that were marched
  bool by_inverse = false;
};

class LivePicture {
 public:
  /// Of the session as it is now. Refers to it and the console. Throws as look().
  LivePicture(Session& session, const SceneView& view, Console& console);
  ~LivePicture();

  /// Another camera, look or clip. Throws InputError as a view does.
  void look(const SceneView& view);
  /// The body may have moved; whether it has, or the view is another.
  bool follow();

  /// Makes what rays read: the inverse, or offsets that samples solve for, whichever is sooner.
  void prepare();
  /// After prepare(): a picture of the view's size within about `budget_ms` (0: however long it
  /// takes), counted from here.
  Image first_pixels(double budget_ms);
  const LiveCost& cost() const { return m_cost; }

  /// One pass more; false when the picture is settled.
  bool refine();
  /// From another thread: refine() returns soon.
  void interrupt();
  /// Complete; empty before refine() says so.
  const std::optional<Image>& settled() const { return m_settled; }

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
  LiveCost m_cost;
  std::optional<Image> m_settled;
};

double ms_since(std::chrono::steady_clock::time_point start);

/// Stretched to that size, linear between pixels.
Image enlarged(const Image& image, int width, int height);

}  // namespace supple::tools
