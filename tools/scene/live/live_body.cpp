#include "tools/scene/live/live_body.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/parallel.h"
#include "volumes/grid/cell.h"

namespace supple::tools {

LiveBody::LiveBody(Session& session, Interpolation interpolation, Progress& progress)
    : m_session(session), m_progress(progress), m_interpolation(interpolation) {
  open(interpolation);
}

std::vector<std::int32_t> LiveBody::take(Changed& changed) {
  const Changed taken = std::exchange(changed, {});
  return {taken.begin(), taken.end()};
}

void LiveBody::open(Interpolation interpolation) {
  m_interpolation = interpolation;
  ++m_opened_count;
  m_renderer.reset();
  m_inversion.reset();
  m_forward.reset();
  m_state = m_session.state();
  m_moved = std::make_unique<LiveDisplacement>(m_state.geometry, m_state.elements,
                                               m_state.density.bricks());
  m_moved->update(m_state.q);
  m_scaled.reset();
  m_amount = 1;
  scale({});
  m_cuts = m_session.cuts();
  m_inversion = new_inversion();
  m_forward = std::make_shared<ForwardOffsets>(displacement(), &m_state.elements);
  m_renderer = std::make_unique<Renderer>(m_state.geometry, m_state.density, 0, interpolation);
  m_for_forward.clear();
  m_for_inverse.clear();
  m_shown = Shown::nothing;
  m_renderer_follows = false;
  m_field.reset();
  m_is_stale = false;
}

/// Forward offsets refer to the displacement that is shown.
void LiveBody::remake_forward() {
  m_for_forward.clear();
  if (!m_forward) return;
  m_forward = std::make_shared<ForwardOffsets>(displacement(), &m_state.elements);
  if (m_shown == Shown::forward) m_renderer->set_pointwise_offsets(m_forward);
}

/// Brings m_scaled up to date where the displacement or the amount changed; returns the bricks in
/// which what is shown did.
std::vector<std::int32_t> LiveBody::scale(const std::vector<std::int32_t>& changed) {
  if (!m_scaled && m_next_amount == 1) return changed;
  const VectorBricks& moved = m_moved->displacement().u;
  std::vector<std::int32_t> bricks = changed;
  if (m_next_amount != m_amount) {
    for (std::size_t b = 0; b < moved.topology.brick_count(); ++b) {
      const bool is_shown = m_scaled && m_scaled->u.vectors.brick(b) != nullptr;
      if (is_shown || moved.vectors.brick(b) != nullptr) bricks.push_back(std::int32_t(b));
    }
    std::sort(bricks.begin(), bricks.end());
    bricks.erase(std::unique(bricks.begin(), bricks.end()), bricks.end());
  }
  m_amount = m_next_amount;
  if (m_amount == 1) {
    // Pictures refer to it until they know of the other one.
    const std::unique_ptr<Displacement> before = std::move(m_scaled);
    remake_forward();
    return bricks;
  }
  if (!m_scaled) {
    m_scaled = std::make_unique<Displacement>(m_moved->displacement());
    remake_forward();
  }
  const float factor = float(m_amount);
  BrickVectors& shown = m_scaled->u.vectors;
  for (const std::int32_t brick : bricks) {
    const std::size_t b = std::size_t(brick);
    const Vec3f* const from = moved.vectors.brick_or_zero(b);
    Vec3f* const to = shown.touch(b);
    for (int n = 0; n < kBrickVoxels; ++n) to[n] = from[n] * factor;
  }
  return bricks;
}

bool LiveBody::follow(const std::array<BrickValues, 3>* shape) {
  const Body& body = m_session.body();
  if (!(body.elements == m_state.elements)) {
    open(m_interpolation);
    return true;
  }
  const std::vector<std::int32_t> changed =
      scale(m_moved->update(shape != nullptr ? *shape : body.q));
  m_for_forward.insert(changed.begin(), changed.end());
  m_for_inverse.insert(changed.begin(), changed.end());
  const LinkCuts& cuts = m_session.cuts();
  const bool is_cut = cuts != m_cuts;
  if (is_cut) m_cuts = cuts;
  m_is_stale = m_is_stale || is_cut || !changed.empty();
  return is_cut || !changed.empty();
}

void LiveBody::show_forward() {
  const Stopwatch time;
  const double bricks = double(m_for_forward.size());
  const bool is_changed = !m_for_forward.empty();
  if (is_changed) m_forward->update(take(m_for_forward));
  if (is_changed || m_shown != Shown::forward) m_renderer->set_pointwise_offsets(m_forward);
  m_shown = Shown::forward;
  m_forward_brick.add(time.ms(), bricks);
}

void LiveBody::show_inverse(OffsetResolution resolution) {
  const bool is_other = std::exchange(m_resolution, resolution) != resolution;
  if (m_shown == Shown::inverse && !m_is_stale && !is_other) return;
  const Stopwatch time;
  const double bricks = double(m_for_inverse.size());
  const bool follows = std::exchange(m_renderer_follows, false);  // unless it throws
  const std::vector<Vec3i> touched = update_inverse();
  if (!follows || is_other || resolution == OffsetResolution::half) {
    m_renderer->set_offsets(&inverse(), resolution);
  } else {
    m_renderer->update_offsets(touched, m_inversion->finder(), m_inversion->split());
  }
  m_renderer_follows = true;
  m_shown = Shown::inverse;
  m_inverse_brick.add(time.ms(), bricks);
}

/// The bricks that are others than before. An inversion that throws is made anew the next time.
std::vector<Vec3i> LiveBody::update_inverse() {
  if (!m_is_stale) return {};
  m_field.reset();
  std::vector<Vec3i> touched;
  std::unique_ptr<IncrementalCutInversion> inversion = std::move(m_inversion);
  const std::vector<std::int32_t> changed = take(m_for_inverse);
  if (inversion) {
    inversion->set_cuts(m_cuts);
    touched = inversion->update(displacement(), changed);
  } else {
    inversion = new_inversion();
  }
  m_inversion = std::move(inversion);
  m_is_stale = false;
  return touched;
}

std::unique_ptr<IncrementalCutInversion> LiveBody::new_inversion() {
  InvertParams params;
  params.material = &m_state.elements;
  return std::make_unique<IncrementalCutInversion>(
      displacement(), CutElements{m_state.elements, m_cuts}, params, &m_progress);
}

void LiveBody::show_rest() {
  if (m_shown != Shown::rest) m_renderer->set_offsets(nullptr);
  m_renderer_follows = false;
  m_shown = Shown::rest;
}

const OffsetField& LiveBody::inverse() {
  if (!m_field) m_field = m_inversion->offsets();
  return *m_field;
}

double LiveBody::longest_mm() const {
  const VectorBricks& u = displacement().u;
  return std::sqrt(parallel_reduce(
      u.vectors.brick_count(), Grain{1}, 0.0,
      [&](std::size_t b, double& most) {
        const Vec3f* const vectors = u.vectors.brick(b);
        for (int n = 0; vectors != nullptr && n < kBrickVoxels; ++n) {
          const Vec3d mm = m_state.geometry.world_vector_from_index(Vec3d(vectors[n]));
          most = std::max(most, mm.dot(mm));
        }
      },
      [](double a, double b) { return std::max(a, b); }));
}

RestPlaceAt rest_places(LiveBody& body) {
  if (!body.shows_forward()) {
    return [&offsets = body.inverse()](const Vec3d& index, Vec3d& at_rest) {
      return offsets.source_of(index, at_rest);
    };
  }
  const State& opened = body.opened();
  return [&forward = body.forward(), &tissue = opened.density.bricks(),
          dims = opened.geometry.dims()](const Vec3d& index, Vec3d& at_rest) {
    PointwiseOffsets::Sample found;
    const Vec3i voxel(int(std::lround(index.x)), int(std::lround(index.y)),
                      int(std::lround(index.z)));
    const std::int32_t brick = forward.bricks().find(voxel);
    if (brick >= 0 && !forward.sample(std::size_t(brick), index, found)) return false;
    at_rest = within_border(index + found.offset, dims);
    return brick >= 0 || tissue.is_active(voxel);
  };
}

}  // namespace supple::tools
