// Units and angles. Solvers have mm, kg, s, kPa, mN and uJ (mN mm, kPa mm^3); reports N, mJ and J.
// Memory is in bytes, or in megabytes of a million bytes.
#pragma once

namespace supple {

constexpr double kPi = 3.14159265358979323846;
constexpr double kRadiansPerDegree = kPi / 180, kDegreesPerRadian = 180 / kPi;

constexpr double kMmPerM = 1e3, kMPerMm = 1e-3, kM3PerMm3 = 1e-9, kMlPerMm3 = 1e-3;
constexpr double kSPerMs = 1e-3, kNsPerMs = 1e6;
constexpr double kNPerMn = 1e-3, kMnPerN = 1e3;
constexpr double kPaPerKpa = 1e3;
constexpr double kMjPerUj = 1e-3, kJPerUj = 1e-6, kJPerMj = 1e-3;
constexpr double kMegabyte = 1e6;  // bytes

}  // namespace supple
