// Warnings about a step: projections, stopped drags, limits that are left broken.
#pragma once

#include "lib/session/step.h"
#include "volumes/base/progress.h"

namespace supple {

/// Of a step whose model does not use the material's diagonal links.
void note_of_links(const StepRequest& request, int links, Progress* progress);
void warn_of_report(const EcmReport& report, Progress* progress);
void warn_of_report(const SidesReport& report, Progress* progress);
void warn_of_report(const BallReport& report, Progress* progress);
void warn_of_report(const TightenReport& report, Progress* progress);
/// `check`: of the links after a relaxation that may break them.
void warn_of_report(const RelaxReport& report, const LinkCheck& check, Progress* progress);

}  // namespace supple
