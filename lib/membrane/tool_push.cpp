#include "lib/membrane/tool_push.h"

#include <algorithm>

#include "lib/contact/friction.h"

namespace supple {

namespace {

void widen(Vec3d& lo, Vec3d& hi, const Vec3d& point, double radius) {
  for (int c = 0; c < 3; ++c) {
    lo[c] = std::min(lo[c], point[c] - radius);
    hi[c] = std::max(hi[c], point[c] + radius);
  }
}

bool is_within(const Vec3d& p, const Vec3d& lo, const Vec3d& hi) {
  return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
}

bool overlap(const Vec3d& lo, const Vec3d& hi, const Vec3d& other_lo, const Vec3d& other_hi) {
  return lo.x <= other_hi.x && hi.x >= other_lo.x && lo.y <= other_hi.y && hi.y >= other_lo.y &&
         lo.z <= other_hi.z && hi.z >= other_lo.z;
}

}  // namespace

void ToolPush::begin(const Sheet& sheet, const std::vector<ToolMotion>& tools, double from,
                     double to, double margin_mm) {
  m_cones.clear();
  m_near.clear();
  for (std::size_t n = 0; n < tools.size(); ++n) {
    for (const MovingPart& part : tools[n].parts) {
      m_cones.push_back({n, between(part.from, part.to, from), between(part.from, part.to, to)});
    }
  }
  if (m_cones.empty()) return;
  Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
  for (const Vec3d& pos : sheet.body.pos_mm) widen(lo, hi, pos, 0);
  for (const Vec3d& pos : sheet.start_mm) widen(lo, hi, pos, 0);
  find_near(sheet, margin_mm, lo, hi);
}

void ToolPush::find_near(const Sheet& sheet, double margin_mm, const Vec3d& sheet_lo,
                         const Vec3d& sheet_hi) {
  for (std::size_t c = 0; c < m_cones.size(); ++c) {
    const SweptCone& cone = m_cones[c];
    Vec3d lo(HUGE_VAL), hi(-HUGE_VAL);
    for (const RoundCone* end : {&cone.from, &cone.to}) {
      widen(lo, hi, end->a_mm, end->a_radius_mm + m_thickness_mm + margin_mm);
      widen(lo, hi, end->b_mm, end->b_radius_mm + m_thickness_mm + margin_mm);
    }
    if (!overlap(lo, hi, sheet_lo, sheet_hi)) continue;
    for (int n = 0; n < sheet.node_count(); ++n) {
      // A node that is fast passes the box: the box of its way counts.
      Vec3d way_lo(HUGE_VAL), way_hi(-HUGE_VAL);
      if (sheet.mobility[n] == 0) continue;
      if (!is_within(sheet.body.pos_mm[n], lo, hi)) {
        widen(way_lo, way_hi, sheet.start_mm[n], 0);
        widen(way_lo, way_hi, sheet.body.pos_mm[n], 0);
        if (!overlap(lo, hi, way_lo, way_hi)) continue;
      }
      m_near.push_back({n, c});
    }
  }
}

void ToolPush::find_touch(const Sheet& sheet, NearNode& near) const {
  const SweptCone& cone = m_cones[near.cone];
  const Vec3d &start = sheet.start_mm[near.node], &pos = sheet.body.pos_mm[near.node];
  const auto part = first_touch(start, pos, cone.from, cone.to, m_thickness_mm);
  if (!part) return;
  const Vec3d there = start + (pos - start) * *part;
  const RoundCone then = between(cone.from, cone.to, *part);
  const Approach at = approach(there, then);
  const double along = nearest_part(there, then);
  const Vec3d by_a = cone.to.a_mm - cone.from.a_mm, by_b = cone.to.b_mm - cone.from.b_mm;
  near.touches = true;
  near.normal = at.normal;
  near.motion_mm = by_a + (by_b - by_a) * along;
  near.bound_mm = at.normal.dot(at.place_mm + near.motion_mm * (1 - *part)) + m_thickness_mm;
}

void ToolPush::push(Sheet& sheet) {
  for (NearNode& near : m_near) {
    if (!near.touches) find_touch(sheet, near);
    if (!near.touches) continue;
    Vec3d& pos = sheet.body.pos_mm[near.node];
    const double gap = near.bound_mm - near.normal.dot(pos);
    if (gap > 0) {
      pos += near.normal * gap;
      near.push_mm += near.normal * gap;
    }
    // The surface bends away from the plane, or has turned.
    const Approach at = approach(pos, m_cones[near.cone].to);
    const double depth = m_thickness_mm - at.distance_mm;
    if (depth <= 0 || at.normal.dot(near.normal) <= 0) continue;
    pos += at.normal * depth;
    near.push_mm += at.normal * depth;
  }
}

void ToolPush::rub(Sheet& sheet, double friction) {
  if (friction == 0) return;
  for (NearNode& near : m_near) {
    const double push = near.push_mm.length();
    if (push == 0) continue;
    const Vec3d normal = near.push_mm / push;
    Vec3d& pos = sheet.body.pos_mm[near.node];
    const Vec3d moved = pos - sheet.start_mm[near.node] - near.motion_mm;
    const Vec3d back = slip_taken_back(friction, normal, push, moved);
    pos -= back;
    near.push_mm -= back;
  }
}

void ToolPush::add_forces(const Sheet& sheet, const MembraneParams& params, double weight,
                          std::vector<Vec3d>& forces_mn) const {
  // Damping that is taken implicitly makes masses seem larger.
  const double h = params.substep_s, seeming = 1 + h * params.damping_per_s;
  for (const NearNode& near : m_near) {
    const double per_mm = weight * seeming * sheet.mass_kg[near.node] / (h * h);
    forces_mn[m_cones[near.cone].motion] -= near.push_mm * per_mm;
  }
}

}  // namespace supple
