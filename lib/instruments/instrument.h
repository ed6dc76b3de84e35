// Rigid surgical instruments of round cones (thesis section 6.1.2, figures 6.6 and 6.7): needle,
// pick, forceps, vitrector, lamp and spatula.
//
// Frame of an instrument: the tip at the origin, the z axis from the tip along the shaft to the
// hand, x and y turned about it by the roll. Jaws turn about the x axis through the hinge, each by
// half of the opening, the one of +1 to +y.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/instruments/round_cone.h"
#include "volumes/base/fields.h"
#include "volumes/base/vec.h"
#include "volumes/io/mesh/triangle_mesh.h"

namespace supple {

enum class InstrumentKind { needle, pick, forceps, vitrector, lamp, spatula, parts };

struct InstrumentPart {
  RoundCone shape;  // in the instrument's frame, a jaw's closed
  int jaw = 0;      // +1 or -1: of that jaw; 0: of the shaft
};

/// Place between the jaws: forceps take hold of points within the radius of its segment.
struct GripZone {
  RoundCone zone;                                              // in the instrument's frame
  double grips_below_degrees = 0, releases_above_degrees = 0;  // opening
};

/// Opening in the side of a vitrector that cuts and sucks.
struct SuctionPort {
  Vec3d centre_mm;  // in the instrument's frame
  Vec3d outward;    // unit
  double radius_mm = 0;
  double reach_mm = 0;  // of what it removes, from its centre
};

/// Light at the tip, which shines along -z.
struct TipLamp {
  double cone_degrees = 0;  // half of the cone of light
};

struct Instrument {
  std::string name;
  InstrumentKind kind = InstrumentKind::needle;
  std::vector<InstrumentPart> parts;
  Vec3d hinge_mm{0, 0, 0};  // of the jaws
  std::optional<GripZone> grip = {};
  std::optional<SuctionPort> port = {};
  std::optional<TipLamp> lamp = {};
  double stiffness_n_m = 100;  // of the hand that presses it against something rigid
};

/// Parts of an instrument of kind `parts`, in its frame; other kinds make their own.
struct InstrumentParts {
  std::vector<InstrumentPart> parts;
  Vec3d hinge_mm{0, 0, 0};
  std::optional<GripZone> grip = {};
  std::optional<SuctionPort> port = {};
  std::optional<TipLamp> lamp = {};
};

/// Measures of an instrument; those that a kind does not have are not looked at.
struct InstrumentSetup {
  std::string name;
  InstrumentKind kind = InstrumentKind::needle;
  double diameter_mm = 0.5;  // of the shaft: 25 gauge
  double length_mm = 30;     // from tip to hand
  double jaw_mm = 1.2;       // length of the jaws
  double suction_mm = 0.6;   // reach of the port
  double cone_degrees = 35;  // half of the lamp's cone
  double stiffness_n_m = 100;
  InstrumentParts own = {};
};
/// Keys of a table [[instrument]] that describe its shape.
Fields fields(InstrumentSetup& setup);

/// Throws InputError for a measure that is not positive, and for own parts that make no instrument.
Instrument make_instrument(const InstrumentSetup& setup);

/// Place of an instrument. `axis` goes from the tip to the hand.
struct InstrumentPose {
  Vec3d tip_mm{0, 0, 0};
  Vec3d axis{0, 0, 1};         // unit
  double roll_degrees = 0;     // about the axis, right-handed
  double opening_degrees = 0;  // between the jaws
  double active = 0;           // 0 … 1: suction and cutting of a vitrector, light of a lamp
};

/// Pose at a part of the way, 0 to 1: all numbers change evenly, the axis along the great circle.
InstrumentPose pose_between(const InstrumentPose& from, const InstrumentPose& to, double part);

/// Axes of an instrument's frame at a pose; at roll 0 those of the world after the shortest turn of
/// z to the axis. Frames go steadily with the axis, but for an axis along -z.
struct ToolFrame {
  Vec3d tip_mm, x, y, z;
  Vec3d place(const Vec3d& local_mm) const {
    return tip_mm + x * local_mm.x + y * local_mm.y + z * local_mm.z;
  }
  Vec3d direction(const Vec3d& local) const { return x * local.x + y * local.y + z * local.z; }
  Vec3d local(const Vec3d& world_mm) const {
    const Vec3d from = world_mm - tip_mm;
    return {from.dot(x), from.dot(y), from.dot(z)};
  }
};
ToolFrame frame_of(const InstrumentPose& pose);

/// Parts in the world at a pose, in their order, jaws opened.
std::vector<RoundCone> parts_at(const Instrument& instrument, const InstrumentPose& pose);

/// Motion of one part in one step: its ends go straight.
struct MovingPart {
  RoundCone from, to;
};

/// Motion of an instrument in one step, as bodies meet it.
struct ToolMotion {
  int tool = 0;  // index among the instruments of the scene
  InstrumentPose from, to;
  std::vector<MovingPart> parts;
};
ToolMotion motion_of(int tool, const Instrument& instrument, const InstrumentPose& from,
                     const InstrumentPose& to);

/// Surface of an instrument for pictures, in its frame with closed jaws: one mesh for the shaft and
/// one for each jaw; of own parts, one for each. Vertices of one mesh are its own.
struct InstrumentMesh {
  TriangleMesh mesh;
  int jaw = 0;
};
std::vector<InstrumentMesh> meshes_of(const Instrument& instrument);
/// Frame in which a mesh of this jaw is placed at a pose.
ToolFrame jaw_frame(const Instrument& instrument, const InstrumentPose& pose, int jaw);

}  // namespace supple
