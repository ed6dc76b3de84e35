// Keys of the tables of an operation's scene (docs/operations.md).
#pragma once

#include <string>
#include <vector>

#include "lib/instruments/track.h"
#include "tools/scene/operation/operation_scene.h"
#include "volumes/base/fields.h"

namespace supple::tools {

/// Keys of [operation].
struct RunKeys {
  double step_s = 0.02, duration_s = 0, frames_per_second = 25;
  bool repeats = false;
  int seed = 1;
};
Fields fields(RunKeys& keys);

/// A row of `way`.
struct WayKeys {
  double time_s = 0;
  InstrumentPose pose;
};
Fields fields(WayKeys& keys);

/// Keys of `hand`.
struct HandKeys {
  HandMotion motion;
  int seed = 1;
};
Fields fields(HandKeys& keys);

/// Keys of [[instrument]] beside those of its shape.
struct ToolKeys {
  std::string incision, track;
  Rgb rgb{0.72, 0.74, 0.78};
  Vec3d hinge_mm{0, 0, 0};  // of own parts
};
Fields fields(ToolKeys& keys);

/// Row of `parts` of an [[instrument]] of that kind.
struct PartKeys {
  Vec3d a_mm{0, 0, 0}, b_mm{0, 0, 0};
  NumberPair radii_mm{0.25, 0.25};
  int jaw = 0;
};
Fields fields(PartKeys& keys);

/// Keys of `grip`.
struct GripKeys {
  Vec3d a_mm{0, 0, 0}, b_mm{0, 0, 0.4};
  double radius_mm = 0.08, grips_below_degrees = 6, releases_above_degrees = 10;
};
Fields fields(GripKeys& keys);

/// Keys of `port` of an [[instrument]] of own parts.
Fields fields(SuctionPort& port);
/// Keys of `lamp`.
Fields fields(TipLamp& lamp);
/// What they are where a scene says nothing.
SuctionPort standard_port();
TipLamp standard_lamp();

/// Keys of [[shape]].
struct ShapeKeys {
  std::string name, kind, path;
  Vec3d at{0, 0, 0}, normal{0, 0, 1};
  double radius_mm = 1;
};
Fields fields(ShapeKeys& keys);

/// Keys of `sheet` of a membrane.
struct SheetKeys {
  Vec3d middle{0, 0, -1};
  double radius_mm = 3;
  int nodes = 1500;
};
Fields fields(SheetKeys& keys);

/// Keys of a [[body]] beside those of its model.
struct MembraneKeys {
  std::string kind, name, path;
  MembraneLook look;
};
Fields fields(MembraneKeys& keys);

/// A row of `models` of a [[body]].
Fields fields(ModelChange& change);

/// A row of `keys` of a [[view]].
struct ViewKey {
  double time_s = 0, zoom = 1;
  Vec3d focus_mm{0, 0, 0};
};
Fields fields(ViewKey& key);

/// A row of `incisions` of [eye].
Fields fields(Incision& incision);

/// A table of keys: its name in documents, and where it stands.
struct OperationTable {
  std::string name, where;
  Fields fields;
};
/// All tables; their values live as long as the program.
std::vector<OperationTable> operation_tables();

}  // namespace supple::tools
