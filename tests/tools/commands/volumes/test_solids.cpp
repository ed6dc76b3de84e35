// Bodies and volumes for ParaView, SOFA and FEBio: .vtu, .vtk and .vti, read back by VTK and meshio
// (skipped where python3-vtk9 or python3-meshio is not installed) and by ourselves.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/session/fem/state_solid.h"
#include "tests/support/program.h"
#include "volumes/io/volume_writer.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

/// A block of 6 x 5 x 4 voxels with a shell of void, and a material for it.
class Solids : public testing::Test {
 protected:
  void SetUp() override {
    write_volume(m_folder / "block.nrrd", kBlockGrid, ValueType::int16, [](int k, float* out) {
      for (int n = 0; n < 10 * 9; ++n) {
        const int i = n % 10, j = n / 10;
        const bool is_in = i >= 2 && i < 8 && j >= 2 && j < 7 && k >= 2 && k < 6;
        out[n] = is_in ? float(100 + i) : 0.0f;
      }
    });
    write_text(m_folder / "soft.toml",
               "domain = [0, 200]\nactive = [50, 200]\nmax_length = [[0, 1.5]]\n"
               "min_length = [[0, 0.5]]\nshear = [[0, 0.5]]\nstiffness = [[0, 10]]\n"
               "poisson = [[0, 0.3]]\n");
  }
  void deform(const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"deform",     m_folder / "block.nrrd",
                                          "--material", m_folder / "soft.toml",
                                          "-o",         m_folder / "d.vdb"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  void export_to(const std::string& name, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments = {"export", m_folder / "d.vdb", "-o", m_folder / name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  }
  Json info(const std::string& name) const {
    const Outcome outcome = run_supple({"info", "--json", m_folder / name});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return Json::parse(outcome.out, nullptr, false);
  }
  bool has_module(const std::string& name) const {
    return std::system(("/usr/bin/python3 -c 'import " + name + "' > /dev/null 2>&1").c_str()) == 0;
  }
  /// Runs the script; returns what it prints, as JSON.
  Json judged(const std::string& script) const {
    write_text(m_folder / "script.py", script);
    EXPECT_EQ(
        std::system(
            ("cd " + (m_folder / "") + " && /usr/bin/python3 script.py > out.json 2> log").c_str()),
        0)
        << read_text(m_folder / "log");
    return Json::parse(read_text(m_folder / "out.json"), nullptr, false);
  }

  const Geometry kBlockGrid{{10, 9, 8}, {5, -3, 2}, {Vec3d(0, 1.5, 0), {-2, 0, 0}, {0, 0, 2.5}}};
  TemporaryFolder m_folder;
};

using UnitSolids = Solids;
using InteropSolids = Solids;
using FaultSolids = Solids;

constexpr const char* kVtkScript = R"(
import json, vtk
said = {}
for name, reader in (('b.vtu', vtk.vtkXMLUnstructuredGridReader()), ('b.vtk', vtk.vtkUnstructuredGridReader())):
    reader.SetFileName(name)
    if name == 'b.vtk':
        reader.ReadAllScalarsOn(); reader.ReadAllVectorsOn()
    reader.Update()
    grid = reader.GetOutput()
    quality = vtk.vtkMeshQuality() if False else vtk.vtkCellSizeFilter()
    quality.SetInputData(grid)
    quality.Update()
    volumes = quality.GetOutput().GetCellData().GetArray('Volume')
    moved, density = grid.GetPointData().GetArray('displacement'), grid.GetCellData().GetArray('density')
    said[name] = {
        'points': grid.GetNumberOfPoints(), 'cells': grid.GetNumberOfCells(), 'bounds': grid.GetBounds(),
        'types': sorted({grid.GetCellType(n) for n in range(grid.GetNumberOfCells())}),
        'volumes': [min(volumes.GetTuple1(n) for n in range(volumes.GetNumberOfTuples())),
                    max(volumes.GetTuple1(n) for n in range(volumes.GetNumberOfTuples()))],
        'longest': max(sum(v * v for v in moved.GetTuple3(n)) ** .5 for n in range(moved.GetNumberOfTuples())),
        'density': density.GetRange(),
        'stress': grid.GetCellData().GetArray('von_mises').GetRange()}
reader = vtk.vtkXMLImageDataReader()
for name in ('o.vti', 'r.vti'):
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    matrix = image.GetDirectionMatrix()
    said[name] = {'dims': image.GetDimensions(), 'origin': image.GetOrigin(), 'spacing': image.GetSpacing(),
                  'direction': [[matrix.GetElement(r, c) for c in range(3)] for r in range(3)],
                  'array': image.GetPointData().GetArray(0).GetName(),
                  'components': image.GetPointData().GetArray(0).GetNumberOfComponents(),
                  'at': image.GetPointData().GetArray(0).GetTuple(image.ComputePointId((4, 3, 3)))}
print(json.dumps(said))
)";

}  // namespace

TEST_F(UnitSolids, ABodyIsItsElementsWithCornersShared) {
  deform({"--grab", "2,2,2:7,6,5", "--by", "0.6,0,0"});
  export_to("b.vtu");
  export_to("b.vtk");
  for (const char* name : {"b.vtu", "b.vtk"}) {
    const Json json = info(name);
    EXPECT_EQ(json["points"], 7 * 6 * 5) << name;
    EXPECT_EQ(json["cells"], 6 * 5 * 4) << name;
    EXPECT_EQ(json["point_arrays"]["displacement"], 3) << name;
    EXPECT_EQ(json["cell_arrays"]["density"], 1) << name;
    // Voxels 2 to 7 along P, 2 to 6 along R, 2 to 5 along S, with their faces.
    EXPECT_NEAR(json["low_lps_mm"][1].get<double>(), -3 + 1.5 * 1.5, 1e-9) << name;
    EXPECT_NEAR(json["high_lps_mm"][1].get<double>(), -3 + 7.5 * 1.5, 1e-9) << name;
    EXPECT_NEAR(json["low_lps_mm"][0].get<double>(), 5 - 6.5 * 2, 1e-9) << name;
    EXPECT_NEAR(json["high_lps_mm"][2].get<double>(), 2 + 5.5 * 2.5, 1e-9) << name;
  }
}

TEST_F(UnitSolids, AffineMotionIsExactUpToTheSurface) {
  deform({"--grab", "2,2,2:7,6,5", "--by", "0.6,0,0"});
  State state = read_state(m_folder / "d.vdb");
  // q of every element by hand: u = (0.1 i - 0.05 j, 0.02 k, 0.03 i) voxels, in exact fixed point.
  for (int c = 0; c < 3; ++c) state.q[std::size_t(c)] = BrickValues(state.elements.brick_count());
  const auto u = [](const Vec3d& x) {
    return Vec3d(0.125 * x.x - 0.0625 * x.y, 0.03125 * x.z, 0.25 * x.x);
  };
  for (std::size_t b = 0; b < state.elements.brick_count(); ++b) {
    for_each_active(state.elements.mask(b), [&](int offset) {
      const Vec3d moved = u(Vec3d(state.elements.origin(b) + brick_local(offset)));
      for (int c = 0; c < 3; ++c) {
        state.q[std::size_t(c)].set(b * kBrickVoxels + std::size_t(offset),
                                    std::int32_t(std::lround(moved[c] * kFixedOne)));
      }
    });
  }
  const HexSolid solid = solid_of(state, "d.vdb", {});
  ASSERT_EQ(solid.points_lps_mm.size(), 7u * 6 * 5);
  const std::vector<float>& moved = solid.of_points.front().values;
  for (std::size_t n = 0; n < solid.points_lps_mm.size(); ++n) {
    const Vec3d expected =
        kBlockGrid.world_vector_from_index(u(kBlockGrid.index_from_world(solid.points_lps_mm[n])));
    EXPECT_LT((Vec3d(moved[3 * n], moved[3 * n + 1], moved[3 * n + 2]) - expected).length(), 1e-4);
  }
}

TEST_F(UnitSolids, ACutPartsTheCornersOnItsSides) {
  write_text(m_folder / "cut.obj",
             "v 10 6.75 -20\nv -30 6.75 -20\nv -30 6.75 40\nv 10 6.75 40\nf 1 2 3\nf 1 3 4\n");
  deform({"--cut", m_folder / "cut.obj"});
  export_to("b.vtu");
  // Across P between voxels 4 and 5 and through the whole block: two blocks of 3 x 5 x 4.
  EXPECT_EQ(info("b.vtu")["points"], 2 * 4 * 6 * 5);
  EXPECT_EQ(info("b.vtu")["cells"], 6 * 5 * 4);
}

TEST_F(UnitSolids, OurOwnSolidLeadsBackAsAWarp) {
  deform({"--grab", "2,2,2:7,6,5", "--by", "0.6,-0.4,0.5"});
  export_to("b.vtu");
  const Warp warp = read_warp(m_folder / "b.vtu", nullptr, &kBlockGrid);
  const Vec3f back = warp.vectors[(4 * 9 + 4) * 10 + 5];
  const Vec3d by = kBlockGrid.direction()[0] * 0.6 - kBlockGrid.direction()[1] * 0.4 +
                   kBlockGrid.direction()[2] * 0.5;
  EXPECT_LT((Vec3d(back) + by).length(), 1e-4);
}

TEST_F(InteropSolids, VtkReadsBodiesAndImagesWhereTheyLie) {
  if (!has_module("vtk")) GTEST_SKIP() << "python3-vtk9 is not installed";
  deform({"--model", "fem", "--fix", "2,2,2:2,6,5", "--grab", "7,2,2:7,6,5", "--by", "0.9,0,0",
          "--elements", "von_mises=" + (m_folder / "s.nrrd")});
  for (const char* name : {"b.vtu", "b.vtk"}) {
    export_to(name, {"--elements", "von_mises=" + (m_folder / "s.nrrd")});
  }
  export_to("o.vti");
  ASSERT_EQ(run_supple({"resample", m_folder / "d.vdb", "-o", m_folder / "r.vti"}).exit_code, 0);
  const Json said = judged(kVtkScript);
  for (const char* name : {"b.vtu", "b.vtk"}) {
    const Json& one = said[name];
    EXPECT_EQ(one["points"], 7 * 6 * 5) << name;
    EXPECT_EQ(one["cells"], 6 * 5 * 4) << name;
    EXPECT_EQ(one["types"], Json({12})) << name;
    EXPECT_NEAR(one["volumes"][0].get<double>(), 1.5 * 2 * 2.5, 1e-4) << name << ": right-handed";
    EXPECT_NEAR(one["volumes"][1].get<double>(), 1.5 * 2 * 2.5, 1e-4) << name;
    // Grabbed voxels go by 0.9 mm; their gradient is that towards the next layer.
    EXPECT_GE(one["longest"].get<double>(), 0.9) << name;
    EXPECT_LT(one["longest"].get<double>(), 0.97) << name;
    EXPECT_EQ(one["density"][0], 102) << name;
    EXPECT_EQ(one["density"][1], 107) << name;
    EXPECT_NEAR(one["stress"][1].get<double>(), info("s.nrrd")["max"].get<double>(), 1e-4) << name;
  }
  const Warp warp = read_warp(m_folder / "o.vti");
  EXPECT_EQ(warp.direction, WarpDirection::resample);
  EXPECT_EQ(said["o.vti"]["array"], "offset");
  EXPECT_EQ(said["o.vti"]["components"], 3);
  EXPECT_EQ(said["r.vti"]["array"], "density");
  const Vec3f ours = warp.vectors[(3 * 9 + 3) * 10 + 4];
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(said["o.vti"]["at"][c].get<float>(), ours[c]);
    EXPECT_EQ(said["o.vti"]["dims"][c], kBlockGrid.dims()[c]);
    EXPECT_NEAR(said["o.vti"]["origin"][c].get<double>(), kBlockGrid.origin_lps_mm()[c], 1e-9);
    EXPECT_NEAR(said["o.vti"]["spacing"][c].get<double>(), kBlockGrid.spacing_mm()[c], 1e-9);
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(said["o.vti"]["direction"][c][a].get<double>(), kBlockGrid.direction()[a][c],
                  1e-9);
    }
  }
}

TEST_F(InteropSolids, MeshioReadsBodies) {
  if (!has_module("meshio")) GTEST_SKIP() << "python3-meshio is not installed";
  deform({"--grab", "2,2,2:7,6,5", "--by", "0.6,0,0"});
  export_to("b.vtu");
  export_to("b.vtk");
  const Json said = judged(
      "import json, meshio\nsaid = {}\nfor name in ('b.vtu', 'b.vtk'):\n"
      "    mesh = meshio.read(name)\n"
      "    said[name] = {'points': len(mesh.points), 'cells': len(mesh.cells_dict['hexahedron']),\n"
      "                  'moved': [float(v) for v in "
      "mesh.point_data['displacement'].max(axis=0)],\n"
      "                  'density': float(mesh.cell_data['density'][0].max())}\n"
      "print(json.dumps(said))\n");
  for (const char* name : {"b.vtu", "b.vtk"}) {
    EXPECT_EQ(said[name]["points"], 7 * 6 * 5) << name;
    EXPECT_EQ(said[name]["cells"], 6 * 5 * 4) << name;
    EXPECT_NEAR(said[name]["moved"][1].get<double>(), 0.6, 1e-4) << name;
    EXPECT_EQ(said[name]["density"], 107) << name;
  }
}

TEST_F(FaultSolids, WhatASolidCannotTakeIsToldAndLeavesNoFile) {
  deform({"--grab", "2,2,2:7,6,5", "--by", "0.6,0,0"});
  const std::string state = m_folder / "d.vdb", out = m_folder / "b.vtu";
  const auto expect = [&](const std::vector<std::string>& more, int code, const std::string& part) {
    std::vector<std::string> arguments = {"export", state, "-o", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(out));
  };
  write_volume(m_folder / "other.nrrd", kBlockGrid.with_dims({3, 3, 3}), ValueType::float32,
               [](int, float* values) { std::fill(values, values + 9, 1.0f); });
  expect({"--margin", "5"}, 2, "--margin");
  expect({"--elements", "a b=" + (m_folder / "other.nrrd")}, 2, "--elements");
  expect({"--elements", "stress=" + (m_folder / "other.nrrd")}, 3, "dims: found 3,3,3");
  const Outcome warp = run_supple({"export", state, "-o", m_folder / "w.nrrd", "--elements",
                                   "stress=" + (m_folder / "other.nrrd")});
  EXPECT_EQ(warp.exit_code, 2);
  EXPECT_NE(warp.err.find("--elements"), std::string::npos) << warp.err;
}
