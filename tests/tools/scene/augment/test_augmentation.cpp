// Random deformations (augmentation.h): the same by seed, certified, rigid where bone is.
#include <set>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/session/file/step_keys.h"
#include "tests/support/errors.h"
#include "tests/support/program.h"
#include "tests/support/sanitized.h"
#include "tools/scene/augment/augmentation.h"
#include "tools/scene/live/replay.h"
#include "volumes/base/parallel.h"
#include "volumes/base/table.h"
#include "volumes/field/inversion/deformation_metrics.h"
#include "volumes/io/warp_file.h"

using namespace supple;
using namespace supple::test;
using namespace supple::tools;

namespace {

constexpr int kSide = 24;

/// Soft tissue in a margin of void, with bones of 6 and 7 voxels that lie two voxels apart.
class Augmented : public ::testing::Test {
 protected:
  Augmented() {
    std::string voxels, labels;
    for (int n = 0; n < kSide * kSide * kSide; ++n) {
      const Vec3i v(n % kSide, n / kSide % kSide, n / kSide / kSide);
      const auto is_in = [&](const Vec3i& lo, const Vec3i& hi) {
        return v.x >= lo.x && v.x <= hi.x && v.y >= lo.y && v.y <= hi.y && v.z >= lo.z &&
               v.z <= hi.z;
      };
      const bool is_tissue = is_in({2, 2, 2}, {21, 21, 21});
      const bool is_large = is_in({4, 8, 8}, {10, 14, 14}),
                 is_small = is_in({13, 9, 9}, {18, 14, 14});
      voxels += char(static_cast<unsigned char>(is_large || is_small ? 200 : is_tissue ? 100 : 0));
      labels += char(is_large ? 1 : is_small ? 2 : 0);
    }
    write_text(path("bones.raw"), voxels);
    write_text(path("labels.raw"), labels);
    for (const std::string name : {"bones", "labels"}) {
      write_text(path(name + ".nhdr"),
                 "NRRD0004\ntype: uint8\ndimension: 3\nspace: left-posterior-superior\n"
                 "sizes: 24 24 24\nspace directions: (1,0,0) (0,1,0) (0,0,1)\n"
                 "space origin: (0,0,0)\nencoding: raw\ndata file: " +
                     name + ".raw\n");
    }
    const std::string limits =
        "domain = [0, 255]\nactive = [1, 255]\nmax_length = [[0, 1.5]]\n"
        "min_length = [[0, 0.6]]\nshear = [[0, 0.4]]\n";
    write_text(path("soft.toml"), limits);
    write_text(path("bony.toml"), limits + "rigid = [180, 255]\n");
  }
  std::string path(const std::string& name) const { return m_folder / name; }
  std::unique_ptr<Session> session(const std::string& material) const {
    SessionOptions options;
    options.material = read_material(path(material));
    options.keeps_undo = true;
    return std::make_unique<Session>(path("bones.nhdr"), options);
  }
  static AugmentParams params(const std::string& motion, int seed) {
    AugmentParams params;
    params.motion = motion;
    params.seed = seed;
    params.limits.reach_mm = 6;
    params.limits.radius_mm = 3;
    params.limits.turn_deg = 15;
    return params;
  }

  TemporaryFolder m_folder;
};

using UnitAugmentation = Augmented;
using PropertyAugmentation = Augmented;
using FaultAugmentation = Augmented;

std::string text(const Value& sample, const char* key) {
  return sample[key].text();
}

}  // namespace

TEST_F(UnitAugmentation, DrawsAreTheSameOnAnyMachine) {
  const auto body = session("soft.toml");
  const DrawnBody drawn(*body);
  RandomNumbers random(7);
  const Value keys = random_motions().front().draw(drawn, params("drag", 7).limits, random)(0.5);
  const Value& first = keys["handles"].items().front();
  const auto number = [&](const char* key, std::size_t n) {
    return first[key].items()[n].number();
  };
  EXPECT_EQ(number("grab_ball", 0), 5);
  EXPECT_NEAR(number("by", 0), -0.097843625606013951, 1e-14);
}

TEST_F(PropertyAugmentation, SamplesAreTheSameWhateverWasDrawnBefore) {
  RUN_WHEN_SANITIZED();
  const auto hashes = [&](const std::vector<int>& order, int threads) {
    return on_threads(threads, [&] {
      const auto body = session("soft.toml");
      Augmentation samples(*body, params("drag", 5));
      std::map<int, std::string> by_number;
      for (const int n : order) by_number[n] = text(samples.draw(n), "hash");
      samples.take_back();
      by_number[0] = hash_of(body->state());
      return by_number;
    });
  };
  const auto forward = hashes({1, 2, 3}, 1), back = hashes({3, 2, 1}, 4);
  EXPECT_EQ(forward, back);
  std::set<std::string> apart;
  for (const auto& [n, hash] : forward) apart.insert(hash);
  EXPECT_EQ(apart.size(), 4u) << "three samples and rest";
  EXPECT_EQ(forward.at(0), hash_of(session("soft.toml")->state()));
}

TEST_F(PropertyAugmentation, NoTissueFoldsAndTheStepOfTheTruthMakesTheSampleAgain) {
  const auto body = session("soft.toml");
  AugmentParams wild = params("drag", 11);
  wild.limits.reach_mm = wild.limits.radius_mm = 30;
  wild.least_det = 0.5;
  Augmentation samples(*body, wild);
  int moved = 0, shortened = 0;
  for (int n = 1; n <= 8; ++n) {
    const Value sample = samples.draw(n);
    const double part = sample["part"].number();
    shortened += part < 1;
    if (part == 0) continue;
    ++moved;
    const State state = body->state();
    const DeformationSummary measured = summarize(
        map_deformation(displacement_of(state), state.elements, state.cuts), state.geometry);
    EXPECT_EQ(measured.folded_cells, 0) << n;
    EXPECT_GT(sample["certificate"]["min_det"].number(), 0.5) << n;
    EXPECT_GT(measured.max_mm, 0.01) << n;

    const auto fresh = session("soft.toml");
    Table table(sample["step"]);
    fresh->step(read_step(table, {}));
    EXPECT_EQ(hash_of(fresh->state()), text(sample, "hash")) << n;
  }
  EXPECT_GE(moved, 4);
  EXPECT_GT(shortened, 0) << "ways that make det F less than half";
}

TEST_F(PropertyAugmentation, JointsTurnOnePieceAndHoldTheLargest) {
  const auto body = session("bony.toml");
  ASSERT_EQ(body->body().rigid.list.size(), 2u);
  Augmentation samples(*body, params("joint", 2));
  double largest_turn = 0;
  for (int n = 1; n <= 6; ++n) {
    const Value sample = samples.draw(n);
    EXPECT_EQ(sample["pieces"].items().size(), 2u);
    for (const Value& piece : sample["pieces"].items()) {
      const double turn = piece["turn_degrees"].number();
      if (piece["elements"].whole() == 7 * 7 * 7) {
        EXPECT_EQ(turn, 0);
      } else {
        largest_turn = std::max(largest_turn, turn);
        EXPECT_LE(turn, 15.001);
      }
    }
    const State state = body->state();
    const Displacement u = displacement_of(state);
    double worst = 0;
    for (int m = 0; m < 60; ++m) {
      const Vec3i a(13 + m % 6, 9 + m * 5 % 6, 9 + m / 6 % 6), b(13 + m * 7 % 6, 9 + m % 5, 14);
      Vec3f ua, ub;
      ASSERT_TRUE(u.u.at(a, ua) && u.u.at(b, ub));
      const double before = Vec3d(a - b).length();
      worst = std::max(worst, std::abs((Vec3d(a - b) + Vec3d(ua - ub)).length() - before));
    }
    EXPECT_LT(worst, 1e-3) << "voxels";
  }
  EXPECT_GT(largest_turn, 1);
}

TEST_F(PropertyAugmentation, DragsHoldTheLargestPiece) {
  const auto body = session("bony.toml");
  Augmentation samples(*body, params("drag", 3));
  double longest = 0;
  for (int n = 1; n <= 6; ++n) {
    EXPECT_EQ(samples.draw(n)["step"]["fix"].items().size(), 1u);
    const Displacement u = displacement_of(body->state());
    for (int m = 0; m < 7 * 7 * 7; ++m) {
      Vec3f here;
      ASSERT_TRUE(u.u.at({4 + m % 7, 8 + m / 7 % 7, 8 + m / 49}, here));
      EXPECT_EQ(here, Vec3f(0)) << n;
    }
    longest =
        std::max(longest, summarize(map_deformation(u, u.u.topology, {}), body->geometry()).max_mm);
  }
  EXPECT_GT(longest, 0.5);
}

TEST_F(FaultAugmentation, ABodyWithoutBonesHasNoJoints) {
  const auto body = session("soft.toml");
  Augmentation samples(*body, params("joint", 2));
  EXPECT_EQ(input_error([&] { samples.draw(1); }),
            "rigid pieces: found none, expected bones that move, such as --material ct-head has, "
            "or --rigid");
}

TEST_F(UnitAugmentation, TheCommandWritesImagesLabelsWarpsAndTruth) {
  const std::vector<std::string> command{"augment",      path("bones.nhdr"),
                                         "--material",   path("bony.toml"),
                                         "--labels",     path("labels.nhdr"),
                                         "--motion",     "joint",
                                         "--count",      "2",
                                         "--seed",       "4",
                                         "--turn",       "15",
                                         "-o",           path("a_%02d.nrrd"),
                                         "--label-maps", path("l_%02d.nrrd"),
                                         "--warps",      path("w_%02d.nrrd"),
                                         "--back-warps", path("b_%02d.nrrd"),
                                         "--truth",      path("truth.json"),
                                         "--quiet"};
  const Outcome outcome = run_supple(command);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const auto truth = nlohmann::json::parse(read_text(path("truth.json")));
  ASSERT_EQ(truth.size(), 2u);
  EXPECT_EQ(truth[1]["files"]["warp"], path("w_02.nrrd"));
  EXPECT_EQ(read_warp(path("w_01.nrrd")).direction, WarpDirection::resample);
  EXPECT_EQ(read_warp(path("b_01.nrrd")).direction, WarpDirection::material);
  ASSERT_EQ(run_supple({"resample", path("bones.nhdr"), "--grid", path("bones.nhdr"), "-o",
                        path("same.nrrd")})
                .exit_code,
            0);
  EXPECT_NE(read_text(path("a_01.nrrd")), read_text(path("a_02.nrrd")));
  const Outcome labels = run_supple({"compare", path("l_01.nrrd"), path("labels.nhdr"), "--json"});
  EXPECT_NE(labels.out.find("dice"), std::string::npos) << labels.out << labels.err;
}

TEST_F(FaultAugmentation, WrongCommandLinesAreOneLine) {
  const auto refused = [&](const std::vector<std::string>& more, int code,
                           const std::string& part) {
    std::vector<std::string> all{"augment", path("bones.nhdr"), "--material", path("soft.toml")};
    all.insert(all.end(), more.begin(), more.end());
    const Outcome outcome = run_supple(all);
    EXPECT_EQ(outcome.exit_code, code) << outcome.err;
    EXPECT_NE(outcome.err.find(part), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  };
  refused({"--count", "3"}, 2, "no output");
  refused({"--count", "3", "-o", path("a.nrrd")}, 2, "a name with a number, as a_%03d.nrrd");
  refused({"--label-maps", path("l_%d.nrrd")}, 2, "--labels");
  refused({"-o", path("a_%d.nrrd"), "--motion", "dance"}, 2, "drag");
  refused({"-o", path("a_%d.nrrd"), "--motion", "joint", "--quiet"}, 3, "rigid pieces");
  EXPECT_FALSE(std::filesystem::exists(path("a_1.nrrd")));
}
