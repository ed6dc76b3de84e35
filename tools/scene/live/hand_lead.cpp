#include "tools/scene/live/hand_lead.h"

#include <algorithm>
#include <cmath>

#include "lib/body/slot_set.h"
#include "lib/session/kept_voxels.h"
#include "volumes/base/parallel.h"

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

/// Time in which one level gives way to the next.
constexpr double kBlend_ms = 200;

/// Rounds for pictures, without a call.
std::int64_t nearest(double value) {
  return std::int64_t(value + (value < 0 ? -0.5 : 0.5));
}

}  // namespace

/// Cancels where the hand asks for it; says nothing.
class HandLead::Listening final : public Progress {
 public:
  explicit Listening(const std::atomic<bool>& is_cancelled) : m_is_cancelled(is_cancelled) {}
  void stage(std::string_view) override {}
  void update(double) override {}
  bool cancelled() const override { return m_is_cancelled; }

 private:
  const std::atomic<bool>& m_is_cancelled;
};

HandLead::HandLead(const SessionBody& in, const Step& grab, const std::vector<Vec3d>& directions)
    : m_live(in, grab,
             [&] {
               std::vector<DragPose> poses;
               for (const Vec3d& by_mm : directions) poses.push_back({by_mm, {}});
               return poses;
             }()),
      m_geometry(in.body.geometry),
      m_elements(in.body.elements),
      m_rigid(in.body.rigid),
      m_shape(in.body.q) {
  for (BrickValues& values : m_shape) values.resize(m_elements.brick_count());
  m_from = m_aim = m_shape;
  std::size_t count = 0;
  for (std::size_t b = 0; b < m_elements.brick_count(); ++b) {
    m_begin.push_back(count);
    for_each_active(m_elements.mask(b), [&](int) { ++count; });
  }
  m_begin.push_back(count);
  m_thread = std::thread([this] {
    Listening progress(m_is_cancelled);
    try {
      m_live.run(&progress);
    } catch (...) {
      m_failure = std::current_exception();
    }
    m_is_over = true;
  });
}

HandLead::~HandLead() {
  m_is_cancelled = true;
  m_thread.join();
}

void HandLead::show_before(const BodyShape& shape) {
  if (m_level >= 0) return;
  m_shape = shape;
  for (BrickValues& values : m_shape) values.resize(m_elements.brick_count());
  m_has_shape = true;
}

/// The offsets that a level gives. Those of rigid pieces follow their poses.
void HandLead::put(const LivePose& pose, BodyShape& shape) const {
  std::vector<PoseOffsets> offsets;
  const std::vector<RigidPose> poses = m_live.piece_poses(pose);
  for (std::size_t n = 0; n < poses.size(); ++n) {
    RigidPiece piece = m_rigid.list[n];
    piece.pose = poses[n];
    offsets.emplace_back(m_geometry, piece);
  }
  for (BrickValues& values : shape) values.touch_all();
  parallel_for(int(m_elements.brick_count()), [&](int brick) {
    const std::size_t b = std::size_t(brick);
    std::array<Vec3f, kBrickVoxels> u;
    m_live.displacements(pose, m_begin[b], m_begin[b + 1], u.data());
    std::size_t n = 0;
    std::array<std::int32_t*, 3> out;
    for (std::size_t c = 0; c < 3; ++c) out[c] = shape[c].touch(b);
    for_each_active(m_elements.mask(b), [&](int offset) {
      const Vec3d index = m_geometry.index_vector_from_world(Vec3d(u[n++]));
      const Slot slot = Slot(b * kBrickVoxels + std::size_t(offset));
      const int piece = m_rigid.at(slot);
      std::array<std::int64_t, 3> by_piece{};
      if (piece >= 0) by_piece = offsets[std::size_t(piece)](voxel_of(m_elements, slot));
      for (std::size_t c = 0; c < 3; ++c) {
        const std::int64_t q =
            piece >= 0 ? by_piece[c] : nearest(index[int(c)] * double(kFixedOne));
        out[c][offset] = std::int32_t(q);
      }
    });
  });
}

void HandLead::blend(double part) {
  m_part = part;
  for (std::size_t c = 0; c < 3; ++c) m_shape[c].touch_all();
  parallel_for(int(m_elements.brick_count()), [&](int brick) {
    const std::size_t b = std::size_t(brick);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t* const from = m_from[c].brick_or_zero(b);
      const std::int32_t* const aim = m_aim[c].brick_or_zero(b);
      std::int32_t* const out = m_shape[c].touch(b);
      for (int n = 0; n < kBrickVoxels; ++n) {
        const double way = double(aim[n]) - double(from[n]);
        out[n] = from[n] + std::int32_t(nearest(part * way));
      }
    }
  });
}

const BodyShape* HandLead::shape(Clock::time_point now) {
  if (!m_is_led) return nullptr;
  const LivePose pose = m_live.pose(m_target);
  if (pose.level < 0) return m_has_shape ? &m_shape : nullptr;
  if (pose.level != m_level) {
    m_level = pose.level;
    m_from = m_shape;
    m_since = now;
  }
  const double ms = std::chrono::duration<double, std::milli>(now - m_since).count();
  const double part = std::clamp(ms / kBlend_ms, 0.0, 1.0);
  m_has_shape = true;
  if (part >= 1) {
    m_part = 1;
    put(pose, m_shape);
    return &m_shape;
  }
  put(pose, m_aim);
  blend(part * part * (3 - 2 * part));
  return &m_shape;
}

LeadState HandLead::state() const {
  LeadState state;
  state.pose = m_live.pose(m_target);
  if (state.pose.level >= 0) state.force_n = m_live.force_n(state.pose);
  state.is_done = m_live.is_done();
  return state;
}

std::shared_ptr<const FemResponses> HandLead::found(Progress* progress) {
  while (!m_is_over) {
    poll(progress);
    std::this_thread::sleep_for(5ms);
  }
  if (m_failure) std::rethrow_exception(m_failure);
  return m_live.found();
}

}  // namespace supple::tools
