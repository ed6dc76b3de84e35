#include "lib/session/step_warnings.h"

#include <algorithm>
#include <cstdio>
#include <limits>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// An anchor nearer to a rigid piece than this was probably meant to hold it.
constexpr double kBesideMm = 10;
/// Free pieces that finite elements move further than this are told of.
constexpr double kToldMm = 0.1;

std::string four_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return text;
}

void warn_of_projection(std::int64_t links, double max_voxels, std::int64_t held,
                        Progress* progress) {
  if (links == 0) return;
  if (held > 0) {
    warn(progress, with_count(held, "held element") +
                       " had to move: links do not reach from one to the other");
  }
  warn(progress, "the start broke " + with_count(links, "link") +
                     "; it was projected, largest move " + four_digits(max_voxels) + " voxels");
}

std::string depth_of(const SidesReport& report) {
  return four_digits(report.left_voxels) + " voxels at voxel " + to_text(report.voxel);
}

/// The largest way of any element between two poses, in mm.
double longest_way_mm(const Body& body, RigidPiece piece, const RigidPose& from) {
  const PoseOffsets now(body.geometry, piece);
  piece.pose = from;
  const PoseOffsets before(body.geometry, piece);
  double longest = 0;
  piece.elements->for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    const auto to = now(voxel), at = before(voxel);
    const Vec3d way = Vec3d(double(to[0] - at[0]), double(to[1] - at[1]), double(to[2] - at[2]));
    longest = std::max(longest, body.geometry.world_vector_from_index(way / kFixedOne).length());
  });
  return longest;
}

}  // namespace

void note_of_links(const Step& request, int links, Progress* progress) {
  const bool is_ball = request.limits == Limits::ball;
  if (links == 6 || (!request.springs && !is_ball)) return;
  note(progress, std::string(is_ball ? "ball limits know" : "springs have") +
                     " links of their own; links = " + std::to_string(links) +
                     " of the material counts in other steps");
}

void warn_of_missed_pieces(const Body& body, const SlotSet& held, const SlotSet& grabbed,
                           Progress* progress) {
  if (held.empty() || body.rigid.empty()) return;
  IndexBox anchors{Vec3i(std::numeric_limits<int>::max()), Vec3i(std::numeric_limits<int>::min())};
  held.for_each([&](Slot slot) {
    const Vec3i voxel = voxel_of(body.elements, slot);
    for (int a = 0; a < 3; ++a) {
      anchors.lo[a] = std::min(anchors.lo[a], voxel[a]);
      anchors.hi[a] = std::max(anchors.hi[a], voxel[a]);
    }
  });
  const RigidPiece* missed = nullptr;
  double least_mm = kBesideMm;
  Vec3i nearest;
  for (const RigidPiece& piece : body.rigid.list) {
    Slot common;
    if (piece.elements->first_common(held, common)) return;
    if (piece.elements->first_common(grabbed, common)) continue;
    piece.elements->for_each([&](Slot slot) {
      const Vec3i voxel = voxel_of(body.elements, slot);
      Vec3d way;
      for (int a = 0; a < 3; ++a) {
        way[a] = voxel[a] - std::clamp(voxel[a], anchors.lo[a], anchors.hi[a]);
      }
      const double mm = body.geometry.world_vector_from_index(way).length();
      if (mm >= least_mm) return;
      least_mm = mm;
      nearest = voxel;
      missed = &piece;
    });
  }
  if (missed == nullptr) return;
  warn(progress, "fix: no rigid piece is held, for no anchor is one of its voxels; voxel " +
                     to_text(nearest) + " of rigid " + missed->name + " is " +
                     four_digits(least_mm) + " mm from the anchors");
}

void warn_of_links(const LinkCheck& links, const std::string& model, const std::string& later,
                   Progress* progress) {
  if (links.violated == 0) return;
  warn(progress, model + " left " + with_count(links.violated, "link") + " of " +
                     std::to_string(links.links) + " beyond the material's limits, by at most " +
                     number_text(links.worst_excess_voxels) + " voxels; " + later);
}

void warn_of_moved_pieces(const Body& body, const std::vector<RigidPiece>& before,
                          const std::vector<PieceMotion>& grabbed, Progress* progress) {
  std::int64_t moved = 0;
  std::size_t largest = 0, most_elements = 0;
  double way_mm = 0;
  for (std::size_t n = 0; n < before.size(); ++n) {
    const RigidPiece& piece = body.rigid.list[n];
    const bool is_grabbed =
        std::any_of(grabbed.begin(), grabbed.end(),
                    [&](const PieceMotion& motion) { return motion.piece == n; });
    if (is_grabbed || piece.pose == before[n].pose) continue;
    const double way = longest_way_mm(body, piece, before[n].pose);
    if (way < kToldMm) continue;
    ++moved;
    const std::size_t elements = piece.elements->size();
    if (elements <= most_elements) continue;
    most_elements = elements;
    largest = n;
    way_mm = way;
  }
  if (moved == 0) return;
  const RigidPiece& piece = body.rigid.list[largest];
  const Turn turn = piece.pose.turn * before[largest].pose.turn.inverse();
  warn(progress, "finite elements moved " + with_count(moved, "free rigid piece") +
                     ", the largest of them, " + piece.name + ", by up to " + number_text(way_mm) +
                     " mm and by a turn of " + number_text(turn.angle_deg()) +
                     " degrees; an anchor on one of its voxels, such as " +
                     to_text(voxel_of(body.elements, piece.elements->first())) + ", holds it");
}

void warn_of_report(const EcmReport& report, Progress* progress) {
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     progress);
  if (report.fraction_numerator != report.fraction_denominator) {
    warn(progress, "anchors stopped the drag at " + four_digits(100 * report.fraction()) + " %" +
                       " (" + std::to_string(report.fraction_numerator) + "/" +
                       std::to_string(report.fraction_denominator) + ")");
  }
}

void warn_of_stop(const BoneStop& stop, const EcmReport& report, Progress* progress) {
  warn(progress, "bone stopped the drag at " + four_digits(100 * report.fraction()) + " %: after " +
                     four_digits(stop.way_mm) + " mm voxel " + to_text(stop.voxel) + " of rigid " +
                     stop.piece + " meets rigid " + stop.other +
                     "; another way, a gap between them (remove) or contact = false in the "
                     "material goes on");
}

void warn_of_report(const SidesReport& report, Progress* progress) {
  if (report.parts < kContactParts) {
    warn(progress, "the sides of a cut stopped the drag: both are held where they meet");
  }
  if (report.is_crushed) {
    note(progress, "tissue that has no room beside bone is crushed: sides of cuts overlap at " +
                       with_count(report.left, "point") + ", by up to " + depth_of(report));
  } else if (report.left > 0) {
    warn(progress, "the sides of a cut overlap by up to " + depth_of(report) +
                       ": what is held leaves no room");
  }
}

void warn_of_sides(const SidesReport& report, Progress* progress) {
  if (report.left == 0) return;
  note(progress, "finite elements know no contact of tissue: sides of cuts overlap at " +
                     with_count(report.left, "point") + ", by up to " + depth_of(report));
}

void warn_of_meetings(const std::vector<BoneMeeting>& meetings, Progress* progress) {
  for (const bool is_kept : {true, false}) {
    std::int64_t count = 0;
    const BoneMeeting* deepest = nullptr;
    for (const BoneMeeting& meeting : meetings) {
      if (meeting.is_kept != is_kept) continue;
      ++count;
      if (deepest == nullptr || meeting.overlap_voxels > deepest->overlap_voxels) {
        deepest = &meeting;
      }
    }
    if (deepest == nullptr) continue;
    const std::string where = with_count(count, "pair") + " of rigid pieces, at most " +
                              deepest->piece + " in " + deepest->other + " by " +
                              four_digits(deepest->overlap_voxels) + " voxels at voxel " +
                              to_text(deepest->voxel);
    if (is_kept) {
      note(progress, "finite elements would press into each other " + where +
                         ": free ones stay where they meet the other");
    } else {
      warn(progress, "finite elements press into each other " + where +
                         "; an anchor on a voxel of a free one holds it");
    }
  }
}

void warn_of_report(const BallReport& report, Progress* progress) {
  if (report.violated == 0) return;
  warn(progress, "ball limits leave " + with_count(report.violated, "link") + " of " +
                     std::to_string(report.links) + " violated, by at most " +
                     four_digits(report.worst_excess_voxels) + " voxels" +
                     (report.capped ? "; the moves reached their limit" : ""));
}

void warn_of_report(const RelaxReport& report, const LinkCheck& check, Progress* progress) {
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     progress);
  if (report.diagonal_links > 0) {
    note(progress, "relaxation that conserves volume knows links along the axes only: " +
                       with_count(report.diagonal_links, "link") +
                       " moved back to the limits of diagonals, largest move " +
                       four_digits(report.diagonal_max_voxels) + " voxels");
  }
  if (report.end == RelaxEnd::budget) {
    note(progress, "relaxation ended by its budget, in pass " + std::to_string(report.passes) +
                       ", whose largest step was " + four_digits(report.largest_step_voxels) +
                       " voxels; a larger budget of relax lets it go on");
  }
  if (check.violated > 0) {
    warn(progress, "plain relaxation broke " + with_count(check.violated, "link") + " of " +
                       std::to_string(check.links) + ", by at most " +
                       four_digits(check.worst_excess_voxels) + " voxels");
  }
}

void warn_of_report(const TightenReport& report, Progress* progress) {
  warn_of_projection(report.projected_links, report.projected_max_voxels, report.projected_held,
                     progress);
  if (report.violated == 0) return;
  note(progress, "tightened limits leave " + with_count(report.violated, "link") + " of " +
                     std::to_string(report.links) + " violated, by at most " +
                     four_digits(report.worst_excess_voxels) +
                     " voxels; the material's own limits hold");
}

}  // namespace supple
