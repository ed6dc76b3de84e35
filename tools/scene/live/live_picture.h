// Pictures of a live session. While it moves: the picture at rest, where little of the last one has
// changed, or a small picture, whose size follows from what
// the last ones cost, so that a promised time is met; samples solve for themselves or the inverse
// is brought up to date, whichever is likely to be sooner. At rest: the picture of `supple render`,
// bit for bit, in passes between which events may come.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>

#include "lib/session/session.h"
#include "raycast/pictures/image.h"
#include "volumes/base/fields.h"
#include "volumes/base/progress.h"

namespace supple {
class Renderer;
struct Camera;
}  // namespace supple

namespace supple::tools {

struct SceneView;

/// Cost of the last first_pixels().
struct LiveCost {
  double prepare_ms = 0;      // from the solver's offsets to what rays read
  double frame_ms = 0;        // what a frame takes whatever its size
  double march_ms = 0;        // what grows with it
  int width = 0, height = 0;  // that were marched, or as far apart in what has changed
  int spacing = 1;            // of these pixels
  bool by_inverse = false;
};

class LivePicture {
 public:
  /// Draws the session as it is now. Refers to it and the listener. Throws as look().
  LivePicture(Session& session, const SceneView& view, Progress& listener);
  ~LivePicture();

  /// Takes another camera, look or clip. Throws InputError as a view does.
  void look(const SceneView& view);
  /// Paints over what is seen, whose depths it has, before marks are drawn; empty: nobody.
  using Painter = std::function<void(FloatImage& picture, const Camera& camera)>;
  void paint_with(Painter painter);
  /// Shows the body with its displacement times this from the next follow() on.
  void set_amount(double amount);
  /// Follows the body, which may have moved; true if it has, or the view is another. `shape`:
  /// LiveBody::follow().
  bool follow(const std::array<BrickValues, 3>* shape = nullptr);
  /// Follows the view while the body is being moved: it is seen as it was followed last.
  bool follow_view();

  /// Makes what rays read: the inverse, or offsets that samples solve for, whichever leaves time
  /// for more pixels in `budget_ms` (0: however long it takes), counted from here; where neither
  /// leaves any, whichever is sooner.
  void prepare(double budget_ms);
  /// Called after prepare(): a picture in about `budget_ms`, of the view's size or smaller.
  Image first_pixels(double budget_ms);
  const LiveCost& cost() const { return m_cost; }

  /// A step towards the settled picture: what it reads, then its pixels; false when it is settled.
  bool refine();
  /// Called from another thread: refine() returns soon.
  void interrupt();
  /// The complete picture; empty before refine() says so.
  const std::optional<Image>& settled() const { return m_settled; }

  /// The settled picture of the view with another camera or size, whatever is being refined. Throws
  /// Cancelled.
  Image shot(const Camera& camera, const PixelSize& size, Progress* progress);

  /// The view as it is drawn, its camera framed.
  const SceneView& view() const;
  const Renderer& renderer() const;
  const State& opened() const;
  /// Tells where what is seen was at rest until the body moves or is seen otherwise; null: nothing
  /// has moved. `exact`: by the inverse, which is brought up to date; else as is sooner.
  std::function<bool(const Vec3d& index, Vec3d& at_rest)> rest_places(bool exact);
  const Displacement& displacement() const;
  /// Counts how often it was looked at otherwise, and its elements were other ones.
  struct Counts {
    int looks = 0, bodies = 0;
  };
  Counts counts() const;
  /// The longest displacement.
  double longest_mm() const;
  /// Memory that it keeps, in bytes.
  struct Memory {
    std::size_t source = 0, displacement = 0, offsets = 0;
  };
  Memory memory() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> m_impl;
  LiveCost m_cost;
  std::optional<Image> m_settled;
};

}  // namespace supple::tools
