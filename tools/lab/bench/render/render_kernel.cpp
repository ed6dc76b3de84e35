#include "tools/lab/bench/render/render_kernel.h"

#include <cmath>
#include <memory>

#include "raycast/march/render_context.h"
#include "tools/lab/bench/bodies/block_topology.h"
#include "tools/lab/bench/bodies/half_sampled_head.h"
#include "tools/lab/bench/render/vdb_line_samplers.h"
#include "volumes/base/error.h"
#include "volumes/field/procedural.h"

namespace supple::tools {

namespace {

constexpr double kStep = 0.5;        // voxels
constexpr int kPictureSize = 512;    // pixels
constexpr int kRaysAcross = 64;      // pixels of the tile in its middle
constexpr double kMargin = 12;       // voxels that lines keep from the border
constexpr double kAgreement = 1e-3;  // of the mean density, relative
const Vec3i kSize(256, 256, 128);

struct Line {
  Vec3d first, step;
  int count;
};

/// Rays of neighbouring pixels of a picture, from in front of the face, inside the volume.
std::vector<Line> lines_through(const Geometry& geometry) {
  const Camera camera = default_camera(geometry, 1);
  const CameraRays rays(camera, kPictureSize, kPictureSize);
  const double corner = 0.5 * (kPictureSize - kRaysAcross) + 0.5;
  std::vector<Line> lines;
  for (int y = 0; y < kRaysAcross; ++y) {
    for (int x = 0; x < kRaysAcross; ++x) {
      const Ray world = rays.at(corner + x, corner + y);
      const IndexRay ray{geometry.index_from_world(world.origin_lps_mm),
                         geometry.index_vector_from_world(world.direction_lps).normalized()};
      const Interval span =
          clip_to_box(ray, Vec3d(kMargin), Vec3d(kSize) - Vec3d(kMargin + 1), {0, HUGE_VAL});
      const int count = int((span.end - span.begin) / kStep);
      if (count > 0) lines.push_back({ray.at(span.begin), ray.direction * kStep, count});
    }
  }
  return lines;
}

DensityGrid head_grid(const BrickTopology& where) {
  const HalfSampledHead head(kSize);
  return fill_density_grid(
      where,
      [&](std::size_t b, float* out) {
        for (int n = 0; n < kBrickVoxels; ++n) out[n] = head(where.origin(b) + brick_local(n));
      },
      0);
}

TransferFunction all_visible() {
  TransferFunction f;
  f.opacity = {{-1, 0.5}, {1, 0.5}};
  f.colour = {{0, {1, 1, 1}}};
  return f;
}

/// The marcher's tables over straight or bent bricks.
class SuppleLines final : public LineSampler {
 public:
  SuppleLines(const Geometry& geometry, const SourceBricks& source, const VectorBricks* offsets)
      : m_source(source),
        m_output(offsets != nullptr ? OffsetBricks(source, *offsets) : OffsetBricks(source)),
        m_context(geometry, source, m_output, default_camera(geometry, 1), all_visible(),
                  RenderSettings()) {}

  double sum(const Vec3d& first, const Vec3d& step, int count) override {
    RayPiece piece;
    for (int a = 0; a < 3; ++a) piece.base[a] = int(std::floor(first[a]));
    piece.first = Vec3f(first - Vec3d(piece.base));
    piece.per_sample = Vec3f(step);
    double sum = 0;
    for (int n = 0; n < count; n += SampleBatch::kLanes) {
      const int lanes = std::min(SampleBatch::kLanes, count - n);
      sample_batch(m_context.tables, piece, n, 1, lanes, m_batch);
      float codes = 0;
      for (int lane = 0; lane < lanes; ++lane) {
        codes += m_batch.inside >> lane & 1 ? m_batch.encoded[lane] : 0;
      }
      sum += codes;
    }
    return m_source.density(0) * count + m_source.scale() * sum;
  }

 private:
  const SourceBricks& m_source;
  OffsetBricks m_output;
  RenderContext m_context;
  SampleBatch m_batch;
};

struct Kernel {
  BrickTopology where = block_topology(kSize, [](const Vec3i&) { return true; });
  Geometry geometry = head_phantom(kSize).geometry;
  DensityGrid density = head_grid(where);
  SourceBricks source{density};
  std::vector<Line> lines = lines_through(geometry);
  VectorBricks offsets = sample_offsets(shear_warp(Vec3d(kSize) / 2, 0.05), geometry, where).o;

  std::unique_ptr<LineSampler> sampler(const KernelSide& side) const {
    const VectorBricks* bent = side.offsets ? &offsets : nullptr;
    if (side.sampler == "openvdb") return openvdb_line_sampler(density, bent);
    if (side.sampler == "nanovdb") return nanovdb_line_sampler(density, bent);
    return std::make_unique<SuppleLines>(geometry, source, bent);
  }
};

}  // namespace

std::vector<KernelSide> kernel_sides() {
  std::vector<KernelSide> sides;
  for (const bool offsets : {false, true}) {
    for (const std::string& name : sampling_instruction_sets()) {
      sides.push_back({"supple", offsets, name});
    }
    sides.push_back({"openvdb", offsets, ""});
    sides.push_back({"nanovdb", offsets, ""});
  }
  return sides;
}

std::string kernel_row_name(const KernelSide& side) {
  return "kernel/" + side.sampler + (side.instruction_set.empty() ? "" : "-") +
         side.instruction_set + (side.offsets ? "/offsets" : "/straight");
}

std::vector<BenchRow> measure_kernel(const std::vector<KernelSide>& sides,
                                     const RoundLimits& limits,
                                     const std::function<void()>& before_run) {
  const Kernel kernel;
  std::int64_t samples = 0;
  for (const Line& line : kernel.lines) samples += line.count;
  std::vector<double> means(sides.size());
  std::vector<std::unique_ptr<LineSampler>> samplers;
  std::vector<TimedSide> timed(sides.size());
  for (std::size_t n = 0; n < sides.size(); ++n) {
    samplers.push_back(kernel.sampler(sides[n]));
    timed[n].run = [&, n](Times& times) {
      choose_sampling_instruction_set(sides[n].instruction_set);
      double sum = 0;
      times.ms.push_back(time_ms([&] {
        for (const Line& line : kernel.lines) {
          sum += samplers[n]->sum(line.first, line.step, line.count);
        }
      }));
      means[n] = sum / double(samples);
    };
  }
  take_turns(timed, limits, before_run);
  choose_sampling_instruction_set("");

  std::vector<BenchRow> rows;
  for (std::size_t n = 0; n < sides.size(); ++n) {
    for (std::size_t other = 0; other < n; ++other) {
      const bool same = sides[n].offsets == sides[other].offsets;
      if (same && std::abs(means[n] - means[other]) > kAgreement * std::abs(means[n])) {
        throw Error(kernel_row_name(sides[n]) + " and " + kernel_row_name(sides[other]) +
                    " read different densities");
      }
    }
    BenchRow row = {{"case", "kernel"},
                    {"sampler", sides[n].sampler},
                    {"offsets", sides[n].offsets},
                    {"isa", sides[n].instruction_set},
                    {"samples", samples},
                    {"msamples_per_s", double(samples) / (1e3 * timed[n].times.median())}};
    add_times(row, timed[n].times, 1);
    rows.push_back(std::move(row));
  }
  return rows;
}

}  // namespace supple::tools
