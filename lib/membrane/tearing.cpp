#include "lib/membrane/tearing.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

double angle_between(const Vec3d& a, const Vec3d& b) {
  return std::atan2(a.cross(b).length(), a.dot(b));
}

int copy_node(Sheet& sheet, int node) {
  const auto copy = [&](auto& values) {
    const auto value = values[node];
    values.push_back(value);
  };
  copy(sheet.body.rest_mm), copy(sheet.body.pos_mm), copy(sheet.body.velocity_mm_s);
  copy(sheet.start_mm), copy(sheet.grip_mm), copy(sheet.anchor_mm);
  copy(sheet.area_mm2), copy(sheet.mass_kg), copy(sheet.mobility), copy(sheet.link_multiplier);
  copy(sheet.holder), copy(sheet.clings);
  sheet.is_torn[node] = 1;
  copy(sheet.is_torn);
  sheet.triangles_at.emplace_back();
  sheet.springs_at.emplace_back();
  return sheet.node_count() - 1;
}

/// Area of a node's triangles that have the other node, too.
double area_beside(const Sheet& sheet, int node, int other) {
  double area = 0;
  for (const int t : sheet.triangles_at[node]) {
    const TriangleNodes& nodes = sheet.body.triangles[t];
    if (std::find(nodes.begin(), nodes.end(), other) != nodes.end()) area += sheet.triangle_mm2[t];
  }
  return area;
}

/// Sets a spring between two nodes to the part `area` of what it stood for.
void take_part(SheetSpring& spring, double area, double of_area) {
  spring.stiffness_n_m *= area / of_area;
  spring.width_mm *= area / of_area;
}

/// Gives triangles of a node to a copy of it; returns how many edges that opens.
int split(Sheet& sheet, int node, const std::vector<int>& moved, const MembraneParams& params) {
  const int copy = copy_node(sheet, node);
  std::vector<int>& kept = sheet.triangles_at[node];
  for (const int t : moved) {
    kept.erase(std::find(kept.begin(), kept.end(), t));
    for (int& corner : sheet.body.triangles[t]) corner = corner == node ? copy : corner;
  }
  sheet.triangles_at[copy] = moved;
  std::sort(sheet.triangles_at[copy].begin(), sheet.triangles_at[copy].end());
  int opened = 0;
  std::vector<int> springs;
  springs.swap(sheet.springs_at[node]);
  for (const int n : springs) {
    SheetSpring& spring = sheet.springs[n];
    const int other = spring.a == node ? spring.b : spring.a;
    const double here = area_beside(sheet, node, other), there = area_beside(sheet, copy, other);
    if (there == 0) {
      sheet.springs_at[node].push_back(n);
    } else if (here == 0) {
      (spring.a == node ? spring.a : spring.b) = copy;
      sheet.springs_at[copy].push_back(n);
    } else {
      SheetSpring second = spring;
      (second.a == node ? second.a : second.b) = copy;
      take_part(spring, here, here + there);
      take_part(second, there, here + there);
      sheet.torn_mm += spring.rest_mm;
      const int added = int(sheet.springs.size());
      sheet.springs_at[node].push_back(n);
      for (const int end : {copy, other}) sheet.springs_at[end].push_back(added);
      sheet.springs.push_back(second);
      ++opened;
    }
  }
  weigh(sheet, node, params);
  weigh(sheet, copy, params);
  return opened;
}

/// Splits a node whose triangles hang together at it alone.
void separate(Sheet& sheet, int node, const MembraneParams& params) {
  const std::vector<NodeFan> fans = fans_of(sheet, node);
  for (std::size_t n = 1; n < fans.size(); ++n) split(sheet, node, fans[n].triangles, params);
}

/// Neighbours of a fan along whose edges it parts, and the triangles that go to the copy.
struct Crack {
  std::vector<int> along, triangles;
};

/// Angles at rest from the first neighbour of a fan to each one; the last is that of all triangles.
std::vector<double> angles_of(const Sheet& sheet, int node, const NodeFan& fan) {
  std::vector<double> angles = {0};
  const std::vector<Vec3d>& rest = sheet.body.rest_mm;
  for (const int t : fan.triangles) {
    const TriangleNodes& corners = sheet.body.triangles[t];
    const Vec3d first = rest[corner_after(corners, node)] - rest[node];
    const Vec3d second = rest[corner_before(corners, node)] - rest[node];
    angles.push_back(angles.back() + angle_between(first, second));
  }
  return angles;
}

/// Crack across the edge to `loaded`, from the rim inwards; empty where the fan has none.
Crack crack_of_rim(const NodeFan& fan, const std::vector<double>& angles, int loaded) {
  const auto at = std::find(fan.neighbours.begin(), fan.neighbours.end(), loaded);
  const int load = int(at - fan.neighbours.begin());
  int best = -1;
  double least = HUGE_VAL;
  for (int n = 1; n + 1 < int(fan.neighbours.size()); ++n) {
    const double along = std::abs(std::cos(angles[n] - angles[load]));
    if (n == load || along >= least) continue;
    least = along;
    best = n;
  }
  if (best < 0) return {};
  const auto middle = fan.triangles.begin() + best;
  Crack crack{{fan.neighbours[best]}, {}};
  if (load < best) crack.triangles.assign(fan.triangles.begin(), middle);
  if (load > best) crack.triangles.assign(middle, fan.triangles.end());
  return crack;
}

/// Crack across the edge to `loaded` through a node within the sheet.
Crack crack_within(const NodeFan& fan, const std::vector<double>& angles, int loaded) {
  const int count = int(fan.neighbours.size());
  const auto at = std::find(fan.neighbours.begin(), fan.neighbours.end(), loaded);
  const int load = int(at - fan.neighbours.begin());
  // Steps of the fan from the loaded edge whose angles are nearest to a quarter of all.
  const auto nearest = [&](double part, int from, int to) {
    int best = from;
    double least = HUGE_VAL;
    for (int step = from; step <= to; ++step) {
      const int n = (load + step) % count;
      double angle = angles[n] - angles[load];
      if (angle < 0) angle += angles.back();
      const double off = std::abs(angle - part * angles.back());
      if (off >= least) continue;
      least = off;
      best = step;
    }
    return best;
  };
  const int first = nearest(0.25, 1, count - 2);
  const int second = nearest(0.75, first + 1, count - 1);
  Crack crack{{fan.neighbours[(load + first) % count], fan.neighbours[(load + second) % count]},
              {}};
  for (int step = second; step < count + first; ++step) {
    crack.triangles.push_back(fan.triangles[(load + step) % count]);
  }
  return crack;
}

Crack crack_at(const Sheet& sheet, int node, int loaded) {
  const std::vector<NodeFan> fans = fans_of(sheet, node);
  const std::vector<double> angles = angles_of(sheet, node, fans[0]);
  return fans[0].is_closed ? crack_within(fans[0], angles, loaded)
                           : crack_of_rim(fans[0], angles, loaded);
}

/// Takes a node out of the forceps.
void slip(Sheet& sheet, int node) {
  sheet.holder[node] = -1;
  sheet.mobility[node] = 1 / sheet.mass_kg[node];
}

struct Overload {
  double tension_n_m;
  int spring;
};

std::vector<Overload> overloads_of(const Sheet& sheet, double strength_n_m, double h) {
  std::vector<Overload> overloads;
  for (std::size_t n = 0; n < sheet.springs.size(); ++n) {
    const SheetSpring& s = sheet.springs[n];
    const double tension = -s.multiplier / (h * h * s.width_mm);
    if (tension > strength_n_m) overloads.push_back({tension, int(n)});
  }
  std::sort(overloads.begin(), overloads.end(), [](const Overload& a, const Overload& b) {
    return a.tension_n_m != b.tension_n_m ? a.tension_n_m > b.tension_n_m : a.spring < b.spring;
  });
  return overloads;
}

}  // namespace

void tear(Sheet& sheet, const MembraneParams& params, double h, MembraneReport& report) {
  if (params.strength_n_m <= 0) return;
  const std::vector<Overload> overloads = overloads_of(sheet, params.strength_n_m, h);
  if (overloads.empty()) return;
  std::vector<char> is_done(std::size_t(sheet.node_count()), 0);
  MembraneEvent event{MembraneEvent::Kind::edge_torn, 0, -1, Vec3d(0.0)};
  for (const Overload& overload : overloads) {
    const auto [a, b] =
        LinkNodes{sheet.springs[overload.spring].a, sheet.springs[overload.spring].b};
    if (std::max(a, b) >= int(is_done.size()) || is_done[a] || is_done[b]) continue;
    // A tear goes on from the rim, if one end lies there; a node in the forceps is the last to go.
    Crack at_a = crack_at(sheet, a, b), at_b = crack_at(sheet, b, a);
    const auto rank = [&](const Crack& crack, int node) {
      return crack.triangles.empty() ? 8u : crack.along.size() + (sheet.holder[node] >= 0 ? 4 : 0);
    };
    const bool takes_b = rank(at_b, b) < rank(at_a, a);
    const Crack& crack = takes_b ? at_b : at_a;
    const int node = takes_b ? b : a;
    if (crack.triangles.empty()) {
      slip(sheet, a);
      slip(sheet, b);
      continue;
    }
    is_done[a] = is_done[b] = 1;
    const int opened = split(sheet, node, crack.triangles, params);
    slip(sheet, sheet.node_count() - 1);  // the torn-off side leaves the forceps
    for (const int neighbour : crack.along) separate(sheet, neighbour, params);
    event.place_mm += sheet.body.pos_mm[node] * double(opened);
    event.count += opened;
  }
  if (event.count == 0) return;
  event.place_mm /= double(event.count);
  report.events.push_back(event);
  ++sheet.version;
  renew_bending(sheet, params);
}

}  // namespace supple
