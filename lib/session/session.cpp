#include "lib/session/session.h"

#include <algorithm>
#include <stdexcept>

#include "lib/material/material.h"
#include "lib/relax/relaxation.h"
#include "lib/session/body_changes.h"
#include "lib/session/deformable_mesh.h"
#include "lib/session/handles/handle_places.h"
#include "lib/session/handles/handles.h"
#include "lib/session/journal.h"
#include "lib/session/mesh_step.h"
#include "lib/session/session_opening.h"
#include "lib/session/step_run.h"
#include "lib/session/undo_history.h"
#include "lib/state/state_outputs.h"
#include "volumes/base/relayed_progress.h"
#include "volumes/base/text.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

namespace {

/// Keeps the warnings that it hands on.
class Listener final : public RelayedProgress {
 public:
  Listener(std::vector<std::string>& messages, Progress* next)
      : RelayedProgress(next), m_messages(messages) {}

  void warn(const std::string& line) override {
    m_messages.push_back(line);
    RelayedProgress::warn(line);
  }

 private:
  std::vector<std::string>& m_messages;
};

/// Errors that name no file get the place of the step.
template <class Work>
decltype(auto) placed_at(const Step& step, const Work& work) {
  try {
    return work();
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    if (!problem.file.empty()) throw;
    throw InputError({step.place, problem.field, problem.found, problem.expected});
  }
}

void require_points(const Step& step, const Body& body) {
  const auto require = [&](const auto& placed) {
    if (placed && placed->points) require_in_body(*placed->points, body);
  };
  for (const Drag& drag : step.drags) require(drag.placed);
  for (const ChosenPart& part : step.fix) require(part.placed);
}

}  // namespace

struct Session::Parts {
  SessionBody in;
  std::vector<DeformableMesh> meshes = {};
  std::optional<UndoHistory> history = {};  // where SessionOptions::keeps_undo
  std::vector<StepRecord> records = {};
  std::vector<std::string> messages = {};
  std::optional<Pose> pose = {};

  const StepRecord& take(const Step& step, Progress* heard) {
    Listener listener(messages, heard);
    StepRecord record;
    static_cast<Step&>(record) = step;
    if (history) history->begin(record);
    pose.reset();
    try {
      run_step(in, records, record, &listener);
    } catch (...) {
      in.walk.reset();
      if (history) history->give_up();
      throw;
    }
    in.walk.reset();
    FemNodes handed_over;
    if (!records.empty()) std::swap(handed_over, records.back().equilibrium.nodes);
    if (history) history->keep(std::move(handed_over));
    records.push_back(std::move(record));
    return records.back();
  }

  /// Throws InputError where there is none of that name.
  DeformableMesh& mesh(const std::string& name) {
    std::vector<std::string> names;
    for (DeformableMesh& mesh : meshes) {
      if (mesh.name() == name) return mesh;
      names.push_back(mesh.name());
    }
    const std::string nearest = nearest_name(name, names);
    throw InputError({"", "body", "\"" + name + "\"",
                      names.empty()     ? "a step of the voxels: there is no mesh body"
                      : nearest.empty() ? "a mesh body: " + listed(names)
                                        : "a mesh body; did you mean \"" + nearest + "\"?"});
  }

  const StepRecord& take_of_mesh(const Step& step, double time, Progress* heard) {
    Listener listener(messages, heard);
    DeformableMesh& moved = mesh(step.body);
    MeshRecord result{mesh_move(step, moved, in.state.geometry, time), {}};
    DeformableMesh::Shape before = moved.kept();
    result.report = moved.move(result.move, &listener);
    StepRecord record;
    static_cast<Step&>(record) = step;
    record.mesh = std::make_shared<const MeshRecord>(std::move(result));
    // Nodes of finite elements wait for the next step of the voxels.
    if (!records.empty()) std::swap(record.equilibrium.nodes, records.back().equilibrium.nodes);
    if (history) history->keep(moved.name(), std::move(before));
    records.push_back(std::move(record));
    return records.back();
  }

  /// The last step, where one is that the session can still show otherwise.
  StepRecord* last_shown() { return history || records.empty() ? nullptr : &records.back(); }
};

Session::Session(const std::string& path, const SessionOptions& options, Progress* progress)
    : m_parts(std::make_unique<Parts>()) {
  Listener listener(m_parts->messages, progress);
  open(m_parts->in, path, options, &listener);
  if (options.keeps_undo) m_parts->history.emplace(m_parts->in);
  for (const Value& record : m_parts->in.state.meshes) m_parts->meshes.emplace_back(record, path);
  m_parts->in.state.meshes.clear();
}

void Session::add(const MeshSetup& setup) {
  for (const DeformableMesh& mesh : m_parts->meshes) {
    if (mesh.name() != setup.name) continue;
    throw InputError(
        {setup.place, "name", "\"" + setup.name + "\", as another mesh body", "a name of its own"});
  }
  m_parts->meshes.emplace_back(setup);
}

const std::vector<DeformableMesh>& Session::meshes() const {
  return m_parts->meshes;
}

Session::~Session() = default;

const Geometry& Session::geometry() const {
  return m_parts->in.state.geometry;
}
const Body& Session::body() const {
  return m_parts->in.body;
}
SessionBody& Session::held_body() {
  return m_parts->in;
}

Body& Session::body_to_push() {
  if (m_parts->history) throw std::logic_error("body_to_push() of a session that can undo");
  m_parts->pose.reset();
  return m_parts->in.body;
}
SlotSet Session::held() const {
  SlotSet held = anchored_elements(body(), m_parts->in.anchors, m_parts->in.holds);
  for (const RigidPiece& piece : body().rigid.list) held.add(*piece.elements);
  return held;
}
const MaterialTable& Session::material() const {
  return m_parts->in.material;
}
const LinkCuts& Session::cuts() const {
  return m_parts->in.cuts();
}
const LinkCheck& Session::links() const {
  return m_parts->in.links;
}
const std::vector<StepRecord>& Session::records() const {
  return m_parts->records;
}
const std::vector<std::string>& Session::messages() const {
  return m_parts->messages;
}
bool Session::has_shifted_pieces() const {
  return m_parts->in.has_shifted_pieces();
}

void Session::check(const Step& step) const {
  placed_at(step, [&] {
    if (!step.body.empty()) {
      mesh_move(step, m_parts->mesh(step.body), geometry(), kWholePaths);
      return;
    }
    require_points(step, body());
    const Step placed = on_grid(step, geometry());
    m_parts->in.check_elements(placed);
    if (!step.material) m_parts->in.check_parts(placed);
  });
}

std::vector<HandlePlace> Session::places(const Step& step) const {
  const SessionBody& in = m_parts->in;
  std::vector<HandlePlace> places;
  if (!step.body.empty()) return places;
  for (const Drag& drag : on_grid(step, geometry()).drags) {
    places.push_back(place_of(in.region_of(drag), in.body, in.state));
  }
  return places;
}

const StepRecord& Session::step(const Step& step, Progress* progress, double time) {
  return placed_at(step, [&]() -> const StepRecord& {
    if (!step.body.empty()) return m_parts->take_of_mesh(step, time, progress);
    require_points(step, body());
    return m_parts->take(on_grid(step, geometry(), time), progress);
  });
}

const StepRecord& Session::drag(const Region& grabbed, const Vec3d& by_mm, Progress* progress) {
  Step request;
  request.drags.push_back({grabbed, by_mm});
  return step(request, progress);
}

const StepRecord& Session::fix(const IndexBox& box, Progress* progress) {
  Step request;
  request.fix.push_back(box);
  return step(request, progress);
}

const StepRecord& Session::cut(const CutSurface& surface, Progress* progress) {
  Step request;
  request.cuts.push_back(surface);
  return step(request, progress);
}

const StepRecord& Session::relax(const RelaxParams& params, Progress* progress) {
  Step request;
  request.relax = params;
  return step(request, progress);
}

const StepRecord& Session::release(Progress* progress) {
  Step request;
  request.release = true;
  return step(request, progress);
}

bool Session::undo() {
  if (!m_parts->history)
    throw std::logic_error("undo() of a session without SessionOptions::keeps_undo");
  if (m_parts->history->steps() == 0) return false;
  FemNodes handed_over = m_parts->history->take_back(m_parts->meshes);
  std::vector<StepRecord>& records = m_parts->records;
  if (records.back().mesh) handed_over = std::move(records.back().equilibrium.nodes);
  records.pop_back();
  if (!records.empty()) records.back().equilibrium.nodes = std::move(handed_over);
  m_parts->pose.reset();
  return true;
}

std::size_t Session::undo_steps() const {
  return m_parts->history ? m_parts->history->steps() : 0;
}

std::size_t Session::undo_bytes() const {
  return m_parts->history ? m_parts->history->bytes() : 0;
}

void Session::show_frame(int frame) {
  StepRecord* const last = m_parts->last_shown();
  if (last == nullptr || !last->equilibrium.motion) throw std::logic_error("no motion to show");
  supple::show_frame(std::size_t(frame), last->equilibrium, m_parts->in.body);
  m_parts->pose.reset();
}

void Session::show_mode(int number) {
  StepRecord* const last = m_parts->last_shown();
  if (last == nullptr || !last->equilibrium.modes) throw std::logic_error("no modes to show");
  supple::show_mode(number, last->equilibrium, m_parts->in.body);
  last->fem->modes->shape = number;
  m_parts->pose.reset();
}

std::string Session::journal() const {
  return journal_json(m_parts->in.state.configuration, m_parts->records);
}

State Session::state() const {
  State state = state_of(m_parts->in);
  for (const DeformableMesh& mesh : m_parts->meshes) state.meshes.push_back(mesh.record());
  state.configuration = journal();
  return state;
}

const Pose& Session::pose(Progress* progress) {
  Listener listener(m_parts->messages, progress);
  if (!m_parts->pose) m_parts->pose = invert_state(state(), &listener);
  return *m_parts->pose;
}

void Session::write_state(const std::string& path, Progress* progress) {
  supple::write_state(path, state(), pose(progress).offsets, progress);
}

void Session::write_warp(const std::string& path, Progress* progress) {
  Listener listener(m_parts->messages, progress);
  WarpOutput output;
  output.path = path;
  output.grid = geometry();
  write_state_warp(output, state(), pose(progress), &listener);
}

}  // namespace supple
