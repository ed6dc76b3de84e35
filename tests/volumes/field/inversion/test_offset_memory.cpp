// Memory of offsets that follow a displacement, as docs/offsets.md has it.
#include <gtest/gtest.h>
#include <malloc.h>

#include "tests/support/field_fixtures.h"
#include "tests/support/sanitized.h"
#include "volumes/field/inversion/forward_offsets.h"
#include "volumes/field/inversion/invert.h"

namespace supple::test {
namespace {

std::int64_t heap_in_use() {
  const struct mallinfo2 info = ::mallinfo2();
  return std::int64_t(info.uordblks + info.hblkhd);
}

Displacement moved_block() {
  std::mt19937 random(71);
  return noisy_displacement(random, box_topology(Vec3i(0), Vec3i(63)), 0.1f, Vec3f(3.5f, -1, 0));
}

TEST(UnitOffsetMemory, AnIncrementalInversionTakesWhatIsDocumented) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have a heap of their own";
  const Displacement displacement = moved_block();
  const std::int64_t before = heap_in_use();
  const IncrementalInversion inversion(displacement);
  inversion.certificate(displacement);
  const double taken = double(heap_in_use() - before);
  const double sources = double(displacement.u.topology.brick_count());
  const double outputs = double(inversion.field(displacement).o.topology.brick_count());
  EXPECT_NEAR(taken / (6600 * outputs + 400 * sources), 1, 0.05);
}

TEST(UnitOffsetMemory, ForwardOffsetsTakeWhatIsDocumentedAndWhatTheySay) {
  if (kSanitized) GTEST_SKIP() << "sanitizers have a heap of their own";
  const Displacement displacement = moved_block();
  const std::int64_t before = heap_in_use();
  const ForwardOffsets offsets(displacement);
  const double taken = double(heap_in_use() - before);
  const double sources = double(displacement.u.topology.brick_count());
  const double outputs = double(offsets.bricks().brick_count());
  EXPECT_NEAR(double(offsets.bytes()) / (400 * sources + 250 * outputs), 1, 0.05);
  EXPECT_NEAR(taken, double(offsets.bytes()), 0.1 * double(offsets.bytes()));
}

}  // namespace
}  // namespace supple::test
