// The one stage that runs a scene, whether a file or the options of a command describe it.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lib/session/session.h"
#include "lib/state/pose.h"
#include "raycast/render.h"
#include "volumes/base/progress.h"

namespace supple::tools {

class FilmView;
class OutputPlan;
class PendingFiles;
class ScenePoses;
struct Scene;

/// A scene file, for programs that run it as it is. Throws InputError: unknown key (line and
/// suggestion), wrong type or value, missing key.
std::shared_ptr<const Scene> open_scene(const std::string& path);

/// The files of check_scene(), in the order in which they are made.
std::vector<std::string> planned_files(const Scene& scene, const std::string& folder,
                                       bool may_overwrite);

/// The files that the scene would write, relative to `folder` (empty: as written), and all that can
/// be known to fail before a volume is read. Missing folders are no error where the scene is a
/// file. Throws UsageError or InputError.
OutputPlan check_scene(const Scene& scene, const std::string& folder, bool may_overwrite);

/// Stage in which displacements of elements are extended into the air around them.
constexpr const char* kDisplacementStage = "displacement";

/// Checks that the steps and paths fit the volume. Throws InputError.
void check_places(const Scene& scene, const Geometry& geometry);

/// True if an output reads where what is seen came from; displacements say where it went.
bool reads_inverse(const Scene& scene);

/// Tells whether a brick of offsets is wanted after a step, where its views see a part of the
/// volume and nothing else reads offsets; null: all are.
std::function<bool(const Vec3i& origin)> seen_bricks(const Scene& scene, int step,
                                                     const Geometry& geometry);

/// True if there is a body to build: something moves, or is written, or a material makes one.
bool needs_body(const Scene& scene);

/// Returns the options by which the body of a scene is opened.
SessionOptions session_options(const Scene& scene);

class SceneRun {
 public:
  /// Opens the subject of the scene: a body where something moves, else a state or a volume alone.
  /// `tells_reactions`: the records hold the forces on handles. Refers to the scene.
  SceneRun(const Scene& scene, const std::string& folder, bool tells_reactions, Progress& progress);
  ~SceneRun();

  /// Throws InputError, with the place in the scene, where a handle or a fixed voxel is no element.
  void check_steps() const;

  /// Solves and draws everything first, so that a scene that fails leaves nothing behind. Every
  /// frame of a film stands by itself: its files appear when all of them are complete.
  void run();

  /// The subject as it is now; of a volume alone geometry and densities.
  State opened() const;
  /// Seconds that opening it took.
  double open_s() const { return m_open_s; }
  /// The body; null where nothing moves.
  const Session* session() const;
  /// Certificate of the last inversion; null where there was none.
  const InversionCertificate* certificate() const;
  /// Report of all pictures.
  const RenderReport& drawn() const { return m_drawn; }

 private:
  int last_step() const;
  std::string path_of(const std::string& name) const;
  /// Solves step n at a frame's time.
  void solve(std::size_t n, double time = kWholePaths);
  void draw_views(int step);
  void make_folders() const;
  void write_outputs(int last, int frame);
  void run_film();
  int pose_frame(int frame);
  int motion_frame(int frame);
  bool shows_motion() const;
  void find_neighbours(int frame);
  void make_frame(int frame, std::vector<std::unique_ptr<FilmView>>& views);
  void make_videos();

  const Scene& m_scene;
  std::string m_folder;
  bool m_tells_reactions;
  Progress& m_progress;
  double m_open_s = 0;
  std::unique_ptr<ScenePoses> m_poses;
  int m_posed_steps = 0;                 // of the session, that a frame of a film has taken
  std::map<int, Displacement> m_beside;  // of frames, for the motion of those beside them
  std::unique_ptr<PendingFiles> m_pictures;
  RenderReport m_drawn;
};

}  // namespace supple::tools
