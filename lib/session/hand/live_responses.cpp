#include "lib/session/hand/live_responses.h"

#include <algorithm>
#include <cmath>

#include "lib/fem/fem_solution.h"
#include "lib/session/fem_limits.h"
#include "lib/session/fem_task.h"
#include "lib/session/hand/live_level.h"
#include "lib/session/handles/handle_motion.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Directions that are shorter than this part of their target are no directions of their own.
constexpr double kLeastPart = 1e-6;
double dot_of(const std::array<double, 12>& a, const std::array<double, 12>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += a[n] * b[n];
  return sum;
}

/// Solves A x = b, A symmetric and not negative; unknowns without a pivot of their own are 0.
std::vector<double> solved(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t count = b.size();
  std::vector<double> scale(count), x(count, 0.0);
  for (std::size_t n = 0; n < count; ++n) scale[n] = a[n][n];
  std::vector<bool> is_used(count, false);
  for (std::size_t n = 0; n < count; ++n) {
    is_used[n] = a[n][n] > kLeastPart * kLeastPart * scale[n] && scale[n] > 0;
    if (!is_used[n]) continue;
    for (std::size_t row = n + 1; row < count; ++row) {
      const double factor = a[row][n] / a[n][n];
      for (std::size_t m = n; m < count; ++m) a[row][m] -= factor * a[n][m];
      b[row] -= factor * b[n];
    }
  }
  for (std::size_t n = count; n-- > 0;) {
    if (!is_used[n]) continue;
    double sum = b[n];
    for (std::size_t m = n + 1; m < count; ++m) sum -= a[n][m] * x[m];
    x[n] = sum / a[n][n];
  }
  return x;
}

}  // namespace

LiveResponses::LiveResponses(const SessionBody& in, const Step& grab,
                             std::vector<DragPose> directions)
    : m_body(in.body),
      m_fits(m_body),
      m_density(in.state.density),
      m_labels(in.state.labels),
      m_cuts(in.cuts()),
      m_anchors(in.anchors),
      m_holds(in.holds) {
  if (!grab.fem || grab.drags.size() != 1) {
    throw InputError({"", "responses", "a step without finite elements or with several handles",
                      "one handle under finite elements"});
  }
  m_step = *grab.fem;
  const Vec3d edges_mm = m_body.geometry.spacing_mm();
  m_step.params =
      solved_params(m_step, !m_labels.empty(), std::min({edges_mm.x, edges_mm.y, edges_mm.z}));
  const std::string reason = why_no_sum(m_step.params);
  if (!reason.empty()) throw InputError({"", "responses", reason, "linear equilibria of voxels"});
  if (in.responses && m_step.params.elements.touching == Touching::apart) {
    m_voxels = in.responses->voxels;
  }
  const SlotSet grabbed = elements_of(m_body, in.region_of(grab.drags.front()), "grab");
  m_about_mm = centre_lps_mm(m_body, grabbed);
  double squares = 0;
  grabbed.for_each([&](Slot slot) {
    squares += (m_body.geometry.world_from_index(place_now(m_body, slot)) - m_about_mm).length2();
  });
  const Vec3d spacing = m_body.geometry.spacing_mm();
  m_radius_mm = std::max(std::sqrt(squares / double(grabbed.size())), spacing.x / 2);
  add(in, grab, {Vec3d(0), {}});
  for (DragPose& pose : directions) add(in, grab, std::move(pose));
}

LiveResponses::~LiveResponses() = default;

void LiveResponses::add(const SessionBody& in, const Step& grab, DragPose direction) {
  Step step = grab;
  Drag& drag = step.drags.front();
  if (!direction.motion.about_lps_mm) direction.motion.about_lps_mm = m_about_mm;
  drag.by_mm = direction.by_mm;
  drag.motion = direction.motion;
  std::vector<Handle> handles = in.handles_of(step, in.motions_of(step), 1);
  const std::lock_guard<std::mutex> lock(m_mutex);
  m_asked.push_back(std::move(handles));
  m_ways.push_back(affine_of(direction));
  m_all.reset();
  m_has_asked = true;
}

/// Shift of the middle, and the linear map less the identity times the radius: a motion of about so
/// many mm each.
LiveResponses::Affine LiveResponses::affine_of(const DragPose& pose) const {
  const Geometry& geometry = m_body.geometry;
  Affine out{};
  const GridSteps steps = steps_of(pose.motion, geometry);
  const auto moved_way = [&](const Vec3d& way_mm) {
    const Vec3d index = geometry.index_vector_from_world(way_mm);
    const Vec3d moved = steps[0] * index.x + steps[1] * index.y + steps[2] * index.z;
    return geometry.world_vector_from_index(moved) - way_mm;
  };
  const Vec3d about = pose.motion.about_lps_mm.value_or(m_about_mm);
  const Vec3d shift = geometry.world_vector_from_index(pose.by_mm / geometry.spacing_mm()) +
                      moved_way(m_about_mm - about);
  for (int a = 0; a < 3; ++a) {
    out[std::size_t(a)] = shift[a];
    Vec3d unit(0.0);
    unit[a] = m_radius_mm;
    const Vec3d column = moved_way(unit);
    for (std::size_t c = 0; c < 3; ++c) out[3 + 3 * c + a] = column[int(c)];
  }
  return out;
}

int LiveResponses::ready() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_ready;
}

std::shared_ptr<const FemResponses> LiveResponses::found() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  return m_all;
}

LivePose LiveResponses::pose(const DragPose& target) const {
  LivePose out;
  std::vector<Affine> ways;
  {
    const std::lock_guard<std::mutex> lock(m_mutex);
    out.level = m_ready - 1;
    out.of = m_best;
    ways.assign(m_ways.begin() + 1, m_ways.end());
  }
  if (out.of) ways.resize(out.of->of.size() - 1);
  const Affine asked = affine_of(target);
  const std::size_t count = ways.size();
  std::vector<std::vector<double>> products(count, std::vector<double>(count));
  std::vector<double> of_asked(count);
  for (std::size_t n = 0; n < count; ++n) {
    of_asked[n] = dot_of(ways[n], asked);
    for (std::size_t m = 0; m < count; ++m) products[n][m] = dot_of(ways[n], ways[m]);
  }
  out.parts = solved(std::move(products), std::move(of_asked));
  Affine left = asked;
  for (std::size_t n = 0; n < count; ++n) {
    for (std::size_t a = 0; a < left.size(); ++a) left[a] -= out.parts[n] * ways[n][a];
  }
  out.beyond_mm = std::sqrt(dot_of(left, left));
  if (!out.of) return out;
  out.error_mm = 0;
  for (std::size_t n = 0; n <= count; ++n) {
    const LiveResponse& of = *out.of->of[n];
    const double part = n == 0 ? 1 : std::abs(out.parts[n - 1]);
    if (part == 0) continue;
    out.doublings = std::max(out.doublings, of.doublings);
    if (!of.is_last) {
      out.error_mm += part * of.change_mm.value_or(std::numeric_limits<double>::infinity());
    }
  }
  return out;
}

namespace {

/// The parts with that of the base, which is 1.
std::vector<double> with_base(const LivePose& pose) {
  std::vector<double> parts = pose.parts;
  parts.insert(parts.begin(), 1);
  return parts;
}

}  // namespace

void LiveResponses::displacements(const LivePose& pose, std::size_t begin, std::size_t end,
                                  Vec3f* out) const {
  pose.of->field.sum(with_base(pose), begin, end, out);
}

Vec3d LiveResponses::force_n(const LivePose& pose) const {
  const std::vector<double> parts = with_base(pose);
  Vec3d sum(0);
  for (std::size_t n = 0; n < parts.size(); ++n) sum += pose.of->of[n]->force_n * parts[n];
  return sum;
}

std::vector<RigidPose> LiveResponses::piece_poses(const LivePose& pose) const {
  const std::vector<double> parts = with_base(pose);
  std::vector<PieceMoments> sums(m_body.rigid.list.size());
  for (std::size_t n = 0; n < parts.size(); ++n) {
    for (std::size_t p = 0; p < sums.size(); ++p) sums[p].add(pose.of->of[n]->pieces[p], parts[n]);
  }
  return m_fits.poses(sums);
}

std::size_t LiveResponses::bytes() const {
  const std::lock_guard<std::mutex> lock(m_mutex);
  const std::size_t sum = m_body.bytes() + (m_best ? m_best->field.bytes() : 0);
  return sum + (m_all ? m_all->known.bytes() : 0);
}

}  // namespace supple
