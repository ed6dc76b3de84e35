#include "tests/lib/operation/operation_fixtures.h"

#include <algorithm>
#include <cmath>

#include "volumes/base/units.h"

namespace supple::test {

namespace {

constexpr double kClear_mm = 1.5;     // from the retina
constexpr double kPolar = 0.5;        // angle of the targets from the posterior pole
constexpr double kBetween = kPi / 3;  // azimuth between two targets
constexpr double kHold_s = 3, kMove_s = 2, kRound_s = 5, kDip_s = 1;

/// Goes from 0 to 1 with no jerk at its ends.
double smooth(double part) {
  const double p = std::clamp(part, 0.0, 1.0);
  return p * p * p * (10 + p * (6 * p - 15));
}

Vec3d at_azimuth(double azimuth, double radius_mm) {
  return Vec3d(std::sin(kPolar) * std::cos(azimuth), std::sin(kPolar) * std::sin(azimuth),
               -std::cos(kPolar)) *
         radius_mm;
}

/// Tones whose peaks do not meet: five times an expert's tremor still does not reach the retina.
Vec3d tremor_at(double time_s, double root_mean_square_mm) {
  const double amplitude = root_mean_square_mm * std::sqrt(2.0 / 3);
  Vec3d sum(0);
  for (int tone = 0; tone < 3; ++tone) {
    for (int c = 0; c < 3; ++c) {
      sum[c] += amplitude * std::sin(2 * kPi * (8 + tone) * time_s + 1.6 * tone * tone + 0.9 * c);
    }
  }
  return sum;
}

/// The pole, three targets, then a detour or a touch where one is wanted, and the last target.
struct Way {
  const Expert& expert;

  double extra_s() const { return expert.rounds * kRound_s + (expert.touches ? kDip_s : 0); }
  double end_s() const { return 3 * (kMove_s + kHold_s) + extra_s(); }
  Vec3d at(double time_s) const {
    const double second_s = 2 * (kMove_s + kHold_s);
    double azimuth = 0, radius_mm = kGlobe_mm - kClear_mm, time = time_s;
    if (time > second_s) {
      const double extra = std::min(time - second_s, extra_s());
      if (expert.rounds > 0) {
        azimuth = 2 * kPi * expert.rounds * smooth(extra / (expert.rounds * kRound_s));
      }
      if (expert.touches) {
        const double down = smooth(2 * extra / kDip_s) - smooth(2 * extra / kDip_s - 1);
        radius_mm += (kClear_mm + 0.2) * down;
      }
      time -= extra;
    }
    for (int target = 1; target < 3; ++target) {
      azimuth += kBetween * smooth((time - target * (kMove_s + kHold_s)) / kMove_s);
    }
    return at_azimuth(azimuth, radius_mm);
  }
};

}  // namespace

Samples samples_of(double seconds, const std::function<Vec3d(double time_s)>& tip) {
  Samples samples;
  const int steps = int(std::lround(seconds / kStep_s));
  for (int n = 0; n <= steps; ++n) {
    OperationSample sample;
    sample.time_s = n * kStep_s;
    sample.instruments.resize(1);
    sample.instruments[0].asked.tip_mm = tip(sample.time_s);
    sample.instruments[0].pose = sample.instruments[0].asked;
    samples.push_back(sample);
  }
  return samples;
}

OperationPlan needle_plan() {
  OperationPlan plan;
  plan.instruments = {"needle"};
  plan.places = {"retina", "lens", "membrane"};
  plan.rules.clear();
  plan.around.globe_radius_mm = kGlobe_mm;
  return plan;
}

ScoreRule rule_of(const std::string& measure) {
  ScoreRule rule;
  rule.measure = measure;
  rule.category = measure_kind(measure).category;
  return rule;
}

OperationScore score_of(const OperationPlan& plan, const Samples& samples) {
  ScoreKeeper keeper(plan);
  for (const OperationSample& sample : samples) keeper.take(sample);
  return keeper.score();
}

double measured(const Samples& samples, OperationPlan plan, const ScoreRule& rule) {
  plan.rules = {rule};
  return score_of(plan, samples).rules.at(0).measured;
}

double measured(const Samples& samples, const std::string& measure) {
  return measured(samples, needle_plan(), rule_of(measure));
}

Samples with_task_events(const OperationPlan& plan, Samples samples) {
  ScoreKeeper keeper(plan);
  for (OperationSample& sample : samples) {
    for (const OperationEvent& event : keeper.take(sample)) sample.events.push_back(event);
  }
  return samples;
}

Samples expert_samples(const Expert& expert) {
  const Way way{expert};
  Samples samples = samples_of(way.end_s(), [&](double time_s) {
    return way.at(time_s) + tremor_at(time_s, expert.tremor_mm);
  });
  bool has_bled = false;
  for (OperationSample& sample : samples) {
    sample.focus_mm = Vec3d(0, 0, -9);
    InstrumentSample& needle = sample.instruments[0];
    const double depth_mm = needle.asked.tip_mm.length() - kGlobe_mm;
    if (depth_mm <= 0) continue;
    needle.pose.tip_mm = needle.asked.tip_mm.normalized() * kGlobe_mm;
    needle.force_n = 0.1 * depth_mm;
    sample.events.push_back(
        {sample.time_s, "touch", "needle", "retina", needle.pose.tip_mm, needle.force_n});
    if (has_bled) continue;
    has_bled = true;
    sample.events.push_back({sample.time_s, "bleeding", "", "retina", needle.pose.tip_mm, 0.5});
  }
  return samples;
}

OperationPlan expert_plan() {
  OperationPlan plan = needle_plan();
  plan.rules = default_score_rules();
  TaskSetup task;
  task.name = "spheres";
  task.instrument = "needle";
  for (int target = 0; target < 3; ++target) {
    task.targets.push_back(
        {at_azimuth(target * kBetween, kGlobe_mm - kClear_mm), 0.5 - 0.1 * target, 1});
  }
  plan.tasks = {task};
  return plan;
}

}  // namespace supple::test
