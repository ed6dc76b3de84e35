// Instruments against the nodes of a membrane: continuous, one-sided, with Coulomb friction.
//
// Nodes are swept against the moving round cones of a substep, so that fast tools do not pass them
// by. Tips whose radius is below 0.6 times the distance of nodes may pass between them.
#pragma once

#include "lib/instruments/round_cone.h"
#include "lib/membrane/sheet.h"

namespace supple {

class ToolPush {
 public:
  explicit ToolPush(double thickness_mm) : m_thickness_mm(thickness_mm) {}

  /// Finds nodes within `margin_mm` of the way of a tool in the part `from` to `to` of a step.
  void begin(const Sheet& sheet, const std::vector<ToolMotion>& tools, double from, double to,
             double margin_mm);
  /// Moves nodes that tools run into.
  void push(Sheet& sheet);
  /// Takes back slip along tools, up to `friction` times the push.
  void rub(Sheet& sheet, double friction);
  /// Adds the forces at tools of a substep of `h` seconds, in mN, each times `weight`.
  void add_forces(const Sheet& sheet, const MembraneParams& params, double weight,
                  std::vector<Vec3d>& forces_mn) const;

  /// Calls `touch(node)` for every node that a tool has pushed in this substep.
  template <class Touch>
  void each_pushed(Touch&& touch) const {
    for (const NearNode& near : m_near) {
      if (near.push_mm.length2() > 0) touch(near.node);
    }
  }

 private:
  /// A part of a tool in a substep.
  struct SweptCone {
    std::size_t motion;  // index of the tool's
    RoundCone from, to;
  };
  /// A node near a part; once it touches, the plane before which it has to end.
  struct NearNode {
    int node;
    std::size_t cone;
    bool touches = false;
    Vec3d normal{0, 0, 1};
    double bound_mm = 0;
    Vec3d motion_mm{0, 0, 0};  // of the tool's surface there
    Vec3d push_mm{0, 0, 0};    // friction included
  };
  void find_touch(const Sheet& sheet, NearNode& near) const;
  void find_near(const Sheet& sheet, double margin_mm, const Vec3d& lo, const Vec3d& hi);

  double m_thickness_mm;
  std::vector<SweptCone> m_cones;
  std::vector<NearNode> m_near;
};

}  // namespace supple
