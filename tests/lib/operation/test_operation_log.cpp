// Logs: the same bits come back, the same score is found, and damage is told.
#include <cmath>
#include <cstring>
#include <random>

#include <gtest/gtest.h>

#include "lib/operation/operation_log.h"
#include "tests/lib/operation/operation_fixtures.h"
#include "tests/support/errors.h"
#include "tests/support/sanitized.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/memory.h"

namespace supple::test {
namespace {

std::string bits_of(double number) {
  std::string bits(sizeof number, '\0');
  std::memcpy(bits.data(), &number, sizeof number);
  return bits;
}

std::string bits_of(const Vec3d& v) {
  return bits_of(v.x) + bits_of(v.y) + bits_of(v.z);
}

std::string bits_of(const InstrumentPose& pose) {
  return bits_of(pose.tip_mm) + bits_of(pose.axis) + bits_of(pose.roll_degrees) +
         bits_of(pose.opening_degrees) + bits_of(pose.active);
}

std::string bits_of(const OperationSample& sample) {
  std::string bits = bits_of(sample.time_s) + bits_of(sample.turn_degrees) +
                     bits_of(sample.focus_mm) + bits_of(sample.zoom) +
                     bits_of(sample.clinging_mm2) + bits_of(sample.vitreous_left);
  for (const InstrumentSample& tool : sample.instruments) {
    bits += bits_of(tool.asked) + bits_of(tool.pose) + bits_of(tool.force_n);
  }
  for (const OperationEvent& event : sample.events) {
    bits += bits_of(event.time_s) + event.kind + "|" + event.instrument + "|" + event.at +
            bits_of(event.place_mm) + bits_of(event.value);
  }
  for (const MembraneSample& membrane : sample.membranes) {
    bits += membrane.body + bits_of(membrane.clinging_mm2) + std::to_string(membrane.inverted);
  }
  return bits;
}

/// A number of any size and sign, -0 and the smallest ones among them.
double random_number(std::mt19937_64& random) {
  static const double kSpecial[] = {0.0, -0.0, 1, 0.1, 1e22, 5e-324, 1.7976931348623157e308, 1e-7};
  if (random() % 5 == 0) return kSpecial[random() % std::size(kSpecial)];
  for (;;) {
    const std::uint64_t bits = random();
    double number;
    std::memcpy(&number, &bits, sizeof number);
    if (std::isfinite(number)) return number;
  }
}

Vec3d random_vector(std::mt19937_64& random) {
  const double x = random_number(random), y = random_number(random);
  return {x, y, random_number(random)};
}

InstrumentPose random_pose(std::mt19937_64& random) {
  InstrumentPose pose;
  pose.tip_mm = random_vector(random);
  pose.axis = random_vector(random);
  pose.roll_degrees = random_number(random);
  pose.opening_degrees = random_number(random);
  pose.active = random_number(random);
  return pose;
}

OperationSample random_sample(std::mt19937_64& random, double time_s) {
  OperationSample sample;
  sample.time_s = time_s;
  for (int tool = 0; tool < 2; ++tool) {
    const InstrumentPose asked = random_pose(random);
    sample.instruments.push_back({asked, random_pose(random), random_number(random)});
  }
  for (std::uint64_t count = random() % 3; count > 0; --count) {
    sample.events.push_back({random_number(random), "touch", "a \"needle\"\n", "Netzhaut ä",
                             random_vector(random), random_number(random)});
  }
  sample.turn_degrees = random_vector(random);
  sample.focus_mm = random_vector(random);
  sample.zoom = random_number(random);
  sample.clinging_mm2 = random_number(random);
  sample.vitreous_left = random_number(random);
  sample.membranes = {{"ilm", random_number(random), int(random() % 3)},
                      {"erm", random_number(random)}};
  return sample;
}

OperationPlan two_tools() {
  OperationPlan plan = needle_plan();
  plan.instruments = {"needle", "lamp"};
  return plan;
}

void write_log(const std::string& path, const OperationPlan& plan, const Samples& samples) {
  OperationLog log(path, plan);
  for (const OperationSample& sample : samples) log.add(sample);
  log.finish();
}

TEST(PropertyOperationLog, AnyNumberComesBackWithTheSameBits) {
  const TemporaryFolder folder;
  const std::string path = folder / "log.jsonl";
  std::mt19937_64 random(54);
  Samples samples;
  for (int n = 0; n < 300; ++n) samples.push_back(random_sample(random, n / 3.0));
  write_log(path, two_tools(), samples);
  OperationLogReader log(path);
  for (const OperationSample& sample : samples) {
    const auto read = log.next();
    ASSERT_TRUE(read);
    ASSERT_EQ(bits_of(*read), bits_of(sample)) << sample.time_s;
  }
  EXPECT_FALSE(log.next());
  EXPECT_FALSE(log.next());
}

TEST(PropertyOperationLog, ALogReplaysToTheSameScoreBitForBit) {
  const TemporaryFolder folder;
  for (const Expert& expert :
       {Expert{}, Expert{0.5, 0, false}, Expert{0.1, 2, false}, Expert{0.1, 0, true}}) {
    const OperationPlan plan = expert_plan();
    const Samples samples = with_task_events(plan, expert_samples(expert));
    const std::string path = folder / "log.jsonl";
    write_log(path, plan, samples);
    const OperationScore live = score_of(plan, samples), replayed = score_of_log(path);
    for (std::size_t c = 0; c < live.points.size(); ++c) {
      EXPECT_EQ(bits_of(replayed.points[c]), bits_of(live.points[c]));
    }
    EXPECT_EQ(json_text(to_value(replayed)), json_text(to_value(live)));
  }
}

TEST(PropertyOperationLog, EventsOfTasksInALogDoNotCountTwice) {
  const OperationPlan plan = expert_plan();
  Expert wandering;
  wandering.rounds = 2;
  const Samples plain = expert_samples(wandering);
  EXPECT_EQ(json_text(to_value(score_of(plan, with_task_events(plan, plain)))),
            json_text(to_value(score_of(plan, plain))));
}

TEST(UnitOperationLog, ALogHasItsNameOnlyWhenItIsWhole) {
  const TemporaryFolder folder;
  {
    OperationLog log(folder / "log.jsonl", needle_plan());
    log.add(samples_of(0, [](double) { return Vec3d(0); })[0]);
  }
  EXPECT_TRUE(folder.entries().empty());
  write_log(folder / "log.jsonl", needle_plan(), {});
  EXPECT_EQ(folder.entries(), std::vector<std::string>({"log.jsonl"}));
  EXPECT_FALSE(OperationLogReader(folder / "log.jsonl").next());
}

TEST(ExtremesOperationLog, MemoryIsFlatOverThirtyThousandSteps) {
  if (kSanitized) GTEST_SKIP() << "sanitizers keep what is freed";
  const TemporaryFolder folder;
  OperationPlan plan = expert_plan();
  OperationSample sample;
  sample.instruments.resize(1);
  OperationLog log(folder / "log.jsonl", plan);
  ScoreKeeper keeper(plan);
  double early_mb = 0;
  for (int n = 0; n < 30000; ++n) {
    sample.time_s = n * kStep_s;
    sample.instruments[0].asked.tip_mm.x = std::sin(sample.time_s);
    sample.instruments[0].pose = sample.instruments[0].asked;
    sample.events = {{sample.time_s, "touch", "needle", "retina", Vec3d(0), 0.01}};
    keeper.take(sample);
    log.add(sample);
    if (n == 3000) early_mb = rss_mb();
  }
  log.finish();
  EXPECT_LT(rss_mb() - early_mb, 2);
  OperationLogReader reader(folder / "log.jsonl");
  ScoreKeeper replay(reader.plan());
  int steps = 0;
  while (const auto read = reader.next()) {
    replay.take(*read);
    if (++steps == 3000) early_mb = rss_mb();
  }
  EXPECT_EQ(steps, 30000);
  EXPECT_LT(rss_mb() - early_mb, 2);
  EXPECT_EQ(json_text(to_value(replay.score())), json_text(to_value(keeper.score())));
}

/// A log of three steps with an event, as text.
std::string log_text(const TemporaryFolder& folder) {
  Samples samples = samples_of(2 * kStep_s, [](double) { return Vec3d(0); });
  samples[1].events = {{kStep_s, "touch", "needle", "retina", Vec3d(0), 0.5}};
  write_log(folder / "whole.jsonl", needle_plan(), samples);
  return read_text(folder / "whole.jsonl");
}

std::string reading_error(const std::string& path) {
  return input_error([&] {
    OperationLogReader log(path);
    while (log.next()) {
    }
  });
}

TEST(FaultOperationLog, DamageIsToldWithFileAndLine) {
  const TemporaryFolder folder;
  const std::string whole = log_text(folder);
  const auto damaged = [&](const std::string& old_text, const std::string& new_text) {
    std::string text = whole;
    const std::size_t at = text.rfind(old_text);
    EXPECT_NE(at, std::string::npos) << old_text;
    text.replace(at, old_text.size(), new_text);
    const std::string line = reading_error(folder.write("log.jsonl", text));
    const std::string place = folder / "log.jsonl";
    EXPECT_EQ(line.compare(0, place.size(), place), 0) << line;
    return line.substr(std::min(line.size(), place.size()));
  };
  // Rows: head, step, event, step, step, end.
  EXPECT_EQ(damaged("\"zoom\":1.0", "\"zoom\":\"1\""),
            ":5: zoom: found '1', expected a finite number");
  EXPECT_EQ(damaged("\"zoom\":1.0,", ""), ":5: zoom: found nothing, expected a finite number");
  EXPECT_EQ(damaged("\"zoom\":1.0", "\"zoom\":null"),
            ":5: zoom: found null, expected a finite number");
  EXPECT_EQ(damaged("\"t\":0.04", "\"t\":0.01"), ":5: t: found 0.01, expected no time before 0.02");
  EXPECT_EQ(damaged("\"steps\":3", "\"steps\":4"),
            ":6: steps: found 4, expected 3, as many as there are");
  EXPECT_EQ(damaged("\"value\":0.5", "\"value\":0.5,\"more\":1").substr(0, 9), ":3: more:");
  EXPECT_EQ(damaged("\"event\":\"touch\"", "\"event\":5"), ":3: event: found 5, expected a string");
  EXPECT_EQ(damaged("0.0],\"force\"", "0.0,1.0],\"force\""),
            ":5: tools[1].pose: found 10 numbers, expected nine numbers: tip, axis, roll, opening, "
            "activity");
  EXPECT_EQ(damaged("{\"t\"", "{t"), ":5: found no table of JSON, expected a row of a log");
  EXPECT_EQ(damaged("{\"steps\":3}\n", "{\"steps\":3}\n{}\n"),
            ":7: found rows after the last one, expected the end of the file");
  EXPECT_EQ(damaged("\"operation_log\":1", "\"operation_log\":2"),
            ":1: operation_log: found 2, expected the first row of a log of an operation, version "
            "1");
  EXPECT_EQ(
      damaged("\"membranes\":{}", "\"membranes\":{},\"inverted\":{\"sheet\":2}").substr(0, 20),
      ":5: inverted.sheet: ");
  EXPECT_EQ(damaged("\"instruments\":[\"needle\"]", "\"instruments\":[\"needle\",\"pick\"]"),
            ":2: tools: found 1 instrument, expected 2 instruments");
}

TEST(FaultOperationLog, ALogThatIsCutOffAnywhereIsRefused) {
  const TemporaryFolder folder;
  const std::string whole = log_text(folder);
  EXPECT_EQ(reading_error(folder.write("log.jsonl", whole)), "");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string told = reading_error(folder.write("log.jsonl", whole.substr(0, size)));
    const bool is_at_end_of_row = size == 0 || whole[size - 1] == '\n';
    EXPECT_NE(told.find(is_at_end_of_row ? "found the end of the file" : "found a line without an"),
              std::string::npos)
        << size << " " << told;
  }
  EXPECT_NE(reading_error(folder / "missing.jsonl"), "");
  EXPECT_NE(reading_error(folder.path()), "");
}

TEST(FaultOperationLog, NumbersThatAreNotFiniteAreRefusedBeforeTheyAreWritten) {
  const TemporaryFolder folder;
  OperationLog log(folder / "log.jsonl", needle_plan());
  OperationSample sample = samples_of(0, [](double) { return Vec3d(0); })[0];
  sample.instruments[0].pose.tip_mm.y = std::nan("");
  EXPECT_NE(input_error([&] { log.add(sample); }).find("expected a finite number"),
            std::string::npos);
}

TEST(FaultOperationLog, AFullDiskLeavesNoLog) {
  const TemporaryFolder folder;
  const Samples samples = samples_of(60, [](double time_s) { return Vec3d(time_s); });
  {
    const FileSizeLimit limit(100000);
    EXPECT_NE(error_of([&] {
                write_log(folder / "log.jsonl", needle_plan(), samples);
              }).find("log.jsonl"),
              std::string::npos);
  }
  EXPECT_TRUE(folder.entries().empty());
}

}  // namespace
}  // namespace supple::test
