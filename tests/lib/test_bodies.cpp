#include "tests/lib/test_bodies.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple::test {

double pick(std::mt19937& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

namespace {

bool chance(std::mt19937& random, double probability) {
  return pick(random, 0, 1) < probability;
}

/// 1 to 4 key points inside the domain; a value is `rigid` with some probability.
Curve random_curve(std::mt19937& random, double lo, double hi, double rigid, double extreme) {
  Curve curve;
  const int count = 1 + int(random() % 4);
  for (int n = 0; n < count; ++n) {
    const double density = lo + (hi - lo) * (n + pick(random, 0, 0.9)) / count;
    const double value = chance(random, 0.3)
                             ? rigid
                             : pick(random, std::min(rigid, extreme), std::max(rigid, extreme));
    curve.keys.push_back({density, value});
  }
  return curve;
}

void random_limits(std::mt19937& random, LimitTable& table) {
  table.domain_lo = chance(random, 0.5) ? 0 : -1000;
  table.domain_hi = table.domain_lo + (chance(random, 0.5) ? 255 : 3000);
  const auto curve = [&](double rigid, double extreme) {
    return random_curve(random, table.domain_lo, table.domain_hi, rigid, extreme);
  };
  const double longest = chance(random, 0.05) ? 1e6 : 2;  // sometimes unlimited
  table.max_length = curve(1, longest);
  table.min_length = curve(1, 0.3);
  table.shear1 = curve(0, 0.8);
  table.shear2 = chance(random, 0.5) ? table.shear1 : curve(0, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    if (chance(random, 0.2)) table.max_length_axis[axis] = curve(1, 1.7);
    if (chance(random, 0.2)) table.min_length_axis[axis] = curve(1, 0.5);
  }
}

MaterialTable random_table(std::mt19937& random) {
  MaterialTable table;
  random_limits(random, table);
  table.active_lo = table.domain_lo;
  table.active_hi = table.domain_hi;
  if (chance(random, 0.25)) table.combine = Combine::limits;
  return table;
}

/// Balls, boxes and single voxels taken out; never all of them.
void carve(std::mt19937& random, Block& block) {
  const std::vector<char> before = block.element;
  const double noise = chance(random, 0.3) ? 0.2 : 0.0;
  const Vec3i centre(int(random() % block.dims.x), int(random() % block.dims.y),
                     int(random() % block.dims.z));
  const double radius = pick(random, 0, 0.4) * std::max(block.dims.x, block.dims.y);
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i d = block.voxel(n) - block.origin - centre;
    if (double(d.x * d.x + d.y * d.y + d.z * d.z) < radius * radius) block.element[n] = 0;
    if (chance(random, noise)) block.element[n] = 0;
  }
  if (std::count(block.element.begin(), block.element.end(), 1) == 0) block.element = before;
}

/// The cut links of one voxel whose both ends are elements.
void mark_cuts(const Block& block, int n, Body& body) {
  const Vec3i voxel = block.voxel(n);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3i next = voxel;
    ++next[axis];
    const bool is_link = body.elements.is_active(voxel) && body.elements.is_active(next);
    if (!is_link || !(block.cut[n] >> axis & 1)) continue;
    body.cuts.cut(std::size_t(body.elements.find(voxel)), brick_offset(voxel), axis);
  }
}

}  // namespace

MaterialTable constant_table(double longest, double shortest, double shear) {
  MaterialTable table = linear_table(longest, shortest, shear);
  table.max_length.keys = {{0, longest}};
  table.min_length.keys = {{0, shortest}};
  table.shear1.keys = table.shear2.keys = {{0, shear}};
  return table;
}

MaterialTable linear_table(double longest, double shortest, double shear) {
  MaterialTable table;
  table.active_lo = 0;
  table.max_length = {{{0, 1.0}, {255, longest}}};
  table.min_length = {{{0, 1.0}, {255, shortest}}};
  table.shear1 = table.shear2 = {{{0, 0.0}, {255, shear}}};
  return table;
}

Block full_block(const Vec3i& dims, const MaterialTable& table,
                 const std::function<double(int, int, int)>& density) {
  Block block;
  block.dims = dims;
  block.table = table;
  block.element.assign(block.size(), 1);
  block.density.resize(block.size());
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) block.density[block.index(i, j, k)] = density(i, j, k);
    }
  }
  return block;
}

Block homogeneous(const Vec3i& dims, double longest, double shortest, double shear) {
  return full_block(dims, constant_table(longest, shortest, shear),
                    [](int, int, int) { return 9.0; });
}

Block soft_block(const Vec3i& dims, double density) {
  return full_block(dims, linear_table(1.5, 0.6, 0.7),
                    [density](int, int, int) { return density; });
}

Body soft_row(int length) {
  return body_of(soft_block({length, 1, 1}));
}

Block random_block(std::mt19937& random, const Vec3i& max_dims) {
  const MaterialTable table = random_table(random);
  const Vec3i dims(1 + int(random() % max_dims.x), 1 + int(random() % max_dims.y),
                   1 + int(random() % max_dims.z));
  const int bands = 1 + int(random() % 6);
  const double noise = chance(random, 0.5) ? 1.0 : 0.1;
  Block block = full_block(dims, table, [&](int i, int j, int k) {
    const double band = double((i / 3 + j / 2 + k) % bands) / bands;
    const double t = std::min(1.0, band * (1 - noise) + noise * pick(random, 0, 1));
    return double(float(table.domain_lo + t * (table.domain_hi - table.domain_lo)));
  });
  block.origin = {int(random() % 20) - 9, int(random() % 20) - 9, int(random() % 20) - 9};
  if (chance(random, 0.5)) {
    block.spacing_mm = {pick(random, 0.3, 3), pick(random, 0.3, 3), pick(random, 0.3, 3)};
  }
  if (chance(random, 0.7)) carve(random, block);
  return block;
}

void cut_randomly(std::mt19937& random, Block& block) {
  block.cut.assign(std::size_t(block.size()), 0);
  const int plane_axis = int(random() % 3), plane_at = int(random() % block.dims[plane_axis]);
  const Vec3i corner = block.voxel(int(random() % unsigned(block.size())));
  const IndexBox freed{corner,
                       corner + Vec3i(int(random() % 4), int(random() % 4), int(random() % 4))};
  const bool has_plane = chance(random, 0.6), has_box = chance(random, 0.5);
  const double noise = chance(random, 0.5) ? pick(random, 0, 0.4) : 0;
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i voxel = block.voxel(n);
    for (int axis = 0; axis < 3; ++axis) {
      Vec3i next = voxel;
      ++next[axis];
      const bool in_plane =
          has_plane && axis == plane_axis && voxel[axis] - block.origin[axis] == plane_at;
      const bool leaves_box = has_box && freed.contains(voxel) != freed.contains(next);
      if (in_plane || leaves_box || chance(random, noise)) block.cut[n] |= char(1 << axis);
    }
  }
}

void label_randomly(std::mt19937& random, Block& block) {
  const int count = 1 + int(random() % 6), width = 1 + int(random() % 4);
  const auto label_at = [&](int n) { return n % 3 == 2 ? 1000 * n : n; };
  const double noise = chance(random, 0.5) ? 0.2 : 0;
  block.label.assign(std::size_t(block.size()), 0);
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i at = block.voxel(n) - block.origin;
    const int blob = at.x / width + at.y / width + at.z / width;
    block.label[std::size_t(n)] =
        label_at(chance(random, noise) ? int(random() % 7) : blob % (count + 1));
  }
  const double constant = pick(random, 0, 1);
  for (int n = 1; n <= count; ++n) {
    if (chance(random, 0.2)) continue;
    LimitTable& table = block.table.labels[label_at(n)];
    random_limits(random, table);
    if (!chance(random, constant)) continue;
    for (Curve* curve : {&table.max_length, &table.min_length, &table.shear1, &table.shear2}) {
      curve->keys.resize(1);
    }
    table.max_length_axis = table.min_length_axis = {};
  }
}

Body body_of(const Block& block) {
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  const auto brick_of = [&](const Vec3i& voxel) {
    const Vec3i origin(voxel.x & ~7, voxel.y & ~7, voxel.z & ~7);
    const auto found = std::find(origins.begin(), origins.end(), origin);
    if (found != origins.end()) return std::size_t(found - origins.begin());
    origins.push_back(origin);
    masks.push_back({});
    return origins.size() - 1;
  };
  for (int n = 0; n < block.size(); ++n) {
    const Vec3i voxel = block.voxel(n);
    if (block.element[n]) mask_set(masks[brick_of(voxel)], brick_offset(voxel));
  }
  const BrickTopology elements(origins, masks);
  std::vector<float> values(elements.brick_count() * kBrickVoxels, 0.0f);
  BrickValues labels(elements.brick_count());
  for (int n = 0; n < block.size(); ++n) {
    if (!block.element[n]) continue;
    const Vec3i voxel = block.voxel(n);
    const std::size_t slot =
        std::size_t(elements.find(voxel)) * kBrickVoxels + std::size_t(brick_offset(voxel));
    values[slot] = float(block.density[n]);
    if (!block.label.empty()) labels.set(slot, block.label[std::size_t(n)]);
  }
  const Geometry geometry({64, 64, 64}, {0, 0, 0},
                          {Vec3d(block.spacing_mm.x, 0, 0), Vec3d(0, block.spacing_mm.y, 0),
                           Vec3d(0, 0, block.spacing_mm.z)});
  Body body =
      make_body(geometry, make_density_grid(elements, values, 0), elements, block.table, labels);
  for (int n = 0; n < int(block.cut.size()); ++n) mark_cuts(block, n, body);
  return body;
}

bool same_offsets(const Body& a, const Body& b) {
  return a.q[0] == b.q[0] && a.q[1] == b.q[1] && a.q[2] == b.q[2];
}

int random_element(std::mt19937& random, const Block& block) {
  while (true) {
    const int n = int(random() % unsigned(block.size()));
    if (block.element[n]) return n;
  }
}

Block t_shape(int size) {
  return full_block({size, size, 1}, linear_table(1.5, 0.6, 0.7), [size](int i, int j, int) {
    const bool bar = i >= size * 3 / 5 && i < size * 7 / 10 && j >= size / 5 && j < size * 4 / 5;
    const bool stem =
        i >= size / 4 && i < size * 7 / 10 && j >= size * 9 / 20 && j < size * 11 / 20;
    return bar || stem ? 0.0 : 255.0;
  });
}

std::string validation_error(const MaterialTable& table) {
  return input_error([&] { table.validate("m.toml"); });
}

}  // namespace supple::test
