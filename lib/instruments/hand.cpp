// Sums, products and square roots alone, so that all machines give the same bits.
#include <array>
#include <cmath>
#include <string>

#include "lib/instruments/track.h"
#include "volumes/base/error.h"
#include "volumes/base/random.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

constexpr int kTones = 16;       // of tremor along one coordinate
constexpr int kBoxes = 3;        // running means of the smoothing
constexpr int kBoxSamples = 15;  // of one mean, odd
/// Width of a mean times the bandwidth, at which three of them leave 1/sqrt(2).
constexpr double kBoxWidth = 0.2626;
constexpr double kMaxSamples = 1e7;

/// The sine of an angle in turns, by its series on a quarter turn; within 1e-14.
double sine_of_turns(double turns) {
  double t = turns - std::floor(turns + 0.5);  // -1/2 … 1/2
  if (t > 0.25) t = 0.5 - t;
  if (t < -0.25) t = -0.5 - t;
  const double x = t * 2 * kPi, x2 = x * x;
  double sum = 0;
  for (int n = 19; n >= 3; n -= 2) sum = (1 + sum) * -x2 / (n * (n - 1));
  return x * (1 + sum);
}

/// Tremor of the tip: tones with frequencies spread over its band and seeded phases.
class Tremor {
 public:
  explicit Tremor(const HandMotion& motion)
      : m_amplitude_mm(motion.tremor_mm * std::sqrt(2.0 / kTones)) {
    const double step_hz = (motion.tremor_highest_hz - motion.tremor_lowest_hz) / kTones;
    RandomNumbers draws(motion.seed);
    for (auto& coordinate : m_tones) {
      for (int n = 0; n < kTones; ++n) {
        const double hz = motion.tremor_lowest_hz + (n + draws.next()) * step_hz;
        coordinate[std::size_t(n)] = {hz, draws.next()};
      }
    }
  }

  Vec3d at(double time_s) const {
    Vec3d sum(0.0);
    for (int c = 0; c < 3; ++c) {
      for (const Tone& tone : m_tones[std::size_t(c)]) {
        sum[c] += sine_of_turns(tone.hz * time_s + tone.turns);
      }
    }
    return sum * m_amplitude_mm;
  }

 private:
  struct Tone {
    double hz, turns;
  };
  std::array<std::array<Tone, kTones>, 3> m_tones;
  double m_amplitude_mm;
};

/// Sums poses by their coordinates.
void add(InstrumentPose& sum, const InstrumentPose& pose, double weight) {
  sum.tip_mm += pose.tip_mm * weight;
  sum.axis += pose.axis * weight;
  sum.roll_degrees += pose.roll_degrees * weight;
  sum.opening_degrees += pose.opening_degrees * weight;
  sum.active += pose.active * weight;
}
InstrumentPose no_pose() {
  return {Vec3d(0.0), Vec3d(0.0), 0, 0, 0};
}

/// The way, smoothed by a kernel that is symmetric in time: the hand knows where it goes.
class SmoothWay {
 public:
  SmoothWay(const std::vector<TrackKey>& keys, double bandwidth_hz)
      : m_keys(keys), m_step_s(kBoxWidth / bandwidth_hz / kBoxSamples) {
    m_weights = {1};
    for (int box = 0; box < kBoxes; ++box) {
      std::vector<double> wider(m_weights.size() + kBoxSamples - 1, 0.0);
      for (std::size_t n = 0; n < m_weights.size(); ++n) {
        for (int k = 0; k < kBoxSamples; ++k) wider[n + std::size_t(k)] += m_weights[n];
      }
      m_weights = std::move(wider);
    }
    for (double& weight : m_weights) weight /= double(kBoxSamples) * kBoxSamples * kBoxSamples;
  }

  double half_width_s() const { return double(m_weights.size() / 2) * m_step_s; }

  InstrumentPose at(double time_s) const {
    InstrumentPose sum = no_pose();
    for (std::size_t n = 0; n < m_weights.size(); ++n) {
      add(sum, way_at(time_s + double(n) * m_step_s - half_width_s()), m_weights[n]);
    }
    const double length = sum.axis.length();
    sum.axis = length > 1e-9 ? sum.axis / length : way_at(time_s).axis.normalized();
    return sum;
  }

 private:
  /// Even way between keys; the axis gets its length by the smoothing.
  InstrumentPose way_at(double time_s) const {
    std::size_t low = 0, high = m_keys.size() - 1;
    if (time_s <= m_keys[low].time_s) return m_keys[low].pose;
    if (time_s >= m_keys[high].time_s) return m_keys[high].pose;
    while (high - low > 1) {
      const std::size_t middle = (low + high) / 2;
      (m_keys[middle].time_s <= time_s ? low : high) = middle;
    }
    const TrackKey &a = m_keys[low], &b = m_keys[high];
    const double part = (time_s - a.time_s) / (b.time_s - a.time_s);
    InstrumentPose pose = no_pose();
    add(pose, a.pose, 1 - part);
    add(pose, b.pose, part);
    return pose;
  }

  const std::vector<TrackKey>& m_keys;
  double m_step_s;
  std::vector<double> m_weights;
};

void check(const HandMotion& motion) {
  require(motion.bandwidth_hz > 0, "bandwidth_hz", motion.bandwidth_hz, "above 0");
  require(motion.tremor_mm >= 0, "tremor_mm", motion.tremor_mm, "0 or above");
  require(motion.tremor_lowest_hz > 0, "tremor_lowest_hz", motion.tremor_lowest_hz, "above 0");
  require(motion.tremor_highest_hz >= motion.tremor_lowest_hz, "tremor_highest_hz",
          motion.tremor_highest_hz, "the lowest frequency of tremor or above");
  require(motion.sampling_hz > 0, "sampling_hz", motion.sampling_hz, "above 0");
  require(motion.latency_s >= 0, "latency_s", motion.latency_s, "0 or above");
}

}  // namespace

InstrumentTrack make_track(const HandMotion& motion) {
  check(motion);
  const std::vector<TrackKey> way = InstrumentTrack(motion.way).keys();
  const SmoothWay smooth(way, motion.bandwidth_hz);
  const Tremor tremor(motion);
  const double start_s = way.front().time_s;
  const double end_s = way.back().time_s + smooth.half_width_s() + motion.latency_s;
  const double samples = std::ceil((end_s - start_s) * motion.sampling_hz);
  require(samples < kMaxSamples, "sampling_hz", motion.sampling_hz,
          "fewer than " + number_text(kMaxSamples) + " samples of the way");
  std::vector<TrackKey> keys;
  for (int n = 0; n <= int(samples); ++n) {
    const double time_s = start_s + n / motion.sampling_hz;
    InstrumentPose pose = smooth.at(time_s - motion.latency_s);
    pose.tip_mm += tremor.at(time_s - motion.latency_s);
    keys.push_back({time_s, pose});
  }
  return InstrumentTrack(std::move(keys));
}

}  // namespace supple
