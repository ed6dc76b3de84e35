// The body of a session with all that is held in it, on which the parts of a session work.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lib/contact/piece_contact.h"
#include "lib/model/voxel_ecm_model.h"
#include "lib/session/free_poses.h"
#include "lib/session/handle_ledger.h"
#include "lib/session/handles/handle_places.h"
#include "lib/session/handles/rigid_drag.h"
#include "lib/session/step.h"

namespace supple {

class CutLips;
struct FemResponses;  // lib/session/kept_voxels.h
struct KeptTets;      // lib/session/tets/tet_body.h
struct LipsBefore;

/// Shapes of pieces and lips, kept from step to step.
struct ContactShapes {
  PieceContact bones;                             // that have come near each other
  std::shared_ptr<CutLips> lips;                  // as steps found them last; null: no cut yet
  std::shared_ptr<const LipsBefore> lips_before;  // of a hand that leads a bone
};

/// Data that is kept while the drags of a step go from pose to pose.
struct StepWalk {
  Body start;                 // that the poses start from
  SlotSet taken;              // by anchors and earlier steps, then
  HandleLedger ledger;        // then
  std::vector<Drag> earlier;  // as of the pose before; empty at the first one
};

struct SessionBody {
  State state;           // its cuts are those of the body without the links that rigid pieces hide
  DensitySource source;  // of a volume
  MaterialTable material;
  Body body;
  std::unique_ptr<VoxelEcmModel> ecm;  // of the body
  LinkCheck links;
  std::vector<Region> anchors;  // the boxes, labels and selections that the state has fixed
  Holds holds;                  // elements that earlier steps dragged
  HandleLedger ledger;          // the handles that did
  ContactShapes contact;
  /// Displacements of the last finite elements for a picture, while their solid is the same.
  std::shared_ptr<const NodeStart> equilibrium;
  std::shared_ptr<const FemResponses> responses;  // of finite elements; null: none yet
  std::shared_ptr<const KeptTets> tets;           // the last mesh of tetrahedra
  RelaxParams relaxed_by;  // of the relaxation that the body rests under, if any
  std::optional<StepWalk> walk;

  /// Finds links, anchors and solver of a body that is new, or whose material is.
  void start_anew();
  HeldBody held() { return {body, anchors, holds}; }
  /// Rigid pieces stand in `fixed` beside the anchors.
  HeldBody held_with_pieces(std::vector<Region>& fixed);
  /// Links that are cut, without those that rigid pieces hide in body.cuts.
  const LinkCuts& cuts() const { return body.rigid.empty() ? body.cuts : state.cuts; }

  Region region_of(const Drag& drag) const;
  std::vector<Region> regions_of(const Step& step) const;
  /// Throws InputError for handles and anchors that are no elements.
  void check_elements(const Step& step) const;
  /// Throws InputError for a part that the step removes or loads, where there is no such part.
  void check_parts(const Step& step) const;
  void release_and_fix(const Step& step);
  /// Finds the anchors of the state; a piece that one of them touches stays as a whole.
  void find_anchors();
  SlotSet fixed_elements() const;

  /// The motions of pieces that the step grabs.
  std::vector<PieceMotion> motions_of(const Step& step) const;
  /// `part`: of all motions, where rigid pieces turn.
  std::vector<Handle> handles_of(const Step& step, const std::vector<PieceMotion>& pieces,
                                 double part) const;
  /// Pieces that nothing holds, where they are.
  std::vector<FreePose> free_pieces(const std::vector<Handle>& handles) const;
  bool has_shifted_pieces() const;
  void forget_shifts();

 private:
  Region without_fixed(const Region& region) const;
  Region region_of_label(std::int32_t label, const std::string& role) const;
};

}  // namespace supple
