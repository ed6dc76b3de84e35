// Tracks of instruments: poses over time, read from CSV or made as a hand would lead them (thesis
// section 6.1.2: positions at 50 Hz with a latency of 12 ms; tremor of 8 to 10 Hz [RK99]).
//
// Columns of a file: time_s, tip_x, tip_y, tip_z (mm), axis_x, axis_y, axis_z, and where wanted
// roll_degrees, opening_degrees, active; in any order, named in the first line.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lib/instruments/instrument.h"

namespace supple {

struct TrackKey {
  double time_s;
  InstrumentPose pose;
};

/// Poses at ascending times. Between two keys tip, roll, opening and activity change evenly, the
/// axis along the great circle; before the first and after the last one it stands.
class InstrumentTrack {
 public:
  InstrumentTrack() = default;
  /// Throws InputError: no key, times that do not ascend, an axis without length, not finite.
  explicit InstrumentTrack(std::vector<TrackKey> keys, const std::string& file = {});

  InstrumentPose at(double time_s) const;
  double end_s() const { return m_keys.empty() ? 0 : m_keys.back().time_s; }
  const std::vector<TrackKey>& keys() const { return m_keys; }

 private:
  std::vector<TrackKey> m_keys;
};

/// Throws InputError that names line and column.
InstrumentTrack read_track(const std::string& path);
/// All columns, with digits enough to read the same bits.
std::string track_text(const InstrumentTrack& track);
/// Writes that text. Throws SystemError.
void write_track(const InstrumentTrack& track, const std::string& path);

/// A hand that leads an instrument along way points.
struct HandMotion {
  std::vector<TrackKey> way;  // through which it leads
  double bandwidth_hz = 6;    // of the hand: the way is smoothed to this
  double tremor_mm = 0.1;     // amplitude (root of the mean square per coordinate) of the tip
  double tremor_lowest_hz = 8, tremor_highest_hz = 10;
  double sampling_hz = 50;   // of the tracking
  double latency_s = 0.012;  // of the tracking
  std::uint64_t seed = 1;
};
/// The track that a tracking system would give of it: same bits for the same seed on all machines.
InstrumentTrack make_track(const HandMotion& motion);

/// Point of the eyeball through which a shaft goes (an incision): the tip keeps its place, the axis
/// goes through the pivot. Poses whose tip is at the pivot keep their axis.
InstrumentPose through_pivot(const InstrumentPose& pose, const Vec3d& pivot_mm);

}  // namespace supple
