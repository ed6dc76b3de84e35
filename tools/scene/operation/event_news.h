// Events of a live operation as a person is told of them.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lib/operation/operation_sample.h"

namespace supple::tools {

/// Tells of a touch once when it begins and, as `touch_ended` with its largest force, once when it
/// is over: touches of one thing that are apart by less than a quarter of a second are one. Other
/// events pass as they are.
class EventNews {
 public:
  std::vector<OperationEvent> of(const OperationSample& sample);

 private:
  struct Touch {
    OperationEvent hardest;
    double last_s;
  };
  std::map<std::pair<std::string, std::string>, Touch> m_touches;  // by instrument and place
  double m_last_s = 0;
};

}  // namespace supple::tools
