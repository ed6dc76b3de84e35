// VTK writes a solid that has moved in every encoding that it has, and says itself what lies where;
// skipped where python3-vtk9 is not installed.
#include <cstdlib>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
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
    // Only one of both may find a point that the hull passes by.
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

const char* const kMeshio = R"(
import meshio, numpy
places = numpy.array([[x, y, z] for z in (0.0, 4.0) for y in (0.0, 4.0) for x in (0.0, 4.0, 8.0)])
moved = places * [0.1, -0.05, 0.02] + [1, 2, 3]
cubes = numpy.array([[0, 1, 4, 3, 6, 7, 10, 9], [1, 2, 5, 4, 7, 8, 11, 10]])
mesh = meshio.Mesh(places, [('hexahedron', cubes)], point_data={'Displacement': moved},
                   cell_data={'stress': [numpy.ones((2, 6))]})
meshio.write('ascii.vtu', mesh, file_format='vtu', binary=False)
for name in ('zlib', 'none', 'lzma'):
    compression = None if name == 'none' else name
    meshio.write(name + '.vtu', mesh, file_format='vtu', binary=True, compression=compression)
)";

TEST(InteropVtu, FilesOfMeshioAreReadOrRefusedByTheirCompression) {
  if (std::system("/usr/bin/python3 -c 'import meshio' > /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "python3-meshio is not installed";
  }
  const TemporaryFolder folder;
  write_text(folder / "script.py", kMeshio);
  ASSERT_EQ(
      std::system(("cd " + (folder / "") + " && /usr/bin/python3 script.py > log 2>&1").c_str()), 0)
      << read_text(folder / "log");
  for (const char* name : {"ascii", "zlib", "none"}) {
    const MovedSolid solid = read_vtu(folder / (std::string(name) + ".vtu"));
    ASSERT_EQ(solid.points_lps_mm.size(), 12u) << name;
    EXPECT_GE(solid.tetrahedra.size(), 10u) << name;
    for (std::size_t n = 0; n < 12; ++n) {
      const Vec3d& x = solid.points_lps_mm[n];
      const Vec3i at(int(n) % 3, int(n) / 3 % 2, int(n) / 6);
      EXPECT_EQ(x, Vec3d(at) * 4.0) << name;
      const Vec3d u = x * Vec3d(0.1, -0.05, 0.02) + Vec3d(1, 2, 3);
      EXPECT_LT((solid.moved_mm[n] - u).length(), 1e-9) << name;
    }
  }
  const std::string refused = input_error([&] { read_vtu(folder / "lzma.vtu"); });
  EXPECT_NE(refused.find("compressor: found vtkLZMADataCompressor"), std::string::npos) << refused;
}

/// A bar of 20 x 10 x 10 mm that CalculiX stretches by a tenth; its `.frd` as VTU by meshio.
const char* const kCalculix = R"(
import subprocess, meshio, numpy
places, n = [], {}
for k in range(3):
    for j in range(3):
        for i in range(5):
            n[i, j, k] = len(places) + 1
            places.append((5.0 * i, 5.0 * j, 5.0 * k))
cubes = [[n[i+a, j+b, k+c] for a, b, c in ((0,0,0),(1,0,0),(1,1,0),(0,1,0),(0,0,1),(1,0,1),(1,1,1),(0,1,1))]
         for k in range(2) for j in range(2) for i in range(4)]
with open('bar.inp', 'w') as f:
    f.write('*NODE, NSET=ALL\n')
    for m, p in enumerate(places): f.write('%d, %g, %g, %g\n' % (m + 1, *p))
    f.write('*ELEMENT, TYPE=C3D8, ELSET=BAR\n')
    for m, c in enumerate(cubes): f.write('%d, %s\n' % (m + 1, ', '.join(map(str, c))))
    f.write('*MATERIAL, NAME=M\n*ELASTIC\n1.0, 0.3\n*SOLID SECTION, ELSET=BAR, MATERIAL=M\n')
    f.write('*STEP\n*STATIC\n*BOUNDARY\n')
    for m, p in enumerate(places):
        if p[0] == 0: f.write('%d, 1, 1, 0\n' % (m + 1))
        if p[0] == 20: f.write('%d, 1, 1, 2\n' % (m + 1))
        if p[1] == 0: f.write('%d, 2, 2, 0\n' % (m + 1))
        if p[2] == 0: f.write('%d, 3, 3, 0\n' % (m + 1))
    f.write('*NODE FILE\nU\n*END STEP\n')
subprocess.run(['ccx', 'bar'], check=True, stdout=subprocess.DEVNULL)
moved, reading = numpy.zeros((len(places), 3)), False
for line in open('bar.frd'):
    if line.startswith(' -4'): reading = 'DISP' in line
    elif line.startswith(' -3'): reading = False
    elif reading and line.startswith(' -1'):
        moved[int(line[3:13]) - 1] = [float(line[13 + 12 * c:25 + 12 * c]) for c in range(3)]
meshio.write('bar.vtu', meshio.Mesh(numpy.array(places), [('hexahedron', numpy.array(cubes) - 1)],
                                    point_data={'U': moved}), file_format='vtu')
)";

TEST(InteropVtu, ABarThatCalculixStretchesGetsThinnerByPoissonsRatio) {
  if (std::system("command -v ccx > /dev/null && /usr/bin/python3 -c 'import meshio' "
                  "> /dev/null 2>&1") != 0) {
    GTEST_SKIP() << "calculix-ccx and python3-meshio are not installed";
  }
  const TemporaryFolder folder;
  write_text(folder / "script.py", kCalculix);
  ASSERT_EQ(
      std::system(("cd " + (folder / "") + " && /usr/bin/python3 script.py > log 2>&1").c_str()), 0)
      << read_text(folder / "log");
  const Geometry grid({12, 6, 6}, {0.5, 0.5, 0.5}, {Vec3d(1.7, 0, 0), {0, 1.7, 0}, {0, 0, 1.7}});
  const Warp warp = read_warp(folder / "bar.vtu", nullptr, &grid);
  int inside = 0;
  for (std::size_t n = 0; n < warp.vectors.size(); ++n) {
    const Vec3i at(int(n) % 12, int(n) / 12 % 6, int(n) / 72);
    const Vec3d y = grid.world_from_index(Vec3d(at));
    const Vec3d x = y / Vec3d(1.1, 0.97, 0.97);
    if (x.x > 20 || x.y > 10 || x.z > 10) continue;
    EXPECT_LT((Vec3d(warp.vectors[n]) - (x - y)).length(), 1e-4) << y;
    ++inside;
  }
  EXPECT_GT(inside, 300);
}

}  // namespace
}  // namespace supple::test
