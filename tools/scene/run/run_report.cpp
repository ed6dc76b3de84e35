#include "tools/scene/run/run_report.h"

#include <algorithm>

#include "tools/scene/run/reports.h"
#include "tools/scene/run/scene_files.h"
#include "volumes/base/memory.h"

namespace supple::tools {

Value run_report(const SceneRun& run, const Scene& scene, const std::string& folder,
                 const StageSeconds& stages) {
  Value report;
  report["steps"] = Value::List();
  if (run.session() != nullptr) {
    for (const StepRecord& record : run.session()->records()) {
      report["steps"].push_back(to_value(record));
    }
    const RigidPieces& pieces = run.session()->body().rigid;
    if (!pieces.empty()) report["rigid_pieces"] = to_value(pieces);
  }
  if (run.certificate() != nullptr) report["certificate"] = to_value(*run.certificate());
  double total_s = 0;
  for (const auto& [name, seconds] : stages) {
    report["stage_seconds"][name] = seconds;
    total_s += seconds;
  }
  report["total_s"] = total_s;
  report["peak_rss_mb"] = std::max(peak_rss_mb(), peak_rss_of_children_mb());
  for (const std::string& name : scene.outputs()) {
    report["outputs"].push_back(path_in(folder, name));
  }
  return report;
}

}  // namespace supple::tools
