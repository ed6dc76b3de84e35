// Promises about methods without a table (docs/tradeoff.md#without-a-table), on blocks of tissue:
// plain, with a stiff core and with a rigid one.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tools/scene/choice/chosen_method.h"
#include "tools/scene/choice/trade_row.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

constexpr int kX = 36, kY = 33, kZ = 33;  // the least that has elements of four voxels

/// Densities of a block, `core` in its middle.
std::string block_of(int core) {
  std::string nrrd =
      "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 36 33 33\n"
      "space directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n"
      "endian: little\n\n";
  for (int z = 0; z < kZ; ++z) {
    for (int y = 0; y < kY; ++y) {
      for (int x = 0; x < kX; ++x) {
        const bool is_core =
            std::max({std::abs(x - kX / 2), std::abs(y - kY / 2), std::abs(z - kZ / 2)}) <= 6;
        const int density = is_core ? core : 0;
        nrrd += {char(density & 0xff), char(density >> 8)};
      }
    }
  }
  return nrrd;
}

class PropertyShippedChoices : public ::testing::Test {
 protected:
  struct Load {
    std::string box, by;
    double way_mm;
  };
  const Load m_pulled{"[13, 11, 29, 23, 21, 32]", "[0.0, 0.0, 4.0]", 4};
  const Load m_pressed{"[32, 9, 9, 35, 25, 25]", "[-2.0, 0.0, 1.0]", std::sqrt(5)};

  void SetUp() override {
    write_text(m_folder / "m.toml",
               "domain = [-300, 1500]\nactive = [-300, 3100]\nrigid = [1000, 3100]\n"
               "max_length = [[-300, 1.25], [100, 1.20], [250, 1.06]]\n"
               "min_length = [[-300, 0.75], [100, 0.80], [250, 0.94]]\n"
               "shear = [[-300, 0.30], [100, 0.25], [250, 0.15]]\n"
               "stiffness = [[-300, 3.25], [100, 3.25], [250, 100]]\n");
  }

  /// Own errors, by the names of methods.
  std::map<std::string, double> errors_of(int core, const Load& load) {
    write_text(m_folder / "block.nrrd", block_of(core));
    write_text(m_folder / "scene.toml",
               "[volume]\npath = \"block.nrrd\"\n[material]\ntable = \"m.toml\"\n[[step]]\n"
               "grab_box = " +
                   load.box + "\nby = " + load.by + "\nfix = [[0, 0, 0, 35, 32, 1]]\n");
    std::vector<std::string> arguments = {"tradeoff",     m_folder / "scene.toml",
                                          "-o",           m_folder / ("out" + std::to_string(core)),
                                          "--runs",       "1",
                                          "--no-drawings"};
    for (const std::string& method : shipped_methods()) {
      arguments.insert(arguments.end(), {"--method", method});
    }
    const Outcome outcome = run_supple(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const std::string file = m_folder / ("out" + std::to_string(core) + "/runs.csv");
    std::map<std::string, double> errors;
    for (const TradeRow& row : rows_from_csv(read_text(file), file)) {
      if (row.status == "ok") errors.emplace(row.name(), row.p95_mm);
    }
    return errors;
  }

  void expect_kept(int core, const Load& load) {
    const std::map<std::string, double> errors = errors_of(core, load);
    std::map<double, std::string> by_promise;
    for (const std::string& method : shipped_methods()) {
      const double promised = shipped_error_mm(method, load.way_mm);
      ASSERT_EQ(errors.count(method), 1u) << method;
      EXPECT_LE(errors.at(method), promised) << method << " around a core of " << core;
      by_promise.emplace(promised, method);
    }
    double nearer = 0;
    for (const auto& [promised, method] : by_promise) {
      EXPECT_GE(errors.at(method), nearer) << method << " around a core of " << core;
      nearer = errors.at(method);
    }
  }

  TemporaryFolder m_folder;
};

}  // namespace

TEST_F(PropertyShippedChoices, APlainBlockIsWithinWhatIsPromisedAndNearerWhereLessIs) {
  expect_kept(0, m_pulled);
}

TEST_F(PropertyShippedChoices, ABlockWithAStiffCoreIsToo) {
  expect_kept(300, m_pulled);
}

TEST_F(PropertyShippedChoices, ABlockWithARigidCoreIsToo) {
  expect_kept(1500, m_pressed);
}
