// A scene that is run once for each case of a cohort, each in a process of its own.
//
// DIR/cohort.json says that the folder is that of a cohort. DIR/cases/NAME has what the scene of a
// case that is done writes, its result.json and a thumbnail.jpg; DIR/failed/NAME.json tells of one
// that failed; in DIR/.work/K-of-N/NAME shard K of N runs one.
//
// The folder of a case gets its name when all is in it, so that several processes may work in one
// DIR, and whatever ends them leaves whole cases. A case is known by a digest of its scene, of the
// files that it names, and of the program's version.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tools/scene/sweep/scene_digests.h"
#include "tools/scene/sweep/sweep_cases.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// Every shards-th case, from the shard-th on, counted from 1.
struct CohortShard {
  int shard = 1, shards = 1;

  /// "-2-of-3"; empty where one shard is all.
  std::string suffix() const;
};

/// Reads K/N. Throws UsageError for another text.
CohortShard parse_shard(const std::string& text);

struct CohortWork {
  CohortShard part;
  int jobs = 1;       // cases at a time
  int threads = 0;    // of each; 0: all
  bool anew = false;  // also cases that are done
};

/// The end of a case.
struct CohortEnd {
  std::size_t n = 0;
  Value line;           // name, values, digest and, where it is done, program, report and warnings
  std::string error;    // empty: it is done
  bool was_run = true;  // false: known from before
};

class Cohort {
 public:
  /// Reads the scenes of all cases. Throws InputError for files that are none, and where no case is
  /// a scene; UsageError for a folder with other files than those of a cohort.
  Cohort(std::string scene_file, const std::string& cases_file, std::string folder);

  std::size_t size() const { return m_names.size(); }
  const SweepCases& values() const { return m_values; }
  const std::string& folder() const { return m_folder; }
  const std::string& name(std::size_t n) const { return m_names[n]; }

  /// Runs the cases of a shard that are not done. Errors of cases are their ends, of which each is
  /// told by `told` as soon as it is there. Returns them in the order of cases. Throws Cancelled;
  /// SystemError where the folder cannot be written.
  std::vector<CohortEnd> run(const CohortWork& work, Progress& progress,
                             const std::function<void(const CohortEnd&)>& told);
  /// Tells what became of each case, without running any. Throws Cancelled.
  std::vector<CohortEnd> gather(Progress& progress);

 private:
  Value line_of(std::size_t n, const std::string& digest) const;
  std::string digest_of(std::size_t n);
  CohortEnd known_end(std::size_t n, const std::string& digest) const;
  CohortEnd run_case(std::size_t n, const std::string& digest, const CohortWork& work,
                     const std::function<bool()>& stops) const;
  std::vector<std::string> arguments_of(std::size_t n, const CohortWork& work) const;
  std::string place_of_case(std::size_t n) const;
  std::string place_of_failure(std::size_t n) const;
  std::string place_of_work(const CohortWork& work) const;

  std::string m_file, m_folder;
  SweepCases m_values;
  std::vector<std::string> m_names, m_faults;  // faults: why a case is no scene; empty: it is one
  Value m_root;
  SceneDigests m_digests;
};

}  // namespace supple::tools
