// Warnings about a step: projections, stopped drags, limits that are left broken.
#pragma once

#include "lib/session/handles/rigid_drag.h"
#include "lib/session/step.h"
#include "volumes/base/progress.h"

namespace supple {

/// Notes that the model of a step does not use the material's diagonal links.
void note_of_links(const Step& request, int links, Progress* progress);
/// Warns where no `held` element is of a rigid piece although an anchor lies beside a piece that is
/// not `grabbed`: names the piece and its voxel nearest to the anchors.
void warn_of_missed_pieces(const Body& body, const SlotSet& held, const SlotSet& grabbed,
                           Progress* progress);
/// Tells how far finite elements moved pieces that neither handles nor anchors hold.
void warn_of_moved_pieces(const Body& body, const std::vector<RigidPiece>& before,
                          const std::vector<PieceMotion>& grabbed, Progress* progress);
void warn_of_report(const EcmReport& report, Progress* progress);
void warn_of_stop(const BoneStop& stop, const EcmReport& report, Progress* progress);
void warn_of_report(const SidesReport& report, Progress* progress);
/// The warnings after finite elements, which know no contact.
void warn_of_sides(const SidesReport& report, Progress* progress);
/// Free pieces that were kept out of others, and those that could not be.
void warn_of_meetings(const std::vector<BoneMeeting>& meetings, Progress* progress);
/// Links that `model` has left beyond the material's limits, and what becomes of them.
void warn_of_links(const LinkCheck& links, const std::string& model, const std::string& later,
                   Progress* progress);
void warn_of_report(const BallReport& report, Progress* progress);
void warn_of_report(const TightenReport& report, Progress* progress);
/// `check`: of the links after a relaxation that may break them.
void warn_of_report(const RelaxReport& report, const LinkCheck& check, Progress* progress);

}  // namespace supple
