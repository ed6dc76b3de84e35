// Memory and work of a picture by rays, for plans.
#pragma once

#include "raycast/sample/source_bricks.h"
#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kSourceBrickCost = {"source_brick", 250,
                                       "A brick of the volume as pictures read it"};
constexpr UnitCost kRayCost = {"ray", 900, "A pixel beside its samples"};
constexpr UnitCost kSampleCost = {"sample", 35, "A sample of a ray"};

constexpr double kSourceBytes = 2 * SourceBricks::kBrickNodes;  // of a brick that rays read
/// Bytes of a deformed brick: 9 nodes along each edge, with floats, or with halves where few move.
constexpr double kNodeBytes = 9 * 9 * 9 * 3 * sizeof(float), kHalfNodeBytes = 1500;
constexpr double kTableBytes = 75;  // of any brick in the tables of a renderer
constexpr double kPixelBytes = 16 + 4 + 4, kAuxiliaryBytes = 28;
constexpr double kCutSample = 4, kCubicSample = 4;  // in usual samples
/// Bytes that threads keep ready in a picture of a body that moves, and of a brick that does.
constexpr double kSlotsInAdvance = 4.5e6, kSlotBytes = 20e3;

}  // namespace supple
