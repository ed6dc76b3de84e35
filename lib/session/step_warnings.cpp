#include "lib/session/step_warnings.h"

#include <cstdio>
#include <string>

#include "volumes/base/text.h"

namespace supple {

namespace {

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

}  // namespace

void note_of_links(const StepRequest& request, int links, Progress* progress) {
  const bool is_ball = request.limits == Limits::ball;
  if (links == 6 || (!request.springs && !is_ball)) return;
  note(progress, std::string(is_ball ? "ball limits know" : "springs have") +
                     " links of their own; links = " + std::to_string(links) +
                     " of the material counts in other steps");
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

void warn_of_report(const SidesReport& report, Progress* progress) {
  if (report.parts < CutContact::kDragParts) {
    warn(progress, "the sides of a cut stopped the drag: both are held where they meet");
  }
  if (report.left > 0) {
    warn(progress, "the sides of a cut overlap by up to " + four_digits(report.left_voxels) +
                       " voxels: what is held leaves no room");
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
