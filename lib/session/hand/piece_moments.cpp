#include "lib/session/hand/piece_moments.h"

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

Vec3d arm_of(const Body& body, const RigidPiece& piece, Slot slot) {
  return body.geometry.world_vector_from_index(Vec3d(voxel_of(body.elements, slot)) -
                                               piece.centre_index);
}

/// The sum of a b^T.
void add_product(const Vec3d& a, const Vec3d& b, Matrix9& sum) {
  for (int n = 0; n < 9; ++n) sum[std::size_t(n)] += a[n / 3] * b[n % 3];
}

}  // namespace

void PieceMoments::add(const PieceMoments& other, double part) {
  shift += other.shift * part;
  for (std::size_t n = 0; n < product.size(); ++n) product[n] += part * other.product[n];
}

PieceFits::PieceFits(const Body& body) : m_body(body) {
  for (const RigidPiece& piece : body.rigid.list) {
    AtRest& rest = m_pieces.emplace_back();
    rest.piece = piece;
    rest.piece.pose = {};
    piece.elements->for_each([&](Slot slot) {
      const Vec3d arm = arm_of(body, piece, slot);
      add_product(arm, arm, rest.products);
      rest.squares += arm.length2();
    });
  }
}

std::vector<PieceMoments> PieceFits::moments(const std::vector<Vec3d>& u_mm) const {
  std::vector<PieceMoments> sums(m_pieces.size());
  if (sums.empty()) return sums;
  std::size_t e = 0;
  for_each_element(m_body.elements, [&](Slot slot) {
    const int piece = m_body.rigid.at(slot);
    if (piece >= 0) {
      PieceMoments& of = sums[std::size_t(piece)];
      of.shift += u_mm[e];
      add_product(arm_of(m_body, m_pieces[std::size_t(piece)].piece, slot), u_mm[e], of.product);
    }
    ++e;
  });
  return sums;
}

std::vector<RigidPose> PieceFits::poses(const std::vector<PieceMoments>& moments) const {
  std::vector<RigidPose> poses;
  for (std::size_t p = 0; p < m_pieces.size(); ++p) {
    const AtRest& rest = m_pieces[p];
    const Vec3d from = m_body.geometry.world_from_index(rest.piece.centre_index);
    const Vec3d to = from + moments[p].shift / double(rest.piece.elements->size());
    // Six points with the same middle and products of places at rest and where they go have the
    // same fit.
    const double arm = std::max(std::sqrt(rest.squares / 6), m_body.geometry.spacing_mm().x / 2);
    RigidFit fit;
    for (int a = 0; a < 3; ++a) {
      Vec3d axis(0.0), image;
      axis[a] = arm;
      for (std::size_t b = 0; b < 3; ++b) {
        const std::size_t n = 3 * std::size_t(a) + b;
        image[int(b)] = (rest.products[n] + moments[p].product[n]) / (2 * arm);
      }
      fit.add(from + axis, to + image);
      fit.add(from - axis, to - image);
    }
    poses.push_back(moved_by(fit.motion(), rest.piece, m_body.geometry));
  }
  return poses;
}

}  // namespace supple
