// A scene that is run once for each case of a sweep, in this process, one case after the other.
#pragma once

#include <exception>
#include <set>
#include <string>
#include <vector>

#include "tools/scene/file/scene.h"
#include "tools/scene/plan/scene_plan.h"
#include "tools/scene/sweep/scene_digests.h"
#include "tools/scene/sweep/sweep_cases.h"
#include "tools/scene/sweep/sweep_journal.h"
#include "volumes/base/progress.h"
#include "volumes/base/value.h"

namespace supple::tools {

/// The end of one case: its report, or the line that says why there is none.
struct CaseEnd {
  Value report;
  std::string error;
  bool was_run = true;  // false: known from a journal
  std::exception_ptr thrown{};
};

class Sweep {
 public:
  /// Reads the scenes of all cases. `pictures`: folder for the pictures of each case, with its
  /// values in their names; empty: nothing is drawn. Throws InputError for a first case that is no
  /// scene, and for films; warns of later cases that are none or whose files cannot be read.
  Sweep(std::string scene_file, SweepCases cases, std::string pictures, Progress& progress);

  const SweepCases& cases() const { return m_cases; }
  /// Digest of the scene and its files as they are without values of the sweep.
  const std::string& scene_digest() const { return m_scene_digest; }
  /// Files that any of the cases is read from.
  const std::set<std::string>& inputs() const { return m_inputs; }
  /// Number of cases that the journal has.
  std::size_t known_in(const SweepJournal& journal) const;
  /// The pictures of all cases. Throws UsageError for one that is there, unless it may be
  /// overwritten; InputError as check_scene().
  std::vector<std::string> pictures(bool may_overwrite) const;
  /// Opens the first case and plans it. Throws InputError as a dry run of its scene.
  ScenePlan plan(Progress& progress) const;

  /// Returns the report of a case from the journal, or runs the case and adds it. Errors of a case
  /// are its end. Throws Cancelled; SystemError of the journal and of pictures; bad_alloc; and
  /// whatever keeps the first case from being opened, since the sweep then is wrong and not the
  /// case.
  CaseEnd end_of(std::size_t n, SweepJournal& journal, Progress& progress);
  /// Runs a case, whatever a journal knows of it. Throws as end_of().
  CaseEnd run(std::size_t n, Progress& progress);

 private:
  Scene scene_of(std::size_t n) const;
  std::string label_of(std::size_t n) const;
  void read_case(std::size_t n, Progress& progress);
  bool has_pictures(std::size_t n) const;
  bool is_of_picture(const std::string& error, std::size_t n) const;

  struct Case {
    std::string digest, fault;  // fault: why it is no scene; empty: it is one
  };
  std::string m_file;
  SweepCases m_cases;
  std::string m_pictures;
  Value m_root;
  SceneDigests m_digests;
  std::string m_scene_digest;
  std::vector<Case> m_each;
  std::set<std::string> m_inputs;
};

}  // namespace supple::tools
