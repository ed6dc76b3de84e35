#include "lib/membrane/membrane.h"

#include <algorithm>
#include <cmath>

#include "lib/membrane/adhesion.h"
#include "lib/membrane/ecm_sheet.h"
#include "lib/membrane/gripping.h"
#include "lib/membrane/solver.h"
#include "lib/membrane/tearing.h"
#include "volumes/base/error.h"

namespace supple {

namespace {

void validate(const MembraneParams& params) {
  MembraneParams copy = params;
  for (const Field& field : fields(copy)) {
    const auto* number = std::get_if<double*>(&field.target());
    const auto* count = std::get_if<int*>(&field.target());
    const double value = number != nullptr ? **number : count != nullptr ? **count : 1;
    if (number == nullptr && count == nullptr) continue;
    require(std::isfinite(value) && field.allows(value), field.name(), value, field.allowed());
  }
}

int substeps_of(double dt_s, double substep_s) {
  const double count = std::round(dt_s / substep_s);
  require(count >= 1 && count < 1e6 && std::abs(dt_s - count * substep_s) < 1e-6 * substep_s,
          "dt_s", dt_s, "a whole number of substeps of " + number_text(substep_s) + " s");
  return int(count);
}

template <class T>
void append(std::string& bytes, const T* first, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(first), count * sizeof(T));
}

template <class Values>
void append(std::string& bytes, const Values& values) {
  const std::size_t count = values.size();
  append(bytes, &count, 1);
  append(bytes, values.data(), count);
}

/// Joins events of one kind and tool, with the middle of all that they count.
void join(std::vector<MembraneEvent>& events) {
  std::vector<MembraneEvent> joined;
  for (const MembraneEvent& event : events) {
    const auto same = std::find_if(joined.begin(), joined.end(), [&](const MembraneEvent& other) {
      return other.kind == event.kind && other.tool == event.tool &&
             event.kind != MembraneEvent::Kind::piece_lost;
    });
    if (same == joined.end()) {
      joined.push_back(event);
      continue;
    }
    const double part = double(event.count) / double(event.count + same->count);
    same->place_mm += (event.place_mm - same->place_mm) * part;
    same->count += event.count;
  }
  events = std::move(joined);
}

}  // namespace

struct Membrane::Impl {
  std::string name;
  MembraneParams params;
  SheetGround ground;
  ToolPush push;
  Sheet sheet;
  std::unique_ptr<EcmSheet> ecm;             // where that is the model
  std::vector<char> is_closed;               // per tool
  double edge_mm = 0;                        // longest at rest
  std::vector<char> is_touched, is_pinched;  // per node, of this step

  Impl(const TriangleMesh& mesh, const MembraneParams& given, std::vector<Obstacle> under,
       std::string its_name)
      : name(std::move(its_name)),
        params(given),
        ground((validate(given), std::move(under)), given.thickness_mm),
        push(given.thickness_mm) {
    TriangleMesh settled = mesh;
    const std::vector<char> is_near =
        ground.settle(settled.vertices_lps_mm, 3 * params.thickness_mm);
    sheet = make_sheet(settled, params);
    if (params.adhesion_j_m2 > 0) sheet.clings = is_near;
    for (const SheetSpring& s : sheet.springs) edge_mm = std::max(edge_mm, s.rest_mm);
    take_model(params.model);
  }

  void take_model(MembraneModel model) {
    params.model = model;
    ecm = model == MembraneModel::ecm ? std::make_unique<EcmSheet>(sheet) : nullptr;
    if (ecm) sheet.body.velocity_mm_s.assign(sheet.body.node_count(), Vec3d(0.0));
  }

  /// Puts nodes that forceps hold where these are at a part of the step.
  void grip_all(const std::vector<ToolMotion>& tools, const std::vector<Instrument>& instruments,
                double part, MembraneReport& report) {
    for (const ToolMotion& motion : tools) {
      grip(sheet, params, motion.tool, instruments.at(std::size_t(motion.tool)),
           pose_between(motion.from, motion.to, part), is_closed, report);
    }
  }

  void count_contacts() {
    is_touched.resize(std::size_t(sheet.node_count()), 0);
    is_pinched.resize(std::size_t(sheet.node_count()), 0);
    push.each_pushed([&](int node) {
      is_touched[node] = 1;
      is_pinched[node] |= ground.pushes_mm()[node].length2() > 0;
    });
  }

  void step_springs(int count, const std::vector<ToolMotion>& tools,
                    const std::vector<Instrument>& instruments, MembraneReport& report) {
    const double h = params.substep_s, weight = 1.0 / count;
    std::vector<Vec3d> by_tool_mn, by_motion_mn(tools.size(), Vec3d(0.0));
    const std::int64_t version = sheet.version;
    for (int n = 0; n < count; ++n) {
      const double part = double(n + 1) / count;
      sheet.start_mm = sheet.body.pos_mm;
      grip_all(tools, instruments, part, report);
      predict(sheet, params);
      push.begin(sheet, tools, double(n) / count, part, edge_mm);
      solve(sheet, params, {ground, push});
      count_contacts();
      push.add_forces(sheet, params, weight, by_motion_mn);
      add_grip_forces(sheet, h, weight, by_tool_mn);
      break_links(sheet, params, h, report);
      tear(sheet, params, h, report);
    }
    for (std::size_t n = 0; n < tools.size(); ++n) {
      const std::size_t tool = std::size_t(tools[n].tool);
      if (tool < by_tool_mn.size()) by_motion_mn[n] += by_tool_mn[tool];
      report.tool_forces_n[n] = by_motion_mn[n] * 1e-3;
    }
    if (sheet.version == version) return;
    lose_pieces(sheet, params, report);
    renew_links(sheet);
  }

  void step_ecm(double dt_s, const std::vector<ToolMotion>& tools,
                const std::vector<Instrument>& instruments, MembraneReport& report) {
    std::vector<Vec3d>& pos = sheet.body.pos_mm;
    sheet.start_mm = pos;
    grip_all(tools, instruments, 1, report);
    ground.begin(sheet);
    push.begin(sheet, tools, 0, 1, edge_mm);
    push.push(sheet);
    std::vector<int> nodes;
    std::vector<Vec3d> targets;
    for (int n = 0; n < sheet.node_count(); ++n) {
      if (sheet.holder[n] < 0 && pos[n] == sheet.start_mm[n]) continue;
      nodes.push_back(n);
      targets.push_back(pos[n]);
    }
    pos = sheet.start_mm;
    ecm->follow(nodes, targets);
    ground.push(sheet);
    count_contacts();
    load_links(sheet, params, dt_s);
    break_links(sheet, params, dt_s, report);
  }
};

Fields fields(MembraneParams& p) {
  return {
      Field("model", p.model, {"springs", "ecm"}, "Model that moves it"),
      Field("stiffness", p.stiffness_n_m, "Young's modulus times thickness").unit("N/m").positive(),
      Field("bending", p.bending_n_m, "Stiffness of springs across edges").unit("N/m").at_least(0),
      Field("density", p.density_kg_m2, "Mass per area").unit("kg/m²").positive(),
      Field("damping", p.damping_per_s, "Damping by the fluid around it").unit("1/s").at_least(0),
      Field("adhesion", p.adhesion_j_m2, "Energy that frees an area").unit("J/m²").at_least(0),
      Field("adhesion_stretch", p.adhesion_mm, "Stretch at which a link of adhesion breaks")
          .unit("mm")
          .positive(),
      Field("strength", p.strength_n_m, "Tension along which edges tear; 0: none")
          .unit("N/m")
          .at_least(0),
      Field("friction", p.friction, "Friction at instruments and at what lies under it")
          .at_least(0),
      Field("substep", p.substep_s, "Fixed length of the solver's steps").unit("s").positive(),
      Field("sweeps", p.sweeps, "Sweeps of the solver in a substep").at_least(2),
      Field("thickness", p.thickness_mm, "Distance that it keeps from what lies under it")
          .unit("mm")
          .positive(),
      Field("smallest_piece", p.smallest_piece_mm2, "Area below which torn-off pieces vanish")
          .unit("mm²")
          .at_least(0),
  };
}

Membrane::Membrane(const TriangleMesh& mesh, const MembraneParams& params,
                   std::vector<Obstacle> under, std::string name)
    : m_impl(std::make_unique<Impl>(mesh, params, std::move(under), std::move(name))) {}
Membrane::~Membrane() = default;
Membrane::Membrane(Membrane&&) noexcept = default;

MembraneReport Membrane::step(double dt_s, const std::vector<ToolMotion>& tools,
                              const std::vector<Instrument>& instruments) {
  MembraneReport report;
  const int count = substeps_of(dt_s, m_impl->params.substep_s);
  report.tool_forces_n.assign(tools.size(), Vec3d(0.0));
  m_impl->is_touched.clear();
  m_impl->is_pinched.clear();
  if (m_impl->ecm) {
    m_impl->step_ecm(dt_s, tools, instruments, report);
  } else {
    m_impl->step_springs(count, tools, instruments, report);
  }
  join(report.events);
  report.contacts = int(std::count(m_impl->is_touched.begin(), m_impl->is_touched.end(), 1));
  report.pinched = int(std::count(m_impl->is_pinched.begin(), m_impl->is_pinched.end(), 1));
  const std::vector<Vec3d>& pos = body().pos_mm;
  for (const SheetSpring& s : m_impl->sheet.springs) {
    report.longest_stretch =
        std::max(report.longest_stretch, (pos[s.b] - pos[s.a]).length() / s.rest_mm);
  }
  report.inverted = inverted_triangles(m_impl->sheet);
  return report;
}

void Membrane::take_model(MembraneModel model) {
  if (model != m_impl->params.model) m_impl->take_model(model);
}

const std::string& Membrane::name() const {
  return m_impl->name;
}
const MeshBody& Membrane::body() const {
  return m_impl->sheet.body;
}
std::int64_t Membrane::topology_version() const {
  return m_impl->sheet.version;
}
const std::vector<char>& Membrane::clings() const {
  return m_impl->sheet.clings;
}

std::vector<int> Membrane::gripped(int tool) const {
  std::vector<int> nodes;
  for (int n = 0; n < m_impl->sheet.node_count(); ++n) {
    if (m_impl->sheet.holder[n] == tool) nodes.push_back(n);
  }
  return nodes;
}

double Membrane::clinging_mm2() const {
  double area = 0;
  for (int n = 0; n < m_impl->sheet.node_count(); ++n) {
    if (m_impl->sheet.clings[n]) area += m_impl->sheet.area_mm2[n];
  }
  return area;
}

double Membrane::torn_mm() const {
  return m_impl->sheet.torn_mm;
}
MembraneEnergy Membrane::energy() const {
  return energy_of(m_impl->sheet, m_impl->params);
}

std::string Membrane::state_bytes() const {
  const Sheet& sheet = m_impl->sheet;
  std::string bytes;
  const int model = int(m_impl->params.model);
  append(bytes, &model, 1);
  append(bytes, sheet.body.rest_mm), append(bytes, sheet.body.pos_mm);
  append(bytes, sheet.body.velocity_mm_s), append(bytes, sheet.body.triangles);
  append(bytes, sheet.holder), append(bytes, sheet.grip_mm), append(bytes, sheet.clings);
  append(bytes, sheet.anchor_mm), append(bytes, sheet.is_torn), append(bytes, m_impl->is_closed);
  for (const SheetSpring& s : sheet.springs) {
    append(bytes, &s.a, 1), append(bytes, &s.b, 1);
    append(bytes, &s.stiffness_n_m, 1);
  }
  append(bytes, &sheet.torn_mm, 1);
  return bytes;
}

}  // namespace supple
