// A small operation in an eye, for tests: forceps beside a membrane of few nodes, and a lamp.
#pragma once

#include "volumes/base/table.h"

namespace supple::tools {

inline const char* kSmallEye = R"(
[operation]
duration = 2
[eye]
[[body]]
kind  = "membrane"
name  = "membrane"
sheet = { middle = [0, 0, -1], radius = 1.5, nodes = 150 }
[[instrument]]
name     = "forceps"
kind     = "forceps"
incision = "nasal"
way = [
  { time = 0, tip = [1, 0, -8],      opening = 20 },
  { time = 1, tip = [1.5, 0, -8],    opening = 20 },
  { time = 2, tip = [1.5, 0.5, -8],  opening = 20 },
]
[[instrument]]
name     = "lamp"
kind     = "lamp"
incision = "temporal"
way      = [{ time = 0, tip = [-4, -1.5, -2.5], active = 1 }]
[[task]]
kind = "peel"
body = "membrane"
instrument = "forceps"
[[view]]
size = [64, 48]
smooth_edges = false
)";

inline Table small_eye() {
  return Table::parse(kSmallEye, "small_eye.toml");
}

}  // namespace supple::tools
