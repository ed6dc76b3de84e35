#include "tools/scene/operation/operation_keys.h"

namespace supple::tools {

Fields fields(RunKeys& keys) {
  return {
      Field("step", keys.step_s, "Time of a step").unit("s").positive(),
      Field("duration", keys.duration_s, "Time until the operation ends")
          .unit("s")
          .at_least(0)
          .otherwise("until the last track ends"),
      Field("repeat", keys.repeats, "Tracks begin again when they end"),
      Field("seed", keys.seed, "Seed of generated tissue").at_least(0),
      Field("frames_per_second", keys.frames_per_second, "Pictures of videos per second")
          .positive(),
  };
}

Fields fields(WayKeys& keys) {
  InstrumentPose& pose = keys.pose;
  return {
      Field("time", keys.time_s, "Time of the key").unit("s").required(),
      Field("tip", pose.tip_mm, "Place of the tip").unit("mm").required(),
      Field("axis", pose.axis, "Direction from the tip to the hand")
          .otherwise("through the incision"),
      Field("roll", pose.roll_degrees, "Turn about the axis").unit("degrees"),
      Field("opening", pose.opening_degrees, "Angle between the jaws").unit("degrees").range(0, 90),
      Field("active", pose.active, "Suction of a vitrector, light of a lamp").range(0, 1),
  };
}

Fields fields(HandKeys& keys) {
  HandMotion& hand = keys.motion;
  return {
      Field("bandwidth", hand.bandwidth_hz, "Frequency to which the way is smoothed")
          .unit("Hz")
          .positive(),
      Field("tremor", hand.tremor_mm, "Tremor of the tip, root mean square per axis")
          .unit("mm")
          .at_least(0),
      Field("tremor_lowest", hand.tremor_lowest_hz, "Lowest frequency of the tremor")
          .unit("Hz")
          .positive(),
      Field("tremor_highest", hand.tremor_highest_hz, "Highest frequency of the tremor")
          .unit("Hz")
          .positive(),
      Field("sampling", hand.sampling_hz, "Rate of the tracking").unit("Hz").positive(),
      Field("latency", hand.latency_s, "Latency of the tracking").unit("s").at_least(0),
      Field("seed", keys.seed, "Seed of the tremor").at_least(0),
  };
}

Fields fields(ToolKeys& keys) {
  return {
      Field("incision", keys.incision, "Incision of the eye through which it goes").otherwise(""),
      Field("track", keys.track, "Its poses over time, a table (.csv)").path().otherwise(""),
      Field("colour", keys.rgb, "Colour in pictures"),
      Field("hinge", keys.hinge_mm, "Of own parts: where jaws turn, about an axis along x")
          .unit("mm"),
  };
}

Fields fields(PartKeys& keys) {
  return {
      Field("a", keys.a_mm, "Centre of its first ball; the tip is at 0, +z goes to the hand")
          .unit("mm")
          .required(),
      Field("b", keys.b_mm, "Centre of its second ball").unit("mm").required(),
      Field("radii", keys.radii_mm, "Radii of the two balls").unit("mm").positive(),
      Field("jaw", keys.jaw, "1 or -1: of the jaw that opens to +y or -y; 0: of the shaft")
          .range(-1, 1),
  };
}

Fields fields(GripKeys& keys) {
  return {
      Field("a", keys.a_mm, "One end of the line between the closed jaws").unit("mm"),
      Field("b", keys.b_mm, "Its other end").unit("mm"),
      Field("radius", keys.radius_mm, "What is so near to the line is held").unit("mm").positive(),
      Field("grips_below", keys.grips_below_degrees, "Opening below which it grips")
          .unit("degrees")
          .positive(),
      Field("releases_above", keys.releases_above_degrees, "Opening above which it lets go")
          .unit("degrees")
          .positive(),
  };
}

Fields fields(SuctionPort& port) {
  return {
      Field("at", port.centre_mm, "Centre of the opening").unit("mm").required(),
      Field("outward", port.outward, "Direction out of the instrument").required(),
      Field("radius", port.radius_mm, "Radius of the opening").unit("mm").positive(),
      Field("reach", port.reach_mm, "What is so near to its centre is removed")
          .unit("mm")
          .positive(),
  };
}

Fields fields(TipLamp& lamp) {
  return {Field("cone", lamp.cone_degrees, "Half of the angle of the cone of light")
              .unit("degrees")
              .range(1, 89)};
}

Fields fields(ShapeKeys& keys) {
  return {
      Field("name", keys.name, "By which events name it").required(),
      Field("kind", keys.kind, "Shape; a hollow one is free inside")
          .one_of({"sphere", "hollow", "plane", "mesh"})
          .required(),
      Field("at", keys.at, "Centre, a point of the plane, or the shift of the mesh").unit("mm"),
      Field("normal", keys.normal, "Direction of a plane's free side"),
      Field("radius", keys.radius_mm, "Radius").unit("mm").positive(),
      Field("path", keys.path, "Mesh: STL, PLY, OBJ or VTK").path().otherwise(""),
  };
}

Fields fields(SheetKeys& keys) {
  return {
      Field("middle", keys.middle, "Direction of its middle from the eye's centre"),
      Field("radius", keys.radius_mm, "Radius of the sheet").unit("mm").positive(),
      Field("nodes", keys.nodes, "Least number of nodes").range(7, 100000),
  };
}

Fields fields(MembraneKeys& keys) {
  return {
      Field("kind", keys.kind, "Kind of body").one_of({"membrane"}).required(),
      Field("name", keys.name, "By which events and tasks name it").required(),
      Field("path", keys.path, "Mesh: STL, PLY, OBJ or VTK").path().otherwise("a sheet"),
      Field("colour", keys.look.rgb, "Colour in pictures"),
      Field("opacity", keys.look.opacity, "Opacity in pictures").range(0, 1),
  };
}

Fields fields(ModelChange& change) {
  return {
      Field("time", change.time_s, "Time from which on it holds").unit("s").positive().required(),
      Field("model", change.model, {"springs", "ecm"}, "Model that moves the membrane").required(),
  };
}

Fields fields(ViewKey& key) {
  return {
      Field("time", key.time_s, "Time of the key").unit("s").required(),
      Field("focus", key.focus_mm, "Place that is in focus").unit("mm").otherwise("the view's"),
      Field("zoom", key.zoom, "Magnification").positive(),
  };
}

Fields fields(Incision& incision) {
  return {
      Field("name", incision.name, "By which instruments name it").required(),
      Field("at", incision.place_mm, "Direction from the centre of the globe").required(),
  };
}

Fields fields(MicroscopeView& view) {
  return {
      Field("image", view.image, "Picture of the end").shown_as("F.png").otherwise(""),
      Field("video", view.video, "All of it: .mp4, .webm, .avi or numbered a_%04d.png")
          .shown_as("F")
          .otherwise(""),
      Field("focus", view.focus_mm, "Place that is in focus").unit("mm"),
      Field("from", view.from, "Direction from the focus to the microscope"),
      Field("up", view.up, "Direction that is up in the picture"),
      Field("distance", view.distance_mm, "Distance from the focus").unit("mm").positive(),
      Field("field", view.field_mm, "Height that is seen at the focus").unit("mm").positive(),
      Field("eye_separation", view.eye_separation_mm, "Distance of the eyes of a stereo pair")
          .unit("mm")
          .positive(),
      Field("stereo", view.stereo, {"none", "side_by_side", "anaglyph", "two_streams"},
            "One picture, or a pair and how it is shown"),
      Field("shadow", view.shadow, {"none", "hard", "soft"}, "Shadow of the lamp"),
      Field("size", view.size, "Size of one picture").unit("pixels").range(16, 8192),
      Field("smooth_edges", view.smooth_edges, "Four samples per pixel at edges"),
      Field("vitreous_part", view.vitreous_part,
            "The vitreous is marched at the width divided by this; 0: not drawn")
          .range(0, 16),
      Field("ambient", view.ambient, "Light without the lamp").range(0, 1),
      Field("eyepiece", view.eyepiece, "Dark outside of the largest circle"),
  };
}

Fields fields(OperationOutput& output) {
  return {
      Field("log", output.log, "Log of steps and events, JSON lines")
          .shown_as("F.jsonl")
          .otherwise(""),
      Field("score", output.score, "Scores with what was measured")
          .shown_as("F.json")
          .otherwise(""),
      Field("tracks", output.tracks, "Poses that hands asked for, %s being the instrument")
          .shown_as("F_%s.csv")
          .otherwise(""),
  };
}

SuctionPort standard_port() {
  return {{0, 0.25, 0.55}, {0, 1, 0}, 0.175, InstrumentSetup().suction_mm};
}

TipLamp standard_lamp() {
  return {InstrumentSetup().cone_degrees};
}

std::vector<OperationTable> operation_tables() {
  static RunKeys run;
  static EyeSetup eye;
  static Incision incision;
  static InstrumentSetup instrument;
  static ToolKeys tool;
  static WayKeys way;
  static HandKeys hand;
  static PartKeys part;
  static GripKeys grip;
  static SuctionPort port = standard_port();
  static TipLamp lamp = standard_lamp();
  static ShapeKeys shape;
  static MembraneKeys membrane;
  static MembraneParams params;
  static SheetKeys sheet;
  static VitreousSetup vitreous;
  static ModelChange change;
  static TaskSetup task;
  static TaskTarget target;
  static ScoreRule rule;
  static MicroscopeView view;
  static ViewKey key;
  static OperationOutput output;
  Fields instruments = supple::fields(instrument), bodies = fields(membrane);
  const Fields more = fields(tool), springs = supple::fields(params);
  instruments.insert(instruments.end(), more.begin(), more.end());
  bodies.insert(bodies.end(), springs.begin(), springs.end());
  return {
      {"operation", "[operation]", fields(run)},
      {"eye", "[eye] of an operation", supple::fields(eye)},
      {"incisions", "incisions = [{ … }] of [eye]", fields(incision)},
      {"instrument", "[[instrument]] of an operation", instruments},
      {"way", "way = [{ … }] of an [[instrument]]", fields(way)},
      {"hand", "hand = { … } of an [[instrument]]", fields(hand)},
      {"parts", "parts = [{ … }] of an [[instrument]]", fields(part)},
      {"grip", "grip = { … } of an [[instrument]] of parts", fields(grip)},
      {"port", "port = { … } of an [[instrument]] of parts", fields(port)},
      {"tip_lamp", "lamp = { … } of an [[instrument]] of parts", fields(lamp)},
      {"shape", "[[shape]] of an operation", fields(shape)},
      {"membrane", "[[body]] of an operation", bodies},
      {"sheet", "sheet = { … } of a [[body]] of an operation", fields(sheet)},
      {"models", "models = [{ … }] of a [[body]] of an operation", fields(change)},
      {"vitreous", "[vitreous] of an operation", supple::fields(vitreous)},
      {"task", "[[task]] of an operation", supple::fields(task)},
      {"target", "targets = [{ … }] of a [[task]]", supple::fields(target)},
      {"score", "[[score]] of an operation", supple::fields(rule)},
      {"microscope", "[[view]] of an operation", fields(view)},
      {"microscope_keys", "keys = [{ … }] of a [[view]] of an operation", fields(key)},
      {"operation_output", "[output] of an operation", fields(output)},
  };
}

}  // namespace supple::tools
