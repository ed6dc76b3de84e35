// Small bodies for the tests of lib/: a dense description, and random ones.
#pragma once

#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "lib/body/body.h"
#include "tests/support/errors.h"

namespace supple::test {

/// The unit of offsets: parts of a voxel.
constexpr std::int32_t kVoxel = 65536;

double pick(std::mt19937& random, double lo, double hi);

/// A dense block of voxels, i fastest; `element` says which belong to the body.
struct Block {
  Vec3i origin{0, 0, 0};
  Vec3i dims{1, 1, 1};
  Vec3d spacing_mm{1, 1, 1};
  std::vector<char> element;
  std::vector<double> density;
  std::vector<char> cut;   // bit a: no link to the next voxel along axis a; empty: none cut
  std::vector<int> label;  // of a segmentation; empty: none
  MaterialTable table;

  int size() const { return dims.x * dims.y * dims.z; }
  int index(int i, int j, int k) const { return (k * dims.y + j) * dims.x + i; }
  Vec3i voxel(int index) const {
    return origin + Vec3i(index % dims.x, index / dims.x % dims.y, index / dims.x / dims.y);
  }
};

/// The same limits for every class.
MaterialTable constant_table(double longest, double shortest, double shear);

/// Linear tables over classes 0 (rigid) … 255: max_length to `longest`, min_length to `shortest`.
MaterialTable linear_table(double longest, double shortest, double shear);

/// A full block with the given density everywhere.
Block full_block(const Vec3i& dims, const MaterialTable& table,
                 const std::function<double(int, int, int)>& density);

/// Elements of one kind, the same limits everywhere.
Block homogeneous(const Vec3i& dims, double longest, double shortest, double shear);
/// A full block between links that stretch by 32768 units and shorten by 26214 (255) and rigid ones
/// (0).
Block soft_block(const Vec3i& dims, double density = 255);
/// Along i.
Body soft_row(int length);

/// Random shape with holes, densities, table (zero slack, overrides, both ways to combine) and
/// spacing; dims at most `max_dims`.
Block random_block(std::mt19937& random, const Vec3i& max_dims);

/// Cuts planes, a box free of the rest and single links out of the block, at random.
void cut_randomly(std::mt19937& random, Block& block);

/// Labels in blobs and noise, some with tables of their own and some without.
void label_randomly(std::mt19937& random, Block& block);

Body body_of(const Block& block);

bool same_offsets(const Body& a, const Body& b);

/// Any voxel of the body, as an index of the block.
int random_element(std::mt19937& random, const Block& block);

/// Rigid T (density 0) in soft tissue (255): figures 4.5 and 4.9. One slice of size x size; the bar
/// lies near the right rim, where the body is pulled.
Block t_shape(int size);

/// Returns the complaint of the table about itself; "" when it is valid.
std::string validation_error(const MaterialTable& table);

}  // namespace supple::test
