// Densities and gradients of the cells that lanes lie in, from the nodes of source bricks.
#if defined(SUPPLE_RAYCAST_SAMPLE_NODES_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUPPLE_RAYCAST_SAMPLE_NODES_INL_H
#undef SUPPLE_RAYCAST_SAMPLE_NODES_INL_H
#else
#define SUPPLE_RAYCAST_SAMPLE_NODES_INL_H
#endif

#include "raycast/sample/lanes-inl.h"
#include "raycast/sample/sample_batch.h"
#include "raycast/sample/source_bricks.h"

HWY_BEFORE_NAMESPACE();
namespace supple {
namespace HWY_NAMESPACE {
namespace {

/// Number of a brick's node; `step_x` … in nodes.
HWY_INLINE HWY_ATTR VI node_of(const IntVector& voxel, int step_x, int step_y, int step_z) {
  const VI low = ints(7);
  return hn::Add(
      hn::Mul(hn::And(voxel.x, low), ints(step_x)),
      hn::Add(hn::Mul(hn::And(voxel.y, low), ints(step_y)),
              step_z == 1 ? hn::And(voxel.z, low) : hn::Mul(hn::And(voxel.z, low), ints(step_z))));
}

/// Two neighbours along z.
struct NodePair {
  VI low, high;
};

/// Densities beside the low corners of lanes' cells, read relative to one brick: byte offsets fit
/// into 32 bits for the lanes of `near`.
class NodeReader {
 public:
  HWY_INLINE HWY_ATTR NodeReader(const SamplingTables& tables, std::int32_t brick, VI bricks,
                                 VI node, MI wanted)
      : m_base(reinterpret_cast<const std::int32_t*>(tables.nodes +
                                                     std::size_t(brick) * kBrickNodes)) {
    const VI distance = hn::Sub(bricks, ints(brick));
    m_near = hn::And(wanted, hn::Lt(hn::Abs(distance), ints(tables.gather_span)));
    const VI bytes = hn::ShiftLeft<1>(hn::Add(hn::Mul(distance, ints(kBrickNodes)), node));
    m_bytes = hn::IfThenElse(near(), bytes, ints(2 * kOrigin));
  }
  HWY_INLINE HWY_ATTR MI near() const { return m_near; }

  /// The nodes `step` and `step` + 1 beyond the low corner.
  HWY_INLINE HWY_ATTR NodePair pair(int step) const {
    const VI both = hn::GatherOffset(kInts, m_base, hn::Add(m_bytes, ints(2 * step)));
    return {hn::ShiftRight<16>(hn::ShiftLeft<16>(both)), hn::ShiftRight<16>(both)};
  }

 private:
  static constexpr std::int32_t kBrickNodes = SourceBricks::kBrickNodes;
  static_assert(2 * std::int64_t(kBrickNodes) * (SamplingTables::kGatherSpan + 1) < INT32_MAX);
  static constexpr std::int32_t kOrigin =
      SourceBricks::kStepX + SourceBricks::kStepY + SourceBricks::kStepZ;

  const std::int32_t* m_base;
  MI m_near;
  VI m_bytes;
};

/// A value, and the lanes where none of its nodes is void.
struct Interpolated {
  VF value;
  MI known;
};

HWY_INLINE HWY_ATTR VI smallest(const NodePair& a, const NodePair& b) {
  return hn::Min(hn::Min(a.low, a.high), hn::Min(b.low, b.high));
}
HWY_INLINE HWY_ATTR MI is_known(VI smallest_node) {
  return hn::Gt(smallest_node, ints(SourceBricks::kVoid));
}
HWY_INLINE HWY_ATTR VF between(VI a, VI b, VF t) {
  return mix(hn::ConvertTo(kFloats, a), hn::ConvertTo(kFloats, b), t);
}

/// Bilinear over a.low, a.high (along v) and b.low, b.high.
HWY_INLINE HWY_ATTR Interpolated on_plane(const NodePair& a, const NodePair& b, VF u, VF v) {
  return {mix(between(a.low, a.high, v), between(b.low, b.high, v), u), is_known(smallest(a, b))};
}

constexpr int kStepX = SourceBricks::kStepX, kStepY = SourceBricks::kStepY;

HWY_INLINE HWY_ATTR Interpolated read_density(const NodeReader& nodes, const FloatVector& f) {
  const Interpolated low = on_plane(nodes.pair(0), nodes.pair(kStepY), f.y, f.z);
  const Interpolated high = on_plane(nodes.pair(kStepX), nodes.pair(kStepX + kStepY), f.y, f.z);
  return {mix(low.value, high.value, f.x), hn::And(low.known, high.known)};
}

/// The difference quotient that the neighbours allow.
HWY_INLINE HWY_ATTR VF difference(const Interpolated& minus, VF here, const Interpolated& plus) {
  const MF has_minus = hn::RebindMask(kFloats, minus.known);
  const MF has_plus = hn::RebindMask(kFloats, plus.known);
  const VF both = hn::Mul(floats(0.5f), hn::Sub(plus.value, minus.value));
  const VF forward = hn::IfThenElseZero(has_plus, hn::Sub(plus.value, here));
  const VF one_sided =
      hn::IfThenElse(has_plus, forward, hn::IfThenElseZero(has_minus, hn::Sub(here, minus.value)));
  return hn::IfThenElse(hn::And(has_minus, has_plus), both, one_sided);
}

/// Derivative along an axis from the planes at -1, 0, 1, 2; t is the place between 0 and 1.
HWY_INLINE HWY_ATTR VF axis_derivative(const Interpolated& before, VF low, VF high,
                                       const Interpolated& after, VF t, VF here) {
  return difference({mix(before.value, low, t), before.known}, here,
                    {mix(high, after.value, t), after.known});
}

HWY_INLINE HWY_ATTR FloatVector read_gradient(const NodeReader& nodes, const FloatVector& f) {
  // Rows of the cell along z: nodes -1, 0 and 1, 2.
  const NodePair a0 = nodes.pair(-1), a1 = nodes.pair(1);
  const NodePair b0 = nodes.pair(kStepY - 1), b1 = nodes.pair(kStepY + 1);
  const NodePair c0 = nodes.pair(kStepX - 1), c1 = nodes.pair(kStepX + 1);
  const NodePair d0 = nodes.pair(kStepX + kStepY - 1), d1 = nodes.pair(kStepX + kStepY + 1);
  const VF a = between(a0.high, a1.low, f.z), b = between(b0.high, b1.low, f.z);
  const VF c = between(c0.high, c1.low, f.z), d = between(d0.high, d1.low, f.z);
  const VF x_low = mix(a, b, f.y), x_high = mix(c, d, f.y);
  const VF y_low = mix(a, c, f.x), y_high = mix(b, d, f.x);
  const VF z_low = on_plane({a0.high, b0.high}, {c0.high, d0.high}, f.x, f.y).value;
  const VF z_high = on_plane({a1.low, b1.low}, {c1.low, d1.low}, f.x, f.y).value;
  const VF here = mix(x_low, x_high, f.x);

  const Interpolated x_before =
      on_plane(nodes.pair(-kStepX), nodes.pair(kStepY - kStepX), f.y, f.z);
  const Interpolated x_after =
      on_plane(nodes.pair(2 * kStepX), nodes.pair(2 * kStepX + kStepY), f.y, f.z);
  const Interpolated y_before =
      on_plane(nodes.pair(-kStepY), nodes.pair(kStepX - kStepY), f.x, f.z);
  const Interpolated y_after =
      on_plane(nodes.pair(2 * kStepY), nodes.pair(kStepX + 2 * kStepY), f.x, f.z);
  const Interpolated z_before = on_plane({a0.low, b0.low}, {c0.low, d0.low}, f.x, f.y);
  const Interpolated z_after = on_plane({a1.high, b1.high}, {c1.high, d1.high}, f.x, f.y);
  return {axis_derivative(x_before, x_low, x_high, x_after, f.x, here),
          axis_derivative(y_before, y_low, y_high, y_after, f.y, here),
          axis_derivative(z_before, z_low, z_high, z_after, f.z, here)};
}

/// The cubic B-spline's weights of the nodes -1, 0, 1, 2 at t in 0 … 1, and their derivatives (Sigg
/// and Hadwiger, GPU Gems 2, equation 20-1).
struct CubicWeights {
  VF weight[4], slope[4];

  HWY_INLINE HWY_ATTR explicit CubicWeights(VF t) {
    const VF s = hn::Sub(floats(1), t), t2 = hn::Mul(t, t), s2 = hn::Mul(s, s);
    const VF sixth = floats(1.0f / 6), half = floats(0.5f), two_thirds = floats(2.0f / 3);
    weight[0] = hn::Mul(hn::Mul(s2, s), sixth);
    weight[1] = hn::MulAdd(t2, hn::MulSub(half, t, floats(1)), two_thirds);
    weight[2] = hn::MulAdd(s2, hn::MulSub(half, s, floats(1)), two_thirds);
    weight[3] = hn::Mul(hn::Mul(t2, t), sixth);
    slope[0] = hn::Neg(hn::Mul(half, s2));
    slope[1] = hn::Mul(t, hn::MulSub(floats(1.5f), t, floats(2)));
    slope[2] = hn::Neg(hn::Mul(s, hn::MulSub(floats(1.5f), s, floats(2))));
    slope[3] = hn::Mul(half, t2);
  }
};

/// Four nodes along z as densities; those that are void take `instead`.
struct SplineRow {
  VF node[4];

  HWY_INLINE HWY_ATTR SplineRow(const NodeReader& nodes, int step, VF instead) {
    const NodePair low = nodes.pair(step - 1), high = nodes.pair(step + 1);
    const VI all[4] = {low.low, low.high, high.low, high.high};
    for (int n = 0; n < 4; ++n) {
      const MF known = hn::RebindMask(kFloats, is_known(all[n]));
      node[n] = hn::IfThenElse(known, hn::ConvertTo(kFloats, all[n]), instead);
    }
  }
  HWY_INLINE HWY_ATTR VF sum(const VF (&weight)[4]) const {
    const VF outer = hn::MulAdd(weight[0], node[0], hn::Mul(weight[3], node[3]));
    return hn::MulAdd(weight[1], node[1], hn::MulAdd(weight[2], node[2], outer));
  }
};

/// The tricubic density; `linear` stands for void nodes.
HWY_INLINE HWY_ATTR VF read_cubic_density(const NodeReader& nodes, const FloatVector& f,
                                          VF linear) {
  const CubicWeights x(f.x), y(f.y), z(f.z);
  VF sum = floats(0);
  for (int i = 0; i < 4; ++i) {
    VF plane = floats(0);
    for (int j = 0; j < 4; ++j) {
      const SplineRow row(nodes, (i - 1) * kStepX + (j - 1) * kStepY, linear);
      plane = hn::MulAdd(y.weight[j], row.sum(z.weight), plane);
    }
    sum = hn::MulAdd(x.weight[i], plane, sum);
  }
  return sum;
}

/// The derivative of the tricubic density.
HWY_INLINE HWY_ATTR FloatVector read_cubic_gradient(const NodeReader& nodes, const FloatVector& f) {
  const VF linear = read_density(nodes, f).value;
  const CubicWeights x(f.x), y(f.y), z(f.z);
  FloatVector sum = {floats(0), floats(0), floats(0)};
  for (int i = 0; i < 4; ++i) {
    VF plane = floats(0), plane_y = floats(0), plane_z = floats(0);
    for (int j = 0; j < 4; ++j) {
      const SplineRow row(nodes, (i - 1) * kStepX + (j - 1) * kStepY, linear);
      const VF along = row.sum(z.weight);
      plane = hn::MulAdd(y.weight[j], along, plane);
      plane_y = hn::MulAdd(y.slope[j], along, plane_y);
      plane_z = hn::MulAdd(y.weight[j], row.sum(z.slope), plane_z);
    }
    sum.x = hn::MulAdd(x.slope[i], plane, sum.x);
    sum.y = hn::MulAdd(x.weight[i], plane_y, sum.y);
    sum.z = hn::MulAdd(x.weight[i], plane_z, sum.z);
  }
  return sum;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace supple
HWY_AFTER_NAMESPACE();
#endif
