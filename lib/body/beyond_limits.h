// Offsets that a model without limits left beyond the limits of links.
//
// Enhanced ChainMail goes from admissible states. Where Body::beyond is given, the admissible state
// is q less that: ECM moves it, with all that is held, and puts `beyond` on again. For a link from
// i to j that is ECM on q itself, with the limits shifted by beyond_j - beyond_i: what is beyond a
// limit may come back, and goes no further. Cost: a pass over the bricks of `beyond`, twice.
#pragma once

#include "lib/body/body.h"
#include "lib/body/slot_set.h"

namespace supple {

/// Makes the offsets of a body the admissible ones while this lives.
class AdmissibleOffsets {
 public:
  explicit AdmissibleOffsets(Body& body);
  /// The same of one coordinate.
  AdmissibleOffsets(Body& body, int coordinate);
  ~AdmissibleOffsets();
  AdmissibleOffsets(const AdmissibleOffsets&) = delete;
  AdmissibleOffsets& operator=(const AdmissibleOffsets&) = delete;

 private:
  void add(int sign);

  Body& m_body;
  const int m_first, m_end;  // coordinates
};

/// Bounds of q as bounds of the admissible offsets, and back.
void to_admissible(const Body& body, Holds& holds);
void from_admissible(const Body& body, Holds& holds);

/// How far an element is beyond the nearest admissible place.
inline std::int32_t beyond_at(const Body& body, int coordinate, Slot slot) {
  return body.beyond ? (*body.beyond)[std::size_t(coordinate)].at(slot) : 0;
}

}  // namespace supple
