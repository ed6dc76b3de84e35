#include "tools/outputs/frames.h"

#include <nlohmann/json.hpp>

#include "raycast/scene/framing.h"
#include "raycast/scene/stereo.h"
#include "tools/outputs/staging.h"
#include "volumes/field/cuts/cut_offsets.h"

namespace supple::tools {

namespace {

double longest_mm(const VectorBricks& bricks, const Geometry& geometry) {
  const BrickTopology& topology = bricks.topology;
  double longest = 0;
  for (std::size_t b = 0; b < topology.brick_count(); ++b) {
    for_each_active(topology.mask(b), [&](int n) {
      const Vec3d vector(bricks.vectors[b * kBrickVoxels + n]);
      longest = std::max(longest, geometry.world_vector_from_index(vector).length());
    });
  }
  return longest;
}

/// Of a moved subject; o(x) = -u(x + o(x)), so that the longest u is the longest offset, too.
double longest_offset_mm(const PosedVolume& subject) {
  return longest_mm(subject.offsets != nullptr ? subject.offsets->o : subject.displacement->u,
                    subject.geometry);
}

/// A body on its way from rest to where it is.
class Halfway {
 public:
  Halfway(const PosedVolume& subject, double fraction, bool needs_inverse, Console& console)
      : m_displacement(*subject.displacement), m_subject(subject) {
    for (Vec3f& u : m_displacement.u.vectors) u *= float(fraction);
    if (!needs_inverse) return;
    InvertParams params;
    params.material = &subject.elements;
    const LinkCuts none;
    const CutElements body{subject.elements, subject.cuts != nullptr ? *subject.cuts : none};
    m_offsets = invert_cut(m_displacement, body, params, &console);
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

/// Draws the pictures of one view, its sampling bricks built once.
class ViewDrawing {
 public:
  ViewDrawing(const PosedVolume& subject, const SceneView& view, RenderReport* report,
              Console& console)
      : m_subject(subject),
        m_view(view),
        m_options(m_view.picture),
        m_report(report),
        m_console(console) {
    require_subject();
    m_offset_range.hi = m_options.offset_max_mm;
    const bool shows_arrows = view.marks.arrows_mm && !view.slice;
    const bool needs_longest = shows("offset") || shows_arrows;
    if (m_offset_range.hi == 0 && needs_longest) m_offset_range.hi = longest_offset_mm(subject);
    if (shows_arrows) m_view.picture.offset_max_mm = m_offset_range.hi;
    if (!view.lattice && !view.slice) m_renderer = make_renderer(subject, m_view);
    if (view.slice) {
      m_view.slice = effective_slice(*view.slice, subject.geometry, subject.density);
    } else {
      m_camera = framed_camera(subject, m_renderer.get(), m_view, console);
      m_view.fit.clear();
      m_view.zoom = 1;
    }
  }

  void draw_all(PictureWriter& writer) {
    for (int n = 0; n < m_options.frame_count(); ++n) {
      SceneView frame = m_view;
      const Camera camera = m_options.turntable > 0
                                ? turned_about_target(m_camera, double(n) / m_options.turntable)
                                : m_camera;
      if (!m_view.slice) frame.camera.camera = camera;
      double fraction = 1;
      if (m_options.sequence > 0) fraction = double(n) / (m_options.sequence - 1);
      m_is_seen = false;
      const FloatImage picture = draw_at(fraction, frame);
      if (m_renderer && !m_is_seen) {
        m_console.warn(m_view.image + ": nothing is to be seen in the picture" +
                       (m_options.is_series() ? ", number " + std::to_string(n) : ""));
      }
      writer.write({picture, n, describe(frame, n, fraction), m_offset_range,
                    -camera_frame(camera).forward});
    }
    writer.finish();
  }

 private:
  bool shows(const std::string& channel) const {
    const std::vector<std::string>& aux = m_options.aux;
    return std::find(aux.begin(), aux.end(), channel) != aux.end();
  }

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
    require(is_moved || !m_view.marks.arrows_mm || m_view.slice, "arrows", "nothing that has moved",
            "a deformed state or a warp");
    const bool is_flat = m_view.lattice || m_view.slice;
    require(!is_flat || m_options.aux.empty(), "aux", "a lattice or slices to draw",
            "a picture of a volume");
  }

  FloatImage draw_at(double fraction, const SceneView& frame) {
    if (m_options.sequence == 0) return draw_eyes(m_subject, frame);
    if (fraction == 0) return draw_posed(at_rest(m_subject), frame);
    if (fraction == 1) return draw_posed(m_subject, frame);
    const bool needs_inverse = m_view.inverse && !m_view.lattice;
    const Halfway halfway(m_subject, fraction, needs_inverse, m_console);
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
    FloatImage picture = draw(subject, m_renderer.get(), frame, &report, m_console);
    add(report, m_report);
    m_is_seen = m_is_seen || !is_empty(picture);
    if (!frame.slice) decorate(picture, subject, frame);
    return picture;
  }

  std::string describe(const SceneView& frame, int n, double fraction) const {
    nlohmann::ordered_json more = nlohmann::ordered_json::object();
    if (m_options.stereo != StereoMode::none) {
      more["stereo"] = m_options.stereo == StereoMode::anaglyph ? "anaglyph" : "side-by-side";
      more["eye_separation"] = m_options.eye_separation_mm;
    }
    if (m_options.is_series()) more["picture"] = {n, m_options.frame_count()};
    if (m_options.sequence > 0) more["fraction"] = fraction;
    if (shows("offset")) more["offset_max"] = m_offset_range.hi;
    return describe_view(frame, more);
  }

  const PosedVolume& m_subject;
  SceneView m_view;
  const PictureOptions& m_options;
  RenderReport* m_report;
  Console& m_console;
  std::unique_ptr<Renderer> m_renderer;
  Camera m_camera;
  bool m_is_seen = false;  // anything, in the picture that is drawn
  ScalarRange m_offset_range{0, 0};
};

}  // namespace

void draw_view(const PosedVolume& subject, const SceneView& view, PictureWriter& writer,
               RenderReport* report, Console& console) {
  try {
    ViewDrawing(subject, view, report, console).draw_all(writer);
  } catch (const InputError& error) {
    rethrow_at(view.place, error);
  }
}

}  // namespace supple::tools
