// Finite elements on tetrahedra as the model of a step.
#include <cmath>

#include "lib/fem/voxel/fem_cost.h"
#include "lib/session/file/tet_keys.h"
#include "lib/session/models/drags.h"
#include "lib/session/tets/tet_task.h"
#include "volumes/base/json.h"

namespace supple {

namespace {

/// Nodes per tetrahedron in a lattice, for plans.
constexpr double kNodesPerTet = 0.2, kMiddlesPerTet = 1.2;

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
  const bool is_same = in.tets && in.tets->key == key && in.tets->elements == in.body.elements;
  if (!is_same) {
    in.tets.reset();
    in.tets = std::make_shared<const KeptTets>(
        KeptTets{key, in.body.elements,
                 make_tet_body(step, in.body, in.state.density, in.state.labels, progress)});
  }
  return in.tets->body;
}

void run_tets(const ModelTask& task) {
  SessionBody& in = task.in;
  StepRecord& record = task.record;
  const std::vector<SlotSet> told = task.told();
  const FemTask work{in.held(),       in.cuts(), in.state.density,
                     in.state.labels, told,      task.pieces,
                     task.nodes,      nullptr,   {}};
  const TetBody& tets = mesh_of(*record.fem->tets, in, task.progress);
  record.equilibrium = move_by_tets(*record.fem, work, tets, task.handles, task.progress);
  if (record.tells_reactions) record.reactions = task.ledger.name(record.equilibrium.reactions);
  in.contact.lips_before.reset();
  task.start_anew();
}

/// Meshes know neither cuts nor pieces.
void check_tets(const Step& step, const SessionBody& in) {
  const auto refuse = [&](const char* field, const std::string& found) {
    throw InputError({step.place, field, found + " beside tets", "model = \"fem\""});
  };
  if (!step.retract.empty()) refuse("retract", "an opening");
  if (!in.cuts().empty()) refuse("cut", "a body with cuts");
  if (!in.body.rigid.empty()) refuse("rigid", "a body with rigid pieces");
}

ModelCost cost_of_tets(const Step& step, const Body& body) {
  const TetStep& tets = *step.fem->tets;
  double count = tets.solid.elements;
  if (tets.solid.spacing_mm) {
    const double mm3 = double(body.elements.active_count()) * std::abs(body.geometry.determinant());
    SolidParams single;
    single.elements = 1;
    count = std::pow(spacing_for(single, mm3) / *tets.solid.spacing_mm, 3);
  }
  const bool is_quadratic = tets.element == TetElement::quadratic;
  const double unknowns = 3 * count * (kNodesPerTet + (is_quadratic ? kMiddlesPerTet : 0));
  ModelCost cost{{unknowns, "unknowns"}, {200, "iterations"}};
  const double per_unknown = tets.element == TetElement::linear ? 800 : 2800;
  const double per_element = 80;  // of the body: its place in the mesh, and where it goes
  cost.bytes = unknowns * per_unknown + per_element * double(body.elements.active_count());
  cost.units = unknowns * cost.passes.count * (tets.element == TetElement::linear ? 0.5 : 3);
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
  model.choose = [](Step& step) { step.fem.emplace().tets = std::make_shared<TetStep>(); };
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
