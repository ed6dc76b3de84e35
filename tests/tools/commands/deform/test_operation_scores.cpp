// Scores of whole operations: what an expert's way loses by tremor, a touch and a detour.
#include <cmath>
#include <map>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "volumes/base/files.h"

using namespace supple;
using namespace supple::test;

namespace {

using Points = std::map<std::string, double>;  // by category

std::string edited(std::string scene, const std::string& from, const std::string& to) {
  const std::size_t at = scene.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? scene : scene.replace(at, from.size(), to);
}

class ExpertScore : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string file = text_of_file(source_dir() + "/docs/scenes/eye/expert.toml");
    m_expert = edited(file, "image = \"expert.png\"\n", "");
  }

  Points points_of(const std::string& scene) const {
    write_text(m_folder / "scene.toml", scene);
    const Outcome outcome =
        run_supple({"run", m_folder / "scene.toml", "-o", m_folder / "out", "--force", "--json"});
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    Points points;
    if (outcome.exit_code != 0) return points;
    const auto report = nlohmann::json::parse(outcome.out);
    for (const auto& [key, category] : report["score"]["categories"].items()) {
      points[key] = category["points"];
    }
    return points;
  }

  /// Checks that only one category suffers.
  void expect_worse(const std::string& scene, const std::string& concerned) const {
    const Points expert = points_of(m_expert), other = points_of(scene);
    ASSERT_EQ(expert.size(), 5u);
    ASSERT_EQ(other.size(), 5u);
    for (const auto& [key, points] : expert) {
      EXPECT_GT(points, 90) << key;
      if (key == concerned) {
        EXPECT_GE(points - other.at(key), 20) << key;
      } else {
        EXPECT_LE(std::abs(points - other.at(key)), 10) << key;
      }
    }
  }

  std::string m_expert;
  const std::string m_hold = "  { time = 4,   tip = [1.5, 0.6, -9.361] },\n";
  TemporaryFolder m_folder;
};
using UnitOperationScore = ExpertScore;

TEST_F(UnitOperationScore, FiveTimesTheTremorCostsHandling) {
  RUN_WHEN_SANITIZED();
  expect_worse(edited(m_expert, "tremor = 0.06", "tremor = 0.3"), "instruments");
}

TEST_F(UnitOperationScore, ATouchOfTheRetinaCostsTissue) {
  const std::string touch =
      "  { time = 4.4, tip = [1.5, 0.6, -11.1] },\n"
      "  { time = 4.8, tip = [1.5, 0.6, -9.361] },\n";
  expect_worse(edited(m_expert, m_hold, m_hold + touch), "tissue");
}

TEST_F(UnitOperationScore, ADetourCostsEfficiency) {
  const std::size_t after = m_expert.find(m_hold) + m_hold.size();
  const std::size_t end = m_expert.find("\n]\n", after);
  const std::string round =
      "  { time = 5.5, tip = [4, 4, -7] },\n"
      "  { time = 7, tip = [4, -4, -7] },\n"
      "  { time = 8.5, tip = [-4, -4, -7] },\n"
      "  { time = 10, tip = [-4, 4, -7] },\n"
      "  { time = 12, tip = [-1.2, 0.8, -9.390] },\n"
      "  { time = 14, tip = [-1.2, 0.8, -9.390] },\n"
      "  { time = 16, tip = [0.2, -1.4, -9.394] },\n"
      "  { time = 18, tip = [0.2, -1.4, -9.394] },";
  ASSERT_NE(end, std::string::npos);
  std::string scene = m_expert;
  expect_worse(scene.replace(after, end - after, round), "efficiency");
}

}  // namespace
