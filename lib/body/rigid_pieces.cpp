#include "lib/body/rigid_pieces.h"

#include <cmath>

#include "lib/state/state.h"

namespace supple {

namespace {

/// Eigenvalues and eigenvectors (columns) of a symmetric matrix by Jacobi's rotations.
void diagonalize(double (&matrix)[4][4], double (&vectors)[4][4]) {
  constexpr int kSweeps = 30;  // converges quadratically; 6 are usual
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) vectors[r][c] = r == c;
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double off = 0;
    for (int p = 0; p < 4; ++p) {
      for (int q = p + 1; q < 4; ++q) {
        off += std::abs(matrix[p][q]);
        if (matrix[p][q] == 0) continue;
        const double theta = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q]);
        const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 4; ++k) {
          const double kp = matrix[k][p], kq = matrix[k][q];
          matrix[k][p] = c * kp - s * kq;
          matrix[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 4; ++k) {
          const double pk = matrix[p][k], qk = matrix[q][k];
          matrix[p][k] = c * pk - s * qk;
          matrix[q][k] = s * pk + c * qk;
          const double kp = vectors[k][p], kq = vectors[k][q];
          vectors[k][p] = c * kp - s * kq;
          vectors[k][q] = s * kp + c * kq;
        }
      }
    }
    if (off == 0) return;
  }
}

}  // namespace

Vec3d RigidMotion::operator()(const Vec3d& place_lps_mm) const {
  return place_lps_mm + turn.way_of(place_lps_mm - about_lps_mm) + shift_lps_mm;
}

RigidMotion RigidMotion::part(double fraction) const {
  RigidMotion part = *this;
  part.shift_lps_mm = shift_lps_mm * fraction;
  part.turn = between(Turn(), turn.unit(), fraction);
  return part;
}

PoseOffsets::PoseOffsets(const Geometry& geometry, const RigidPiece& piece)
    : m_centre(piece.centre_index), m_shift(piece.pose.shift_q) {
  for (int a = 0; a < 3; ++a) {
    Vec3d step(0.0);
    step[a] = 1;
    m_columns[std::size_t(a)] = geometry.index_vector_from_world(
        piece.pose.turn.way_of(geometry.world_vector_from_index(step)));
  }
}

std::array<std::int64_t, 3> PoseOffsets::operator()(const Vec3i& voxel) const {
  const Vec3d from = Vec3d(voxel) - m_centre;
  const Vec3d way = m_columns[0] * from.x + m_columns[1] * from.y + m_columns[2] * from.z;
  std::array<std::int64_t, 3> offset{};
  for (int c = 0; c < 3; ++c) {
    offset[std::size_t(c)] = std::llround(way[c] * kFixedOne) + m_shift[std::size_t(c)];
  }
  return offset;
}

RigidPose moved_by(const RigidMotion& motion, const RigidPiece& piece, const Geometry& geometry) {
  RigidPose pose = piece.pose;
  if (motion.turns()) pose.turn = (motion.turn * piece.pose.turn).unit();
  Vec3d centre = piece.centre_index;
  for (int c = 0; c < 3; ++c) centre[c] += double(pose.shift_q[std::size_t(c)]) / kFixedOne;
  const Vec3d from = geometry.world_from_index(centre);
  const Vec3d way = geometry.index_vector_from_world(motion(from) - from);
  for (int c = 0; c < 3; ++c) {
    pose.shift_q[std::size_t(c)] += std::llround(way[c] * kFixedOne);
  }
  return pose;
}

void RigidFit::add(const Vec3d& from_lps_mm, const Vec3d& to_lps_mm) {
  if (m_count++ == 0) {
    m_first_from = from_lps_mm;
    m_first_to = to_lps_mm;
  }
  const Vec3d from = from_lps_mm - m_first_from, to = to_lps_mm - m_first_to;
  m_sum_from += from;
  m_sum_to += to;
  m_square += from.length2() + to.length2();
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) m_products[a][b] += from[a] * to[b];
  }
}

RigidMotion RigidFit::motion() const {
  const double count = double(m_count);
  double s[3][3];
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) s[a][b] = m_products[a][b] - m_sum_from[a] * m_sum_to[b] / count;
  }
  double matrix[4][4] = {
      {s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]},
      {0, s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]},
      {0, 0, -s[0][0] + s[1][1] - s[2][2], s[1][2] + s[2][1]},
      {0, 0, 0, -s[0][0] - s[1][1] + s[2][2]}};
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < r; ++c) matrix[r][c] = matrix[c][r];
  }
  double vectors[4][4];
  diagonalize(matrix, vectors);
  double largest = matrix[0][0];
  for (int n = 1; n < 4; ++n) largest = std::max(largest, matrix[n][n]);
  // Take, of all turns that fit equally well, the one nearest to no turn.
  const double tolerance = 1e-12 * m_square;
  Turn turn{0, {0, 0, 0}};
  for (int n = 0; n < 4; ++n) {
    if (matrix[n][n] < largest - tolerance) continue;
    turn.w += vectors[0][n] * vectors[0][n];
    for (int a = 0; a < 3; ++a) turn.v[a] += vectors[0][n] * vectors[a + 1][n];
  }
  RigidMotion motion;
  if (turn.w > 1e-12) motion.turn = turn.unit();
  motion.about_lps_mm = m_first_from + m_sum_from / count;
  motion.shift_lps_mm = m_first_to + m_sum_to / count - motion.about_lps_mm;
  return motion;
}

}  // namespace supple
