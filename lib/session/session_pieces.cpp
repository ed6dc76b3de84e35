// The part of a session that deals with rigid pieces, cuts and removed elements.
#include <algorithm>

#include "lib/material/material_file.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/removal.h"
#include "lib/session/session.h"
#include "lib/session/session_walk.h"
#include "volumes/base/text.h"
#include "volumes/base/value.h"

namespace supple {

std::vector<Region> Session::regions_of(const Step& request) const {
  std::vector<Region> regions;
  for (const Drag& drag : request.drags) regions.push_back(region_of(drag));
  return regions;
}

std::vector<Handle> Session::handles_of(const Step& request, const std::vector<PieceMotion>& pieces,
                                        double part) const {
  const bool has_edges = std::any_of(request.drags.begin(), request.drags.end(),
                                     [](const Drag& drag) { return drag.soft_mm > 0; });
  const bool is_pushed = !request.springs && !request.fem && request.limits != Limits::ball;
  const std::vector<Region> regions = regions_of(request);
  const bool goes_on = m_walk && !m_walk->earlier.empty();
  SlotSet taken;
  if (has_edges || !request.retract.empty()) {
    taken = m_walk ? m_walk->taken : anchored_elements(m_body, m_anchors, m_holds);
  }
  const HandleSurroundings around = {m_body,
                                     m_state.density,
                                     cuts(),
                                     taken,
                                     is_pushed ? HandleKind::push : HandleKind::two_sided,
                                     pieces.empty() ? nullptr : &pieces,
                                     part,
                                     goes_on ? &m_walk->start : nullptr,
                                     goes_on ? &m_walk->earlier : nullptr};
  std::vector<Handle> handles = supple::handles_of(request.drags, regions, around);
  if (request.retract.empty()) return handles;
  for (const Handle& handle : handles) taken.add(elements_of(m_body, handle.region, "grab"));
  for (const RigidPiece& piece : m_body.rigid.list) taken.add(*piece.elements);
  for (Retraction retraction : request.retract) {
    retraction.by_mm *= part;
    for (Handle& lip : supple::handles_of(retraction, m_body, taken)) {
      if (!is_pushed) lip.kind = HandleKind::two_sided;
      taken.add(elements_of(m_body, lip.region, "grab"));
      handles.push_back(std::move(lip));
    }
  }
  return handles;
}

namespace {

bool holds_density(const BrickTopology& elements, const DensityGrid& density,
                   const NumberPair& range) {
  for (std::size_t b = 0; b < elements.brick_count(); ++b) {
    bool is_found = false;
    for_each_active(elements.mask(b), [&](int offset) {
      const double value = density.at(elements.origin(b) + brick_local(offset));
      is_found = is_found || (value >= range.first && value <= range.second);
    });
    if (is_found) return true;
  }
  return false;
}

}  // namespace

/// Takes over pieces; then m_state.cuts are the cuts without the links that pieces hide.
void Session::take_pieces_of_state(const std::string& path, Progress* progress) {
  m_body.rigid = pieces_of(m_state.piece_records, m_state.pieces, m_body.elements, path);
  if (!m_body.rigid.empty()) m_body.cuts = cuts_with_pieces(m_body, m_state.cuts);
  if (m_body.rigid.empty() && m_material.rigid &&
      holds_density(m_body.elements, m_state.density, *m_material.rigid)) {
    RigidRequest request;
    request.density = m_material.rigid;
    m_state.cuts = m_body.cuts;
    make_pieces(m_body, m_state.cuts, request, m_state.density, m_state.labels, progress);
  }
  m_state.pieces.clear();
  m_state.piece_records.clear();
}

/// Rigid pieces stay what they are.
void Session::change_material(const MaterialTable& material, Progress* progress) {
  if (material.fits_domain) {
    throw InputError({"", "domain", "none", "the densities that the curves span, [LO, HI]"});
  }
  m_material = material;
  m_material.finds_foreground = false;
  m_material.active_lo = m_body.material.active_lo;
  m_material.active_hi = m_body.material.active_hi;
  m_material.components = m_body.material.components;
  for (const std::string& line : m_material.warnings()) warn(progress, "material: " + line);
  Body changed =
      make_body(m_state.geometry, m_state.density, m_state.elements, m_material, m_state.labels);
  m_body.material = m_material;
  m_body.classes = std::move(changed.classes);
  m_body.slacks = std::move(changed.slacks);
  m_state.material_toml = material_to_toml(m_material);
  m_links = check_links(m_body);
  m_body.links_known_valid = !m_body.beyond && m_links.violated == 0;
  m_ecm = std::make_unique<VoxelEcmModel>(held());
}

/// Material, cuts, removals and new pieces come before anything that moves.
void Session::prepare_body(StepRecord& record, Progress* progress) {
  const bool is_another = record.material || !record.cuts.empty() || !record.remove.empty();
  if (is_another || !record.rigid.empty()) m_equilibrium.reset();
  if (record.material) change_material(*record.material, progress);
  cut_body(record, progress);
  if (!record.remove.empty()) remove_parts(record, progress);
  if (!record.rigid.empty()) {
    if (m_body.rigid.empty()) m_state.cuts = m_body.cuts;
    record.cut_links +=
        make_pieces(m_body, m_state.cuts, record.rigid, m_state.density, m_state.labels, progress);
    find_anchors();
  }
  m_links.fold_free = m_links.fold_free && m_body.cuts.empty();
}

void Session::cut_body(StepRecord& record, Progress* progress) {
  if (record.cuts.empty()) return;
  if (m_body.rigid.empty()) {
    record.cut_links = apply_cuts(m_body, m_state.labels, record.cuts, progress);
    return;
  }
  const std::vector<std::int64_t> inside = cut_links_inside(m_body, m_state.cuts);
  std::swap(m_body.cuts, m_state.cuts);
  try {
    record.cut_links = apply_cuts(m_body, m_state.labels, record.cuts, progress);
  } catch (...) {
    std::swap(m_body.cuts, m_state.cuts);
    throw;
  }
  std::swap(m_body.cuts, m_state.cuts);
  part_pieces(m_body, m_state.cuts, inside);
  m_body.cuts = cuts_with_pieces(m_body, m_state.cuts);
  find_anchors();
}

void Session::remove_parts(StepRecord& record, Progress* progress) {
  stage(progress, "removing elements");
  RemovedElements removed;
  for (const ChosenPart& part : record.remove) {
    removed.add(elements_of(part, m_body, m_state.density, m_state.labels, "remove"),
                part.selection ? &*part.selection : nullptr, m_body);
  }
  const State whole = state();
  const BrickTopology from = whole.elements;
  m_state = without_elements(whole, removed);
  m_state.configuration = whole.configuration;
  record.removed = std::int64_t(removed.slots.size());
  for (auto selection = m_state.anchor_selections.begin();
       selection != m_state.anchor_selections.end();) {
    const bool is_lost = [&] {
      try {
        const Region region =
            supple::region_of(selection_of(*selection, "state"), m_body, m_state.density, "fix");
        return moved_to(from, m_state.elements, elements_of(m_body, region, "fix")).empty();
      } catch (const InputError&) {
        return true;
      }
    }();
    selection = is_lost ? m_state.anchor_selections.erase(selection) : selection + 1;
  }
  m_holds = moved_to(from, m_state.elements, m_holds);
  m_ledger.move_to(from, m_state.elements);
  const bool known_valid = m_body.links_known_valid;
  RigidPieces pieces = m_body.rigid;
  for (RigidPiece& piece : pieces.list) {
    piece.elements = std::make_shared<SlotSet>(moved_to(from, m_state.elements, *piece.elements));
  }
  m_body = make_body(m_state, m_material);
  m_body.rigid = numbered(std::move(pieces.list), m_body.elements);
  if (!m_body.rigid.empty()) m_body.cuts = cuts_with_pieces(m_body, m_state.cuts);
  m_body.links_known_valid = known_valid;
  m_state.pieces.clear();
  m_state.piece_records.clear();
  m_links = check_links(m_body);
  find_anchors();
  m_ecm = std::make_unique<VoxelEcmModel>(held());
}

void Session::find_anchors() {
  m_anchors.assign(m_state.anchors.begin(), m_state.anchors.end());
  for (const std::int32_t label : m_state.anchor_labels) {
    m_anchors.push_back(region_of_label(label, "fix"));
  }
  for (const Value& selection : m_state.anchor_selections) {
    m_anchors.push_back(
        supple::region_of(selection_of(selection, "state"), m_body, m_state.density, "fix"));
  }
  fix_whole_pieces();
}

/// A piece that an anchor touches stays as a whole.
void Session::fix_whole_pieces() {
  if (m_body.rigid.empty() || m_anchors.empty()) return;
  SlotSet fixed;
  for (const Region& region : m_anchors) fixed.add(elements_of(m_body, region, "fix"));
  for (const RigidPiece& piece : m_body.rigid.list) {
    Slot slot;
    if (!piece.elements->first_common(fixed, slot)) continue;
    m_anchors.push_back(supple::region_of(*piece.elements, m_body.elements, "rigid " + piece.name));
  }
}

HeldBody Session::held_with_pieces(std::vector<Region>& anchors) {
  if (m_body.rigid.empty()) return held();
  anchors = m_anchors;
  for (const RigidPiece& piece : m_body.rigid.list) {
    anchors.push_back(supple::region_of(*piece.elements, m_body.elements, "rigid " + piece.name));
  }
  return {m_body, anchors, m_holds};
}

void Session::check_model_of_pieces(const Step& request) const {
  if (!request.retract.empty() && (request.springs || request.limits == Limits::ball)) {
    throw InputError({request.retract.front().place, "retract",
                      request.springs ? "beside springs" : "beside limits = \"ball\"",
                      "a step of ECM with box limits, or of finite elements"});
  }
  if (m_body.rigid.empty()) return;
  if (request.limits != Limits::box) {
    throw InputError({"", "limits", request.limits == Limits::ball ? "ball" : "tighten",
                      "box, in a body with rigid pieces"});
  }
  if (!request.springs) return;
  for (const Region& region : regions_of(request)) {
    elements_of(m_body, region, "grab").for_each([&](Slot slot) {
      if (m_body.rigid.at(slot) < 0) return;
      throw InputError({"", "grab " + region.name(),
                        "voxel " + voxel_text(voxel_of(m_body.elements, slot)) +
                            " of a rigid piece, which springs hold",
                        "tissue; pieces move in steps without springs"});
    });
  }
}

}  // namespace supple
