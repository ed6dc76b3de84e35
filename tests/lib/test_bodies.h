// Small bodies for the tests of lib/: a dense description, and random ones.
#pragma once

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "lib/body/body.h"

namespace supple::test {

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

/// Linear tables over classes 0 (rigid) … 255: max_length to `longest`, min_length to `shortest`.
MaterialTable linear_table(double longest, double shortest, double shear);

/// A full block with the given density everywhere.
Block full_block(const Vec3i& dims, const MaterialTable& table,
                 const std::function<double(int, int, int)>& density);

/// Random shape with holes, densities, table (zero slack, overrides, both ways to combine) and
/// spacing; dims at most `max_dims`.
Block random_block(std::mt19937& random, const Vec3i& max_dims);

/// Cuts planes, a box free of the rest and single links out of the block, at random.
void cut_randomly(std::mt19937& random, Block& block);

/// Labels in blobs and noise, some with tables of their own and some without.
void label_randomly(std::mt19937& random, Block& block);

Body body_of(const Block& block);

/// Any voxel of the body, as an index of the block.
int random_element(std::mt19937& random, const Block& block);

/// Rigid T (density 0) in soft tissue (255): figures 4.5 and 4.9. One slice of size x size; the bar
/// lies near the right rim, where the body is pulled.
Block t_shape(int size);

/// The message of the InputError that `action` throws; "" when it throws none.
std::string input_error(const std::function<void()>& action);

}  // namespace supple::test
