#include "tools/examples/original_figures.h"

#include <cstdio>

#include "lib/chainmail/ecm.h"
#include "lib/chainmail/reference/original_chainmail.h"
#include "raycast/drawings/lattice.h"

namespace supple::examples {

namespace {

constexpr double kPullMm = 28;

/// Black is rigid; white stretches by 50 %, compresses by 40 % and shears by 70 % (section 4.2.3).
MaterialTable grey_material() {
  MaterialTable material;
  material.active_lo = 0;
  material.max_length.keys = {{0, 1.0}, {255, 1.5}};
  material.min_length.keys = {{0, 1.0}, {255, 0.6}};
  material.shear1.keys = material.shear2.keys = {{0, 0.0}, {255, 0.7}};
  return material;
}

struct Slice {
  Geometry geometry;
  DensityGrid density;
};

/// Negative densities are void.
Slice to_slice(const Phantom& phantom) {
  const Vec3i dims = phantom.geometry.dims();
  std::vector<Vec3i> origins;
  std::vector<BrickMask> masks;
  std::vector<float> values;
  for (int i0 = 0; i0 < dims.x; i0 += kBrickDim) {
    for (int j0 = 0; j0 < dims.y; j0 += kBrickDim) {
      origins.emplace_back(i0, j0, 0);
      masks.emplace_back(BrickMask{});
      values.resize(values.size() + kBrickVoxels);
      for (int i = i0; i < std::min(i0 + kBrickDim, dims.x); ++i) {
        for (int j = j0; j < std::min(j0 + kBrickDim, dims.y); ++j) {
          if (phantom.density(i, j, 0) < 0) continue;
          const int offset = brick_offset({i, j, 0});
          mask_set(masks.back(), offset);
          values[values.size() - kBrickVoxels + offset] = phantom.density(i, j, 0);
        }
      }
    }
  }
  return {phantom.geometry, make_density_grid(BrickTopology(origins, masks), values, 0)};
}

void draw(const std::string& path, const Body& body, const Slice& slice) {
  State state;
  state.geometry = body.geometry;
  state.elements = body.elements;
  state.q = body.q;
  const Displacement displacement = displacement_of(state);
  LatticeStyle style;
  style.width = style.height = 400;
  write_png(path, draw_lattice(slice.geometry, slice.density, displacement,
                               lattice_camera(slice.geometry, displacement, 1.0), style));
  const LinkCheck check = check_links(body);
  std::printf("%s: %lld of %lld links beyond their limits, by at most %.3g voxels\n", path.c_str(),
              static_cast<long long>(check.violated), static_cast<long long>(check.links),
              check.worst_excess_voxels);
}

/// Two arms of 4 voxels with a gap of 4 on a bar of 4, all of density 255.
Phantom u_phantom() {
  constexpr int kSize = 12;
  Phantom phantom = constant_phantom({kSize, kSize, 1}, 255);
  phantom.density = [](int i, int j, int) { return i >= 4 && i < 8 && j < 8 ? -1.0f : 255.0f; };
  return phantom;
}

/// At rest, under the original ChainMail and under ECM.
void draw_three(const std::string& prefix, const Slice& slice, const Vec3i& grabbed,
                const Vec3d& by_mm) {
  const Body rest =
      make_body(slice.geometry, slice.density, slice.density.bricks(), grey_material());
  const auto by_q = fixed_from_mm(by_mm, slice.geometry.spacing_mm());

  draw(prefix + "_rest.png", rest, slice);
  draw(prefix + "_original.png", reference::original_chainmail(rest, grabbed, by_q), slice);
  Body ecm = rest;
  drag(ecm, {{grabbed, by_q}}, {});
  draw(prefix + "_ecm.png", ecm, slice);
}

}  // namespace

void draw_figure_4_5(const Phantom& t_shape, const std::string& folder) {
  const Vec3i dims = t_shape.geometry.dims();
  draw_three(folder + "/figure_4_5", to_slice(t_shape), {dims.x - 1, dims.y / 2, 0},
             {kPullMm, 0, 0});
}

void draw_u_shape(const std::string& folder) {
  const Phantom u = u_phantom();
  const double spacing_mm = u.geometry.spacing_mm().x;
  draw_three(folder + "/figure_u_shape", to_slice(u), {0, 0, 0}, {-20 * spacing_mm, 0, 0});
}

}  // namespace supple::examples
