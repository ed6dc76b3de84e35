// Golden images: small deterministic renders against committed references. On failure the image,
// the reference and their difference are kept under the build folder's test-output/golden.
// `bash tools/update_golden.sh` renders the references anew.
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "raycast/compare.h"
#include "raycast/render.h"
#include "tests/tools/program.h"
#include "volumes/field/invert.h"
#include "volumes/state/state.h"

using namespace supple;
using namespace supple::test;

namespace {

constexpr double kMaxRmse = 1e-3;
constexpr double kMinSsim = 0.999;
constexpr double kMaxDiff = 0.1;

const std::string kGolden = "/tests/golden/";

/// Generated input, scene and outputs of one golden scene, in a folder of its own.
class GoldenScene {
 public:
  GoldenScene(const std::string& scene, const std::string& input) {
    const std::filesystem::path bin =
        std::filesystem::path(std::getenv("SUPPLE_BINARY")).parent_path();
    const std::string kind = std::filesystem::path(input).stem().string();
    EXPECT_EQ(run_program({(bin / "supple-examples").string(), "phantom", kind, m_folder / input})
                  .exit_code,
              0);
    std::filesystem::copy_file(source_dir() + kGolden + scene, m_folder / scene);
    m_outcome = run_supple({"run", m_folder / scene, "-o", m_folder.path()});
    EXPECT_EQ(m_outcome.exit_code, 0) << m_outcome.err;
  }
  std::string operator/(const std::string& name) const { return m_folder / name; }

 private:
  TemporaryFolder m_folder;
  Outcome m_outcome;
};

std::string kept(const std::string& name) {
  const std::filesystem::path folder =
      std::filesystem::path(std::getenv("SUPPLE_TEST_OUTPUT")) / "golden";
  std::filesystem::create_directories(folder);
  return (folder / name).string();
}

void expect_golden(const GoldenScene& scene, const std::string& name) {
  const std::string image = scene / name;
  const std::string reference = source_dir() + kGolden + "reference/" + name;
  const Outcome outcome =
      run_supple({"compare", image, reference, "--max-rmse", std::to_string(kMaxRmse), "--min-ssim",
                  std::to_string(kMinSsim), "--max-diff", std::to_string(kMaxDiff)});
  if (outcome.exit_code == 0) return;
  const std::string stem = std::filesystem::path(name).stem().string();
  std::filesystem::copy_file(image, kept(stem + "_image.png"),
                             std::filesystem::copy_options::overwrite_existing);
  std::filesystem::copy_file(reference, kept(stem + "_reference.png"),
                             std::filesystem::copy_options::overwrite_existing);
  run_supple({"compare", image, reference, "--diff", kept(stem + "_difference.png"), "--force"});
  ADD_FAILURE() << name << ": " << outcome.out << outcome.err << "kept in " << kept("");
}

}  // namespace

TEST(GoldenImages, TheHeadPhantomLooksAsItDid) {
  const GoldenScene scene("head.toml", "small-head.nhdr");
  for (const char* name :
       {"head_bone_rest.png", "head_bone_drag.png", "head_skin_drag.png", "head_soft_drag.png"}) {
    expect_golden(scene, name);
  }
}

TEST(GoldenImages, SamplingPathsLookAsTheyDid) {
  const GoldenScene scene("paths.toml", "small-head.nhdr");
  for (const char* name :
       {"paths_explode_rest.png", "paths_open_twist_drag.png", "paths_bend_lattice_drag.png"}) {
    expect_golden(scene, name);
  }
}

TEST(GoldenImages, TheLatticeOfASliceLooksAsItDid) {
  const GoldenScene scene("slice.toml", "t-shape.png");
  expect_golden(scene, "slice_lattice.png");
}

TEST(GoldenImages, AFlippedOffsetSignFailsTheGoldenImage) {
  const GoldenScene scene("head.toml", "small-head.nhdr");
  const State state = read_state(scene / "head.vdb");
  OffsetField offsets = invert(extended_displacement_of(state));
  Renderer renderer(state.geometry, state.density);
  RenderSettings settings;
  settings.width = settings.height = 160;
  const Camera camera = default_camera(state.geometry, 1.0);
  const Image reference = read_png(source_dir() + kGolden + "reference/head_bone_drag.png");

  renderer.set_offsets(&offsets);
  const Image right = renderer.render(camera, preset("CT-Bone"), settings);
  EXPECT_LE(compare(right, reference, false).rmse, kMaxRmse);

  for (Vec3f& vector : offsets.o.vectors) vector = -vector;
  renderer.set_offsets(&offsets);
  const Comparison flipped =
      compare(renderer.render(camera, preset("CT-Bone"), settings), reference, false);
  EXPECT_GT(flipped.rmse, 10 * kMaxRmse);
  EXPECT_LT(flipped.ssim, kMinSsim);
}
