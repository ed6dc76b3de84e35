#include "tools/scene/live/kept_pictures.h"

#include "tools/scene/live/hand_lead.h"
#include "tools/scene/run/kept_renderer.h"
#include "tools/scene/run/space_marks.h"
#include "volumes/field/cuts/cut_offsets.h"

namespace supple::tools {

namespace {

/// True if the picture reads offsets beside what its rays read.
bool reads_offsets(const SceneView& view) {
  const bool is_marched = !view.slice && view.caster == Caster::supple;
  return !is_marched || !view.marks.empty() || !view.picture.aux.empty() || !view.path.empty();
}

}  // namespace

SinglePicture KeptPictures::draw(const SceneView& view, double amount, RenderReport& report,
                                 Progress& progress) {
  check_view(view);
  if (view.picture.is_series()) {
    throw InputError({view.place, "image", "a series of pictures", "one picture"});
  }
  m_progress.hand_on_to(&progress);
  try {
    const PosedView posed = pose(view, amount);
    const SceneView& seen = posed.view;
    const bool is_marched = !seen.slice && !seen.lattice && seen.caster == Caster::supple;
    if (posed.own || !is_marched) {
      return draw_single(posed.subject, seen, nullptr, &report, progress);
    }
    Renderer& shown = renderer(posed);
    if (m_has_surfaces && !has_surfaces(seen)) shown.set_surfaces({});
    m_has_surfaces = has_surfaces(seen);
    const KeptRenderer kept{shown, m_followed};
    return draw_single(posed.subject, seen, &kept, &report, progress);
  } catch (...) {
    m_followed.forget();
    m_has_surfaces = false;
    forget();
    throw;
  }
}

/// The body as it is now, with what its rays read.
LiveBody& BodyPictures::body_at(const SceneView& view, double amount) {
  const Interpolation interpolation = view.sampling.interpolation;
  const int opened_count = m_body ? m_body->opened_count() : 0;
  if (!m_body) {
    m_body.emplace(m_live.session(), interpolation, progress());
  } else if (m_body->interpolation() != interpolation) {
    m_body->open(interpolation);
  }
  m_body->set_amount(amount);
  HandLead* const lead = m_live.lead();
  m_body->follow(lead != nullptr ? lead->shape() : nullptr);
  if (m_body->opened_count() != opened_count) forget_last();
  return *m_body;
}

PosedView BodyPictures::pose(const SceneView& view, double amount) {
  LiveBody& body = body_at(view, amount);
  const State& state = body.opened();
  const MaterialTable& material = m_live.session().material();
  PosedView posed{
      effective_view(view, state.geometry, state.density.background()),
      {state.geometry, state.density, state.elements, nullptr, nullptr, material.domain_lo,
       material.domain_hi, 0, &state.elements, &body.cuts(), &state.labels},
      {}};
  add_mesh_bodies(m_live.session().meshes(), state.geometry, posed.view);
  if (!view.deformed) {
    body.show_rest();
    if (view.path.empty()) return posed;
    posed.own = std::make_unique<const Pose>(
        send_along(view.path, state.geometry, state.density.bricks(), progress()));
    posed.subject.offsets = &posed.own->offsets;
    return posed;
  }
  posed.subject.displacement = &body.displacement();
  if (!view.inverse) {
    if (has_open_cut(body.displacement(), {state.elements, body.cuts()})) {
      throw InputError({view.place, "inverse", "cuts that have opened", "a body without"});
    }
    body.show_forward();
    return posed;
  }
  body.show_inverse(view.half_offsets ? OffsetResolution::half : OffsetResolution::full);
  if (reads_offsets(posed.view)) posed.subject.offsets = &body.inverse();
  if (view.path.empty()) return posed;
  posed.own = std::make_unique<const Pose>(
      send_along(view.path, {body.displacement(), body.inverse()}, progress()));
  posed.subject.offsets = &posed.own->offsets;
  posed.subject.displacement = &posed.own->displacement;
  return posed;
}

PosedView VolumePictures::pose(const SceneView& view, double) {
  const auto shows_air = [&](const SceneView& shown) {
    return !shown.slice && (shown.lattice || m_poses->state().geometry.dims().z == 1);
  };
  // A view without inverse is refused as it is opened.
  if (!m_poses || !view.inverse || shows_air(view) != shows_air(m_scene.views.front())) {
    forget_last();
    forget();
    m_scene.views = {view};
    m_poses.emplace(m_scene, progress());
  }
  return m_poses->drawn_after(0, view);
}

Renderer& VolumePictures::renderer(const PosedView& posed) {
  const SceneView& view = posed.view;
  if (m_renderer && m_shown.sampling.interpolation != view.sampling.interpolation) {
    forget_last();
    m_renderer.reset();
  }
  const bool is_shown =
      m_shown.deformed == view.deformed && m_shown.half_offsets == view.half_offsets;
  if (!m_renderer) {
    m_renderer = make_renderer(posed.subject, view);
  } else if (!is_shown) {
    supple::tools::pose(*m_renderer, posed.subject, view);
  }
  m_shown = view;
  return *m_renderer;
}

void VolumePictures::forget() {
  m_renderer.reset();
  m_poses.reset();
}

}  // namespace supple::tools
