// The way of an instrument from one pose to another within a step: a turn at even speed about a
// point of the shaft that goes straight, which is the pivot where there is one.
#pragma once

#include "lib/instruments/instrument.h"

namespace supple {

class ToolPath {
 public:
  ToolPath(const InstrumentPose& from, const InstrumentPose& to, const Vec3d* pivot_mm);

  /// The pose at a part of the way, 0 to 1; at 1 the asked one to the bit.
  InstrumentPose at(double part) const;

  /// How far a point of the instrument is, within a part of the way, at most from where it would be
  /// if it went straight: of a turn by small φ at even speed φ²/8 of its distance from what is
  /// turned about, and φ/4 of the way that the shaft goes along itself meanwhile.
  double sag_mm(const Instrument& instrument, const InstrumentPart& part, double share) const;
  /// A bound on the way of any point of the instrument.
  double longest_mm(const Instrument& instrument) const;

 private:
  double reach_mm(const InstrumentPart& part) const;

  InstrumentPose m_from, m_to;
  ToolFrame m_frame;               // of m_from
  Vec3d m_centre_mm, m_way_mm;     // of what it turns about
  double m_depth_mm, m_deeper_mm;  // of the tip below it, along the shaft
  Vec3d m_turn_axis{0, 0, 1};
  double m_turn_radians = 0;
};

}  // namespace supple
