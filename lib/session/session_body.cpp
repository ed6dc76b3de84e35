// Handles and anchors of a step, found in the body of a session.
#include "lib/session/session_body.h"

#include <algorithm>

#include "lib/relax/relaxation.h"
#include "lib/session/handles/drag_handles.h"
#include "lib/session/retraction.h"
#include "lib/session/step_model.h"
#include "lib/session/tet_step.h"
#include "volumes/base/error.h"
#include "volumes/grid/labels.h"

namespace supple {

void SessionBody::start_anew() {
  links = check_links(body);
  body.links_known_valid = !body.beyond && links.violated == 0;
  find_anchors();
  ecm = std::make_unique<VoxelEcmModel>(held());
}

Region SessionBody::region_of_label(std::int32_t label, const std::string& role) const {
  require_label(state.labels, label, role);
  return Region::of_mask(
      std::make_shared<BrickTopology>(label_mask(state.elements, state.labels, label)),
      "label:" + std::to_string(label));
}

Region SessionBody::region_of(const Drag& drag) const {
  Region region = drag.region;
  if (drag.selection) {
    region = supple::region_of(*drag.selection, body, state.density, "grab");
  } else if (drag.label != 0) {
    region = region_of_label(drag.label, "grab");
  }
  return drag.spares_fixed && !anchors.empty() ? without_fixed(region) : region;
}

Region SessionBody::without_fixed(const Region& region) const {
  SlotSet free = elements_of(body, region, "grab");
  const SlotSet fixed = fixed_elements();
  Slot slot;
  if (!free.first_common(fixed, slot)) return region;
  free.remove(fixed);
  if (free.empty()) {
    throw InputError({"", "grab " + region.name(), "fixed elements alone",
                      "elements that no anchor holds; an anchor that is released lets go of them"});
  }
  return supple::region_of(free, body.elements, region.name());
}

std::vector<Region> SessionBody::regions_of(const Step& request) const {
  std::vector<Region> regions;
  for (const Drag& drag : request.drags) regions.push_back(region_of(drag));
  return regions;
}

std::vector<Handle> SessionBody::handles_of(const Step& request,
                                            const std::vector<PieceMotion>& pieces,
                                            double part) const {
  const bool has_edges = std::any_of(request.drags.begin(), request.drags.end(),
                                     [](const Drag& drag) { return drag.soft_mm > 0; });
  const bool is_pushed = model_of(request).knows_pushes && request.limits != Limits::ball;
  const std::vector<Region> regions = regions_of(request);
  const bool goes_on = walk && !walk->earlier.empty();
  SlotSet taken;
  if (has_edges || !request.retract.empty()) {
    taken = walk ? walk->taken : anchored_elements(body, anchors, holds);
  }
  const HandleSurroundings around = {body,
                                     state.density,
                                     cuts(),
                                     taken,
                                     is_pushed ? HandleKind::push : HandleKind::two_sided,
                                     pieces.empty() ? nullptr : &pieces,
                                     part,
                                     goes_on ? &walk->start : nullptr,
                                     goes_on ? &walk->earlier : nullptr};
  std::vector<Handle> handles = supple::handles_of(request.drags, regions, around);
  if (request.retract.empty()) return handles;
  for (const Handle& handle : handles) taken.add(elements_of(body, handle.region, "grab"));
  for (const RigidPiece& piece : body.rigid.list) taken.add(*piece.elements);
  for (Retraction retraction : request.retract) {
    retraction.by_mm *= part;
    for (Handle& lip : supple::handles_of(retraction, body, taken)) {
      if (!is_pushed) lip.kind = HandleKind::two_sided;
      taken.add(elements_of(body, lip.region, "grab"));
      handles.push_back(std::move(lip));
    }
  }
  return handles;
}

std::vector<PieceMotion> SessionBody::motions_of(const Step& request) const {
  const bool goes_on = walk && !walk->earlier.empty();
  const Body& start = goes_on ? walk->start : body;
  std::vector<PieceMotion> pieces = motions_of_pieces(start, request.drags, regions_of(request));
  if (!goes_on) return pieces;
  for (PieceMotion& piece : pieces) piece = continued(piece, start, body);
  return pieces;
}

void SessionBody::check_elements(const Step& request) const {
  const auto waits = [&](const Selection& selection) {  // for pieces that a step makes
    return selection.rigid_at && body.rigid.empty();
  };
  for (const Drag& drag : request.drags) {
    if (drag.selection && waits(*drag.selection)) continue;
    const Region region = region_of(drag);
    require_element(region, "grab", body, state, source);
    elements_of(body, region, "grab");
  }
  for (const ChosenPart& part : request.fix) {
    if (const IndexBox* box = part.box()) {
      require_element(*box, "fix", body, state, source);
      elements_of(body, *box, "fix");
    } else if (part.label != 0) {
      require_label(state.labels, part.label, "fix");
    } else if (!waits(*part.selection)) {
      supple::region_of(*part.selection, body, state.density, "fix");
    }
  }
}

void SessionBody::check_parts(const Step& request) const {
  const auto require_part = [&](const ChosenPart& part, const char* key) {
    const bool waits = part.selection && part.selection->rigid_at && body.rigid.empty();
    if (waits) return;
    elements_of(part, body, state.density, state.labels, key);
  };
  for (const ChosenPart& part : request.remove) require_part(part, "remove");
  if (!request.fem) return;
  for (const FemLoad& load : request.fem->loads) require_part(load.part, name_of(load.kind));
  if (!request.fem->tets) return;
  for (const TetOpening& opening : request.fem->tets->openings) {
    if (opening.part) require_part(*opening.part, "openings");
  }
}

void SessionBody::release_and_fix(const Step& request) {
  if (request.release) {
    state.anchors.clear();
    state.anchor_labels.clear();
    state.anchor_selections.clear();
    holds = {};
    ledger.release();
    forget_shifts();
  }
  const auto add = [](auto& list, const auto& item) {
    if (std::find(list.begin(), list.end(), item) == list.end()) list.push_back(item);
  };
  for (const ChosenPart& part : request.fix) {
    if (const IndexBox* box = part.box()) {
      add(state.anchors, *box);
    } else if (part.label != 0) {
      require_label(state.labels, part.label, "fix");
      add(state.anchor_labels, part.label);
    } else {
      add(state.anchor_selections, selection_value(*part.selection));
    }
  }
  if (request.release || !request.fix.empty()) find_anchors();
}

void SessionBody::find_anchors() {
  anchors.assign(state.anchors.begin(), state.anchors.end());
  for (const std::int32_t label : state.anchor_labels) {
    anchors.push_back(region_of_label(label, "fix"));
  }
  for (const Value& selection : state.anchor_selections) {
    anchors.push_back(
        supple::region_of(selection_of(selection, "state"), body, state.density, "fix"));
  }
  if (body.rigid.empty() || anchors.empty()) return;
  const SlotSet fixed = fixed_elements();
  for (const RigidPiece& piece : body.rigid.list) {
    Slot slot;
    if (!piece.elements->first_common(fixed, slot)) continue;
    anchors.push_back(supple::region_of(*piece.elements, body.elements, "rigid " + piece.name));
  }
}

HeldBody SessionBody::held_with_pieces(std::vector<Region>& fixed) {
  if (body.rigid.empty()) return held();
  fixed = anchors;
  for (const RigidPiece& piece : body.rigid.list) {
    fixed.push_back(supple::region_of(*piece.elements, body.elements, "rigid " + piece.name));
  }
  return {body, fixed, holds};
}

SlotSet SessionBody::fixed_elements() const {
  SlotSet fixed;
  for (const Region& region : anchors) fixed.add(elements_of(body, region, "fix"));
  return fixed;
}

bool SessionBody::has_shifted_pieces() const {
  const std::vector<RigidPiece>& pieces = body.rigid.list;
  return std::any_of(pieces.begin(), pieces.end(),
                     [](const RigidPiece& piece) { return piece.shifted_from.has_value(); });
}

void SessionBody::forget_shifts() {
  for (RigidPiece& piece : body.rigid.list) piece.shifted_from.reset();
}

std::vector<FreePose> SessionBody::free_pieces(const std::vector<Handle>& handles) const {
  SlotSet held = anchored_elements(body, anchors, holds);
  for (const Handle& handle : handles) held.add(elements_of(body, handle.region, "grab"));
  std::vector<FreePose> poses;
  for (std::size_t n = 0; n < body.rigid.list.size(); ++n) {
    const RigidPiece& piece = body.rigid.list[n];
    Slot slot;
    if (!piece.elements->first_common(held, slot)) poses.push_back({n, piece.pose});
  }
  return poses;
}

}  // namespace supple
