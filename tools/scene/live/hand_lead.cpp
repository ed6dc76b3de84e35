#include "tools/scene/live/hand_lead.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/session/kept_voxels.h"
#include "volumes/base/relayed_progress.h"

namespace supple::tools {

namespace {

using namespace std::chrono_literals;

/// Time in which one level gives way to the next.
constexpr double kBlend_ms = 200;

}  // namespace

Value to_value(const LeadState& state) {
  Value lead = {{"level", state.pose.level}, {"done", state.is_done}};
  if (state.pose.level < 0) return lead;
  lead["edge_voxels"] = 1 << state.pose.doublings;
  lead["force_n"] = state.force_n.length();
  if (std::isfinite(state.pose.error_mm)) lead["error_mm"] = state.pose.error_mm;
  return lead;
}

AheadThread::AheadThread(SessionBody& in, const FemStep& step) : m_solid(in, step) {
  m_thread = std::thread([this] {
    CancelWhere progress(m_is_cancelled);
    try {
      m_solid.run(&progress);
    } catch (...) {  // who needs the solid makes it, and hears why it cannot be
    }
    m_is_over = true;
  });
}

AheadThread::~AheadThread() {
  m_is_cancelled = true;
  m_thread.join();
}

std::shared_ptr<KeptVoxels> AheadThread::voxels(const Progress* progress) const {
  while (!m_is_over) {
    poll(progress);
    std::this_thread::sleep_for(5ms);
  }
  return m_solid.voxels();
}

HandLead::HandLead(const SessionBody& in, const Step& grab, std::vector<DragPose> directions,
                   std::shared_ptr<AheadThread> ahead)
    : m_live(in, grab, std::move(directions)),
      m_elements(in.body),
      m_bricks(in.body.elements.brick_count()) {
  show_before(in.body.q);
  m_has_shape = false;
  m_from = m_aim = m_shape;
  m_thread = std::thread([this, ahead = std::move(ahead)] {
    CancelWhere progress(m_is_cancelled);
    try {
      const std::shared_ptr<KeptVoxels> solid = ahead ? ahead->voxels(&progress) : nullptr;
      for (; !m_is_cancelled; std::this_thread::sleep_for(5ms)) {
        if (m_live.has_asked()) m_live.run(&progress, solid);
      }
    } catch (...) {
      m_failure = std::current_exception();
      m_has_failed = true;
    }
  });
}

HandLead::~HandLead() {
  m_is_cancelled = true;
  m_thread.join();
}

void HandLead::show_before(const BodyShape& shape) {
  if (m_level >= 0) return;
  m_shape = shape;
  for (BrickValues& values : m_shape) values.resize(m_bricks);
  m_has_shape = true;
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
  m_part = part * part * (3 - 2 * part);
  m_elements.put(m_live, pose, part < 1 ? m_aim : m_shape);
  if (part < 1) m_elements.put_between(m_from, m_aim, m_part, m_shape);
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
  for (; is_finding(); std::this_thread::sleep_for(5ms)) poll(progress);
  if (m_has_failed) std::rethrow_exception(m_failure);
  return m_live.found();
}

}  // namespace supple::tools
