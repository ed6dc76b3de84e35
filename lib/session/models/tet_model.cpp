// Finite elements on tetrahedra as the model of a step.
#include <cmath>
#include <filesystem>

#include "lib/fem/voxel/fem_cost.h"
#include "lib/session/fem_limits.h"
#include "lib/session/file/tet_keys.h"
#include "lib/session/models/drags.h"
#include "lib/session/tets/tet_task.h"
#include "volumes/base/json.h"

namespace supple {

namespace {

/// Nodes per tetrahedron in a lattice, for plans.
constexpr double kNodesPerTet = 0.2, kMiddlesPerTet = 1.2;
/// Likewise: of a file, of a voxel's place in the mesh and its way, of exact factors by the 4/3rd
/// power of their unknowns.
constexpr double kFileBytesPerTet = 40, kBytesPerVoxel = 80, kFactorBytes = 130;
/// Linear systems of a step at finite strain.
constexpr double kFiniteSolutions = 30;

/// The settings that the mesh depends on, and the material, as text.
std::string key_of(const TetStep& step, const SessionBody& in) {
  TetStep mesh = step;
  mesh.sheets.clear();
  mesh.element = {};
  mesh.equations = {};
  mesh.outside = {};
  mesh.frees_rims = mesh.clamps = false;
  return json_text(settings_value(mesh)) + in.state.material_toml;
}

/// The mesh of the body, from the step before where it is the same.
const TetBody& mesh_of(const TetStep& step, SessionBody& in, Progress* progress) {
  const std::string key = key_of(step, in);
  const bool is_same = in.tets && in.tets->key == key && in.tets->elements == in.body.elements &&
                       in.tets->cuts == in.body.cuts;
  if (!is_same) {
    in.tets.reset();
    in.tets = std::make_shared<const KeptTets>(
        KeptTets{key, in.body.elements, in.body.cuts,
                 make_tet_body(step, in.body, in.state.density, in.state.labels, progress)});
  }
  return in.tets->body;
}

void run_tets(const ModelTask& task) {
  SessionBody& in = task.in;
  StepRecord& record = task.record;
  record.fem->params = solved_params(*record.fem, true, 0);
  const std::vector<SlotSet> told = task.told();
  const FemTask work{in.held(),   in.cuts(),  in.state.density, in.state.labels, told,
                     task.pieces, task.nodes, nullptr,          in.responses,    {}};
  const TetBody& tets = mesh_of(*record.fem->tets, in, task.progress);
  record.equilibrium = move_by_tets(*record.fem, work, tets, task.handles, task.progress);
  if (record.tells_reactions) record.reactions = task.ledger.name(record.equilibrium.reactions);
  in.contact.lips_before.reset();
  task.start_anew();
}

/// Meshes know no pieces, and cuts between labels alone.
void check_tets(const Step& step, const SessionBody& in) {
  const auto refuse = [&](const char* field, const std::string& found) {
    throw InputError({step.place, field, found + " beside tets", "model = \"fem\""});
  };
  if (!step.retract.empty()) refuse("retract", "an opening");
  if (!in.cuts().empty() && !step.fem->tets->has_labels) {
    refuse("cut", "a body with cuts and labels = false");
  }
  if (!in.body.rigid.empty()) refuse("rigid", "a body with rigid pieces");
}

/// About so many, by the settings or by the size of the mesh's file.
double count_tets(const TetStep& tets, const Body& body) {
  if (!tets.mesh.empty()) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(tets.mesh, failed);
    return failed ? tets.solid.elements : double(bytes) / kFileBytesPerTet;
  }
  if (!tets.solid.spacing_mm) return tets.solid.elements;
  SolidParams single;
  single.elements = 1;
  const double mm3 = double(body.elements.active_count()) * std::abs(body.geometry.determinant());
  return std::pow(spacing_for(single, mm3) / *tets.solid.spacing_mm, 3);
}

ModelCost cost_of_tets(const Step& step, const Body& body) {
  const FemStep& fem = *step.fem;
  const TetStep& tets = *fem.tets;
  const double count = count_tets(tets, body);
  const bool is_quadratic = tets.element == TetElement::quadratic;
  const bool is_linear = tets.element == TetElement::linear;
  const double unknowns = 3 * count * (kNodesPerTet + (is_quadratic ? kMiddlesPerTet : 0));
  ModelCost cost{{unknowns, "unknowns"}, {200, "iterations"}};
  cost.bytes =
      unknowns * (is_linear ? 800 : 2800) + kBytesPerVoxel * double(body.elements.active_count());
  cost.units = unknowns * cost.passes.count * (is_linear ? 0.5 : 3);
  if (tets.equations == TetEquations::factor) {  // fronts grow faster than the mesh
    cost.bytes += kFactorBytes * std::pow(unknowns, 4.0 / 3);
  }
  if (fem.params.strain == StrainTheory::finite) cost.units *= kFiniteSolutions;
  cost.unit = kFemUnknownCost;
  return cost;
}

}  // namespace

StepModel tet_model() {
  StepModel model;
  model.name = "tets";
  model.title = "finite elements on tetrahedra";
  model.menu = "Tetrahedra, after a drag";
  model.waits_for_hands = true;
  model.moves = [](const Step& step) { return step.fem && step.fem->tets; };
  model.choose = [](Step& step) { step.fem = make_tet_step(); };
  model.fields = [](Step& step) { return tet_fields(*step.fem); };
  model.read = [](Table& table, const LabelNames& names, Step& step) {
    step.fem = read_tets(table, names);
  };
  model.settings = fem_settings;
  model.cost = cost_of_tets;
  model.check = check_tets;
  model.run = run_tets;
  return model;
}

}  // namespace supple
