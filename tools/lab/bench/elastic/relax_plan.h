// Which rows `supple bench relax` measures, in the order in which they run.
#pragma once

#include <string>
#include <vector>

#include "lib/model/relax_model.h"

namespace supple::tools {

struct RelaxRow {
  std::string kind;   // the row's `case`
  std::string field;  // noise, ct, head_phantom, ct_head, ball, tissue_ball or tissue_bar
  int size;           // voxels per axis; 0: the head CT's own
  RelaxMethod method;
  double volume_kpa = 0;  // bulk modulus; 0: volume is not conserved
  int threads = 1;
  int count = 0;  // passes timed per round, states, most passes, or passes before tightening
  int links = 6;  // per voxel

  /// True if the bulk modulus tells the row from others.
  bool is_of_volume() const { return kind == "volume" || kind == "press" || kind == "pull"; }

  /// Rows of a group share a body and follow each other.
  std::string group() const;
  /// case/field/size/method[/volume or links][/threads], or tighten/field/size/passes, which --only
  /// matches.
  std::string name() const;
};

struct RelaxPlanOptions {
  bool quick = false;
  int threads = 0;                // of the rows with several threads; 0: two, one on a single core
  bool has_ct_head = false;       // rows of ct_head
  std::vector<std::string> only;  // patterns; empty: every row
};

/// Rows that the options choose; empty when `only` leaves none.
std::vector<RelaxRow> plan_relax(const RelaxPlanOptions& options);

}  // namespace supple::tools
