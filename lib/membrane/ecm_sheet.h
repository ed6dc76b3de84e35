// Enhanced ChainMail as the other model of a membrane (thesis section 6.1.2 tried both): gripped
// nodes and nodes that tools run into are handles, the sheet follows within limits of its links.
//
// Links of adhesion give way up to their breaking stretch, which ChainMail, without forces, turns
// into a force by their stiffness; then they break. The sheet does not tear, has no velocity, and
// does not go back when nothing pulls it.
#pragma once

#include "lib/chainmail/mesh_ecm.h"
#include "lib/membrane/solver.h"

namespace supple {

/// Limits of links of a membrane, times their lengths at rest.
inline constexpr MeshLimits kSheetLimits{1.1, 0.9, 0.5};

class EcmSheet {
 public:
  /// Refers to the sheet, whose topology must not change meanwhile.
  explicit EcmSheet(Sheet& sheet) : m_sheet(sheet), m_ecm(sheet.body, kSheetLimits) {}

  /// Lets the sheet follow from where it is to nodes that are held or pushed to `targets_mm`; its
  /// other nodes are where they were.
  void follow(const std::vector<int>& nodes, const std::vector<Vec3d>& targets_mm);

 private:
  Sheet& m_sheet;
  MeshEcm m_ecm;
};

}  // namespace supple
