#include "lib/relax/sweep_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "lib/relax/node_rows.h"

namespace supple {

namespace {

/// Lane n + 1 of the result is lane n of `row`, and `first` enters.
inline NodeRow moved_up(NodeRow row, double first) {
  const NodeRow entering = NodeRow{} + first;
  return __builtin_shufflevector(row, entering, 8, 0, 1, 2, 3, 4, 5, 6);
}

/// Eight links under the present stretch of their ends.
struct NodePull {
  NodeRow force{};  // on the low end, upwards
  NodeRow stiffness{};
  NodeRow wider{}, narrower{};  // slack left until the link is too long, and too short
  NodeRow energy{};             // twice
};

template <bool kPlastic>
inline NodePull pull_of(const LinkRow& link, NodeRow stretch, const double* rest) {
  NodeRow pulled = stretch, work = stretch;
  if constexpr (kPlastic) {
    const NodeRow beyond = stretch - load(rest);
    pulled = lanes_max(-link.yield, lanes_min(link.yield, beyond));
    work = beyond + beyond - pulled;
  }
  const NodeRow force = link.stiffness * pulled;
  return {force, link.stiffness, link.upper - stretch, link.lower + stretch, force * work};
}

/// Pull of the six links of eight nodes, and how far these may rise and sink.
struct NodeForces {
  NodeRow force{}, stiffness{}, rise, sink;

  explicit NodeForces(const NodePull& to_next)
      : force(to_next.force),
        stiffness(to_next.stiffness),
        rise(to_next.narrower),
        sink(to_next.wider) {}
  void add_next(const NodePull& pull) {
    force += pull.force;
    stiffness += pull.stiffness;
    rise = lanes_min(rise, pull.narrower);
    sink = lanes_min(sink, pull.wider);
  }
  void add_last(const NodePull& pull) {
    force -= pull.force;
    stiffness += pull.stiffness;
    rise = lanes_min(rise, pull.wider);
    sink = lanes_min(sink, pull.narrower);
  }
};

template <bool kLimited>
inline NodeRow step_of(const NodeForces& ask, const SweepRule& rule) {
  const NodeRow wanted = ask.force * rule.relaxation / (ask.stiffness + kNoStiffness);
  if constexpr (!kLimited) return truncated(wanted);
  const NodeRow up = ask.rise * rule.share, down = ask.sink * rule.share;
  return truncated(lanes_max(-down, lanes_min(up, wanted)));
}

/// Force of one spring, as pull_of().
template <bool kPlastic>
inline double force_of(const LinkValues& link, double stretch, double rest) {
  if constexpr (!kPlastic) return double(link.stiffness) * stretch;
  return link.stiffness * pulled_stretch(link, stretch - rest);
}

template <bool kLimited, bool kPlastic>
SweepOutcome sweep(const PaddedBrick<double>& offsets, const BrickSprings& links,
                   const BrickRest* rest, const LinkTable& table, const BrickMask& free,
                   const SweepRule& rule, double* out) {
  const LinkValues* along_i = table.row(0);
  const LinkValues* along_j = table.row(1);
  const LinkValues* along_k = table.row(2);
  NodeRow energy{}, largest{}, least = NodeRow{} + std::numeric_limits<double>::infinity();
  NodePull last_i[8];
  for (int j = 0; j < 8; ++j) {
    last_i[j] = pull_of<kPlastic>(look_up(along_i, links.i[0][j]),
                                  load(offsets.row(0, j)) - load(offsets.row(-1, j)),
                                  kPlastic ? rest->i[0][j] : nullptr);
  }
  for (int i = 0; i < 8; ++i) {
    NodePull last_j = pull_of<kPlastic>(look_up(along_j, links.j[i][0]),
                                        load(offsets.row(i, 0)) - load(offsets.row(i, -1)),
                                        kPlastic ? rest->j[i][0] : nullptr);
    for (int j = 0; j < 8; ++j) {
      const double* place = offsets.row(i, j);
      const NodeRow here = load(place);
      const NodeRow stretch_i = load(offsets.row(i + 1, j)) - here;
      const NodeRow stretch_j = load(offsets.row(i, j + 1)) - here;
      const NodeRow stretch_k = load(place + 1) - here;
      const NodePull next_i = pull_of<kPlastic>(look_up(along_i, links.i[i + 1][j]), stretch_i,
                                                kPlastic ? rest->i[i + 1][j] : nullptr);
      const NodePull next_j = pull_of<kPlastic>(look_up(along_j, links.j[i][j + 1]), stretch_j,
                                                kPlastic ? rest->j[i][j + 1] : nullptr);
      const NodePull next_k = pull_of<kPlastic>(look_up(along_k, links.k[i][j]), stretch_k,
                                                kPlastic ? rest->k[i][j] : nullptr);
      energy += next_i.energy + next_j.energy + next_k.energy;

      const LinkValues& entering = along_k[links.low_k[i][j]];
      const double entering_stretch = place[0] - place[-1];
      const NodePull last_k = {
          moved_up(next_k.force, force_of<kPlastic>(entering, entering_stretch,
                                                    kPlastic ? rest->low_k[i][j] : 0)),
          moved_up(next_k.stiffness, entering.stiffness),
          moved_up(next_k.wider, double(entering.upper) * kFinePerUnit - entering_stretch),
          moved_up(next_k.narrower, double(entering.lower) * kFinePerUnit + entering_stretch),
          NodeRow{}};
      NodeForces ask(next_i);
      ask.add_next(next_j);
      ask.add_next(next_k);
      ask.add_last(last_i[j]);
      ask.add_last(last_j);
      ask.add_last(last_k);
      last_i[j] = next_i;
      last_j = next_j;

      least = lanes_min(least, lanes_min(ask.rise, ask.sink));
      const int first = 64 * i + 8 * j;
      const unsigned bits = unsigned(free[std::size_t(i)] >> (8 * j)) & 0xff;
      const NodeRow step = chosen(bits, step_of<kLimited>(ask, rule));
      const NodeRow moved = here + step;
      std::memcpy(out + first, &moved, sizeof moved);
      largest = lanes_max(largest, lanes_max(step, -step));
    }
  }
  return outcome_of(energy, least, largest);
}

}  // namespace

SweepOutcome sweep_brick(const PaddedBrick<double>& offsets, const BrickSprings& links,
                         const BrickRest* rest, const LinkTable& table, const BrickMask& free,
                         const SweepRule& rule, double* out) {
  if (rest != nullptr) {
    return rule.limited ? sweep<true, true>(offsets, links, rest, table, free, rule, out)
                        : sweep<false, true>(offsets, links, rest, table, free, rule, out);
  }
  return rule.limited ? sweep<true, false>(offsets, links, rest, table, free, rule, out)
                      : sweep<false, false>(offsets, links, rest, table, free, rule, out);
}

}  // namespace supple
