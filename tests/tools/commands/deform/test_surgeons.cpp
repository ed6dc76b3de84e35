// Promises of docs/five_commands.md to surgeons: its first command and the scenes that it names do
// what their sentences say, on the head CT. Pictures are left out.
#include <cctype>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "volumes/base/vec.h"

using namespace supple;
using namespace supple::test;

namespace {

using Json = nlohmann::json;

/// mm per voxel of the head CT.
constexpr double kSpacing[3] = {0.957031, 0.957031, 1.5};

std::string page(const std::string& name) {
  const char* source = std::getenv("SUPPLE_SOURCE_DIR");
  return read_text(std::string(source != nullptr ? source : ".") + "/docs/" + name);
}

/// The words of the command of a page that begins so, as a shell has them.
std::vector<std::string> command_of(const std::string& text, const std::string& beginning) {
  const std::size_t begin = text.find("\n" + beginning);
  if (begin == std::string::npos) return {};
  std::vector<std::string> words(1);
  bool is_quoted = false;
  for (std::size_t n = begin + 1; n < text.size(); ++n) {
    if (text[n] == '\'') {
      is_quoted = !is_quoted;
    } else if (text[n] == '\\' && text[n + 1] == '\n') {
      ++n;
    } else if (!is_quoted && text[n] == '\n') {
      break;
    } else if (is_quoted || text[n] != ' ') {
      words.back() += text[n];
    } else if (!words.back().empty()) {
      words.emplace_back();
    }
  }
  return words;
}

/// A scene without its views, with the scan of this machine and one state.
std::string reduced(std::string scene, const std::string& head) {
  const std::size_t views = scene.find("[[view]]"), output = scene.find("[output]");
  scene.erase(std::min(views, output));
  const std::string path = "\"../../build/data/ct_head.nhdr\"";
  scene.replace(scene.find(path), path.size(), "\"" + head + "\"");
  // Relaxation moves no bone. It takes most of the time.
  const std::string material = "[material]\n";
  if (scene.find("model") == std::string::npos) {
    scene.insert(scene.find(material) + material.size(), "relax = false\n");
  }
  return scene + "[output]\nstate = \"state.vdb\"\n";
}

/// The way of a piece in mm along an axis.
double way_mm(const Json& piece, int axis) {
  return piece.at("shift_voxels").at(std::size_t(axis)).get<double>() * kSpacing[axis];
}

const Json& largest_of(const Json& pieces) {
  std::size_t largest = 0;
  for (std::size_t n = 1; n < pieces.size(); ++n) {
    if (pieces[n].at("elements") > pieces[largest].at("elements")) largest = n;
  }
  return pieces[largest];
}

const Json* named(const Json& pieces, const std::string& part) {
  for (const Json& piece : pieces) {
    if (piece.at("name").get<std::string>().find(part) != std::string::npos) return &piece;
  }
  return nullptr;
}

void expect_at_rest(const Json& piece) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(way_mm(piece, axis), 0) << axis;
  EXPECT_NEAR(piece.at("turn_degrees").get<double>(), 0, 1e-9);
}

class InteropSurgeons : public ::testing::Test {
 protected:
  void SetUp() override {
    m_head = public_volume("ct_head.nhdr");
    if (m_head.empty()) GTEST_SKIP() << "no head CT (tools/fetch_ct_head.sh)";
  }

  /// Runs a scene of the docs with other keys in place of these.
  Json run_scene_of(const std::string& name, const std::string& key = "",
                    const std::string& other = "") {
    std::string scene = reduced(page("scenes/" + name), m_head);
    const std::size_t at = scene.find(key);
    EXPECT_NE(at, std::string::npos) << key;
    if (at != std::string::npos) scene.replace(at, key.size(), other);
    write_text(m_folder / "scene.toml", scene);
    m_outcome =
        run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out", "--json", "--force"});
    EXPECT_EQ(m_outcome.exit_code, 0) << m_outcome.err;
    return m_outcome.exit_code == 0 ? Json::parse(m_outcome.out) : Json();
  }

  /// Expects no loss of tissue and none of the warnings that no scene may give.
  void expect_nothing_lost(const Json& json, int most_folds) {
    const Json& certificate = json.at("certificate");
    EXPECT_LE(
        certificate.at("folded_cells").get<int>() - certificate.at("folded_air_cells").get<int>(),
        most_folds);
    EXPECT_EQ(certificate.at("unresolved_voxels"), 0);
    for (const char* said : {"no rigid piece is held", "bone stopped", "sides of a cut overlap"}) {
      EXPECT_EQ(m_outcome.err.find(said), std::string::npos) << m_outcome.err;
    }
  }

  /// Displacement of a voxel by the scene, LPS mm.
  Vec3d way_of(const std::string& voxel) {
    const Outcome probe =
        run_supple({"probe", m_folder / "out/state.vdb", "--at", voxel, "--json"});
    EXPECT_EQ(probe.exit_code, 0) << probe.err;
    if (probe.exit_code != 0) return Vec3d(0.0);
    const Json way = Json::parse(probe.out).at("places").at(0).at("displacement_mm");
    return {way[0], way[1], way[2]};
  }

  std::string m_head;
  TemporaryFolder m_folder;
  Outcome m_outcome;
};

}  // namespace

TEST_F(InteropSurgeons, TheFirstCommandAdvancesTheUpperJawByEightMillimetres) {
  std::vector<std::string> words = command_of(page("five_commands.md"), "supple deform head.nhdr");
  ASSERT_FALSE(words.empty());
  words.erase(words.begin());
  bool has_model = false;
  for (std::string& word : words) {
    if (word == "head.nhdr") word = m_head;
    if (word == "advanced.vdb") word = m_folder / word;
    has_model = has_model || word == "--model";
  }
  words.push_back("--json");
  if (!has_model) words.push_back("--no-relax");
  m_outcome = run_supple(words);
  ASSERT_EQ(m_outcome.exit_code, 0) << m_outcome.err;
  const Json json = Json::parse(m_outcome.out);
  const Json* jaw = named(json.at("rigid_pieces"), "jaw");
  ASSERT_NE(jaw, nullptr);
  EXPECT_NEAR(way_mm(*jaw, 1), 8, 0.08);
  EXPECT_NEAR(jaw->at("turn_degrees").get<double>(), 0, 1e-9);
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 20'000);
}

TEST_F(InteropSurgeons, TheSceneOfTheUpperJawAdvancesIt) {
  const Json json = run_scene_of("head_upper_jaw.toml");
  ASSERT_FALSE(json.is_null());
  const Json* jaw = named(json.at("rigid_pieces"), "upper jaw");
  ASSERT_NE(jaw, nullptr);
  EXPECT_NEAR(way_mm(*jaw, 1), 8, 0.08);
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 20'000);
}

TEST_F(InteropSurgeons, TheSceneOfTheJawOpensItByFifteenDegrees) {
  const Json json = run_scene_of("head_jaw.toml");
  ASSERT_FALSE(json.is_null());
  int opened = 0;
  for (const char* ramus : {"83,150,4", "175,150,4"}) {
    const Json* piece = named(json.at("rigid_pieces"), ramus);
    ASSERT_NE(piece, nullptr) << ramus;
    EXPECT_NEAR(piece->at("turn_degrees").get<double>(), 15, 0.05);
    // Condyle and coronoid are part of the ramus: it reaches above the joint.
    EXPECT_GT(piece->at("elements"), 4'000);
    ++opened;
  }
  EXPECT_EQ(opened, 2);
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 20'000);
}

TEST_F(InteropSurgeons, CheekAndNoseMoveTissueAloneAndTheWholeWay) {
  for (const char* scene : {"head_cheek_pressed.toml", "head_nose.toml"}) {
    const Json json = run_scene_of(scene);
    ASSERT_FALSE(json.is_null());
    expect_at_rest(largest_of(json.at("rigid_pieces")));
    const Json& step = json.at("steps")[0];
    EXPECT_EQ(step.value("fraction", 1.0), 1) << scene;
    expect_nothing_lost(json, 20'000);
  }
}

TEST_F(InteropSurgeons, TheIncisionIsHeldOpenAndTheTissueBesideItsLipsFollows) {
  const Json json = run_scene_of("head_incision.toml");
  ASSERT_FALSE(json.is_null());
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 1'000);
  // Across the cut, LPS: both lips beside its middle, then 8 mm further on either side.
  const Vec3d across = Vec3d(0.39, -0.92, 0).normalized();
  const double front = way_of("63,174,21").dot(across), back = way_of("61,170,21").dot(across);
  EXPECT_GT(front - back, 9);
  EXPECT_LT(front - back, 11);
  EXPECT_GT(way_of("66,182,21").dot(across), 0.2 * front);
  EXPECT_LT(way_of("58,162,21").dot(across), 0.2 * back);
}

TEST_F(InteropSurgeons, TheHooksOfTheCurveAreFifteenMillimetresApart) {
  const Json json = run_scene_of("head_incision_curve.toml");
  ASSERT_FALSE(json.is_null());
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 1'000);
  EXPECT_EQ(json.at("steps")[0].value("fraction", 1.0), 1);
  EXPECT_NEAR((way_of("64,180,21") - way_of("61,173,21")).length(), 15, 0.05);
}

TEST_F(InteropSurgeons, TheFlapIsGone) {
  const Json json = run_scene_of("head_flap.toml");
  ASSERT_FALSE(json.is_null());
  EXPECT_GT(json.at("steps")[0].at("removed"), 1'000);
}

TEST_F(InteropSurgeons, TheBrainComesOutOfTheCraniectomyAndTheSkullStays) {
  // Larger elements take a fifth of the time.
  const Json json = run_scene_of("head_craniectomy.toml", "accuracy  = \"picture\"", "coarsen = 2");
  ASSERT_FALSE(json.is_null());
  expect_at_rest(largest_of(json.at("rigid_pieces")));
  expect_nothing_lost(json, 0);
  const Json& step = json.at("steps")[0];
  EXPECT_GT(step.at("removed"), 60'000);  // 90 ml
  EXPECT_EQ(step.at("fem").at("loose_islands"), 0);
  const double out_ml = step.at("fem").at("volume_change_ml");
  EXPECT_GT(out_ml, 28);
  EXPECT_LT(out_ml, 34);
  EXPECT_GT(step.at("fem").at("smallest_det_f"), 0.4);
  // Brain below the middle of the opening goes to the left, out of it; at the other side it stays.
  EXPECT_NEAR(way_of("190,122,70").x, 8, 1);
  EXPECT_LT(way_of("75,122,70").length(), 0.5);
}
