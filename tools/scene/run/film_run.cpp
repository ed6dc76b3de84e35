// The frames of a film. Each is solved from where the body is before the first step with a path, so
// that it depends on the scene and its own time alone: frames may be made in any order, by several
// processes, and again after an interruption, with the same bytes. What stays from frame to frame
// is that body, one copy of its node state and the sampling bricks of each view.
#include <algorithm>
#include <filesystem>

#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/pictures/video.h"
#include "tools/scene/run/film_record.h"
#include "tools/scene/run/frames.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_poses.h"
#include "tools/scene/run/scene_run.h"

namespace supple::tools {

namespace {

InputError in_frame(int frame, const InputError& error) {
  const Problem& problem = error.problem();
  return InputError({problem.file, problem.field + " in frame " + std::to_string(frame),
                     problem.found, problem.expected});
}

}  // namespace

/// Runs the steps once; their motion has a shape for every frame.
int SceneRun::motion_frame(int frame) {
  for (; m_posed_steps < int(m_scene.steps.size()); ++m_posed_steps) {
    solve(std::size_t(m_posed_steps));
  }
  const int last = m_scene.film->frames - 1;
  m_poses->forget();
  m_poses->session()->show_frame(std::clamp(frame, 0, last));
  return frame;
}

/// The number by which the poses of this frame are kept.
int SceneRun::pose_frame(int frame) {
  m_progress.enter("frame", frame);
  if (m_scene.films_motion()) return motion_frame(frame);
  const std::size_t still = m_scene.still_steps();
  if (still == m_scene.steps.size()) return 0;
  m_poses->forget();
  for (; m_posed_steps > 0; --m_posed_steps) m_poses->session()->undo();
  const double time = m_scene.film->time_of(frame);
  for (std::size_t n = still; n < m_scene.steps.size(); ++n) {
    solve(n, time);
    ++m_posed_steps;
  }
  return frame;
}

bool SceneRun::shows_motion() const {
  return std::any_of(m_scene.views.begin(), m_scene.views.end(),
                     [](const SceneView& view) { return view.picture.shows("motion"); });
}

/// The displacements of the frames before and after one; none of others is kept.
void SceneRun::find_neighbours(int frame) {
  const bool moves = m_scene.films_motion() || m_scene.still_steps() < m_scene.steps.size();
  if (!shows_motion() || !moves) return;
  m_beside.erase(m_beside.begin(), m_beside.lower_bound(frame - 1));
  for (const int other : {frame - 1, frame + 1}) {
    if (m_beside.count(other) != 0) continue;
    pose_frame(other);
    m_beside[other] = extended_displacement_of(m_poses->session()->state());
  }
}

void SceneRun::make_frame(int frame, std::vector<std::unique_ptr<FilmView>>& views) {
  find_neighbours(frame);
  const int pose = pose_frame(frame);
  PendingFiles pictures;
  for (std::size_t n = 0; n < views.size(); ++n) {
    const SceneView& view = m_scene.views[n];
    const PosedView drawn = m_poses->drawn_after(pose, view);
    PictureWriter writer(pictures, path_of(view.image), view.picture);
    const Displacement* same = drawn.subject.displacement;  // where no step moves anything
    NeighbourFrames beside = {same, same};
    if (same != nullptr && m_beside.count(frame - 1) != 0) {
      beside = {&m_beside.at(frame - 1), &m_beside.at(frame + 1)};
    }
    views[n]->draw(drawn.subject, drawn.view.meshes, beside, frame, writer);
  }
  write_outputs(pose, frame);
  pictures.commit();
}

void SceneRun::run_film() {
  const std::size_t still = m_scene.films_motion() ? 0 : m_scene.still_steps();
  for (std::size_t n = 0; n < still; ++n) {
    solve(n);
  }
  // Cameras are framed by the first frame, whichever frames are made.
  std::vector<std::unique_ptr<FilmView>> views;
  const int first = m_scene.film->frames_to_make.empty() ? 0 : pose_frame(0);
  for (const SceneView& view : m_scene.views) {
    if (m_scene.film->frames_to_make.empty()) break;
    const PosedView drawn = m_poses->drawn_after(first, view);
    views.push_back(
        std::make_unique<FilmView>(drawn.subject, drawn.view, *m_scene.film, &m_drawn, m_progress));
  }
  make_folders();
  write_film_record(m_scene, m_folder);
  for (const int frame : m_scene.film->frames_to_make) {
    try {
      make_frame(frame, views);
    } catch (const InputError& error) {
      throw in_frame(frame, error);
    }
  }
  m_progress.tell_repeats();
  make_videos();
}

void SceneRun::make_videos() {
  if (!m_scene.film->makes_videos) return;
  for (const SceneView& view : m_scene.views) {
    PendingFiles files;
    make_video(view, m_folder, files);
    files.commit();
  }
}

void make_video(const SceneView& view, const std::string& folder, PendingFiles& files) {
  const PictureOptions& options = view.picture;
  if (options.video.empty()) return;
  std::unique_ptr<VideoEncoder> encoder;
  const std::string path = path_in(folder, options.video);
  for (int frame = 0; frame < options.film; ++frame) {
    const Image image = read_png(path_in(folder, frame_name(view.image, frame)));
    if (encoder == nullptr) {
      encoder = std::make_unique<VideoEncoder>(files.add(path).path(), path, image.width,
                                               image.height, options.frames_per_second, "");
    }
    encoder->add(image);
  }
  encoder->finish();
}

}  // namespace supple::tools
