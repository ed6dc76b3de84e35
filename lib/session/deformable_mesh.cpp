#include "lib/session/deformable_mesh.h"

#include <algorithm>
#include <map>
#include <stdexcept>

#include "lib/mesh/mesh_edges.h"
#include "volumes/base/error.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/table.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

MeshBody read_body(const MeshSetup& setup) {
  LineNetwork network = read_network(setup.path);
  MergedMesh merged = merge_equal_vertices(network.mesh);
  network.mesh = std::move(merged.mesh);
  std::vector<LinkNodes> kept;
  for (const auto& line : network.lines) {
    const auto end = [&](int n) { return merged.merged_from[std::size_t(line[std::size_t(n)])]; };
    if (end(0) != end(1)) kept.push_back({end(0), end(1)});
  }
  network.lines = std::move(kept);
  try {
    return make_mesh_body(network);
  } catch (const InputError& error) {
    const Problem& problem = error.problem();
    throw InputError({setup.path, problem.field, problem.found, problem.expected});
  }
}

Value flat(const std::vector<Vec3d>& places) {
  Value list = Value::List();
  for (const Vec3d& place : places) {
    for (int c = 0; c < 3; ++c) list.push_back(place[c]);
  }
  return list;
}

template <std::size_t count>
Value flat(const std::vector<std::array<int, count>>& cells) {
  Value list = Value::List();
  for (const auto& cell : cells) {
    for (const int node : cell) list.push_back(node);
  }
  return list;
}

std::vector<Vec3d> places_of(const Value& list) {
  const std::vector<double> numbers = numbers_of(list);
  std::vector<Vec3d> places;
  for (std::size_t n = 0; n + 2 < numbers.size(); n += 3) {
    places.emplace_back(numbers[n], numbers[n + 1], numbers[n + 2]);
  }
  return places;
}

template <std::size_t count>
std::vector<std::array<int, count>> cells_of(const Value& list) {
  std::vector<std::array<int, count>> cells(list.size() / count);
  for (std::size_t n = 0; n < cells.size() * count; ++n) {
    cells[n / count][n % count] = int(list.at(n).whole());
  }
  return cells;
}

NodeSet nodes_of(const Value& list) {
  NodeSet nodes;
  for (const Value& node : list.items()) nodes.push_back(int(node.whole()));
  return nodes;
}

/// The body of a record. Its links hold those of the triangles already.
MeshBody body_of(const Value& record) {
  MeshBody body;
  body.rest_mm = places_of(record["rest"]);
  body.pos_mm = places_of(record["pos"]);
  if (record.contains("velocity")) body.velocity_mm_s = places_of(record["velocity"]);
  body.links = cells_of<2>(record["links"]);
  body.triangles = cells_of<3>(record["triangles"]);
  const auto fits = [&](const auto& cells) {
    return std::all_of(cells.begin(), cells.end(), [&](const auto& cell) {
      return std::all_of(cell.begin(), cell.end(), [&](int node) {
        return node >= 0 && std::size_t(node) < body.node_count();
      });
    });
  };
  const bool is_whole =
      body.node_count() > 0 && body.pos_mm.size() == body.node_count() &&
      (body.velocity_mm_s.empty() || body.velocity_mm_s.size() == body.node_count()) &&
      fits(body.links) && fits(body.triangles) &&
      fits(std::vector<NodeSet>{nodes_of(record["fixed"]), nodes_of(record["held"])});
  if (!is_whole) throw std::invalid_argument("no mesh body");
  return body;
}

}  // namespace

Fields fields(MeshSetup& setup) {
  MeshSpringParams& springs = setup.springs;
  MeshLimits& limits = setup.limits;
  return {
      Field("name", setup.name, "By which steps name the body").required(),
      Field("path", setup.path, "Its mesh: STL, PLY, OBJ or VTK, triangles or lines").path(),
      Field("structural", springs.structural_n_m, "Stiffness of springs along edges")
          .unit("N/m")
          .at_least(0),
      Field("bending", springs.bending_n_m,
            "Stiffness of springs across edges, between opposite corners")
          .unit("N/m")
          .at_least(0),
      Field("damping", springs.damping_n_s_m, "Damping along each spring")
          .unit("N s/m")
          .at_least(0),
      Field("stiffness_damping", springs.stiffness_damping_s, "Rayleigh's beta")
          .unit("s")
          .at_least(0),
      Field("density", springs.density_kg_m3, "Mass per volume").unit("kg/m³").positive(),
      Field("thickness", springs.thickness_mm, "Thickness of its triangles").unit("mm").positive(),
      Field("section", springs.section_mm2, "Area across its lines").unit("mm²").positive(),
      Field("max_length", limits.max_length, "Longest length of an edge, in its rest length")
          .at_least(1),
      Field("min_length", limits.min_length, "Shortest length of an edge").range(0.01, 1),
      Field("max_shear", limits.shear, "Largest move across an edge, in its rest length")
          .at_least(0),
      Field("fix_rim", setup.fixes_rim, "Nodes at the rim of its triangles stay where they are"),
      Field("colour", setup.rgb, "Colour in pictures"),
      Field("opacity", setup.opacity, "Share of the light that a layer stops; 0: not drawn")
          .range(0, 1),
  };
}

DeformableMesh::DeformableMesh(MeshSetup setup)
    : m_setup(std::move(setup)), m_body(read_body(m_setup)) {
  if (m_setup.fixes_rim) m_fixed = rim();
}

DeformableMesh::DeformableMesh(const Value& record, const std::string& file) {
  try {
    Table table(record["setup"], file);
    table.read(fields(m_setup));
    m_body = body_of(record);
    m_fixed = nodes_of(record["fixed"]);
    m_held = nodes_of(record["held"]);
  } catch (const std::logic_error&) {
    throw InputError({file, "bodies", "a record that is none of a mesh body", "a state of supple"});
  }
}

NodeSet DeformableMesh::rim() const {
  std::map<LinkNodes, int> sides;
  for (const TriangleNodes& t : m_body.triangles) {
    for (std::size_t c = 0; c < 3; ++c) {
      const int a = t[c], b = t[(c + 1) % 3];
      ++sides[{std::min(a, b), std::max(a, b)}];
    }
  }
  NodeSet nodes;
  for (const auto& [edge, count] : sides) {
    if (count == 1) add_nodes(nodes, {edge[0], edge[1]});
  }
  return nodes;
}

LineNetwork DeformableMesh::shape() const {
  LineNetwork network{{m_body.pos_mm, m_body.triangles}, {}};
  const std::vector<LinkNodes> sides = unique_edges(m_body.triangles);
  std::set_difference(m_body.links.begin(), m_body.links.end(), sides.begin(), sides.end(),
                      std::back_inserter(network.lines));
  return network;
}

Value DeformableMesh::record() const {
  MeshSetup setup = m_setup;
  Value record{{"setup", fields_value(fields(setup))},
               {"rest", flat(m_body.rest_mm)},
               {"pos", flat(m_body.pos_mm)},
               {"links", flat(m_body.links)},
               {"triangles", flat(m_body.triangles)},
               {"fixed", Value(m_fixed)},
               {"held", Value(m_held)}};
  if (!m_body.velocity_mm_s.empty()) record["velocity"] = flat(m_body.velocity_mm_s);
  return record;
}

std::size_t DeformableMesh::bytes() const {
  return m_body.bytes() + (m_fixed.capacity() + m_held.capacity()) * sizeof(int);
}

int DeformableMesh::nearest_node(const Vec3d& at_lps_mm) const {
  const auto further = [&](const Vec3d& a, const Vec3d& b) {
    return (a - at_lps_mm).length() < (b - at_lps_mm).length();
  };
  const auto nearest = std::min_element(m_body.rest_mm.begin(), m_body.rest_mm.end(), further);
  return int(nearest - m_body.rest_mm.begin());
}

MeshMoveReport DeformableMesh::move(const MeshMove& move, Progress* progress) {
  const auto begin = std::chrono::steady_clock::now();
  const Shape before = kept();
  MeshMoveReport report;
  try {
    if (move.releases) {
      m_fixed = m_setup.fixes_rim ? rim() : NodeSet();
      m_held.clear();
    }
    add_nodes(m_fixed, move.fix);
    remove_nodes(m_held, m_fixed);
    const std::vector<NodeSet> anchors =
        m_fixed.empty() ? std::vector<NodeSet>() : std::vector<NodeSet>{m_fixed};
    const HeldMesh held{m_body, anchors, m_held};
    if (move.springs) {
      move_by_springs(move, held, report, progress);
    } else if (!move.handles.empty()) {
      stage(progress, "solving");
      MeshEcmModel model(held, m_setup.limits);
      model.move(move.handles, 1, progress);
      model.store();
      report.ecm = model.report();
    }
  } catch (...) {
    restore(before);
    throw;
  }
  report.milliseconds = ms_since(begin);
  warn_of(report, move, progress);
  return report;
}

void DeformableMesh::warn_of(const MeshMoveReport& report, const MeshMove& move,
                             Progress* progress) const {
  const std::string body = "body \"" + name() + "\": ";
  if (report.ecm.fraction() < 1) {
    warn(progress, body + "what is held stopped the drag at " +
                       number_text(100 * report.ecm.fraction(), 4) + " %");
  }
  if (report.ecm.projection.violated_links > 0) {
    warn(progress, body + "the start broke " +
                       with_count(report.ecm.projection.violated_links, "link") +
                       " and was projected, by up to " +
                       number_text(report.ecm.projection.max_move_mm, 4) + " mm");
  }
  if (report.residual_mn && *report.residual_mn > move.springs->tolerance_mn) {
    warn(progress, body + "no rest after " + with_count(report.steps, "step") + ", a force of " +
                       number_text(*report.residual_mn, 4) + " mN is left");
  }
}

void DeformableMesh::move_by_springs(const MeshMove& move, const HeldMesh& held,
                                     MeshMoveReport& report, Progress* progress) {
  stage(progress, "springs");
  MeshSpringParams springs = m_setup.springs;
  springs.mass_damping_per_s = move.mass_damping_per_s;
  MeshSpringModel model(held, springs, *move.springs);
  report.springs = model.system().springs.size();
  report.before = model.energy();
  model.move(move.handles, move.steps, progress);
  report.steps = run_model(model, move.steps, progress);
  report.after = model.energy();
  if (move.springs->minimise) {
    report.residual_mn = model.motion().residual_mn();
  } else {
    report.motion = model.motion().report();
  }
  report.reactions = model.reactions(move.handles);
  report.collider_forces_n = model.motion().collider_forces_n();
}

void DeformableMesh::restore(Shape shape) {
  m_body.pos_mm = std::move(shape.pos_mm);
  m_body.velocity_mm_s = std::move(shape.velocity_mm_s);
  m_fixed = std::move(shape.fixed);
  m_held = std::move(shape.held);
}

}  // namespace supple
