// Other people's OpenVDB reads our states. Skipped where python3-openvdb is not installed.
#include <cstdio>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/random_state.h"
#include "tests/support/temporary_folder.h"
#include "volumes/field/procedural.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr const char* kPython = "/usr/bin/python3";

}  // namespace

TEST(InteropState, PythonOpenVdbReadsTheDerivedGridsInMillimetres) {
  if (!runs_python("-c 'import pyopenvdb' 2>&1"))
    GTEST_SKIP() << "python3-openvdb is not installed";
  const TemporaryFolder folder;

  // x moves by half a voxel of 2 mm along i, which points to -y: 1 mm to the anterior.
  State state;
  state.geometry = Geometry({9, 8, 8}, {10, 20, 30}, {Vec3d(0, -2, 0), {3, 0, 0}, {0, 0, 4}});
  state.elements = bricks_where({9, 8, 8}, [](const Vec3i& v) { return v.y == 3; });
  state.density =
      make_density_grid(state.elements, std::vector<float>(2 * kBrickVoxels, 7.5f), -1000);
  state.q[0].resize(2);
  for (std::size_t b = 0; b < 2; ++b) {
    for_each_active(state.elements.mask(b),
                    [&](int offset) { state.q[0].touch(b)[offset] = 1 << (kFixedBits - 1); });
  }
  const OffsetField offsets = sample_offsets({{}, [](const Vec3d&) { return Vec3d(-0.5, 0, 0); }},
                                             state.geometry, state.elements);
  write_state(folder / "a.vdb", state, offsets);

  write_text(folder / "judge.py", R"(
import sys
import pyopenvdb as vdb
for name, direction, y in (('displacement', 'material', -1.0), ('offset', 'resample', 1.0)):
    grid = vdb.read(sys.argv[1], name)
    assert grid.activeVoxelCount() == 9 * 8, grid.activeVoxelCount()
    assert grid.getConstAccessor().getValue((8, 3, 2)) == (0.0, y, 0.0)
    assert grid.metadata['direction'] == direction and grid.metadata['units'] == 'mm'
    assert grid.metadata['frame'] == 'LPS'
    assert grid.metadata['vector_type'] == 'contravariant relative'
    assert grid.transform.indexToWorld((1, 1, 1)) == (13.0, 18.0, 34.0)
density = vdb.read(sys.argv[1], 'density')
assert density.getConstAccessor().getValue((8, 3, 2)) == 7.5
assert density.background == -1000
element = vdb.read(sys.argv[1], 'element')
assert element.activeVoxelCount() == 9 * 8
)");
  EXPECT_TRUE(runs_python((folder / "judge.py") + " " + (folder / "a.vdb")));
}
