// Keys of a step of finite elements.
#include "lib/model/fem_model.h"
#include "lib/model/refined_shape.h"
#include "lib/session/fem/fem_modes.h"
#include "lib/session/fem/motion_step.h"
#include "lib/session/fem_limits.h"
#include "lib/session/fem_step.h"
#include "lib/session/handles/drag.h"
#include "lib/session/kept_voxels.h"
#include "lib/session/tet_step.h"
#include "volumes/base/value.h"

namespace supple {

const char* name_of(LoadKind kind) {
  static constexpr const char* kNames[] = {"force", "pressure", "swelling"};
  return kNames[int(kind)];
}

std::optional<Problem> contradiction(const FemStep& step) {
  if (step.tets) return contradiction(*step.tets, step.params.strain);
  const bool is_finite = step.params.strain == StrainTheory::finite;
  if (step.motion && is_finite) return Problem{"", "strain", "finite beside a motion", "linear"};
  const char* const beside = step.modes ? "modes" : step.motion ? "a motion" : nullptr;
  if (step.halvings > 0 && beside != nullptr) {
    return Problem{"", "refine", std::string("smaller elements beside ") + beside, "0"};
  }
  if (step.params.solver != EquationSolver::multigrid && beside != nullptr) {
    return Problem{"", "solver", std::string("another program beside ") + beside, "multigrid"};
  }
  const char* const beside_large = beside != nullptr   ? beside
                                   : is_finite         ? "finite strain"
                                   : step.halvings > 0 ? "smaller ones"
                                                       : nullptr;
  if (step.params.doublings > 0 && beside_large != nullptr) {
    return Problem{"", "coarsen", std::string("larger elements beside ") + beside_large, "0"};
  }
  const std::string no_sum = beside != nullptr ? beside : why_no_sum(step.params);
  if (!step.directions.empty() && !no_sum.empty()) {
    return Problem{"", "directions", "directions beside " + no_sum, "linear equilibria of voxels"};
  }
  if (step.params.error_mm && (beside_large != nullptr || !step.params.can_end_by_error()) &&
      step.halvings == 0) {
    return Problem{"", "error_mm",
                   "an error beside finite strain, a motion, modes, coarsen or another program",
                   "tolerance"};
  }
  return std::nullopt;
}

namespace {

/// True where places and reactions alone are asked for, and not to a tolerance.
bool ends_by_error(const FemStep& step) {
  const FemParams& params = step.params;
  if (params.error_mm || params.tolerance) return params.error_mm.has_value();
  return params.can_end_by_error() && params.accuracy == FemAccuracy::voxel && !step.tets &&
         !step.modes && !step.motion && !step.keeps_nodes && step.wanted.empty();
}

}  // namespace

FemParams solved_params(const FemStep& step, bool has_labels, double shortest_edge_mm) {
  constexpr double kVoxelPart = 0.05;
  FemParams params = step.params;
  if (params.error_mm) return params;
  if (ends_by_error(step) && !has_labels) {
    params.error_mm = kVoxelPart * shortest_edge_mm;
  } else {
    params.tolerance = params.residual_limit();
    params.reaction_tolerance = params.reaction_limit();
  }
  return params;
}

void settle_reactions(FemStep& step) {
  constexpr double kSettled = 1e-3;
  if (ends_by_error(step) && !step.params.reaction_tolerance) {
    step.params.reaction_tolerance = kSettled;
  }
}

Field accuracy_field(FemStep& step) {
  return Field("accuracy", step.params.accuracy, {"voxel", "exact", "picture"},
               "Finite elements to 1/20 voxel, exact, or rough");
}

Fields option_fields(FemStep& step) {
  FemParams& params = step.params;
  return {accuracy_field(step),
          Field("strain", params.strain, {"linear", "finite"},
                "Finite elements of small turns, or of any"),
          Field("integration", params.elements.dilatation, {"mean", "full"},
                "Strain of volume: mean, or full integration"),
          Field("touching", params.elements.touching, {"apart", "joined"},
                "Voxels that touch by an edge or corner alone")};
}

Fields fields(FemStep& step) {
  FemParams& params = step.params;
  const Fields own = {
      Field("refine", step.halvings,
            "Elements of half a voxel's edge, 1, of a quarter, 2, an eighth, 3")
          .range(0, kMostHalvings),
      Field("coarsen", params.doublings, "Elements of 2 voxels' edge, 1, of 4, 2, of 8, 3")
          .range(0, kMostDoublings),
      Field("beyond_limits", step.links_beyond, {"project", "keep"},
            "Links that are left beyond their limits: later drags project them, or keep them"),
      Field("max_rotation", params.max_rotation_deg, "Larger turns of an element are warned of")
          .unit("degrees")
          .shown_as("DEG")
          .positive()
          .recorded_as("max_rotation_deg"),
      Field("max_strain", params.max_strain, "Larger strains are warned of").positive(),
      Field("gravity", step.gravity_m_s2, "Acceleration in LPS")
          .unit("m/s²")
          .recorded_as("gravity_m_s2"),
      Field("rigid_stiffness", step.rigid_young_kpa, "Young's modulus of rigid pieces")
          .unit("kPa")
          .shown_as("KPA")
          .positive()
          .otherwise("10000 times that of the stiffest tissue, at most 18600000")
          .recorded_as("rigid_stiffness_kpa"),
      Field("rigid_poisson", step.rigid_poisson, "Poisson's ratio of rigid pieces")
          .range(0, kLargestPoisson),
  };
  Fields all = option_fields(step);
  for (const Fields& of_scenes : {solver_fields(params), own}) {
    for (Field field : of_scenes) all.push_back(field.only_in_scenes());
  }
  return all;
}

FemStep make_tet_step() {
  FemStep step;
  step.tets = std::make_shared<TetStep>();
  step.params.accuracy = FemAccuracy::exact;
  step.params.max_iterations = 5000;  // of incomplete factors, which take more of them
  return step;
}

Fields tet_fields(FemStep& step) {
  Fields all = fields(*step.tets);
  all.push_back(Field("tolerance", step.params.tolerance,
                      "Largest force left on a node, of the largest there is")
                    .positive()
                    .otherwise("1e-06"));
  all.push_back(Field("reaction_tolerance", step.params.reaction_tolerance,
                      "Largest change of the reactions in the last iteration, relative")
                    .positive()
                    .otherwise("1e-05"));
  for (const Field& field : fields(step)) {
    for (const char* name :
         {"strain", "max_iterations", "loose", "max_rotation", "max_strain", "gravity"}) {
      if (field.name() == name) all.push_back(field);
    }
  }
  for (Field& field : all) field.only_in_scenes();
  return all;
}

Fields load_fields(FemLoad& load) {
  if (load.kind == LoadKind::force) {
    return {
        Field("force_n", load.force_n, "In all, in N along LPS; elements share it by their volume")
            .unit("N")
            .required()};
  }
  Fields fields = {Field("pressure_kpa", load.pressure_kpa,
                         load.kind == LoadKind::pressure
                             ? "On faces without a neighbour, inwards where positive"
                             : "Inside elements, outwards where positive")
                       .unit("kPa")
                       .required()};
  if (load.kind == LoadKind::pressure) {
    fields.push_back(Field("facing", load.facing,
                           "Faces whose normal is within 60 degrees of this direction in LPS")
                         .otherwise("all faces"));
  }
  return fields;
}

Value settings_value(const FemStep& step) {
  FemStep copy = step;
  auto value = fields_value(copy.tets ? tet_fields(copy) : fields(copy));
  // Limits that are recorded say what other accuracies stand for.
  if (copy.params.accuracy != FemAccuracy::picture) value.erase("accuracy");
  if (copy.params.elements.dilatation == Dilatation::mean) value.erase("integration");
  if (copy.params.elements.touching == Touching::apart) value.erase("touching");
  if (copy.links_beyond == LinksBeyond::project) value.erase("beyond_limits");
  if (copy.motion) {
    value["motion"] = fields_value(fields(*copy.motion));
    for (const Vec3i& voxel : copy.motion->watch) value["motion"]["watch"].push_back(voxel);
  }
  if (copy.hand_levels > 0) value["hand_levels"] = copy.hand_levels;
  for (const HandDirection& direction : copy.directions) {
    value["directions"].push_back(direction.value());
  }
  if (copy.modes) value["modes"] = fields_value(fields(*copy.modes));
  if (copy.tets) value.update(settings_value(*copy.tets));
  for (FemLoad& load : copy.loads) {
    auto entry = chosen_value(load.part);
    entry.update(fields_value(load_fields(load)));
    value[std::string(name_of(load.kind)) + "s"].push_back(std::move(entry));
  }
  return value;
}

DragPose HandDirection::pose(const Geometry& geometry) const {
  if (turn_deg == 0) return {way, {}};
  HandleMotion turn;
  turn.axis_lps = geometry.world_vector_from_index(way / geometry.spacing_mm());
  turn.angle_deg = turn_deg;
  return {Vec3d(0), turn};
}

Value HandDirection::value() const {
  Value row = Value::List{way.x, way.y, way.z};
  if (turn_deg != 0) row.push_back(turn_deg);
  return row;
}

}  // namespace supple
