#include "tools/scene/operation/operated_volume.h"

#include <vector>

#include "lib/session/session.h"
#include "raycast/render.h"
#include "tools/scene/file/scene.h"
#include "tools/scene/pictures/picture_writer.h"
#include "tools/scene/run/frames.h"
#include "tools/scene/run/scene_files.h"
#include "tools/scene/run/scene_poses.h"
#include "tools/scene/run/scene_run.h"
#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// The instruments where they are, as surfaces of a view.
void add_instruments(const Operation& operation, const std::vector<ToolTrack>& tracks,
                     std::vector<MeshChoice>& meshes) {
  for (std::size_t n = 0; n < operation.instruments().size(); ++n) {
    const Instrument& instrument = operation.instruments()[n];
    const InstrumentPose& pose = operation.sample().instruments[n].pose;
    for (InstrumentMesh& part : meshes_of(instrument)) {
      const ToolFrame frame = jaw_frame(instrument, pose, part.jaw);
      for (Vec3d& vertex : part.mesh.vertices_lps_mm) vertex = frame.place(vertex);
      MeshChoice choice;
      choice.place = instrument.name;
      choice.mesh = std::make_shared<const TriangleMesh>(std::move(part.mesh));
      choice.rgb = tracks[n].rgb;
      meshes.push_back(std::move(choice));
    }
  }
}

}  // namespace

struct OperatedVolume::Impl {
  const OperationScene& scene;
  const Scene& parts;
  std::string folder;
  Progress& progress;
  ScenePoses poses;
  RenderReport drawn;
  std::vector<std::unique_ptr<FilmView>> views;
  std::unique_ptr<Renderer> renderer;  // of draw()
  std::optional<Camera> camera;

  Impl(const OperationScene& given, const std::string& to, Progress& listener)
      : scene(given),
        parts(*given.volume),
        folder(to),
        progress(listener),
        poses(parts, listener) {}

  /// A view of the body as it is now, with the instruments where they are.
  PosedView posed(const Operation& operation, const SceneView& view, int frame);
};

OperatedVolume::OperatedVolume(const OperationScene& scene, const std::string& folder,
                               Progress& progress)
    : m_impl(std::make_unique<Impl>(scene, folder, progress)) {
  if (m_impl->poses.session() == nullptr) {
    throw InputError({scene.file, "material", "none", "a table [material], by which tissue moves"});
  }
  Session& session = *m_impl->poses.session();
  check_places(m_impl->parts, session.geometry());
  for (const Step& step : m_impl->parts.steps) session.step(step, &progress);
}

OperatedVolume::~OperatedVolume() = default;

OperationSetup OperatedVolume::joined_to(OperationSetup setup) {
  Session& session = *m_impl->poses.session();
  setup.volume = OperationVolume{&session.body_to_push(), session.held()};
  if (auto bone = solid_of(session.body())) setup.shapes.push_back({kBone, std::move(*bone)});
  return setup;
}

PosedView OperatedVolume::Impl::posed(const Operation& operation, const SceneView& view,
                                      int frame) {
  PosedView posed = poses.drawn_after(frame, view);
  add_instruments(operation, scene.tracks, posed.view.meshes);
  return posed;
}

Image OperatedVolume::draw(const Operation& operation, const SceneView& view, int frame) {
  Impl& in = *m_impl;
  in.poses.forget();
  PosedView posed = in.posed(operation, view, frame);
  const bool marches = !posed.view.lattice && !posed.view.slice;
  if (marches && !in.renderer) in.renderer = make_renderer(posed.subject, posed.view);
  if (marches) {
    if (!in.camera) in.camera = camera_of(posed.subject, posed.view);
    posed.view.camera.camera = in.camera;
    pose(*in.renderer, posed.subject, posed.view);
  }
  return to_image(tools::draw(posed.subject, in.renderer.get(), posed.view, nullptr, in.progress));
}

void OperatedVolume::draw_frame(const Operation& operation, int frame) {
  Impl& in = *m_impl;
  in.poses.forget();
  PendingFiles pictures;
  for (std::size_t n = 0; n < in.parts.views.size(); ++n) {
    const SceneView& view = in.parts.views[n];
    const PosedView posed = in.posed(operation, view, frame);
    if (n == in.views.size()) {
      in.views.push_back(std::make_unique<FilmView>(posed.subject, posed.view, *in.parts.film,
                                                    &in.drawn, in.progress));
    }
    PictureWriter writer(pictures, path_in(in.folder, view.image), view.picture);
    in.views[n]->draw(posed.subject, posed.view.meshes, {}, frame, writer);
  }
  pictures.commit();
}

void OperatedVolume::make_videos(PendingFiles& files) {
  for (const SceneView& view : m_impl->parts.views) make_video(view, m_impl->folder, files);
}

std::int64_t OperatedVolume::element_count() const {
  return m_impl->poses.session()->body().elements.active_count();
}

}  // namespace supple::tools
