#include "lib/session/mesh_step.h"

#include <algorithm>

#include "lib/session/handles/handles.h"
#include "lib/session/spring_step.h"
#include "lib/session/step_model.h"
#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/geometry/pose_path.h"

namespace supple {

namespace {

struct Unknown {
  bool is_given;
  const char* key;
};

/// Refuses the first key that is given and that mesh bodies do not know.
void refuse(std::initializer_list<Unknown> keys, const std::string& place,
            const DeformableMesh& mesh, const char* known) {
  for (const Unknown& key : keys) {
    if (!key.is_given) continue;
    throw InputError(
        {place, key.key, std::string(key.key) + " beside body \"" + mesh.name() + "\"", known});
  }
}

void check(const Step& step, const DeformableMesh& mesh) {
  refuse({{!step.cuts.empty(), "cut"},
          {!step.remove.empty(), "remove"},
          {!step.rigid.empty(), "rigid"},
          {!step.retract.empty(), "retract"},
          {step.limits != Limits::box, "limits"},
          {step.relax.has_value(), "relax"},
          {step.no_relax, "no_relax"},
          {has_own_model(step) && !step.springs, "model"},
          {step.shift_pieces, "shift_pieces"},
          {step.turn_pieces, "turn_pieces"},
          {step.material.has_value(), "material"}},
         step.place, mesh, "handles, fix, release and springs, as mesh bodies know");
}

void check(const PlacedSelection& given, const std::string& place, const DeformableMesh& mesh) {
  refuse({{given.label.has_value(), "label"},
          {given.density.has_value(), "density"},
          {given.piece_at.has_value(), "piece_at"},
          {given.rigid_at.has_value(), "rigid_at"}},
         place, mesh, "voxels, boxes, balls, points or places in mm");
}

void check(const Drag& drag, const std::string& place, const DeformableMesh& mesh) {
  const PlacedHandle& given = *drag.placed;
  const bool turns = std::any_of(given.path.begin(), given.path.end(), [](const PlacedPose& pose) {
    return pose.rotate_deg || pose.scale || pose.scale_axes;
  });
  refuse({{given.rotate_deg || turns, "rotate"},
          {given.scale.has_value(), "scale"},
          {given.scale_axes.has_value(), "scale_axes"},
          {drag.soft_mm > 0, "soft"},
          {given.points && given.radius_mm, "radius"},
          {drag.spares_fixed, "spare_fixed"},
          {drag.slides, "slide"}},
         place, mesh, "handles that only shift");
}

/// The nodes of a step on one mesh.
class NodeFinder {
 public:
  NodeFinder(const DeformableMesh& mesh, const Geometry& geometry, const std::string& place)
      : m_mesh(mesh), m_geometry(geometry), m_place(place) {}

  NodeSet nodes_of(const PlacedSelection& given) const {
    check(given, m_place, m_mesh);
    if (given.at_lps_mm) return {m_mesh.nearest_node(*given.at_lps_mm)};
    if (given.points) {
      NodeSet nodes;
      for (const PointFile::Row& row : given.points->rows) {
        add_nodes(nodes, {m_mesh.nearest_node(row.at_lps_mm)});
      }
      return nodes;
    }
    if (given.ball) return nodes_of_ball(given);
    return nodes_of_box(given);
  }

 private:
  Vec3d world_of(const Vec3d& place, PlaceFrame frame) const {
    return m_geometry.world_from_index(index_of(place, frame, m_geometry));
  }

  NodeSet nodes_of_ball(const PlacedSelection& given) const {
    const Vec3d centre = world_of(*given.ball, given.frame);
    const double radius = given.radius_mm.value_or(0);
    return required(
        m_mesh.nodes_where([&](const Vec3d& at) { return (at - centre).length() <= radius; }),
        centre, "a ball of " + number_text(radius) + " mm");
  }

  NodeSet nodes_of_box(const PlacedSelection& given) const {
    const Vec3d a = given.corners.value()[0], b = (*given.corners)[1];
    if (a == b) return {m_mesh.nearest_node(world_of(a, given.frame))};
    // Voxels reach half of one beyond their centres.
    const double beyond = given.frame == PlaceFrame::voxel ? 0.5 : 0;
    const auto inside = [&](const Vec3d& at) {
      const Vec3d index = m_geometry.index_from_world(at);
      const Vec3d place = given.frame == PlaceFrame::voxel ? index
                          : given.frame == PlaceFrame::lps ? at
                                                           : Vec3d(-at.x, -at.y, at.z);
      for (int c = 0; c < 3; ++c) {
        if (place[c] < std::min(a[c], b[c]) - beyond) return false;
        if (place[c] > std::max(a[c], b[c]) + beyond) return false;
      }
      return true;
    };
    return required(m_mesh.nodes_where(inside), world_of((a + b) / 2, given.frame), "a box");
  }

  NodeSet required(NodeSet nodes, const Vec3d& middle, const std::string& found) const {
    if (!nodes.empty()) return nodes;
    const Vec3d& nearest = m_mesh.body().rest_mm[std::size_t(m_mesh.nearest_node(middle))];
    throw InputError(
        {m_place, "body \"" + m_mesh.name() + "\"", found + " without a node",
         "one with nodes; the nearest to its middle is at " + to_text(nearest) + " mm LPS"});
  }

  const DeformableMesh& m_mesh;
  const Geometry& m_geometry;
  const std::string& m_place;
};

/// The shift of a handle in mm, LPS.
Vec3d shift_of(const PlacedHandle& given, const Geometry& geometry, double time) {
  if (!given.path.empty()) {
    const Vec3d along_grid_mm = path_of(given, geometry).at(time).shift_mm;
    return lps_of(along_grid_mm, PlaceFrame::voxel, geometry);
  }
  if (given.by_lps_mm) return *given.by_lps_mm;
  return lps_of(given.by.value_or(Vec3d(0)), given.frame, geometry);
}

std::vector<MeshHandle> handles_of(const Drag& drag, const NodeFinder& finder,
                                   const DeformableMesh& mesh, const Geometry& geometry,
                                   double time) {
  const PlacedHandle& given = *drag.placed;
  const HandleKind kind = drag.pushes ? HandleKind::push : HandleKind::two_sided;
  if (!given.points || !given.points->has_displacements) {
    return {{finder.nodes_of(given), shift_of(given, geometry, time), kind}};
  }
  std::vector<MeshHandle> handles;
  for (const PointFile::Row& row : given.points->rows) {
    handles.push_back({{mesh.nearest_node(row.at_lps_mm)}, row.by_lps_mm, kind});
  }
  return handles;
}

}  // namespace

MeshMove mesh_move(const Step& step, const DeformableMesh& mesh, const Geometry& geometry,
                   double time) {
  check(step, mesh);
  const NodeFinder finder(mesh, geometry, step.place);
  MeshMove move;
  for (const Drag& drag : step.drags) {
    if (!drag.placed) {
      throw InputError({step.place, "grab", "elements of a grid",
                        "a place, as nodes of body \"" + mesh.name() + "\" are found by"});
    }
    check(drag, step.place, mesh);
    for (MeshHandle& handle : handles_of(drag, finder, mesh, geometry, time)) {
      move.handles.push_back(std::move(handle));
    }
  }
  for (const ChosenPart& part : step.fix) {
    refuse({{!part.placed && part.box() == nullptr, "fix"}}, step.place, mesh,
           "voxels, boxes, balls, points or places in mm");
    PlacedSelection given = part.placed.value_or(PlacedSelection());
    if (!part.placed) given.corners = {Vec3d(part.box()->lo), Vec3d(part.box()->hi)};
    add_nodes(move.fix, finder.nodes_of(given));
  }
  move.releases = step.release;
  if (!step.springs) return move;
  move.springs = step.springs->motion;
  move.mass_damping_per_s = step.springs->mass_damping_per_s;
  move.steps = step.springs->is_motion() ? step.springs->motion_steps() : step.springs->most_steps;
  if (step.springs->is_motion()) move.springs->step_s = step.springs->time_s / move.steps;
  refuse({{step.springs->structural_n_m.has_value(), "structural"},
          {step.springs->shear_n_m.has_value(), "shear"},
          {step.springs->bending_n_m.has_value(), "bending"}},
         step.place, mesh, "stiffnesses of its [[body]]");
  return move;
}

Value to_value(const MeshRecord& record, const Step& step) {
  const MeshMove& move = record.move;
  Value value{{"body", step.body}};
  for (const MeshHandle& handle : move.handles) {
    Value& written = value["handles"].push_back({{"nodes", Value(handle.nodes)}});
    written["by_mm_lps"] = handle.by_mm;
    if (handle.kind == HandleKind::push) written["push"] = true;
  }
  if (!move.fix.empty()) value["fix_nodes"] = Value(move.fix);
  if (move.releases) value["release"] = true;
  if (step.springs) value["springs"] = settings_value(*step.springs);
  if (!step.springs && !move.handles.empty()) value["fraction"] = record.report.ecm.fraction();
  return value;
}

}  // namespace supple
