// Memory and work of finite elements on a voxel body, for plans.
#pragma once

#include "lib/body/slot_set.h"
#include "lib/fem/voxel/fem.h"
#include "lib/material/material.h"
#include "volumes/base/unit_cost.h"

namespace supple {

constexpr UnitCost kFemUnknownCost = {"fem_unknown", 60,
                                      "An unknown of finite elements, per iteration"};

/// Bytes per unknown: of an equilibrium; more at finite strain, of every mode, of every vector that
/// modes are found from, and with mass, damping and what moves. tests/lib/test_model_costs.cpp
/// compares the first with what a solver takes.
constexpr double kFemBytes = 58, kFiniteBytes = 70, kModeBytes = 16, kLanczosBytes = 8,
                 kMotionBytes = 200;

/// Corners of elements, and those of them that no fixed element has.
struct NodeCount {
  double all = 0, free = 0;
};
NodeCount count_nodes(const BrickTopology& elements, const SlotSet& fixed);

struct FemWish {
  FemParams params;
  int halvings = 0;
  bool has_rigid_pieces = false;
  int modes = 0, motion_steps = 0;  // in place of an equilibrium
};

struct FemWork {
  double unknowns = 0, iterations = 0;
  double bytes = 0;
  double unknown_iterations = 0;  // of kFemUnknownCost, on a body that no cache holds
};

FemWork fem_work(const NodeCount& nodes, const FemWish& wish, const MaterialTable& material);

/// Work of an equilibrium in unknowns times iterations: setting up the levels is as much as 5
/// iterations more, and every iteration takes what 18,000 unknowns more do.
double fem_work(double unknowns, double iterations);

}  // namespace supple
