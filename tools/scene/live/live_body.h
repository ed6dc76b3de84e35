// The body of a live session as rays read it: its displacement, and offsets from it that samples
// solve for themselves or that an inverse holds, brought up to date where the body has moved.
//
// Cost: of the bricks that have changed since.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <set>

#include "lib/session/session.h"
#include "lib/state/pose.h"
#include "raycast/drawings/slice.h"
#include "raycast/render.h"
#include "volumes/base/progress.h"
#include "volumes/base/stopwatch.h"
#include "volumes/field/cuts/cut_offsets.h"
#include "volumes/field/inversion/forward_offsets.h"

namespace supple::tools {

class LiveBody {
 public:
  /// Makes the body of the session as it is now. Refers to it and to `progress`.
  LiveBody(Session& session, Interpolation interpolation, Progress& progress);

  /// Reads all that depends on which voxels are elements.
  void open(Interpolation interpolation);
  Interpolation interpolation() const { return m_interpolation; }
  /// Number of times that it was opened: each time it has another renderer.
  int opened_count() const { return m_opened_count; }
  /// Takes over what the session has done since, and the amount; false where that is nothing.
  /// `shape`: offsets that are shown instead of the body's; null: none.
  bool follow(const std::array<BrickValues, 3>* shape = nullptr);
  /// Shows the body with its displacement times this from the next follow() on: a picture between
  /// rest and what it is, or beyond. The session does not know of it.
  void set_amount(double amount) { m_next_amount = amount; }

  /// Choose the field that the renderer reads from now on, and bring it up to date.
  void show_forward();
  void show_inverse(OffsetResolution resolution);
  void show_rest();
  /// Times that show_forward() and show_inverse() are likely to take, by what they took before.
  double forward_ms() const { return m_forward_brick.of(double(m_for_forward.size())); }
  double inverse_ms() const { return m_inverse_brick.of(double(changed_bricks())); }
  /// Number of changed bricks that show_inverse() has not taken over.
  std::size_t changed_bricks() const { return m_for_inverse.size(); }
  /// Samples do not solve across cuts.
  bool needs_inverse() const { return !m_cuts.empty(); }
  bool shows_forward() const { return m_shown == Shown::forward; }

  const State& opened() const { return m_state; }  // its q and cuts are not kept up to date
  /// Displacement that is shown.
  const Displacement& displacement() const {
    return m_scaled ? *m_scaled : m_moved->displacement();
  }
  /// The longest displacement that is shown.
  double longest_mm() const;
  const LinkCuts& cuts() const { return m_cuts; }  // as they were followed last
  const Renderer& renderer() const { return *m_renderer; }
  Renderer& renderer() { return *m_renderer; }
  const ForwardOffsets& forward() const { return *m_forward; }
  /// The inverse as show_inverse() has left it.
  const OffsetField& inverse();

 private:
  using Changed = std::set<std::int32_t>;
  static std::vector<std::int32_t> take(Changed& changed);
  void remake_forward();
  std::vector<std::int32_t> scale(const std::vector<std::int32_t>& changed);
  std::vector<Vec3i> update_inverse();
  std::unique_ptr<IncrementalCutInversion> new_inversion();

  Session& m_session;
  Progress& m_progress;
  Interpolation m_interpolation;
  State m_state;
  int m_opened_count = 0;
  std::unique_ptr<LiveDisplacement> m_moved;
  std::unique_ptr<Displacement> m_scaled;  // null where the amount is 1
  double m_amount = 1, m_next_amount = 1;
  std::shared_ptr<ForwardOffsets> m_forward;
  std::unique_ptr<IncrementalCutInversion> m_inversion;
  std::unique_ptr<Renderer> m_renderer;
  Changed m_for_forward, m_for_inverse;  // bricks in which the displacement has changed since
  enum class Shown { nothing, forward, inverse, rest };
  Shown m_shown = Shown::nothing;
  OffsetResolution m_resolution = OffsetResolution::full;
  bool m_renderer_follows = false;     // the renderer has kept all offsets of m_inversion so far
  std::optional<OffsetField> m_field;  // those of m_inversion, copied
  LinkCuts m_cuts;
  bool m_is_stale = false;  // m_inversion has not taken over everything
  CostPer m_forward_brick{0.02}, m_inverse_brick{0.08};
};

/// Tells where what is seen was at rest, as the body shows it now; valid until it moves or is shown
/// otherwise.
RestPlaceAt rest_places(LiveBody& body);

}  // namespace supple::tools
