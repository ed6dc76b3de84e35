// Solid meshes in files: what is written is read back, by us and by meshio, VTK and CalculiX.
#include <cmath>
#include <cstdlib>

#include <gtest/gtest.h>

#include "lib/mesh/tets/make_solid.h"
#include "tests/support/errors.h"
#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"
#include "volumes/io/solid/solid_mesh_file.h"

namespace supple::test {
namespace {

/// Tetrahedra of an ellipsoid in two regions and two materials.
SolidMesh ellipsoid() {
  std::vector<Vec3i> voxels;
  for (int n = 0; n < 12 * 12 * 12; ++n) {
    const Vec3i at(n % 12, n / 12 % 12, n / 144);
    const Vec3d from = Vec3d(at) - Vec3d(5.5);
    if (from.length2() < 25) voxels.push_back(at);
  }
  const Geometry geometry(Vec3i(12), {-40, 3, 100}, {Vec3d(1.5, 0, 0), {0, 1.2, 0}, {0, 0, 2}});
  SolidParams params;
  params.spacing_mm = 3;
  BrickTopology topology(
      {Vec3i(0), {0, 0, 8}, {0, 8, 0}, {0, 8, 8}, {8, 0, 0}, {8, 0, 8}, {8, 8, 0}, {8, 8, 8}}, [&] {
        std::vector<BrickMask> masks(8);
        for (const Vec3i& v : voxels) {
          const int brick = (v.x >> 3) * 4 + (v.y >> 3) * 2 + (v.z >> 3);
          mask_set(masks[std::size_t(brick)], brick_offset(v));
        }
        return masks;
      }());
  SolidMesh mesh = make_tets(mask_of(geometry, topology), params, 4, "outer wall");
  mesh.materials = {{"soft", 6, 0.45}, {"stiff", 18.5, 0.3}};
  for (std::size_t e = 0; e < mesh.tets.size(); ++e) {
    mesh.region_of[e] = e % 3 == 0 ? 9 : 4;
    mesh.material_of.push_back(std::int32_t(e % 2));
  }
  return mesh;
}

/// Young's modulus and Poisson's ratio of all elements.
std::vector<std::pair<float, float>> stiffness_of(const SolidMesh& mesh) {
  std::vector<std::pair<float, float>> of_elements;
  for (const std::int32_t material : mesh.material_of) {
    const SolidMaterial& made = mesh.materials[std::size_t(material)];
    of_elements.emplace_back(float(made.young_kpa), float(made.poisson));
  }
  return of_elements;
}

SolidMesh two_hexahedra() {
  SolidMesh mesh;
  for (int n = 0; n < 12; ++n) mesh.nodes_lps_mm.push_back(Vec3d(n % 3, n / 3 % 2, n / 6));
  mesh.hexes = {{0, 1, 4, 3, 6, 7, 10, 9}, {1, 2, 5, 4, 7, 8, 11, 10}};
  mesh.region_of = {1, 2};
  mesh.material_of = {0, 0};
  mesh.materials = {{"one", 3, 0.2}};
  mesh.faces = {{"end", {{2, 5, 11}, {2, 11, 8}}}};
  return mesh;
}

}  // namespace

TEST(UnitSolidMeshFile, ElementsRegionsAndMaterialsComeBackFromVtuAndInp) {
  const TemporaryFolder folder;
  for (const SolidMesh& mesh : {ellipsoid(), two_hexahedra()}) {
    for (const char* name : {"mesh.vtu", "mesh.inp"}) {
      write_solid_mesh(folder / name, mesh);
      const SolidMesh read = read_solid_mesh(folder / name);
      ASSERT_EQ(read.nodes_lps_mm.size(), mesh.nodes_lps_mm.size()) << name;
      for (std::size_t n = 0; n < mesh.nodes_lps_mm.size(); ++n) {
        EXPECT_LT((read.nodes_lps_mm[n] - mesh.nodes_lps_mm[n]).length(), 1e-9) << name;
      }
      EXPECT_EQ(read.tets, mesh.tets) << name;
      EXPECT_EQ(read.hexes, mesh.hexes) << name;
      EXPECT_EQ(read.region_of, mesh.region_of) << name;
      EXPECT_EQ(stiffness_of(read), stiffness_of(mesh)) << name;
    }
  }
}

TEST(UnitSolidMeshFile, FacesComeBackFromInpAsSeenFromOutside) {
  const TemporaryFolder folder;
  for (const SolidMesh& mesh : {ellipsoid(), two_hexahedra()}) {
    write_solid_mesh(folder / "mesh.inp", mesh);
    const SolidMesh read = read_solid_mesh(folder / "mesh.inp");
    ASSERT_EQ(read.faces.size(), 1u);
    EXPECT_EQ(read.faces[0].name, mesh.faces[0].name == "end" ? "end" : "outer_wall");
    const auto area = [](const SolidMesh& of) {
      Vec3d sum(0);
      double size = 0;
      for (const auto& t : of.faces[0].triangles) {
        const Vec3d across =
            (of.nodes_lps_mm[std::size_t(t[1])] - of.nodes_lps_mm[std::size_t(t[0])])
                .cross(of.nodes_lps_mm[std::size_t(t[2])] - of.nodes_lps_mm[std::size_t(t[0])]);
        sum += across;
        size += across.length();
      }
      return std::pair(sum, size);
    };
    EXPECT_EQ(read.faces[0].triangles.size(), mesh.faces[0].triangles.size());
    EXPECT_LT((area(read).first - area(mesh).first).length(), 1e-8);
    EXPECT_NEAR(area(read).second, area(mesh).second, 1e-8);
  }
}

TEST(UnitSolidMeshFile, DecksOfOthersMayNumberAndNameAsTheyLike) {
  const TemporaryFolder folder;
  write_text(folder / "other.inp",
             "** a comment\n*Heading\n a bar\n*Node\n 10, 0., 0., 0.\n 20, 1., 0., 0.\n"
             "30, 0, 1., 0\n 40, 0., 0., 1e0,\n*Element, type=c3d10, elset=Part-1\n"
             "7, 10, 20, 30, 40, 10, 20,\n30, 40, 10, 20\n*ELEMENT, TYPE=S3\n8, 10, 20, 30\n"
             "*Elset, elset=all, generate\n7, 7, 1\n*Surface, name=Base\nALL, S1\n"
             "*Material, name=Steel\n*Elastic\n 210e6, .3\n"
             "*Solid Section, elset=ALL, material=STEEL\n");
  const SolidMesh mesh = read_solid_mesh(folder / "other.inp");
  ASSERT_EQ(mesh.tets.size(), 1u);
  EXPECT_EQ(mesh.tets[0], (std::array<std::int32_t, 4>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.region_of, std::vector<std::int32_t>{1});
  ASSERT_EQ(mesh.materials.size(), 1u);
  EXPECT_EQ(mesh.materials[0].young_kpa, 210e6);
  EXPECT_EQ(mesh.materials[0].name, "steel");
  ASSERT_EQ(mesh.faces.size(), 1u);
  EXPECT_EQ(mesh.faces[0].triangles, (std::vector<std::array<std::int32_t, 3>>{{0, 2, 1}}));
}

TEST(UnitSolidMeshFile, RegionsOfNamesDifferAndElementsOfNoSectionHaveNoMaterial) {
  const TemporaryFolder folder;
  const std::string nodes = "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n",
                    tet = ", 1, 2, 3, 4\n";
  write_text(folder / "sets.inp",
             nodes + "*ELEMENT, TYPE=C3D4, ELSET=region_1\n1" + tet +
                 "*ELEMENT, TYPE=C3D4, ELSET=skull\n2" + tet +
                 "*ELEMENT, TYPE=C3D4, ELSET=region_99999999999\n3" + tet +
                 "*MATERIAL, NAME=a\n*ELASTIC, TYPE=ORTHO\n1, 2, 3, 4, 5, 6, 7, 8\n"
                 "*MATERIAL, NAME=b\n*ELASTIC, TYPE=ISO\n5, 0.3\n"
                 "*SOLID SECTION, ELSET=skull, MATERIAL=b\n");
  SolidMesh mesh = read_solid_mesh(folder / "sets.inp");
  EXPECT_EQ(mesh.region_of, (std::vector<std::int32_t>{1, 2, 3}));
  EXPECT_EQ(mesh.material_of, (std::vector<std::int32_t>{-1, 1, -1}));
  EXPECT_EQ(mesh.materials.at(0).young_kpa, 0);
  EXPECT_EQ(mesh.materials.at(1).young_kpa, 5);
  for (const char* name : {"none.vtu", "none.inp", "none.feb"}) {
    write_solid_mesh(folder / name, mesh);
    if (std::string(name) == "none.feb") continue;
    EXPECT_EQ(read_solid_mesh(folder / name).material_of, mesh.material_of) << name;
  }
  EXPECT_EQ(read_text(folder / "none.feb").find("mat=\"\""), std::string::npos);
}

TEST(FaultSolidMeshFile, DecksAndGridsThatCannotBeAreRefused) {
  const TemporaryFolder folder;
  const std::string deck =
      "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n4, 0, 0, 1\n"
      "*ELEMENT, TYPE=C3D4, ELSET=all\n1, 1, 2, 3, 4\n*MATERIAL, NAME=m\n*ELASTIC\n1, 0.3\n";
  const std::string section = "*SOLID SECTION, ELSET=A, MATERIAL=m\n";
  const std::string generate = "*ELSET, ELSET=A, GENERATE\n";
  const auto grid = [](const std::string& type, const std::string& region,
                       const std::string& material) {
    const auto array = [](const std::string& name, const std::string& values) {
      return "<DataArray type=\"Float64\" Name=\"" + name + "\" format=\"ascii\">" + values +
             "</DataArray>";
    };
    return "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" "
           "NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" "
           "format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1</DataArray></Points><Cells>" +
           array("connectivity", "0 1 2 3") + array("offsets", "4") + array("types", type) +
           "</Cells><CellData>" + array("region", region) + array("material", material) +
           "</CellData></Piece></UnstructuredGrid></VTKFile>";
  };
  struct Case {
    const char* name;
    std::string text, said;
  };
  const Case cases[] = {
      {"a.inp", deck + generate + "1, 9000000000000000000, 1\n", "at most 100000000 elements"},
      {"b.inp", deck + generate + "-5, 7\n", "found -5 to 7"},
      {"c.inp", deck + "*ELSET, ELSET=A\nB\n*ELSET, ELSET=B\n1, A\n" + section, "without circles"},
      {"d.inp", deck + "*ELEMENT, TYPE=C3D4\n2, 1, 2\n", "the other nodes of an element"},
      {"e.vtu", grid("1e300", "1", "0"), "types: found 1e+300"},
      {"f.vtu", grid("10", "nan", "0"), "region: found nan"},
      {"g.vtu", grid("10", "1.5", "0"), "region: found 1.5"},
      {"h.vtu", grid("10", "1", "1e9"), "material: found 1"},
      {"i.vtu", grid("10", "1", "-2"), "material: found -2"},
  };
  for (const Case& one : cases) {
    write_text(folder / one.name, one.text);
    const std::string error = input_error([&] { read_solid_mesh(folder / one.name); });
    EXPECT_NE(error.find(one.said), std::string::npos) << one.name << ": " << error;
  }
  write_text(folder / "good.vtu", grid("10", "7", "3"));
  write_solid_mesh(folder / "again.vtu", read_solid_mesh(folder / "good.vtu"));
  EXPECT_EQ(read_solid_mesh(folder / "again.vtu").materials.size(), 4u);
}

TEST(FaultSolidMeshFile, DamagedFilesAreToldByLine) {
  const TemporaryFolder folder;
  const auto failure = [&](const std::string& name, const std::string& text) {
    write_text(folder / name, text);
    return input_error([&] { read_solid_mesh(folder / name); });
  };
  EXPECT_NE(failure("a.inp", "*NODE\n1, 0, 0\n").find("line 2: found 3 numbers"),
            std::string::npos);
  EXPECT_NE(failure("b.inp", "*NODE\n1, 0, x, 0\n").find("line 2: found 'x'"), std::string::npos);
  EXPECT_NE(failure("c.inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=C3D4\n1, 1, 2, 3, 4\n")
                .find("line 4: found node 2"),
            std::string::npos);
  EXPECT_NE(failure("d.inp", "*NODE\n1, 0, 0, 0\n").find("elements: found none"),
            std::string::npos);
  EXPECT_NE(failure("e.vtu", "<VTKFile type=\"UnstructuredGrid\"></VTKFile>").find("elements"),
            std::string::npos);
  EXPECT_NE(failure("f.feb", "").find("expected .vtu or .inp"), std::string::npos);
  EXPECT_NE(input_error([&] {
              write_solid_mesh(folder / "g.stp", SolidMesh());
            }).find("expected .vtu, .inp, .feb or .msh"),
            std::string::npos);
}

namespace {

const char* const kSolidByOthers = R"(
import meshio, vtk, sys, xml.etree.ElementTree as tree
nodes, tets, surface = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
for name in ('mesh.vtu', 'mesh.inp', 'mesh.msh'):
    mesh = meshio.read(name)
    assert len(mesh.points) == nodes, name
    assert sum(len(c.data) for c in mesh.cells if c.type == 'tetra') == tets, name
    if name == 'mesh.msh': assert sum(len(c.data) for c in mesh.cells if c.type == 'triangle') == surface
reader = vtk.vtkXMLUnstructuredGridReader()
reader.SetFileName('mesh.vtu')
reader.Update()
grid = reader.GetOutput()
assert grid.GetNumberOfCells() == tets
assert grid.GetCellData().GetArray('young_kpa').GetRange() == (6, 18.5)
quality = vtk.vtkMeshQuality()
quality.SetInputData(grid)
quality.SetTetQualityMeasureToVolume()
quality.Update()
assert quality.GetOutput().GetCellData().GetArray('Quality').GetRange()[0] > 0
model = tree.parse('mesh.feb').getroot()
assert len(model.find('Mesh/Nodes')) == nodes
assert sum(len(e) for e in model.findall('Mesh/Elements')) == tets
assert len(model.find('Mesh/Surface')) == surface
parts = {e.get('name') for e in model.findall('Mesh/Elements')}
assert {d.get('name') for d in model.findall('MeshDomains/SolidDomain')} == parts
materials = {m.get('name') for m in model.findall('Material/material')}
assert {d.get('mat') for d in model.findall('MeshDomains/SolidDomain')} == materials
)";

}  // namespace

TEST(InteropSolidMeshFile, MeshioAndVtkReadWhatIsWritten) {
  if (!runs("/usr/bin/python3 -c 'import meshio, vtk'")) {
    GTEST_SKIP() << "python3-meshio and python3-vtk9 are not installed";
  }
  const TemporaryFolder folder;
  const SolidMesh mesh = ellipsoid();
  for (const char* name : {"mesh.vtu", "mesh.inp", "mesh.msh", "mesh.feb"}) {
    write_solid_mesh(folder / name, mesh);
  }
  write_text(folder / "script.py", kSolidByOthers);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && /usr/bin/python3 script.py " +
                   std::to_string(mesh.nodes_lps_mm.size()) + " " +
                   std::to_string(mesh.tets.size()) + " " +
                   std::to_string(mesh.faces[0].triangles.size()) + " > log 2>&1"))
      << read_text(folder / "log");
}

TEST(InteropSolidMeshFile, CalculixPressesABodyTogetherByItsBulkModulus) {
  if (!runs("command -v ccx")) GTEST_SKIP() << "calculix-ccx is not installed";
  const TemporaryFolder folder;
  SolidMesh mesh = ellipsoid();
  mesh.materials[1] = mesh.materials[0];
  write_solid_mesh(folder / "mesh.inp", mesh);
  // Three nodes of the lattice hold the body as little as can be: its motion is known then.
  const auto place = [&](std::size_t n) { return mesh.nodes_lps_mm[n]; };
  std::size_t first = 0, along_x = 0, in_plane = 0;
  for (; first < mesh.nodes_lps_mm.size() && (along_x == 0 || in_plane == 0); ++first) {
    along_x = in_plane = 0;
    for (std::size_t n = 0; n < mesh.nodes_lps_mm.size(); ++n) {
      const Vec3d d = place(n) - place(first);
      if (std::abs(d.z) > 1e-9 || n == first) continue;
      (std::abs(d.y) < 1e-9 ? along_x : in_plane) = n;
    }
  }
  --first;
  ASSERT_GT(along_x, 0u);
  ASSERT_GT(in_plane, 0u);
  const auto held = [](std::size_t n, const char* components) {
    return std::to_string(n + 1) + ", " + components + ", 0\n";
  };
  // A pressure of 0.3 kPa all around.
  write_text(folder / "press.inp",
             "*INCLUDE, INPUT=mesh.inp\n*STEP\n*STATIC\n*DSLOAD\nouter_wall, P, 0.3\n*BOUNDARY\n" +
                 held(first, "1, 3") + held(along_x, "2, 3") + held(in_plane, "3, 3") +
                 "*NODE PRINT, NSET=all_nodes\nU\n*END STEP\n");
  ASSERT_TRUE(runs("cd " + (folder / "") + " && ccx press > log 2>&1"))
      << read_text(folder / "log");
  std::istringstream lines(read_text(folder / "press.dat"));
  const double strain = -0.3 * (1 - 2 * 0.45) / 6;  // -p / 3K
  std::size_t found = 0;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t number = 0;
    Vec3d u;
    if (!(words >> number >> u.x >> u.y >> u.z)) continue;
    const Vec3d expected = (place(number - 1) - place(first)) * strain;
    EXPECT_LT((u - expected).length(), 2e-5 * std::abs(strain) * 20) << number;
    ++found;
  }
  EXPECT_EQ(found, mesh.nodes_lps_mm.size());
}

}  // namespace supple::test
