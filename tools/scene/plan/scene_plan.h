// Plan of what a scene is going to hold and compute, and why: in database terms its
// EXPLAIN.
//
// The volume is open, so that elements and bricks are counted and not guessed. How far drags reach
// (moved_bricks.h) and what rays read (ray_work.h) is estimated. Times are those counts at the
// machine's unit costs; memory is what the process holds now, which includes the volume, and what
// the code allocates per brick, voxel and unknown. docs/economy.md has the rules and their errors.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace supple {
class Session;
struct State;
}  // namespace supple

namespace supple::tools {

class SceneRun;
struct Scene;
class UnitCosts;

/// One thing that is allocated or computed.
struct PlanRow {
  std::string stage;    // "volume", "step 1", "view bone.png", "output warp.nrrd"
  std::string what;     // "offsets of 1,234 bricks"
  std::string why;      // what asks for it
  double held_mb = 0;   // from then on, in millions of bytes
  double brief_mb = 0;  // until the row is done
  double seconds = 0;
};

/// One thing that is neither allocated nor computed.
struct PlanGap {
  std::string what, why;
};

struct ScenePlan {
  std::vector<PlanRow> rows;  // in the order of the run
  std::vector<PlanGap> gaps;
  double peak_mb = 0;  // of the process, at the most
  double seconds = 0;  // of all rows
  std::string costs;   // where the unit costs are from
};

/// Bricks that a volume will fill which is not read yet.
struct ExpectedBricks {
  double read = 0;           // while it is read
  double kept = 0;           // from then on, of densities and of elements alike
  double reading_bytes = 0;  // beside them, while it is read
};

/// Subject of the scene that is open, and the memory that the process holds by now.
struct PlanSubject {
  const Session* session = nullptr;  // null: nothing moves, or it is not open yet
  const State& state;                // of which density, elements and geometry are read
  double start_seconds = 0;          // that loading the program took
  double open_seconds = 0;           // that opening took
  double held_mb = 0, peak_mb = 0;   // of the process, now and so far
  /// Bricks of a volume that is not open: the state has its geometry alone. The plan is then one of
  /// a scene in which nothing moves and no ray meets anything, and so the least that it may be.
  std::optional<ExpectedBricks> expected = {};
};

/// Memory of a body at rest in so many bricks: opened, while a picture shows all of them, and while
/// a state of it is written, by itself or referring to its volume. Bricks that move take more
/// (docs/economy.md).
struct BodyBytes {
  std::int64_t opened, shown, saved, saved_referring;
};
BodyBytes body_bytes(std::int64_t bricks);

ScenePlan plan_scene(const Scene& scene, const PlanSubject& subject, const UnitCosts& costs);

/// The plan of a scene that a run has opened, with the costs of the user's calibration. Throws
/// InputError where that is damaged.
ScenePlan plan_of(const Scene& scene, const SceneRun& run);

/// Seconds that the steps of a scene take in the session of its volume, which has taken none of
/// them. Throws as plan_of().
double planned_solve_s(const Scene& scene, const Session& session);

}  // namespace supple::tools
