#include "lib/relax/brick_springs.h"

#include <algorithm>

namespace supple {

namespace {

/// Sets the entry `at` each voxel of `cut`, the low ends of cut links along one axis, to `missing`.
template <class At>
void remove_cut(const BrickMask& cut, std::int32_t missing, At&& at) {
  for_each_active(cut, [&](int offset) { at(brick_local(offset)) = missing; });
}

void remove_cuts(const Body& body, std::size_t b, std::int32_t missing, BrickSprings& links) {
  if (const LinkCuts::BrickCuts* own = body.cuts.brick(b)) {
    remove_cut((*own)[0],
               missing, [&](const Vec3i& v) -> auto& { return links.i[v.x + 1][v.y][v.z]; });
    remove_cut((*own)[1],
               missing, [&](const Vec3i& v) -> auto& { return links.j[v.x][v.y + 1][v.z]; });
    remove_cut((*own)[2], missing, [&](const Vec3i& v) -> auto& { return links.k[v.x][v.y][v.z]; });
  }
  for (int axis = 0; axis < 3; ++axis) {
    const std::int32_t before = body.elements.neighbour(b, 2 * axis);
    const LinkCuts::BrickCuts* cuts = before >= 0 ? body.cuts.brick(std::size_t(before)) : nullptr;
    if (cuts == nullptr) continue;
    for_each_active((*cuts)[std::size_t(axis)], [&](int offset) {
      const Vec3i v = brick_local(offset);
      if (v[axis] != 7) return;
      (axis == 0   ? links.i[0][v.y][v.z]
       : axis == 1 ? links.j[v.x][0][v.z]
                   : links.low_k[v.x][v.y]) = missing;
    });
  }
}

/// Fills in classes; that of a voxel without element takes every entry with it beyond the others.
void pad_classes(const Body& body, std::size_t b, std::int32_t missing,
                 PaddedBrick<std::int32_t>& out) {
  const BrickTopology& elements = body.elements;
  const auto classes_of = [&](std::size_t brick) {
    return [classes = body.classes.data() + kBrickVoxels * brick](int offset) {
      return std::int32_t(classes[offset]);
    };
  };
  pad_brick(elements, b, missing, classes_of, out);
  for (int word = 0; word < 8; ++word) {
    for (std::uint64_t void_bits = ~elements.mask(b)[std::size_t(word)]; void_bits != 0;
         void_bits &= void_bits - 1) {
      const int offset = __builtin_ctzll(void_bits);
      out.row(word, offset / 8)[offset % 8] = missing;
    }
  }
  for (int face = 0; face < 6; ++face) {
    const std::int32_t other = elements.neighbour(b, face);
    if (other < 0) continue;
    const int outside = is_high_face(face) ? 8 : -1;
    for (std::uint64_t void_bits =
             ~face_bits(elements.mask(std::size_t(other)), opposite_face(face));
         void_bits != 0; void_bits &= void_bits - 1) {
      const int m = __builtin_ctzll(void_bits) / 8, n = __builtin_ctzll(void_bits) % 8;
      switch (axis_of_face(face)) {
        case 0:
          out.row(outside, m)[n] = missing;
          break;
        case 1:
          out.row(m, outside)[n] = missing;
          break;
        default:
          out.row(m, n)[outside] = missing;
      }
    }
  }
}

}  // namespace

void find_links(const Body& body, std::size_t b, std::int32_t missing, BrickSprings& links) {
  PaddedBrick<std::int32_t> classes;
  pad_classes(body, b, missing, classes);

  const std::int32_t stride = body.slacks.stride();
  const auto entry = [&](std::int32_t low, std::int32_t high) {
    return std::min(missing, std::min(low, missing) * stride + high);
  };
  for (int i = -1; i < 8; ++i) {
    for (int j = -1; j < 8; ++j) {
      if (i < 0 && j < 0) continue;
      const std::int32_t* here = classes.row(i, j);
      if (j >= 0) {
        const std::int32_t* next = classes.row(i + 1, j);
        for (int k = 0; k < 8; ++k) links.i[i + 1][j][k] = entry(here[k], next[k]);
      }
      if (i >= 0) {
        const std::int32_t* next = classes.row(i, j + 1);
        for (int k = 0; k < 8; ++k) links.j[i][j + 1][k] = entry(here[k], next[k]);
      }
      if (i < 0 || j < 0) continue;
      for (int k = 0; k < 8; ++k) links.k[i][j][k] = entry(here[k], here[k + 1]);
      links.low_k[i][j] = entry(here[-1], here[0]);
    }
  }
  if (!body.cuts.empty()) remove_cuts(body, b, missing, links);
}

void find_rest(const BrickTopology& elements, const std::array<const BrickValues*, 3>& rest,
               std::size_t b, BrickRest& out) {
  const auto brick_before = [&](int axis) {
    const std::int32_t before = elements.neighbour(b, 2 * axis);
    return before >= 0 ? rest[std::size_t(axis)]->brick_or_zero(std::size_t(before)) : kZeroBrick;
  };
  const std::int32_t* own[3];
  for (std::size_t axis = 0; axis < 3; ++axis) own[axis] = rest[axis]->brick_or_zero(b);
  const std::int32_t* before_i = brick_before(0);
  const std::int32_t* before_j = brick_before(1);
  const std::int32_t* before_k = brick_before(2);
  for (int m = 0; m < 8; ++m) {
    for (int n = 0; n < 8; ++n) {
      out.low_k[m][n] = before_k[64 * m + 8 * n + 7] * kFinePerUnit;
      for (int k = 0; k < 8; ++k) {
        out.i[0][m][k] = before_i[64 * 7 + 8 * m + k] * kFinePerUnit;
        out.i[m + 1][n][k] = own[0][64 * m + 8 * n + k] * kFinePerUnit;
        out.j[m][n + 1][k] = own[1][64 * m + 8 * n + k] * kFinePerUnit;
        out.k[m][n][k] = own[2][64 * m + 8 * n + k] * kFinePerUnit;
      }
    }
    for (int k = 0; k < 8; ++k) out.j[m][0][k] = before_j[64 * m + 8 * 7 + k] * kFinePerUnit;
  }
}

}  // namespace supple
