#include "tools/scene/operation/operation_record.h"

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <map>
#include <optional>

#include "lib/operation/operation_log.h"
#include "tools/scene/operation/operated_volume.h"
#include "tools/scene/run/scene_files.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"

namespace supple::tools {

namespace {

/// The name of the tracks' files for one instrument.
std::string track_name(const std::string& pattern, const std::string& instrument) {
  const std::size_t at = pattern.find("%s");
  return pattern.substr(0, at) + instrument + pattern.substr(at + 2);
}

void write_text(const AtomicFile& file, const std::string& text) {
  std::ofstream out(file.path(), std::ios::binary);
  if (!(out << text << std::flush)) throw_write_error(file.final_path(), errno);
}

TaskBall ball_of(const TaskTarget& target, const TargetProgress& progress) {
  TaskBall ball{target.centre_mm, target.radius_mm};
  switch (progress.state) {
    case TargetState::waiting:
      ball.rgb = {0.6, 0.6, 0.6};
      ball.opacity = 0.2;
      break;
    case TargetState::active:
      ball.rgb = {1, 0.8, 0.1};
      break;
    case TargetState::held:
      ball.rgb = {1 - 0.8 * progress.held_part, 0.9, 0.1};
      ball.opacity = 0.5;
      break;
    case TargetState::done:
      ball.rgb = {0.1, 0.8, 0.2};
      ball.opacity = 0.15;
      break;
  }
  return ball;
}

}  // namespace

OperationPlan plan_of(const OperationScene& scene) {
  OperationPlan plan;
  for (const OperationTool& tool : scene.setup.tools) {
    plan.instruments.push_back(tool.shape.name);
    const std::optional<TipLamp> lamp = make_instrument(tool.shape).lamp;
    if (!lamp) continue;
    plan.around.lamp = tool.shape.name;
    plan.around.lamp_cone_degrees = lamp->cone_degrees;
  }
  if (scene.setup.eye) {
    for (const Obstacle& obstacle : obstacles_of(*scene.setup.eye)) {
      plan.places.push_back(obstacle.name);
    }
    plan.around.globe_radius_mm = scene.setup.eye->radius_mm;
  }
  if (scene.volume) plan.places.push_back(kBone);
  for (const Obstacle& shape : scene.setup.shapes) plan.places.push_back(shape.name);
  for (const OperationMembrane& one : scene.setup.membranes) plan.places.push_back(one.name);
  if (!scene.views.empty()) plan.around.view = scene.views.front().from.normalized();
  plan.tasks = scene.tasks;
  plan.rules = scene.rules;
  return plan;
}

struct OperationRecord::Impl {
  const OperationScene& scene;
  OperationPlan plan;
  ScoreKeeper keeper;
  std::optional<OperationLog> log;
  std::vector<std::vector<TrackKey>> asked;   // per instrument, where tracks are written
  std::map<std::string, int> events;          // by kind
  std::vector<MembraneSample> extremes, now;  // of membranes
  double time_s = 0;

  Impl(const OperationScene& given)
      : scene(given), plan(plan_of(given)), keeper(plan), asked(given.setup.tools.size()) {}
  void take_membranes(const std::vector<MembraneSample>& membranes);
};

void OperationRecord::Impl::take_membranes(const std::vector<MembraneSample>& membranes) {
  now = membranes;
  extremes.resize(now.size());
  for (std::size_t n = 0; n < now.size(); ++n) {
    MembraneSample& most = extremes[n];
    most.longest_stretch = std::max(most.longest_stretch, now[n].longest_stretch);
    most.pinched = std::max(most.pinched, now[n].pinched);
    most.inverted = std::max(most.inverted, now[n].inverted);
  }
}

OperationRecord::OperationRecord(const OperationScene& scene, const Operation& operation)
    : m_impl(std::make_unique<Impl>(scene)) {
  if (scene.output.tracks.empty()) return;
  for (std::size_t n = 0; n < m_impl->asked.size(); ++n) {
    m_impl->asked[n].push_back({0, operation.setup().tools[n].start});
  }
}
OperationRecord::~OperationRecord() = default;

void OperationRecord::plan(const std::string& folder, OutputPlan& plan) const {
  const OperationOutput& output = m_impl->scene.output;
  if (!output.log.empty()) plan.add_log(path_in(folder, output.log));
  if (!output.score.empty()) plan.add_report(path_in(folder, output.score));
  if (output.tracks.empty()) return;
  for (const std::string& name : m_impl->plan.instruments) {
    plan.add_table(path_in(folder, track_name(output.tracks, name)));
  }
}

void OperationRecord::open(const std::string& folder) {
  const std::string& name = m_impl->scene.output.log;
  if (!name.empty()) m_impl->log.emplace(path_in(folder, name), m_impl->plan);
}

void OperationRecord::take(const Operation& operation, const std::vector<InstrumentPose>& asked) {
  Impl& in = *m_impl;
  OperationSample sample = operation.sample();
  in.time_s = sample.time_s;
  if (!in.scene.views.empty()) {
    sample.focus_mm = in.scene.views.front().focus_at(sample.time_s);
    sample.zoom = in.scene.views.front().zoom_at(sample.time_s);
  }
  for (const OperationEvent& event : in.keeper.take(sample)) sample.events.push_back(event);
  for (const OperationEvent& event : sample.events) ++in.events[event.kind];
  in.take_membranes(sample.membranes);
  if (in.log) in.log->add(sample);
  if (in.scene.output.tracks.empty()) return;
  for (std::size_t n = 0; n < asked.size(); ++n) in.asked[n].push_back({sample.time_s, asked[n]});
}

void OperationRecord::write(const std::string& folder, PendingFiles& files) {
  Impl& in = *m_impl;
  const OperationOutput& output = in.scene.output;
  if (in.log) in.log->end();
  if (!output.tracks.empty()) {
    for (std::size_t n = 0; n < in.asked.size(); ++n) {
      write_text(files.add(path_in(folder, track_name(output.tracks, in.plan.instruments[n]))),
                 track_text(InstrumentTrack(in.asked[n])));
    }
  }
  if (output.score.empty()) return;
  write_text(files.add(path_in(folder, output.score)),
             json_text(to_value(in.keeper.score()), 2) + "\n");
}

void OperationRecord::commit() {
  if (m_impl->log) m_impl->log->finish();
}

std::vector<TaskBall> OperationRecord::balls() const {
  std::vector<TaskBall> balls;
  for (const TaskWatcher& task : m_impl->keeper.tasks()) {
    const std::vector<TargetProgress> progress = task.targets();
    for (std::size_t n = 0; n < progress.size(); ++n) {
      balls.push_back(ball_of(task.setup().targets[n], progress[n]));
    }
  }
  return balls;
}

const ScoreKeeper& OperationRecord::keeper() const {
  return m_impl->keeper;
}

Value OperationRecord::report() const {
  Value events = Value::Entries();
  for (const auto& [kind, count] : m_impl->events) events[kind] = count;
  Value membranes = Value::Entries();
  for (std::size_t n = 0; n < m_impl->now.size(); ++n) {
    const MembraneSample &most = m_impl->extremes[n], &now = m_impl->now[n];
    membranes[now.body] = {{"longest_stretch", most.longest_stretch},
                           {"most_pinched_nodes", most.pinched},
                           {"most_inverted_triangles", most.inverted},
                           {"inverted_triangles", now.inverted}};
  }
  return {
      {"events", events}, {"membranes", membranes}, {"score", to_value(m_impl->keeper.score())}};
}

}  // namespace supple::tools
