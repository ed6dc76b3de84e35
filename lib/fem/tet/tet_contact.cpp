#include "lib/fem/tet/tet_contact.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "lib/fem/conjugate_gradients.h"
#include "lib/fem/tet/shell_surface.h"
#include "lib/fem/tet/tet_system.h"
#include "volumes/base/stopwatch.h"
#include "volumes/base/units.h"

namespace supple {

namespace {

/// Rounds in which all nodes that pull are let go.
constexpr int kEagerRounds = 6;
/// Cosine of the angle to which the shell counts as turning along a slide.
constexpr double kLeastSlope = 0.2;
/// The smallest part of the way to new bounds that is gone at once.
constexpr double kLeastPart = 1.0 / 16;
/// Nodes that are so far beyond the shell do not come back.
constexpr double kLostMm = 1000;
/// Nodes that are so little beyond their bound are on it.
constexpr double kRoundingMm = 1e-7;

/// Rows: a normal, and two directions across it.
Matrix9 frame_along(const Vec3d& normal) {
  const int least = std::abs(normal.x) <= std::min(std::abs(normal.y), std::abs(normal.z)) ? 0
                    : std::abs(normal.y) <= std::abs(normal.z)                             ? 1
                                                                                           : 2;
  Vec3d axis(0);
  axis[least] = 1;
  const Vec3d b = normal.cross(axis).normalized(), c = normal.cross(b);
  return {normal.x, normal.y, normal.z, b.x, b.y, b.z, c.x, c.y, c.z};
}

Vec3d vector_at(const std::vector<double>& values, NodeIndex node) {
  const double* of = &values[3 * std::size_t(node)];
  return {of[0], of[1], of[2]};
}
void set_vector(const Vec3d& of, NodeIndex node, std::vector<double>& values) {
  for (int a = 0; a < 3; ++a) values[3 * std::size_t(node) + std::size_t(a)] = of[a];
}
Vec3d into(const Matrix9& q, const Vec3d& x) {
  return {q[0] * x.x + q[1] * x.y + q[2] * x.z, q[3] * x.x + q[4] * x.y + q[5] * x.z,
          q[6] * x.x + q[7] * x.y + q[8] * x.z};
}
Vec3d out_of(const Matrix9& q, const Vec3d& x) {
  return {q[0] * x.x + q[3] * x.y + q[6] * x.z, q[1] * x.x + q[4] * x.y + q[7] * x.z,
          q[2] * x.x + q[5] * x.y + q[8] * x.z};
}

/// The state of the rounds.
class ShellRounds {
 public:
  ShellRounds(const TetModel& model, const TetLoads& loads, const TetShellContact& shell,
              const TetParams& params)
      : m_model(model),
        m_shell(shell),
        m_params(params),
        m_loads(model.nodal_loads(loads)),
        m_surface(model.node_positions(), model.parts_of_faces(shell.faces)),
        m_bound_of(std::size_t(model.node_count()), -1),
        m_frames(std::size_t(model.node_count()), kIdentity9) {
    HeldBits held = m_loads.held;
    if (model.hold_loose(false, held).loose_islands > 0) {
      throw InputError({"", "held", "too little beside the shell",
                        "nodes that prevent rigid motions, such as those of the brain stem"});
    }
    find_bounds();
    m_turned = std::make_unique<BlockCsr>(model.stiffness().in_frames(m_frames));
    m_u = m_loads.u_mm;
  }

  TetContactSolution run(const TetLoads& loads, Progress* progress);

 private:
  struct Bound {
    NodeIndex node;
    ShellSurface::Place place;  // nearest now
    Vec3d normal{0, 0, 0};      // of the shell where the node rests
    Matrix9 frame{};
    double limit_mm = 0;  // of u along the normal
    bool presses = true;
    double force_mn = 0;
  };
  void find_bounds();
  void solve(Progress* progress);
  bool change_pressing(int round);
  bool move_bounds();
  void write_report(const TetLoads& loads, TetContactSolution& out) const;

  const TetModel& m_model;
  const TetShellContact& m_shell;
  TetParams m_params;
  NodalLoads m_loads;
  ShellSurface m_surface;
  std::vector<Bound> m_bounds;
  std::vector<std::int32_t> m_bound_of;
  std::vector<Matrix9> m_frames;       // of all nodes
  std::unique_ptr<BlockCsr> m_turned;  // the stiffness in them
  std::vector<double> m_u, m_r;        // f - K u
  FemReport m_report;
  double m_deepest_mm = 0;
  double m_off_mm = 1e300, m_part = 1;  // of the way to new bounds: less where nodes come away
  int m_rounds = 0;
};

void ShellRounds::find_bounds() {
  std::vector<char> is_free(m_bound_of.size(), 0);
  for (const std::string& name : m_shell.openings) {
    for (const NodeIndex node : m_model.nodes_of_faces(name)) {
      is_free[std::size_t(node)] = m_shell.frees_rims;
    }
  }
  for (NodeIndex node = 0; node < NodeIndex(m_model.place_count()); ++node) {
    const std::int32_t triangle = m_surface.triangle_at(node);
    if (triangle < 0 || is_free[std::size_t(node)] || m_loads.held[std::size_t(node)] != 0)
      continue;
    m_bound_of[std::size_t(node)] = std::int32_t(m_bounds.size());
    Bound bound;
    bound.node = node;
    bound.normal = m_surface.normal_at(node);
    bound.place = {m_model.volumes().positions()[std::size_t(node)], bound.normal, triangle};
    bound.frame = frame_along(bound.normal);
    m_frames[std::size_t(node)] = bound.frame;
    m_bounds.push_back(bound);
  }
}

/// Solves in the frames of the nodes, those that press held at their limits.
void ShellRounds::solve(Progress* progress) {
  NodalLoads loads = m_loads;
  loads.u_mm = m_u;
  loads.nodes_of.clear();
  for (const Bound& bound : m_bounds) {
    const std::size_t node = std::size_t(bound.node);
    set_vector(into(bound.frame, vector_at(m_loads.force_mn, bound.node)), bound.node,
               loads.force_mn);
    Vec3d u = into(bound.frame, vector_at(m_u, bound.node));
    if (bound.presses) {
      loads.held[node] = 1;
      u.x = bound.limit_mm;
    }
    set_vector(u, bound.node, loads.u_mm);
  }
  TetSystem system(*m_turned, loads.held);
  ConjugateGradients solver(
      system, loads, {m_params.tolerance, m_params.reaction_tolerance, m_params.max_iterations});
  const bool is_found = solver.run(progress);
  m_report.iterations += solver.iterations();
  note(solver.size(), m_report);
  if (!is_found) throw NotConverged(m_report);
  m_u = solver.u();
  m_r = solver.residual();
  for (Bound& bound : m_bounds) {
    bound.force_mn = bound.presses ? m_r[3 * std::size_t(bound.node)] : 0;
    set_vector(out_of(bound.frame, vector_at(m_u, bound.node)), bound.node, m_u);
    set_vector(out_of(bound.frame, vector_at(m_r, bound.node)), bound.node, m_r);
  }
}

/// Decides by the bounds of this round which nodes press; false when these are the same. After
/// some rounds only the nodes that pull most are let go, as many at once may come back by turns.
bool ShellRounds::change_pressing(int round) {
  double most_mn = 0, pull_mn = 0;
  for (const Bound& bound : m_bounds) {
    most_mn = std::max(most_mn, std::abs(bound.force_mn));
    pull_mn = std::max(pull_mn, -bound.force_mn);
  }
  const double rounding_mn = 10 * m_params.tolerance * most_mn;
  const double least_pull_mn = std::max(rounding_mn, round > kEagerRounds ? 0.5 * pull_mn : 0);
  bool has_changed = false;
  for (Bound& bound : m_bounds) {
    const Vec3d u = vector_at(m_u, bound.node);
    const bool pulls = bound.presses && bound.force_mn < -least_pull_mn;
    const bool enters = !bound.presses && bound.normal.dot(u) - bound.limit_mm > kRoundingMm;
    bound.presses = bound.presses ? !pulls : enters;
    has_changed = has_changed || pulls || enters;
  }
  return has_changed;
}

/// Sets the bounds anew by where the shell is from where nodes are now, along their normals; false
/// when no node is off by more than is allowed.
bool ShellRounds::move_bounds() {
  double most_off_mm = 0;  // of nodes that press, on either side
  m_deepest_mm = 0;
  for (Bound& bound : m_bounds) {
    const Vec3d u = vector_at(m_u, bound.node);
    const Vec3d x = m_model.volumes().positions()[std::size_t(bound.node)] + u;
    bound.place = m_surface.nearest(x, bound.place.triangle);
    const double beyond_mm = bound.place.normal.dot(x - bound.place.point);
    m_deepest_mm = std::max(m_deepest_mm, beyond_mm);
    if (bound.presses) most_off_mm = std::max(most_off_mm, std::abs(beyond_mm));
    const double slope = std::max(kLeastSlope, bound.normal.dot(bound.place.normal));
    const double limit_mm = bound.normal.dot(u) - beyond_mm / slope;
    bound.limit_mm += m_part * (limit_mm - bound.limit_mm);
  }
  const double off_mm = std::max(m_deepest_mm, most_off_mm);
  if (m_shell.has_planes || off_mm <= m_shell.tolerance_mm) return false;
  m_part = off_mm > m_off_mm ? std::max(kLeastPart, m_part / 2) : std::min(1.0, m_part * 1.25);
  m_off_mm = off_mm;
  return true;
}

TetContactSolution ShellRounds::run(const TetLoads& loads, Progress* progress) {
  const Stopwatch clock;
  stage(progress, "solving");
  do {
    int round = 0;
    do {
      poll(progress);
      if (m_rounds >= m_shell.max_rounds || m_deepest_mm > kLostMm) {
        throw Error("contact with a shell: no end after " + std::to_string(m_rounds) +
                    " rounds, nodes are up to " + number_text(m_deepest_mm) +
                    " mm beyond it; expected smaller loads, or planes in place of the shell");
      }
      solve(progress);
      ++m_rounds;
    } while (change_pressing(++round));
  } while (move_bounds());
  TetContactSolution out;
  m_report.solve_ms = clock.ms();
  write_report(loads, out);
  return out;
}

void ShellRounds::write_report(const TetLoads& loads, TetContactSolution& out) const {
  ShellContactReport& report = out.report;
  report.rounds = m_rounds;
  report.deepest_mm = m_deepest_mm;
  report.nodes = std::int64_t(m_bounds.size());
  Vec3d sum(0);
  double lengths = 0;
  const auto add_force = [&](const Vec3d& force) {
    sum += force;
    lengths += force.length();
  };
  for (const Bound& bound : m_bounds) {
    const double pressure = bound.force_mn / m_surface.area_at(bound.node);
    out.nodes.push_back(bound.node);
    out.pressure_kpa.push_back(pressure);
    const Vec3d pressed = bound.force_mn == 0 ? Vec3d(0) : vector_at(m_r, bound.node);
    report.force_n += pressed * kNPerMn;
    add_force(-pressed);
    report.pressing += bound.force_mn > 0;
    report.pressed_area_mm2 += bound.force_mn > 0 ? m_surface.area_at(bound.node) : 0;
    report.largest_pressure_kpa = std::max(report.largest_pressure_kpa, pressure);
  }
  for (NodeIndex node = 0; node < NodeIndex(m_model.place_count()); ++node) {
    add_force(vector_at(m_loads.force_mn, node));
    Vec3d reaction(0);
    for (int a = 0; a < 3; ++a) {
      const bool is_held = (m_loads.held[std::size_t(node)] >> a & 1) != 0;
      if (is_held) reaction[a] = -m_r[3 * std::size_t(node) + std::size_t(a)];
    }
    add_force(reaction);
  }
  report.force_balance = lengths > 0 ? sum.length() / lengths : 0;
  for (const std::string& name : m_shell.openings) {
    ShellOpening opening{name, m_model.area_of_faces(name), 0};
    for (const auto& face : m_model.parts_of_faces({name})) {
      const bool is_free = std::all_of(face.begin(), face.end(), [&](NodeIndex node) {
        return m_bound_of[std::size_t(node)] < 0 && m_loads.held[std::size_t(node)] == 0;
      });
      if (is_free) opening.free_area_mm2 += m_model.area_of(face);
    }
    report.openings.push_back(opening);
  }
  out.solution.u_mm = m_u;
  out.solution.report = m_report;
  out.solution.report.elements = m_model.element_count();
  out.solution.report.nodes = std::int64_t(m_model.place_count());
  out.solution.reactions = reactions_of(m_model, m_loads, m_r);
  m_model.note_motion(out.solution, loads, m_params.limits);
}

}  // namespace

void TetShellContact::validate() const {
  require(tolerance_mm > 0, "tolerance", tolerance_mm, "above 0 mm");
  require(max_rounds > 0, "max_rounds", max_rounds, "at least 1");
}

TetContactSolution solve_in_shell(const TetModel& model, const TetLoads& loads,
                                  const TetShellContact& shell, const TetParams& params,
                                  Progress* progress) {
  params.validate();
  if (params.strain == StrainTheory::finite) {
    throw InputError({"", "strain", "finite", "linear in a shell"});
  }
  shell.validate();
  return ShellRounds(model, loads, shell, params).run(loads, progress);
}

}  // namespace supple
