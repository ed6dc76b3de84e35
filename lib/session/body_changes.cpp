// Changes of the body of a session: pieces, materials, cuts, removals.
#include "lib/session/body_changes.h"

#include "lib/body/rigid_links.h"
#include "lib/material/material.h"
#include "lib/session/cut_surface.h"
#include "lib/session/removal.h"
#include "lib/session/rigid_request.h"

namespace supple {

State state_of(const SessionBody& in) {
  State state = in.state;
  state.q = in.body.q;
  if (in.body.rigid.empty()) {
    state.cuts = in.body.cuts;
  } else {
    state.pieces = *in.body.rigid.number_of;
    state.piece_records = records_of(in.body.rigid);
  }
  state.rest = in.body.rest;
  state.velocity_mm_s = in.body.velocity_mm_s;
  state.beyond = in.body.beyond;
  return state;
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

/// Rigid pieces stay what they are.
void change_material(SessionBody& in, const MaterialTable& material, Progress* progress) {
  if (material.fits_domain) {
    throw InputError({"", "domain", "none", "the densities that the curves span, [LO, HI]"});
  }
  const MaterialTable before = in.body.material;
  in.material = material;
  in.material.finds_foreground = false;
  in.material.active_lo = before.active_lo;
  in.material.active_hi = before.active_hi;
  in.material.components = before.components;
  for (const std::string& line : in.material.warnings()) warn(progress, "material: " + line);
  Body changed = make_body(in.state.geometry, in.state.density, in.state.elements, in.material,
                           in.state.labels);
  in.body.material = in.material;
  in.body.classes = std::move(changed.classes);
  in.body.slacks = std::move(changed.slacks);
  in.state.material_toml = material_to_toml(in.material);
  in.start_anew();
}

void cut_body(SessionBody& in, StepRecord& record, Progress* progress) {
  if (record.cuts.empty()) return;
  if (in.body.rigid.empty()) {
    record.cut_links = apply_cuts(in.body, in.state.labels, record.cuts, progress);
    return;
  }
  const std::vector<std::int64_t> inside = cut_links_inside(in.body, in.state.cuts);
  std::swap(in.body.cuts, in.state.cuts);
  try {
    record.cut_links = apply_cuts(in.body, in.state.labels, record.cuts, progress);
  } catch (...) {
    std::swap(in.body.cuts, in.state.cuts);
    throw;
  }
  std::swap(in.body.cuts, in.state.cuts);
  part_pieces(in.body, in.state.cuts, inside);
  in.body.cuts = cuts_with_pieces(in.body, in.state.cuts);
  in.find_anchors();
}

void remove_parts(SessionBody& in, StepRecord& record, Progress* progress) {
  stage(progress, "removing elements");
  RemovedElements removed;
  for (const ChosenPart& part : record.remove) {
    removed.add(elements_of(part, in.body, in.state.density, in.state.labels, "remove"),
                part.selection ? &*part.selection : nullptr, in.body);
  }
  const BrickTopology from = in.state.elements;
  in.state = without_elements(state_of(in), removed);
  record.removed = std::int64_t(removed.slots.size());
  for (auto selection = in.state.anchor_selections.begin();
       selection != in.state.anchor_selections.end();) {
    const bool is_lost = [&] {
      try {
        const Region region =
            supple::region_of(selection_of(*selection, "state"), in.body, in.state.density, "fix");
        return moved_to(from, in.state.elements, elements_of(in.body, region, "fix")).empty();
      } catch (const InputError&) {
        return true;
      }
    }();
    selection = is_lost ? in.state.anchor_selections.erase(selection) : selection + 1;
  }
  in.holds = moved_to(from, in.state.elements, in.holds);
  in.ledger.move_to(from, in.state.elements);
  const bool known_valid = in.body.links_known_valid;
  RigidPieces pieces = in.body.rigid;
  for (RigidPiece& piece : pieces.list) {
    piece.elements = std::make_shared<SlotSet>(moved_to(from, in.state.elements, *piece.elements));
  }
  in.body = make_body(in.state, in.material);
  in.body.rigid = numbered(std::move(pieces.list), in.body.elements);
  if (!in.body.rigid.empty()) in.body.cuts = cuts_with_pieces(in.body, in.state.cuts);
  in.state.pieces.clear();
  in.state.piece_records.clear();
  in.start_anew();
  in.body.links_known_valid = known_valid;
}

}  // namespace

void take_pieces_of_state(SessionBody& in, const std::string& path, Progress* progress) {
  in.body.rigid = pieces_of(in.state.piece_records, in.state.pieces, in.body.elements, path);
  if (!in.body.rigid.empty()) in.body.cuts = cuts_with_pieces(in.body, in.state.cuts);
  if (in.body.rigid.empty() && in.material.rigid &&
      holds_density(in.body.elements, in.state.density, *in.material.rigid)) {
    RigidRequest request;
    request.density = in.material.rigid;
    in.state.cuts = in.body.cuts;
    make_pieces(in.body, in.state.cuts, request, in.state.density, in.state.labels, progress);
  }
  in.state.pieces.clear();
  in.state.piece_records.clear();
}

void prepare_body(SessionBody& in, StepRecord& record, Progress* progress) {
  const bool is_another = record.material || !record.cuts.empty() || !record.remove.empty();
  if (is_another || !record.rigid.empty()) in.equilibrium.reset();
  if (record.material) change_material(in, *record.material, progress);
  cut_body(in, record, progress);
  if (!record.remove.empty()) remove_parts(in, record, progress);
  if (!record.rigid.empty()) {
    if (in.body.rigid.empty()) in.state.cuts = in.body.cuts;
    record.cut_links += make_pieces(in.body, in.state.cuts, record.rigid, in.state.density,
                                    in.state.labels, progress);
    in.find_anchors();
  }
  in.links.fold_free = in.links.fold_free && in.body.cuts.empty();
}

}  // namespace supple
