// Scenes that the viewer opens: which of their views is shown, and that whatever file they name
// lies within the folders.
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "tests/support/errors.h"
#include "tests/support/program.h"
#include "tools/scene/live/live_view.h"
#include "tools/viewer/opened_file.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

Scene scene_of(const std::string& views) {
  return read_scene(Table::parse("[volume]\npath = \"none.nrrd\"\n" + views, "scene"));
}

}  // namespace

TEST(UnitOpenedScenes, TheFirstViewInSpaceOfTheBodyAtTheEndIsShown) {
  const std::string slice = "[[view]]\nimage = \"slice.png\"\nslice = { plane = \"axial\" }\n";
  const std::string rest = "[[view]]\nimage = \"rest.png\"\ndeformed = false\n";
  const std::string space = "[[view]]\nimage = \"space.png\"\n";
  const std::string series = "[[view]]\nimage = \"turn_%02d.png\"\nturntable = 4\n";
  EXPECT_EQ(shown_view(scene_of(rest + slice + space + series))->image, "space.png");
  EXPECT_EQ(shown_view(scene_of(slice + rest))->image, "rest.png");
  EXPECT_EQ(shown_view(scene_of(slice)), nullptr);
}

/// Slices alone of blocks under finite elements do not count, which have a look of their own.
TEST(UnitOpenedScenes, EveryPatientOfTheDocsHasAViewThatIsShown) {
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_dir() + "/docs/scenes")) {
    const std::string name = entry.path().stem().string();
    if (entry.path().extension() != ".toml") continue;
    Table root = Table::read(entry.path().string());
    const bool is_drawing = name.rfind("figure_", 0) == 0 || name.rfind("t_shape_", 0) == 0 ||
                            name.rfind("fem_", 0) == 0;
    if (!root.table("volume") || root.has("film") || root.has("labels") || is_drawing) continue;
    const Scene scene = read_scene(root);
    ++scenes;
    const bool is_shown = scene.views.empty() || shown_view(scene) != nullptr;
    EXPECT_TRUE(is_shown) << name;
  }
  EXPECT_GE(scenes, 15);
}

/// Every key of a file that names an input, itself or by a file that it names.
TEST(UnitOpenedScenes, NoKeyNamesAFileOutsideTheFolders) {
  const TemporaryFolder outside;
  std::filesystem::create_directory(outside / "in");
  std::ofstream(outside / "secret.toml") << "the secret\n";
  const std::string volume = "[volume]\npath = \"ball.nrrd\"\n";
  std::ofstream(outside / "in/ball.nrrd") << "no volume, which nobody reads here\n";
  std::ofstream(outside / "in/path.toml")
      << "[[path]]\nfunction = \"lattice\"\nlattice = [3, 3, 3]\npoints = \"../secret.toml\"\n";
  const std::vector<std::string> scenes = {
      "[volume]\npath = \"../secret.toml\"\n",
      "[volume]\npath = \"ball.nrrd\"\noffsets = \"../secret.toml\"\n",
      volume + "[labels]\npath = \"../secret.toml\"\n",
      volume + "[material]\ntable = \"../secret.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\ntransfer = \"../secret.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\ncamera = \"../secret.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\npath = \"../secret.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\npath = \"path.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\nlabels = \"../secret.toml\"\n",
      volume + "[[view]]\nimage = \"a.png\"\nmesh = [{ path = \"../secret.toml\" }]\n",
      volume + "[[step]]\nfix_points = \"../secret.toml\"\n",
      volume +
          "[[step]]\ngrab = [1, 1, 1]\nby = [1, 0, 0]\nmaterial = { table = \"../secret.toml\" }\n",
      volume + "[[step]]\npoints = \"../secret.toml\"\nby = [1, 0, 0]\n",
      volume + "[[step]]\ncut = [{ mesh = \"../secret.toml\" }]\n",
  };
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const std::string file = outside / ("in/scene_" + std::to_string(n) + ".toml");
    std::ofstream(file) << scenes[n];
    const std::string error = input_error([&] {
      Table root = Table::read(file);
      require_within(root, Folders({outside / "in"}));
      read_scene(root);
    });
    EXPECT_NE(error.find("(see --folder)"), std::string::npos) << scenes[n] << error;
    EXPECT_EQ(error.find("the secret"), std::string::npos) << error;
  }
}
