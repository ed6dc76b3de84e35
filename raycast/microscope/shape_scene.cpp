#include "raycast/microscope/shape_scene.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "volumes/base/error.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

/// Dimming is added up as a whole number, which the order of hits does not change.
constexpr double kDimSteps = 1 << 16;  // for each halving
constexpr double kLeastPart = 1e-6;    // of light, which counts as none

/// The shape's part of the light as steps of dimming.
int dim_steps(const ShapeShadow& shadow) {
  if (shadow.blocks) return TriangleFloats::kBlocks;
  return int(std::lround(-std::log2(std::max(shadow.dims, kLeastPart)) * kDimSteps));
}

/// Wider cones of light are not divided into blocks, since these would become too wide.
constexpr float kLeastCosine = 0.2f;
constexpr int kLightBlocks = 100;  // across a cone

/// The lamp as a lens that sees its cone.
LensFloats lens_of(const LampFloats& lamp) {
  const Vec3f unlike = std::abs(lamp.direction.x) < 0.7f ? Vec3f(1, 0, 0) : Vec3f(0, 1, 0);
  const Vec3f right = lamp.direction.cross(unlike).normalized();
  const float cosine = lamp.cosine_none;
  const float half = std::sqrt(1 - cosine * cosine) / cosine;
  constexpr int kPixels = TriangleBins::kPixels * kLightBlocks;
  LensFloats lens;
  lens.origin = lamp.place;
  lens.forward = lamp.direction;
  lens.right = right * (2 * half / kPixels);
  lens.up = right.cross(lamp.direction) * (2 * half / kPixels);
  lens.middle_x = lens.middle_y = kPixels / 2;
  return lens;
}

void require_good(const std::vector<Vec3d>& vertices_mm, const Triangles& triangles) {
  for (const Vec3d& vertex : vertices_mm) {
    if (!is_finite(vertex)) {
      throw InputError({"", "vertex of a mesh", to_text(vertex, " "), "three finite numbers"});
    }
  }
  for (const auto& triangle : triangles) {
    for (const int index : triangle) {
      if (index < 0 || std::size_t(index) >= vertices_mm.size()) {
        throw InputError(
            {"", "corner of a triangle", std::to_string(index),
             "the number of one of " + std::to_string(vertices_mm.size()) + " vertices"});
      }
    }
  }
}

std::array<Vec3f, 3> corners_of(const TriangleFloats& triangle) {
  return {triangle.corner, triangle.corner + triangle.to_second,
          triangle.corner + triangle.to_third};
}

}  // namespace

int ShapeScene::add(const ShapeShadow& shadow) {
  m_shapes.emplace_back();
  m_shapes.back().dim_steps = dim_steps(shadow);
  return int(m_shapes.size()) - 1;
}

void ShapeScene::shape(int number, const std::vector<Vec3d>& vertices_mm,
                       const Triangles& triangles, double crease_degrees) {
  require_good(vertices_mm, triangles);
  SceneShape& shape = m_shapes.at(std::size_t(number));
  shape.vertices.assign(vertices_mm.begin(), vertices_mm.end());
  shape.triangles = triangles;
  shape.corner_normals = corner_normals(vertices_mm, triangles, crease_degrees);
  shape.is_changed = true;
}

void ShapeScene::place(int number, const ShapeMotion& motion) {
  SceneShape& shape = m_shapes.at(std::size_t(number));
  shape.motion = motion;
  shape.is_changed = true;
}

void ShapeScene::move_triangles(SceneShape& shape, int number) {
  m_moved.clear();
  for (const Vec3f& vertex : shape.vertices) {
    m_moved.push_back(shape.motion.turned(vertex) + shape.motion.origin);
  }
  const auto unit = [](const Vec3f& v) { return v / std::max(v.length(), 1e-20f); };
  for (std::size_t t = 0; t < shape.triangles.size(); ++t) {
    const auto [a, b, c] = shape.triangles[t];
    TriangleFloats& triangle = m_triangles[shape.first + t];
    triangle = triangle_floats(
        {m_moved[std::size_t(a)], m_moved[std::size_t(b)], m_moved[std::size_t(c)]});
    triangle.shape = number;
    triangle.dim_steps = shape.dim_steps;
    for (std::size_t k = 0; k < 3; ++k) {
      m_normals[shape.first + t].of[k] = unit(shape.motion.turned(shape.corner_normals[3 * t + k]));
    }
  }
  shape.is_changed = false;
}

void ShapeScene::commit() {
  std::size_t count = 0;
  for (SceneShape& shape : m_shapes) {
    shape.is_changed |= shape.first != count;
    shape.first = count;
    count += shape.triangles.size();
  }
  m_triangles.resize(count);
  m_normals.resize(count);
  for (std::size_t n = 0; n < m_shapes.size(); ++n) {
    if (m_shapes[n].is_changed) move_triangles(m_shapes[n], int(n));
  }
}

void ShapeScene::light_from(const LampFloats& lamp, const DiscReach& disc) {
  if (lamp.cosine_none < kLeastCosine)
    m_before_lamp.begin_undivided();
  else
    m_before_lamp.begin(lens_of(lamp), TriangleBins::kPixels * kLightBlocks,
                        TriangleBins::kPixels * kLightBlocks, disc);
  for (std::size_t n = 0; lamp.is_on && n < m_triangles.size(); ++n) {
    if (m_triangles[n].dim_steps != 0)
      m_before_lamp.add(std::uint32_t(n), corners_of(m_triangles[n]));
  }
  m_before_lamp.finish();
}

void ShapeScene::sort_seen(const LensFloats& lens, int width, int height,
                           TriangleBins& seen) const {
  seen.begin(lens, width, height);
  for (std::size_t n = 0; n < m_triangles.size(); ++n) {
    seen.add(std::uint32_t(n), corners_of(m_triangles[n]));
  }
  seen.finish();
}

void ShapeScene::passing(const PacketRays& rays, const TriangleList& list, LaneFloats& part) const {
  PacketDimming dimming;
  dim_rays(m_triangles.data(), list, rays, dimming);
  std::int32_t dimmed_by = 0;
  float dimmed = 1;
  for (int lane = 0; lane < kPacketRays; ++lane) {
    if (dimming.steps[lane] != dimmed_by) {
      dimmed_by = dimming.steps[lane];
      dimmed = std::exp2(-float(dimmed_by) / float(kDimSteps));
    }
    part[lane] = (dimming.blocked >> lane & 1) != 0 ? 0.0f : dimmed;
  }
}

}  // namespace supple
