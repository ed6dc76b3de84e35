#include "tools/scene/run/frames.h"

#include "raycast/motion.h"
#include "raycast/scene/camera.h"
#include "raycast/scene/framing.h"
#include "raycast/scene/stereo.h"
#include "tools/scene/run/kept_renderer.h"
#include "tools/scene/run/overlay_paint.h"
#include "tools/scene/run/staging.h"
#include "tools/scene/run/view_record.h"
#include "volumes/base/value.h"
#include "volumes/field/cuts/cut_offsets.h"

namespace supple::tools {

namespace {

double longest_mm(const VectorBricks& bricks, const Geometry& geometry) {
  const BrickTopology& topology = bricks.topology;
  double longest = 0;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    const Vec3f* const vectors = bricks.vectors.brick(b);
    if (vectors == nullptr) continue;
    for_each_active(topology.mask(b), [&](int n) {
      const Vec3d vector(vectors[n]);
      longest = std::max(longest, geometry.world_vector_from_index(vector).length());
    });
  }
  return longest;
}

/// Longest offset of a moved subject: o(x) = -u(x + o(x)), so it is as long as the longest u.
double longest_offset_mm(const PosedVolume& subject) {
  return longest_mm(subject.offsets != nullptr ? subject.offsets->o : subject.displacement->u,
                    subject.geometry);
}

/// A body on its way from rest to where it is.
class Halfway {
 public:
  Halfway(const PosedVolume& subject, double fraction, bool needs_inverse, Progress& progress)
      : m_displacement(*subject.displacement), m_subject(subject) {
    for_each_stored(m_displacement.u.vectors, [&](Vec3f& u) { u *= float(fraction); });
    if (!needs_inverse) return;
    InvertParams params;
    params.material = &subject.elements;
    const LinkCuts none;
    const CutElements body{subject.elements, subject.cuts != nullptr ? *subject.cuts : none};
    m_offsets = invert_cut(m_displacement, body, params, &progress);
  }
  PosedVolume subject() const {
    PosedVolume halfway = m_subject;
    halfway.offsets = m_offsets ? &*m_offsets : nullptr;
    halfway.displacement = &m_displacement;
    return halfway;
  }

 private:
  Displacement m_displacement;
  std::optional<OffsetField> m_offsets;
  const PosedVolume& m_subject;
};

PosedVolume at_rest(const PosedVolume& subject) {
  PosedVolume resting = subject;
  resting.offsets = nullptr;
  resting.displacement = nullptr;
  return resting;
}

bool is_empty(const FloatImage& picture) {
  for (std::size_t n = 3; n < picture.rgba.size(); n += 4) {
    if (picture.rgba[n] > 0) return false;
  }
  return true;
}

void add(const RenderReport& more, RenderReport* sum) {
  if (sum == nullptr) return;
  sum->samples += more.samples;
  sum->rays += more.rays;
  sum->prepare_ms += more.prepare_ms;
  sum->march_ms += more.march_ms;
  sum->bytes = std::max(sum->bytes, more.bytes);
}

/// Numbers of meshes come after those of labels.
constexpr int kFirstMeshId = 65536;

/// Returns for each pixel the label of the tissue that is seen, or the number of the mesh.
std::vector<float> ids_of(const FloatImage& picture, const std::vector<Vec3d>& rest_places,
                          const PosedVolume& subject) {
  std::vector<float> ids(picture.pixel_count(), 0.0f);
  for (std::size_t n = 0; n < ids.size(); ++n) {
    if (picture.surface[n] >= 0) {
      ids[n] = float(kFirstMeshId + picture.surface[n]);
    } else if (is_finite(rest_places[n]) && subject.labels != nullptr) {
      const Vec3i voxel = floor_voxel(rest_places[n] + Vec3d(0.5));
      const std::int32_t brick = subject.elements.find(voxel);
      if (brick < 0) continue;
      ids[n] = float(subject.labels->at(std::size_t(brick) * kBrickVoxels + brick_offset(voxel)));
    }
  }
  return ids;
}

/// The keys of a view's camera, framed as the first frame shows the subject.
CameraPath camera_path_of(const PosedVolume& subject, const Renderer* renderer, SceneView view,
                          Progress& progress) {
  CameraPath path;
  const std::vector<CameraKey> keys = std::exchange(view.camera_keys, {});
  const bool has_heights =
      std::any_of(keys.begin(), keys.end(), [](const CameraKey& key) { return key.height; });
  for (const CameraKey& key : keys) {
    if (key.choice) {
      view.camera = *key.choice;
      const Camera camera = framed_camera(subject, renderer, view, progress);
      path.add_place(key.time, camera, key.easing);
      if (!has_heights) path.add_height(key.time, camera.height_mm, key.easing);
    }
    if (key.fov) path.add_fov(key.time, *key.fov, key.easing);
    if (key.height) path.add_height(key.time, *key.height, key.easing);
    if (key.turn_deg) path.add_turn(key.time, *key.turn_deg, key.easing);
    if (key.zoom) path.add_zoom(key.time, *key.zoom, key.easing);
  }
  return path;
}

}  // namespace

/// Draws the pictures of one view, its sampling bricks built once.
class ViewDrawing {
 public:
  ViewDrawing(const PosedVolume& subject, const SceneView& view, const Film* film,
              RenderReport* report, Progress& progress, const KeptRenderer* kept = nullptr)
      : m_subject(subject),
        m_view(view),
        m_film(film != nullptr ? *film : Film()),
        m_options(m_view.picture),
        m_report(report),
        m_progress(progress) {
    require_subject();
    m_offset_range.hi = m_options.offset_max_mm;
    const bool shows_arrows = view.marks.arrows_mm && !view.slice;
    const bool needs_longest = shows("offset") || shows_arrows;
    if (m_offset_range.hi == 0 && needs_longest) m_offset_range.hi = longest_offset_mm(subject);
    if (shows_arrows) m_view.picture.offset_max_mm = m_offset_range.hi;
    TissueMarks& marks = view.slice ? m_view.slice->marks : m_view.marks;
    const bool colours_motion = marks.shows_displacement() && !marks.overlay_range;
    marks = with_overlay_range(marks, colours_motion ? longest_offset_mm(subject) : 0);
    const bool marches = !view.lattice && !view.slice && view.caster == Caster::supple;
    if (marches && kept != nullptr) {
      m_marched_by = &kept->renderer;
      m_followed = &kept->followed;
      if (has_surfaces(m_view)) pose_surfaces(kept->renderer, subject, m_view);
    } else if (marches) {
      m_renderer = make_renderer(subject, m_view);
      m_marched_by = m_renderer.get();
    }
    if (view.slice) {
      m_view.slice = effective_slice(*m_view.slice, subject.geometry, subject.density);
    } else {
      SceneView framing = m_view;
      framing.zoom = 1;
      const bool turns = std::any_of(view.camera_keys.begin(), view.camera_keys.end(),
                                     [](const CameraKey& key) { return key.turn_deg; });
      if (turns) framing.picture.turntable = 1;  // in sight all the way round
      m_camera = framed_camera(subject, m_marched_by, framing, progress);
      m_path = camera_path_of(subject, m_marched_by, framing, progress);
      m_view.fit.clear();
      m_view.zoom = 1;
      m_zoom = view.zoom;
    }
  }

  void draw_all(PictureWriter& writer) {
    for (int n = 0; n < m_options.frame_count(); ++n) {
      const double fraction = m_options.fraction_at(n);
      FloatImage picture = draw_at(fraction, frame_view(n));
      const Displacement* moved = m_subject.displacement;
      add_channels(picture, m_subject, {moved, moved}, n);
      write_picture(picture, n, fraction, writer);
    }
    writer.finish();
  }

  SinglePicture draw_single() {
    FloatImage picture = draw_eyes(m_subject, frame_view(0));
    warn_of_nothing(0);
    return {std::move(picture), describe(frame_view(0), 0, 1)};
  }

  void draw_frame(const PosedVolume& subject, const std::vector<MeshChoice>& meshes,
                  const NeighbourFrames& beside, int n, PictureWriter& writer) {
    m_view.meshes = meshes;
    FloatImage picture = draw_posed(subject, frame_view(n));
    add_channels(picture, subject, beside, n);
    write_picture(picture, n, 1, writer);
    writer.finish();
  }

 private:
  Camera camera_at(int n) const {
    if (m_options.turntable > 0) {
      return zoomed(turned_about_target(m_camera, double(n) / m_options.turntable), m_zoom);
    }
    if (m_options.film == 0) return zoomed(m_camera, m_zoom);
    return zoomed(m_path.at(m_camera, m_film.time_of(n)), m_zoom);
  }

  /// The view of one picture, of which nothing has been seen so far.
  SceneView frame_view(int n) {
    SceneView frame = m_view;
    if (!m_view.slice) frame.camera.camera = camera_at(n);
    m_is_seen = false;
    return frame;
  }

  void warn_of_nothing(int n) {
    if (m_marched_by == nullptr || m_is_seen) return;
    m_progress.warn(m_view.image + ": nothing is to be seen in the picture" +
                    (m_options.is_series() ? ", number " + std::to_string(n) : ""));
  }

  void write_picture(const FloatImage& picture, int n, double fraction, PictureWriter& writer) {
    warn_of_nothing(n);
    const Camera camera = camera_at(n);
    const bool is_view = !m_view.slice && m_options.stereo == StereoMode::none;
    writer.write({picture, n, describe(frame_view(n), n, fraction), m_offset_range,
                  -camera_frame(camera).forward,
                  is_view ? camera_matrices(camera, picture.width, picture.height)
                          : std::vector<RowMatrix>()});
  }

  /// Motion to the frames beside this one, and numbers of what is seen.
  void add_channels(FloatImage& picture, const PosedVolume& subject, const NeighbourFrames& beside,
                    int n) const {
    if (!shows("motion") && !shows("id")) return;
    const Geometry& geometry = subject.geometry;
    const Camera camera = camera_at(n);
    const std::vector<Vec3d> places = rest_places(picture, camera, geometry, subject.offsets);
    const auto deforms = [&](int mesh) { return m_view.meshes[std::size_t(mesh)].deform; };
    const auto motion_to = [&](int other, const Displacement* displacement) {
      return screen_motion(picture, places, geometry, {camera, subject.displacement},
                           {camera_at(other), displacement}, deforms);
    };
    if (shows("motion")) {
      picture.forward_px = motion_to(n + 1, beside.after);
      picture.backward_px = motion_to(n - 1, beside.before);
    }
    if (shows("id")) picture.id = ids_of(picture, places, subject);
  }

  bool shows(const std::string& channel) const { return m_options.shows(channel); }

  void require_subject() const {
    const auto require = [&](bool good, const char* field, const char* found,
                             const char* expected) {
      if (!good) throw InputError({m_view.place, field, found, expected});
    };
    require(m_subject.displacement != nullptr || m_options.sequence == 0, "sequence",
            "nothing that is deformed", "a deformed state");
    require(m_view.path.empty() || m_options.sequence == 0, "sequence",
            "sampling paths, whose pieces may come apart", "a deformed state alone");
    const bool is_moved = m_subject.offsets != nullptr || m_subject.displacement != nullptr;
    require(is_moved || !shows("offset"), "aux", "no offsets to show",
            "a deformed state, or a volume through a warp");
    const bool has_motion = shows("motion");
    require(!has_motion || m_view.path.empty(), "aux", "motion along sampling paths",
            "a body without");
    const bool solves = m_subject.displacement != nullptr && m_subject.offsets == nullptr;
    require(!(has_motion || shows("id")) || !solves, "aux", "motion or id without an inverse",
            "inverse = true");
    check_ids(m_view, m_subject.labels != nullptr && !m_subject.labels->empty());
    require(is_moved || !m_view.marks.arrows_mm || m_view.slice, "arrows", "nothing that has moved",
            "a deformed state or a warp");
    const TissueMarks& marks = m_view.slice ? m_view.slice->marks : m_view.marks;
    const bool shows_motion = marks.shows_displacement() || marks.shows_det_f();
    require(is_moved || !shows_motion, "overlay", "nothing that has moved",
            "a deformed state or a warp");
    require(!m_view.outline || m_subject.outlined != nullptr, "outline", "a volume, not a body",
            "a deformed state");
    const bool is_flat = m_view.lattice || m_view.slice;
    require(!is_flat || m_options.aux.empty(), "aux", "a lattice or slices to draw",
            "a picture of a volume");
  }

  FloatImage draw_at(double fraction, const SceneView& frame) {
    if (m_options.sequence == 0) return draw_eyes(m_subject, frame);
    if (fraction == 0) return draw_posed(at_rest(m_subject), frame);
    if (fraction == 1) return draw_posed(m_subject, frame);
    const bool needs_inverse = m_view.inverse && !m_view.lattice;
    const Halfway halfway(m_subject, fraction, needs_inverse, m_progress);
    return draw_posed(halfway.subject(), frame);
  }

  FloatImage draw_posed(const PosedVolume& subject, const SceneView& frame) {
    if (m_renderer) pose(*m_renderer, subject, m_view);
    return draw_eyes(subject, frame);
  }

  FloatImage draw_eyes(const PosedVolume& subject, SceneView frame) {
    if (m_options.stereo == StereoMode::none) return draw_one(subject, frame);
    const StereoCameras eyes = stereo_cameras(*frame.camera.camera, m_options.eye_separation_mm);
    frame.camera.camera = eyes.left;
    const FloatImage left = draw_one(subject, frame);
    frame.camera.camera = eyes.right;
    const FloatImage right = draw_one(subject, frame);
    return m_options.stereo == StereoMode::anaglyph ? anaglyph(left, right)
                                                    : side_by_side(left, right);
  }

  FloatImage draw_one(const PosedVolume& subject, const SceneView& frame) {
    RenderReport report;
    FloatImage picture =
        draw_following(subject, m_marched_by, frame, m_followed, &report, m_progress);
    add(report, m_report);
    m_is_seen = m_is_seen || !is_empty(picture);
    if (!frame.slice) decorate(picture, subject, frame);
    return picture;
  }

  std::string describe(const SceneView& frame, int n, double fraction) const {
    Value more = Value::Entries();
    if (m_options.stereo != StereoMode::none) {
      more["stereo"] = m_options.stereo == StereoMode::anaglyph ? "anaglyph" : "side-by-side";
      more["eye_separation"] = m_options.eye_separation_mm;
    }
    if (m_options.is_series()) more["picture"] = {n, m_options.frame_count()};
    if (m_options.sequence > 0) more["fraction"] = fraction;
    if (shows("offset")) more["offset_max"] = m_offset_range.hi;
    return describe_view(frame, more);
  }

  const PosedVolume m_subject;
  SceneView m_view;
  const Film m_film;
  const PictureOptions& m_options;
  RenderReport* m_report;
  Progress& m_progress;
  std::unique_ptr<Renderer> m_renderer;    // null: a kept one, or none
  const Renderer* m_marched_by = nullptr;  // null: of slices and lattices
  FollowedPictures* m_followed = nullptr;
  Camera m_camera;
  CameraPath m_path;
  double m_zoom = 1;
  bool m_is_seen = false;  // anything, in the picture that is drawn
  ScalarRange m_offset_range{0, 0};
};

FilmView::FilmView(const PosedVolume& first, const SceneView& view, const Film& film,
                   RenderReport* report, Progress& progress)
    : m_place(view.place) {
  try {
    m_drawing = std::make_unique<ViewDrawing>(first, view, &film, report, progress);
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

FilmView::~FilmView() = default;

void FilmView::draw(const PosedVolume& subject, const std::vector<MeshChoice>& meshes,
                    const NeighbourFrames& beside, int frame, PictureWriter& writer) {
  try {
    m_drawing->draw_frame(subject, meshes, beside, frame, writer);
  } catch (const InputError& error) {
    rethrow_at(m_place, error);
  }
}

void draw_view(const PosedVolume& subject, const SceneView& view, PictureWriter& writer,
               RenderReport* report, Progress& progress) {
  try {
    ViewDrawing(subject, view, nullptr, report, progress).draw_all(writer);
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

SinglePicture draw_single(const PosedVolume& subject, const SceneView& view,
                          const KeptRenderer* kept, RenderReport* report, Progress& progress) {
  try {
    return ViewDrawing(subject, view, nullptr, report, progress, kept).draw_single();
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

}  // namespace supple::tools
