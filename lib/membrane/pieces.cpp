#include <algorithm>
#include <numeric>

#include "lib/membrane/tearing.h"

namespace supple {

namespace {

/// Piece of every node, by its lowest node.
std::vector<int> pieces_of(const Sheet& sheet) {
  std::vector<int> piece(std::size_t(sheet.node_count()));
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int n) {
    while (piece[n] != n) n = piece[n] = piece[piece[n]];
    return n;
  };
  for (const SheetSpring& s : sheet.springs) {
    const int a = root(s.a), b = root(s.b);
    piece[std::max(a, b)] = std::min(a, b);
  }
  for (int& n : piece) n = root(n);
  return piece;
}

template <class Values>
void keep(Values& values, const std::vector<int>& now) {
  std::size_t next = 0;
  for (std::size_t n = 0; n < now.size(); ++n) {
    if (now[n] >= 0) std::swap(values[next++], values[n]);
  }
  values.resize(next);
}

void renew_neighbours(Sheet& sheet) {
  sheet.triangles_at.assign(std::size_t(sheet.node_count()), {});
  sheet.springs_at = sheet.triangles_at;
  for (std::size_t n = 0; n < sheet.body.triangles.size(); ++n) {
    for (const int node : sheet.body.triangles[n]) sheet.triangles_at[node].push_back(int(n));
  }
  for (std::size_t n = 0; n < sheet.springs.size(); ++n) {
    sheet.springs_at[sheet.springs[n].a].push_back(int(n));
    sheet.springs_at[sheet.springs[n].b].push_back(int(n));
  }
}

/// Removes nodes that have no new index, and what belongs to them.
void remove_nodes(Sheet& sheet, const std::vector<int>& now) {
  MeshBody& body = sheet.body;
  std::vector<int> triangle_now;
  for (TriangleNodes& t : body.triangles) {
    triangle_now.push_back(now[t[0]]);
    for (int& node : t) node = now[node];
  }
  keep(body.triangles, triangle_now);
  keep(sheet.triangle_mm2, triangle_now);
  std::vector<int> spring_now;
  for (SheetSpring& s : sheet.springs) {
    spring_now.push_back(now[s.a]);
    s.a = now[s.a];
    s.b = now[s.b];
  }
  keep(sheet.springs, spring_now);
  keep(body.rest_mm, now), keep(body.pos_mm, now), keep(body.velocity_mm_s, now);
  keep(sheet.start_mm, now), keep(sheet.grip_mm, now), keep(sheet.anchor_mm, now);
  keep(sheet.area_mm2, now), keep(sheet.mass_kg, now), keep(sheet.mobility, now);
  keep(sheet.link_multiplier, now), keep(sheet.holder, now), keep(sheet.clings, now);
  keep(sheet.is_torn, now);
  renew_neighbours(sheet);
}

}  // namespace

void lose_pieces(Sheet& sheet, const MembraneParams& params, MembraneReport& report) {
  const std::vector<int> piece = pieces_of(sheet);
  std::vector<double> area(piece.size(), 0);
  std::vector<char> is_torn(piece.size(), 0);
  std::vector<MembraneEvent> lost(piece.size(), {MembraneEvent::Kind::piece_lost});
  for (int n = 0; n < sheet.node_count(); ++n) {
    area[piece[n]] += sheet.area_mm2[n];
    is_torn[piece[n]] |= sheet.is_torn[n];
    lost[piece[n]].place_mm += sheet.body.pos_mm[n] * sheet.area_mm2[n];
  }
  const int largest = int(std::max_element(area.begin(), area.end()) - area.begin());
  for (const TriangleNodes& t : sheet.body.triangles) ++lost[piece[t[0]]].count;
  std::vector<int> now(piece.size(), -1);
  int count = 0;
  for (int n = 0; n < sheet.node_count(); ++n) {
    const int p = piece[n];
    const bool is_lost = is_torn[p] && area[p] < params.smallest_piece_mm2 && p != largest;
    if (!is_lost) now[n] = count++;
    if (!is_lost || p != n) continue;
    lost[p].place_mm /= area[p];
    report.events.push_back(lost[p]);
  }
  if (count == sheet.node_count()) return;
  remove_nodes(sheet, now);
  ++sheet.version;
  renew_bending(sheet, params);
}

}  // namespace supple
