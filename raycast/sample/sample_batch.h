// Up to sixteen samples of one ray at once, in vector registers (design.md section 5): brick
// look-up, offset, trilinear or cubic density, visibility under the transfer function, gradient.
// The instruction set is chosen when the program starts (Google Highway).
//
// Positions are single precision about a voxel near the samples (RayPiece), so that they are within
// 1e-4 voxel of their place in a volume of any size.
// Cost per sample and core, AVX-512: docs/benchmarks/render.md.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "volumes/field/offset_field.h"
#include "volumes/grid/brick_topology.h"

namespace supple {

class SourceBricks;

/// The bricks of a frame as flat arrays.
struct SamplingTables {
  static constexpr std::int32_t kSkip = -1;
  static constexpr std::int32_t kPointwise = 1 << 29;  // added to the number of such a brick
  static constexpr std::int32_t kDeformed = 1 << 30;   // added to the slot of a deformed brick

  static constexpr std::int32_t kGatherSpan = 400'000;  // bytes between them fit into 31 bits

  // Tables that hold, in place of brick numbers: kSkip, a source brick (of an identity brick the
  // one beneath), or a pointwise or deformed brick.
  BrickLookup output, source;
  const float* output_highest = nullptr;  // largest code that an output brick can read, laid out
                                          // as output.tables; null where none is asked for
  const SourceBricks* bricks = nullptr;
  const std::int16_t* nodes = nullptr;  // of them
  const float* offsets = nullptr;       // OffsetBricks
  int offset_dim = 0;                   // OffsetBricks::node_dim
  bool is_cubic = false;                // SourceBricks::interpolation

  const PointwiseOffsets* pointwise = nullptr;
  // For each brick of theirs: the slot if some cells have interpolated offsets, or -1; and these
  // cells.
  const std::int32_t* pointwise_slots = nullptr;
  const BrickMask* interpolated = nullptr;

  std::int32_t gather_span = kGatherSpan;  // bricks apart that one gather can span

  // Encoded densities that are not transparent: intervals of the classifier's table from the first
  // to the last, and if not all of those, one bit for each: bit n & 31 of word n >> 5.
  std::int32_t first_visible = 0, last_visible = -1;
  const std::int32_t* visible_bits = nullptr;
  float first_code = 0, entries_per_code = 0, last_entry = 0;
};

/// A stretch of a ray in index space: sample n lies at base + first + n * per_sample.
struct RayPiece {
  Vec3i base{0, 0, 0};
  Vec3f first{0, 0, 0};
  Vec3f per_sample{0, 0, 0};
  // Bricks without larger codes are skipped; only where the tables give their largest codes.
  float above = -std::numeric_limits<float>::infinity();
};

/// Places and values that samples read. Lanes outside a mask hold nothing of use.
struct SampleBatch {
  static constexpr int kLanes = 16;

  std::uint32_t read = 0;       // lanes that reached a source brick
  std::uint32_t inside = 0;     // of those, lanes whose eight corners all have a density
  std::uint32_t visible = 0;    // of those, lanes that are not transparent
  std::uint32_t bent = 0;       // of those that were read, lanes that followed an offset,
  std::uint32_t pointwise = 0;  // or one of their own; of those that were bent,
  std::uint32_t split = 0;      // lanes in interpolated cells of pointwise bricks

  alignas(64) float encoded[kLanes];
  alignas(64) std::int32_t brick[kLanes];                // source
  alignas(64) std::int32_t node[kLanes];                 // low corner in the brick
  alignas(64) float x[kLanes], y[kLanes], z[kLanes];     // in the source cell, 0 … 1
  alignas(64) std::int32_t offset_node[kLanes];          // slot * brick + low corner, in nodes
  alignas(64) float ox[kLanes], oy[kLanes], oz[kLanes];  // in the offset cell, 0 … 1
  std::int32_t piece[kLanes];                            // of pointwise lanes
  alignas(64) float px[kLanes], py[kLanes], pz[kLanes];  // read at, from the piece's base
  alignas(64) float gx[kLanes], gy[kLanes], gz[kLanes];  // see sample_gradients
};

/// Samples first, first + stride, … of the piece; `count` of them, at most kLanes.
void sample_batch(const SamplingTables& tables, const RayPiece& piece, int first, int stride,
                  int count, SampleBatch& batch);

/// Places in index space: base + (x, y, z).
struct SamplePlaces {
  Vec3i base{0, 0, 0};
  alignas(64) float x[SampleBatch::kLanes], y[SampleBatch::kLanes], z[SampleBatch::kLanes];
};

/// Samples anywhere; the first `count` places, all set to numbers.
void sample_places(const SamplingTables& tables, const SamplePlaces& places, int count,
                   SampleBatch& batch);

/// Fills in the index-space gradients, encoded density per voxel, of these lanes, all of them
/// inside: by central differences of the trilinear density over +-1 voxel, one-sided where a
/// neighbour is void, 0 where both are. Of a cubic density: its derivative.
void sample_gradients(const SamplingTables& tables, SampleBatch& batch, std::uint32_t wanted);

/// Instruction set that the calls above use, for example "AVX3".
const char* sampling_instruction_set();
/// Instruction sets that this machine has, best first.
std::vector<std::string> sampling_instruction_sets();
/// Chooses one of them from now on, in all threads, for comparisons; "" the best again.
void choose_sampling_instruction_set(const std::string& name);

}  // namespace supple
