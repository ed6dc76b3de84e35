// VTK writes a solid that has moved in every encoding that it has, and says itself what lies where;
// skipped where python3-vtk9 is not installed.
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/vtu/vtu.h"
#include "volumes/io/warp_file.h"

namespace supple::test {
namespace {

const char* const kScript = R"(
import random
import vtk
random.seed(3)
points = vtk.vtkPoints()
points.SetDataTypeToDouble()
moved = vtk.vtkDoubleArray()
moved.SetName('U')
moved.SetNumberOfComponents(3)
for n in range(200):
    x = [random.uniform(-10, 10) for _ in range(3)]
    points.InsertNextPoint(x)
    moved.InsertNextTuple([0.1 * x[1] + 1, 0.02 * x[0] * x[0] - 2, -0.1 * x[2] + 0.05 * x[0]])
cloud = vtk.vtkPolyData()
cloud.SetPoints(points)
cloud.GetPointData().AddArray(moved)
solid = vtk.vtkDelaunay3D()
solid.SetInputData(cloud)
solid.Update()
grid = solid.GetOutput()
for name, mode, raw, zlib, big, wide in [('ascii', 0, 0, 0, 0, 0), ('binary', 1, 0, 0, 0, 0),
        ('zlib', 1, 0, 1, 0, 1), ('appended', 2, 0, 1, 0, 0), ('raw', 2, 1, 0, 0, 1),
        ('rawzlib', 2, 1, 1, 0, 0), ('big', 2, 0, 0, 1, 0)]:
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(name + '.vtu')
    writer.SetDataMode(mode)
    writer.SetEncodeAppendedData(not raw)
    writer.SetBlockSize(512)
    writer.SetCompressorTypeToZLib() if zlib else writer.SetCompressorTypeToNone()
    writer.SetHeaderTypeToUInt64() if wide else writer.SetHeaderTypeToUInt32()
    if big:
        writer.SetByteOrderToBigEndian()
    writer.Write()
grid.GetPointData().SetActiveVectors('U')
warped = vtk.vtkWarpVector()
warped.SetInputData(grid)
image = vtk.vtkImageData()
image.SetDimensions(20, 18, 16)
image.SetOrigin(-12, -11, -10)
image.SetSpacing(1.25, 1.25, 1.25)
probe = vtk.vtkProbeFilter()
probe.SetInputData(image)
probe.SetSourceConnection(warped.GetOutputPort())
probe.Update()
vectors = probe.GetOutput().GetPointData().GetArray('U')
known = probe.GetOutput().GetPointData().GetArray(probe.GetValidPointMaskArrayName())
with open('vtk.txt', 'w') as out:
    for n in range(vectors.GetNumberOfTuples()):
        print(int(known.GetTuple1(n)), *('%.17g' % v for v in vectors.GetTuple(n)), file=out)
)";

TEST(InteropVtu, EveryEncodingIsReadAndSolidsLieWhereVtkFindsThem) {
  if (std::system("/usr/bin/python3 -c 'import vtk' > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "python3-vtk9 is not installed";
  }
  const TemporaryFolder folder;
  write_text(folder / "script.py", kScript);
  ASSERT_EQ(
      std::system(("cd " + (folder / "") + " && /usr/bin/python3 script.py > log 2>&1").c_str()), 0)
      << read_text(folder / "log");
  const Geometry grid({20, 18, 16}, {-12, -11, -10},
                      {Vec3d(1.25, 0, 0), {0, 1.25, 0}, {0, 0, 1.25}});
  const Warp warp = read_warp(folder / "raw.vtu", nullptr, &grid);
  std::istringstream judge(read_text(folder / "vtk.txt"));
  int inside = 0, on_hull = 0;
  for (std::size_t n = 0; n < warp.vectors.size(); ++n) {
    int known = 0;
    Vec3d u;
    judge >> known >> u.x >> u.y >> u.z;
    const Vec3d ours(warp.vectors[n]);
    inside += known;
    // Where the hull passes by a point only one of both may find it.
    const bool is_ours = ours.length() > 0;
    on_hull += is_ours != (known == 1);
    if (is_ours && known == 1) {
      ASSERT_LT((ours + u).length(), 1e-3) << n;  // VTK warps in floats
    }
  }
  EXPECT_GT(inside, 1500);
  EXPECT_LT(on_hull, inside / 100);
  const MovedSolid raw = read_vtu(folder / "raw.vtu");
  for (const char* name : {"ascii", "binary", "zlib", "appended", "rawzlib", "big"}) {
    const MovedSolid other = read_vtu(folder / (std::string(name) + ".vtu"));
    EXPECT_EQ(other.tetrahedra, raw.tetrahedra) << name;
    ASSERT_EQ(other.points_lps_mm.size(), raw.points_lps_mm.size()) << name;
    for (std::size_t n = 0; n < raw.points_lps_mm.size(); ++n) {
      ASSERT_LT((other.moved_mm[n] - raw.moved_mm[n]).length(), 1e-5) << name;
      ASSERT_LT((other.points_lps_mm[n] - raw.points_lps_mm[n]).length(), 1e-5) << name;
    }
  }
}

}  // namespace
}  // namespace supple::test
