// Mesh bodies in scenes: pictures, files, reports, states, and refusals that name the line.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/io/mesh/mesh_writer.h"

using namespace supple;
using namespace supple::test;

namespace {

class SceneBodies : public ::testing::Test {
 protected:
  SceneBodies() {
    write_ball(m_folder, "ball", 16);
    LineNetwork square;
    square.mesh.vertices_lps_mm = {{0, -4, 0}, {15, -4, 0}, {15, -4, 15}, {0, -4, 15}, {7, -4, 8}};
    square.mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    write_mesh(m_folder / "sheet.ply", square);
  }

  Outcome run(const std::string& scene) {
    write_text(m_folder / "scene.toml", "[volume]\npath = \"ball.nhdr\"\n" + scene);
    return run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "", "--force", "--json"});
  }

  static std::string body(const std::string& more = "") {
    return "[[body]]\nname = \"sheet\"\npath = \"sheet.ply\"\nfix_rim = true\n" + more;
  }
  static std::string push(const std::string& more = "") {
    return "[[step]]\nbody = \"sheet\"\nframe = \"lps\"\ngrab = [7, -4, 8]\nby = [0, -3, 0]\n"
           "model = \"springs\"\nsprings = { minimise = true }\n" +
           more;
  }
  static std::string view(const std::string& image) {
    return "[[view]]\nimage = \"" + image + "\"\nsize = [64, 64]\n";
  }

  TemporaryFolder m_folder;
};

}  // namespace

using FaultSceneBodies = SceneBodies;

TEST_F(SceneBodies, AStepMovesOneOfThemAndTheFileHasIt) {
  const Outcome outcome =
      run(body("output = \"moved.vtk\"\n") + push() + "[output]\nstate = \"a.vdb\"\n");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const TriangleMesh moved = read_mesh(m_folder / "moved.vtk");
  EXPECT_EQ(moved.vertices_lps_mm[4], Vec3d(7, -7, 8));
  EXPECT_EQ(moved.vertices_lps_mm[0], Vec3d(0, -4, 0));
  const auto report = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(report["steps"][0]["body"], "sheet");
  EXPECT_EQ(report["steps"][0]["model"], "springs");
  EXPECT_LT(report["steps"][0]["springs"]["residual_mn"], 1e-3);
}

TEST_F(SceneBodies, PicturesShowThemWhereTheyAreAfterEachStep) {
  const std::string views = view("before.png") + "after_step = 0\n" + view("after.png");
  ASSERT_EQ(run(views + "[[step]]\nfix = [[8, 8, 8]]\n").exit_code, 0);
  const std::string alone = read_text(m_folder / "after.png");
  const Outcome outcome = run(body("colour = \"#20A040\"\n") + push() + views);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_NE(read_text(m_folder / "after.png"), alone);
  EXPECT_NE(read_text(m_folder / "after.png"), read_text(m_folder / "before.png"));
}

TEST_F(SceneBodies, AStateGoesOnWithThem) {
  ASSERT_EQ(run(body() + push() + "[output]\nstate = \"a.vdb\"\n").exit_code, 0);
  write_text(m_folder / "next.toml",
             "[volume]\npath = \"a.vdb\"\n" + push() + "[output]\nstate = \"b.vdb\"\n");
  const Outcome next = run_supple({"run", m_folder / "next.toml", "-o", m_folder / "", "--json"});
  ASSERT_EQ(next.exit_code, 0) << next.err;
  const auto info = nlohmann::json::parse(run_supple({"info", m_folder / "b.vdb", "--json"}).out);
  ASSERT_EQ(info["bodies"].size(), 1u);
  EXPECT_EQ(info["bodies"][0]["name"], "sheet");
  EXPECT_EQ(info["bodies"][0]["nodes"], 5);
  EXPECT_NEAR(info["bodies"][0]["moved_mm"], 6, 1e-6);
}

TEST_F(FaultSceneBodies, ErrorsNameTheLineAndWhatIsExpected) {
  const auto error_of = [&](const std::string& scene) {
    const Outcome outcome = run(scene);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.out << outcome.err;
    return outcome.err;
  };
  EXPECT_NE(error_of(body() + "[[step]]\nbody = \"sheat\"\ngrab = [1, 1, 1]\nby = [0, 0, 1]\n")
                .find("did you mean \"sheet\"?"),
            std::string::npos);
  EXPECT_NE(error_of("[[body]]\nname = \"sheet\"\n").find("scene.toml:3"), std::string::npos);
  EXPECT_NE(error_of(body() + body()).find("\"sheet\" twice"), std::string::npos);
  EXPECT_NE(error_of("[[body]]\nname = \"a\"\npath = \"none.ply\"\n" + push()).find("none.ply"),
            std::string::npos);
  EXPECT_NE(error_of(body("output = \"a.png\"\n") + push()).find(".stl, .ply, .obj or .vtk"),
            std::string::npos);
  EXPECT_NE(error_of(body() + push("cut = [{ plane = { corner = [0, 0, 0], edge1 = [9, 0, 0], "
                                   "edge2 = [0, 9, 0] } }]\n"))
                .find("cut beside body \"sheet\""),
            std::string::npos);
}
