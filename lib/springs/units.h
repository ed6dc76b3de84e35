// Springs work in N, kg, s and mm; energies are in J.
#pragma once

namespace supple {

constexpr double kMmPerM = 1e3;
constexpr double kM3PerMm3 = 1e-9;

}  // namespace supple
