#include "tools/scene/operation/live_operation.h"

#include <algorithm>
#include <filesystem>

#include "lib/instruments/track.h"
#include "tools/scene/operation/operation_keys.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

constexpr double kFarthestMm = 1000;  // of a tip from the origin

OperationScene viewed_scene(const Table& root) {
  OperationScene scene = read_operation(root);
  if (scene.volume) {
    throw InputError({scene.file, "volume", "a scanned volume", "none: supple run films those"});
  }
  if (scene.views.empty()) scene.views.emplace_back();
  return scene;
}

/// The place of the incision through which an instrument goes; null where it goes through none.
const Vec3d* incision_of(const OperationSetup& setup, std::size_t instrument) {
  if (!setup.eye) return nullptr;
  for (const Incision& incision : setup.eye->incisions) {
    if (incision.name == setup.tools[instrument].incision) return &incision.place_mm;
  }
  return nullptr;
}

/// Index of a name. Throws InputError that lists the names.
int index_of(const std::string& name, const std::vector<std::string>& names, const char* kind) {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return int(found - names.begin());
  throw InputError({"", "name", "'" + name + "'",
                    names.empty() ? std::string(kind) + " in the scene" : listed(names, "or")});
}

/// Place and magnification of the microscope from a time on.
struct SteppedLook {
  double time_s;
  Vec3d focus_mm;
  double zoom;

  bool is_as(const SteppedLook& other) const {
    return focus_mm == other.focus_mm && zoom == other.zoom;
  }
};

}  // namespace

Fields fields(PoseWish& wish) {
  return {
      Field("tip", wish.tip_mm, "Place of the tip").unit("mm").range(-kFarthestMm, kFarthestMm),
      Field("axis", wish.axis, "Direction from the tip to the hand"),
      Field("roll", wish.roll_degrees, "Turn about the axis").unit("degrees").range(-36000, 36000),
      Field("opening", wish.opening_degrees, "Angle between the jaws").unit("degrees").range(0, 90),
      Field("active", wish.active, "Suction of a vitrector, light of a lamp").range(0, 1),
  };
}

Fields fields(LookWish& wish) {
  return {
      Field("focus", wish.focus_mm, "Place that is in focus")
          .unit("mm")
          .range(-kFarthestMm, kFarthestMm),
      Field("zoom", wish.zoom, "Magnification").range(0.1, 20),
      Field("stereo", wish.stereo, "One picture, or a pair and how it is shown")
          .one_of({"none", "side_by_side", "anaglyph"}),
      Field("shadow", wish.shadow, "Shadow of the lamp").one_of({"none", "hard", "soft"}),
  };
}

struct LiveOperation::Impl {
  Value root;  // of the scene's file, with absolute paths
  OperationScene scene;
  std::optional<Operation> operation;
  std::unique_ptr<OperationRecord> record;
  std::vector<InstrumentPose> asked;         // per instrument
  std::vector<char> led;                     // by a hand
  std::vector<std::vector<TrackKey>> poses;  // per instrument: of all steps
  std::vector<SteppedLook> looks;            // where they change
  int steps = 0, restarts = 0;

  explicit Impl(const Table& given);
  void begin();
  MicroscopeView& view() { return scene.views.front(); }
  SteppedLook look_at(double time_s) const {
    const MicroscopeView& view = scene.views.front();
    return {time_s, view.focus_at(time_s), view.zoom_at(time_s)};
  }
  void keep_look(double time_s);
  Value saved_view() const;
  Value saved_root(const std::vector<std::string>& files) const;
};

LiveOperation::Impl::Impl(const Table& given)
    : scene(viewed_scene(given)), led(scene.tracks.size(), 0) {
  root = given.written();
  begin();
}

void LiveOperation::Impl::begin() {
  operation.emplace(scene.setup);
  record = std::make_unique<OperationRecord>(scene, *operation);
  steps = 0;
  asked.clear();
  poses.assign(scene.tracks.size(), {});
  for (std::size_t n = 0; n < scene.setup.tools.size(); ++n) {
    asked.push_back(scene.setup.tools[n].start);
    poses[n].push_back({0, asked[n]});
  }
  looks = {look_at(0)};
}

/// Looks are kept so that they change smoothly, as those of scenes do, from one step to the next.
void LiveOperation::Impl::keep_look(double time_s) {
  const SteppedLook now = look_at(time_s);
  const SteppedLook last = looks.back();
  if (now.is_as(last)) return;
  const double before_s = (steps - 1) * scene.setup.step_s;
  if (last.time_s < before_s) looks.push_back({before_s, last.focus_mm, last.zoom});
  looks.push_back(now);
}

/// The first view with the looks of the session.
Value LiveOperation::Impl::saved_view() const {
  Value view = root.contains("view") ? root["view"][0] : Value(Value::Entries());
  view.erase("focus");
  Value keys = Value::List();
  for (const SteppedLook& look : looks) {
    keys.push_back({{"time", look.time_s}, {"focus", look.focus_mm}, {"zoom", look.zoom}});
  }
  view["keys"] = keys;
  return view;
}

Value LiveOperation::Impl::saved_root(const std::vector<std::string>& files) const {
  Value saved = root;
  saved["operation"]["duration"] = steps * scene.setup.step_s;
  saved["operation"].erase("repeat");
  for (std::size_t n = 0; n < poses.size(); ++n) {
    Value& instrument = saved["instrument"][n];
    for (const char* key : {"way", "hand"}) instrument.erase(key);
    instrument["track"] = std::filesystem::path(files[n + 1]).filename().string();
  }
  for (std::size_t n = 0; n < operation->setup().membranes.size(); ++n) {
    Value changes = Value::List();
    for (ModelChange change : operation->setup().membranes[n].changes) {
      changes.push_back(fields_value(fields(change)));
    }
    if (!changes.items().empty()) saved["body"][n]["models"] = changes;
  }
  if (!saved.contains("view")) saved["view"] = Value::List{Value()};
  saved["view"][0] = saved_view();
  return saved;
}

LiveOperation::LiveOperation(const Table& root) : m_impl(std::make_unique<Impl>(root)) {}
LiveOperation::~LiveOperation() = default;

int LiveOperation::find(const std::string& instrument) const {
  std::vector<std::string> names;
  for (const OperationTool& tool : m_impl->scene.setup.tools) names.push_back(tool.shape.name);
  return index_of(instrument, names, "an instrument");
}

int LiveOperation::find_membrane(const std::string& name) const {
  std::vector<std::string> names;
  for (const OperationMembrane& one : m_impl->scene.setup.membranes) names.push_back(one.name);
  return index_of(name, names, "a membrane");
}

void LiveOperation::ask(int instrument, const PoseWish& wish) {
  Impl& in = *m_impl;
  const std::size_t n = std::size_t(instrument);
  InstrumentPose pose = in.asked[n];
  if (wish.tip_mm) pose.tip_mm = *wish.tip_mm;
  if (wish.roll_degrees) pose.roll_degrees = *wish.roll_degrees;
  if (wish.opening_degrees) pose.opening_degrees = *wish.opening_degrees;
  if (wish.active) pose.active = *wish.active;
  if (wish.axis) {
    if (!(wish.axis->length() > 1e-9)) {
      throw InputError({"", "axis", "a direction without length", "a direction"});
    }
    pose.axis = wish.axis->normalized();
  } else if (const Vec3d* place_mm = incision_of(in.scene.setup, n)) {
    pose = through_pivot(pose, *place_mm);
  }
  // A pose as its track will give it again.
  in.asked[n] = InstrumentTrack({{0, pose}}).at(0);
  in.led[n] = 1;
}

void LiveOperation::let_go(int instrument) {
  m_impl->led[std::size_t(instrument)] = 0;
}

bool LiveOperation::is_led(int instrument) const {
  return m_impl->led[std::size_t(instrument)] != 0;
}

const InstrumentPose& LiveOperation::asked(int instrument) const {
  return m_impl->asked[std::size_t(instrument)];
}

void LiveOperation::look(const LookWish& wish) {
  MicroscopeView& view = m_impl->view();
  Fields keys = fields(view);
  const auto choose = [&](const char* name, const std::string& word) {
    for (const Field& field : keys) {
      if (word.empty() || field.name() != name) continue;
      const auto& names = field.names();
      const auto found = std::find(names.begin(), names.end(), word);
      std::get<Field::Names>(field.target()).set(int(found - names.begin()));
    }
  };
  choose("stereo", wish.stereo);
  choose("shadow", wish.shadow);
  if (wish.focus_mm) {
    view.focus_keys = {};
    view.focus_mm = *wish.focus_mm;
  }
  if (wish.zoom) {
    view.zoom_keys = {};
    view.zoom_keys.add(0, *wish.zoom, Easing::smooth);
  }
}

void LiveOperation::take_model(int membrane, MembraneModel model) {
  if (model != this->model(membrane)) m_impl->operation->take_model(std::size_t(membrane), model);
}

MembraneModel LiveOperation::model(int membrane) const {
  const Impl& in = *m_impl;
  const OperationMembrane& one = in.operation->setup().membranes[std::size_t(membrane)];
  const double next_s = (in.steps + 1.5) * in.scene.setup.step_s;
  ModelChange last{0, one.params.model};
  for (const ModelChange& change : one.changes) {
    if (change.time_s < next_s && change.time_s >= last.time_s) last = change;
  }
  return last.model;
}

const OperationSample& LiveOperation::step() {
  Impl& in = *m_impl;
  ++in.steps;
  const double time_s = in.steps * in.scene.setup.step_s;
  const std::vector<InstrumentPose> tracks = in.scene.poses_at(time_s);
  for (std::size_t n = 0; n < in.asked.size(); ++n) {
    if (!in.led[n]) in.asked[n] = tracks[n];
    in.poses[n].push_back({time_s, in.asked[n]});
  }
  in.keep_look(time_s);
  const OperationSample& sample = in.operation->step(in.asked);
  in.record->take(*in.operation, in.asked);
  return sample;
}

void LiveOperation::restart() {
  m_impl->begin();
  ++m_impl->restarts;
}

std::vector<std::string> LiveOperation::files(const std::string& path) const {
  std::vector<std::string> files = {path};
  const std::filesystem::path scene(path);
  for (const OperationTool& tool : m_impl->scene.setup.tools) {
    const std::string name = scene.stem().string() + "_" + tool.shape.name + ".csv";
    files.push_back((scene.parent_path() / name).string());
  }
  return files;
}

void LiveOperation::save(const std::string& path) const {
  const std::vector<std::string> names = files(path);
  for (std::size_t n = 0; n < m_impl->poses.size(); ++n) {
    write_track(InstrumentTrack(m_impl->poses[n]), names[n + 1]);
  }
  replace_text_file(path, toml_document(m_impl->saved_root(names)));
}

const OperationScene& LiveOperation::scene() const {
  return m_impl->scene;
}
const Operation& LiveOperation::operation() const {
  return *m_impl->operation;
}
const OperationRecord& LiveOperation::record() const {
  return *m_impl->record;
}
const MicroscopeView& LiveOperation::view() const {
  return m_impl->scene.views.front();
}
int LiveOperation::steps() const {
  return m_impl->steps;
}
int LiveOperation::restarts() const {
  return m_impl->restarts;
}

}  // namespace supple::tools
