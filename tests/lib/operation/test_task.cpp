// Tasks: targets in their order, areas and parts, and their keys.
#include <cmath>

#include <gtest/gtest.h>

#include "lib/operation/task.h"
#include "tests/lib/operation/operation_fixtures.h"
#include "tests/support/errors.h"
#include "volumes/base/json.h"

namespace supple::test {
namespace {

TaskSetup two_targets() {
  TaskSetup task;
  task.name = "spheres";
  task.instrument = "needle";
  task.targets = {{Vec3d(0), 0.5, 1}, {Vec3d(4, 0, 0), 0.5, 1}};
  return task;
}

TaskSetup task_of(ExerciseKind kind, double part) {
  TaskSetup task;
  task.name = "task";
  task.kind = kind;
  task.part = part;
  return task;
}

std::vector<OperationEvent> events_of(TaskWatcher& watcher, const Samples& samples) {
  std::vector<OperationEvent> events;
  for (const OperationSample& sample : samples) {
    for (const OperationEvent& event : watcher.take(sample)) events.push_back(event);
  }
  return events;
}

std::vector<std::string> kinds_of(const std::vector<OperationEvent>& events) {
  std::vector<std::string> kinds;
  for (const OperationEvent& event : events) kinds.push_back(event.kind);
  return kinds;
}

using Kinds = std::vector<std::string>;

TEST(UnitTask, TargetsAreReachedInTheirOrderByHoldingTheTip) {
  TaskWatcher watcher(two_targets(), {"needle"});
  const auto events = events_of(
      watcher, samples_of(6, [](double time_s) { return Vec3d(time_s < 2 ? 0 : 4, 0, 0); }));
  ASSERT_EQ(kinds_of(events),
            Kinds({"task_begun", "target_reached", "target_reached", "task_done"}));
  EXPECT_NEAR(events[1].time_s, 1, 1e-9);
  EXPECT_EQ(events[1].value, 1);
  EXPECT_EQ(events[2].value, 2);
  EXPECT_EQ(events[2].at, "spheres");
  EXPECT_EQ(events[2].instrument, "needle");
  EXPECT_EQ(events[2].place_mm, Vec3d(4, 0, 0));
  // The tip jumps at 2 s; the filter brings it within 1/8 of the way some 0.5 s later.
  EXPECT_NEAR(events[2].time_s, 3.5, 0.15);
  EXPECT_EQ(*watcher.done_s(), events[2].time_s);
}

TEST(UnitTask, ATargetBeforeItsTurnIsNotReached) {
  TaskWatcher watcher(two_targets(), {"needle"});
  const auto events = events_of(watcher, samples_of(3, [](double) { return Vec3d(4, 0, 0); }));
  EXPECT_EQ(kinds_of(events), Kinds({"task_begun"}));
  EXPECT_EQ(watcher.progress(), 0);
}

TEST(UnitTask, ATipThatLeavesATargetLosesTheTimeForWhichItHeld) {
  TaskWatcher watcher(two_targets(), {"needle"});
  const auto events = events_of(watcher, samples_of(4, [](double time_s) {
                                  const bool is_away = time_s > 0.6 && time_s < 1.6;
                                  return Vec3d(0, is_away ? 2 : 0, 0);
                                }));
  ASSERT_EQ(kinds_of(events), Kinds({"task_begun", "target_lost", "target_reached"}));
  EXPECT_GT(events[2].time_s, 2.6);
}

TEST(PropertyTask, TremorLosesNoTarget) {
  TaskWatcher watcher(two_targets(), {"needle"});
  const auto events =
      events_of(watcher, samples_of(2, [](double time_s) {
                  return Vec3d(1.5 * std::sin(2 * 3.14159265358979 * 9 * time_s), 0, 0);
                }));
  EXPECT_EQ(kinds_of(events), Kinds({"task_begun", "target_reached"}));
}

TEST(UnitTask, ProgressAndTargetsTellWhatIsHeld) {
  TaskWatcher watcher(two_targets(), {"needle"});
  const auto states = [&] {
    std::vector<TargetState> all;
    for (const TargetProgress& one : watcher.targets()) all.push_back(one.state);
    return all;
  };
  using States = std::vector<TargetState>;
  EXPECT_EQ(states(), States({TargetState::active, TargetState::waiting}));
  const Samples samples = samples_of(1, [](double) { return Vec3d(0); });
  for (int n = 0; n <= 25; ++n) watcher.take(samples[std::size_t(n)]);
  EXPECT_EQ(states(), States({TargetState::held, TargetState::waiting}));
  EXPECT_NEAR(watcher.targets()[0].held_part, 0.5, 1e-9);
  EXPECT_NEAR(watcher.progress(), 0.25, 1e-9);
  EXPECT_TRUE(watcher.holds_target());
  for (int n = 26; n <= 50; ++n) watcher.take(samples[std::size_t(n)]);
  EXPECT_EQ(states(), States({TargetState::done, TargetState::active}));
  EXPECT_EQ(watcher.progress(), 0.5);
  EXPECT_FALSE(watcher.is_done());
}

TEST(UnitTask, APeelEndsWhereItsPartOfTheClingingAreaIsFree) {
  TaskWatcher watcher(task_of(ExerciseKind::peel, 0.5), {"needle"});
  OperationSample sample;
  std::vector<double> progress;
  for (const double area : {40.0, 30.0, 20.0, 25.0}) {
    sample.clinging_mm2 = area;
    watcher.take(sample);
    progress.push_back(watcher.progress());
    sample.time_s += 1;
  }
  EXPECT_EQ(progress, std::vector<double>({0, 0.5, 1, 1}));
  EXPECT_EQ(*watcher.done_s(), 2);
}

TEST(UnitTask, APeelOfOneMembraneLooksAtThatOne) {
  TaskSetup task = task_of(ExerciseKind::peel, 1);
  task.body = "ilm";
  task.place = "scene.toml:7";
  TaskWatcher watcher(task, {});
  OperationSample sample;
  sample.clinging_mm2 = 50;
  EXPECT_EQ(input_error([&] { watcher.take(sample); }),
            "scene.toml:7: task.body: found \"ilm\", expected nothing, since there is none");
  sample.membranes = {{"erm", 30}, {"ilm", 20}};
  watcher.take(sample);
  sample.membranes[0].clinging_mm2 = 0;
  watcher.take(sample);
  EXPECT_EQ(watcher.progress(), 0);
  sample.membranes[1].clinging_mm2 = 0;
  EXPECT_EQ(kinds_of(watcher.take(sample)), Kinds({"task_done"}));
}

TEST(UnitTask, AVitrectomyEndsWhereItsPartIsRemoved) {
  TaskWatcher watcher(task_of(ExerciseKind::vitrectomy, 0.8), {});
  OperationSample sample;
  watcher.take(sample);
  sample.vitreous_left = 0.6;
  watcher.take(sample);
  EXPECT_NEAR(watcher.progress(), 0.5, 1e-12);
  sample.vitreous_left = 1 - 0.8;
  EXPECT_EQ(kinds_of(watcher.take(sample)), Kinds({"task_done"}));
  EXPECT_TRUE(watcher.take(sample).empty());
}

TEST(UnitTask, TasksAreReadFromTheirRowsAndWrittenBack) {
  Table scene = Table::parse(
      "[[task]]\nkind = \"navigate\"\ninstrument = \"needle\"\n"
      "targets = [{ at = [1, 2, -9.5], radius = 0.25, hold = 2 }, { at = [0, 0, -9] }]\n"
      "[[task]]\nname = \"peel it\"\nkind = \"peel\"\nbody = \"ilm\"\npart = 0.75\n",
      "scene.toml");
  const std::vector<TaskSetup> tasks = read_tasks(scene);
  ASSERT_EQ(tasks.size(), 2u);
  EXPECT_EQ(tasks[0].name, "navigate");
  ASSERT_EQ(tasks[0].targets.size(), 2u);
  EXPECT_EQ(tasks[0].targets[0].centre_mm, Vec3d(1, 2, -9.5));
  EXPECT_EQ(tasks[0].targets[0].radius_mm, 0.25);
  EXPECT_EQ(tasks[0].targets[0].hold_s, 2);
  EXPECT_EQ(tasks[0].targets[1].radius_mm, 0.5);
  EXPECT_EQ(tasks[1].body, "ilm");
  EXPECT_EQ(tasks[1].part, 0.75);
  EXPECT_EQ(tasks[1].place, "scene.toml:5");
  for (const TaskSetup& task : tasks) {
    Table row(to_value(task));
    EXPECT_EQ(json_text(to_value(read_task(row))), json_text(to_value(task)));
  }
}

TEST(FaultTask, TasksThatCannotBeDoneAreRefusedWithTheirLine) {
  const auto failure = [](const std::string& keys) {
    return input_error([&] {
      Table scene = Table::parse("[[task]]\n" + keys, "scene.toml");
      for (const TaskSetup& task : read_tasks(scene)) TaskWatcher watcher(task, {"needle"});
    });
  };
  const std::string ball = "targets = [{ at = [0, 0, 0] }]\n";
  EXPECT_EQ(failure("kind = \"navigate\"\ninstrument = \"needle\"\n" + ball), "");
  EXPECT_NE(failure("kind = \"navigat\"").find("scene.toml:2: task[1].kind"), std::string::npos);
  EXPECT_NE(failure("kind = \"navigate\"\n" + ball).find("task[1].instrument: found nothing"),
            std::string::npos);
  EXPECT_NE(failure("kind = \"navigate\"\ninstrument = \"needle\"").find("task[1].targets"),
            std::string::npos);
  EXPECT_EQ(failure("kind = \"navigate\"\ninstrument = \"pick\"\n" + ball),
            "scene.toml:1: task.instrument: found \"pick\", expected needle");
  EXPECT_EQ(failure("kind = \"peel\"\n" + ball),
            "scene.toml:3: task[1].targets: found a key of another kind of task, expected keys of "
            "\"peel\"");
  EXPECT_NE(failure("kind = \"peel\"\npart = 0").find("task[1].part"), std::string::npos);
  EXPECT_NE(failure("kind = \"navigate\"\ninstrument = \"needle\"\ntargets = [{ radius = 1 }]")
                .find("task[1].targets[1].at: found nothing"),
            std::string::npos);
  EXPECT_EQ(failure("kind = \"peel\"\n[[task]]\nkind = \"peel\""),
            "scene.toml:3: task[2].name: found \"peel\" twice, expected another name");
}

TEST(FaultTask, AMembraneThatClingsNowhereCannotBePeeled) {
  TaskSetup task = task_of(ExerciseKind::peel, 0.9);
  task.place = "scene.toml:3";
  TaskWatcher watcher(task, {});
  EXPECT_EQ(input_error([&] { watcher.take({}); }),
            "scene.toml:3: task.kind: found 0, expected a membrane that clings, to be peeled");
}

}  // namespace
}  // namespace supple::test
