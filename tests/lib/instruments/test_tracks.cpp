// Tracks of instruments, read, written and made.
#include <array>
#include <fstream>

#include <gtest/gtest.h>

#include "lib/instruments/track.h"
#include "tests/lib/instruments/tool_cases.h"
#include "tests/support/errors.h"
#include "tests/support/temporary_folder.h"
#include "volumes/base/files.h"
#include "volumes/base/units.h"

using namespace supple;
using namespace supple::test;

namespace {

/// Mean square of a signal at 50 Hz per band of 1 Hz, by a discrete Fourier transform.
std::vector<double> power_by_hz(const std::vector<double>& signal) {
  const int count = int(signal.size()), per_hz = count / 50;
  std::vector<double> power(26, 0.0);
  for (int k = 1; k <= count / 2; ++k) {
    double c = 0, s = 0;
    for (int n = 0; n < count; ++n) {
      const double angle = 2 * kPi * k / count * n;
      c += signal[std::size_t(n)] * std::cos(angle);
      s += signal[std::size_t(n)] * std::sin(angle);
    }
    power[std::size_t(k / per_hz)] += 2 * (c * c + s * s) / count / count;
  }
  return power;
}

HandMotion still_hand(double seconds) {
  HandMotion motion;
  motion.way = {{0, {}}, {seconds, {}}};
  return motion;
}

std::string track_error(const std::string& text) {
  const TemporaryFolder folder;
  const std::string path = folder / "hand.csv";
  std::ofstream(path) << text;
  return input_error([&] { read_track(path); });
}

void expect_parts(const std::string& error, const std::vector<std::string>& parts) {
  for (const std::string& part : parts) {
    EXPECT_NE(error.find(part), std::string::npos) << error << " lacks " << part;
  }
}

}  // namespace

TEST(PropertyTracks, TremorHasItsSizeAndLiesInItsBand) {
  const InstrumentTrack track = make_track(still_hand(20));
  for (int c = 0; c < 3; ++c) {
    std::vector<double> tip;
    for (int n = 0; n < 1000; ++n) tip.push_back(track.keys()[std::size_t(n)].pose.tip_mm[c]);
    const std::vector<double> power = power_by_hz(tip);
    double all = 0;
    for (const double part : power) all += part;
    EXPECT_NEAR(std::sqrt(all), 0.1, 0.01);
    EXPECT_GT(power[8] + power[9], 0.97 * all);
  }
}

TEST(PropertyTracks, WayIsSmoothedToTheBandwidthOfTheHand) {
  // Ways that swing at one frequency, drawn by many keys, lose 1/sqrt(2) at 6 Hz.
  const auto swing = [](double hz) {
    HandMotion motion;
    for (int n = 0; n <= 4000; ++n) {
      InstrumentPose pose;
      pose.tip_mm.x = std::sin(2 * kPi * hz * n / 1000.0);
      motion.way.push_back({n / 1000.0, pose});
    }
    motion.tremor_mm = 0;
    motion.sampling_hz = 1000;
    double most = 0;
    const InstrumentTrack track = make_track(motion);
    for (const TrackKey& key : track.keys()) {
      if (key.time_s > 1 && key.time_s < 3) most = std::max(most, key.pose.tip_mm.x);
    }
    return most;
  };
  EXPECT_NEAR(swing(0.5), 1, 0.01);
  EXPECT_NEAR(swing(6), std::sqrt(0.5), 0.02);
  EXPECT_LT(swing(15), 0.15);
}

TEST(UnitTracks, SamplesComeAtTheirRateAndAsLateAsTheTrackingIs) {
  HandMotion motion;
  motion.way = {{0, {}}, {4, {}}};
  motion.way[1].pose.tip_mm = {40, 0, 0};
  motion.tremor_mm = 0;
  const InstrumentTrack track = make_track(motion);
  EXPECT_NEAR(track.keys()[1].time_s - track.keys()[0].time_s, 0.02, 1e-12);
  EXPECT_NEAR(track.at(2).tip_mm.x, 20 - 0.12, 1e-9);
  EXPECT_NEAR(track.at(track.end_s()).tip_mm.x, 40, 1e-12);
}

TEST(PropertyTracks, SameSeedGivesTheSameBitsAndAnotherOneDoesNot) {
  HandMotion motion = still_hand(2);
  const auto sum = [&] {
    double all = 0;
    const std::vector<TrackKey> keys = make_track(motion).keys();
    for (const TrackKey& key : keys) all += key.pose.tip_mm.x * (1 + key.time_s);
    return all;
  };
  const double first = sum();
  EXPECT_EQ(first, sum());
  motion.seed = 2;
  EXPECT_NE(first, sum());
}

TEST(PropertyTracks, ATrackThatWasWrittenIsReadAsTheSameBits) {
  std::mt19937 random(4);
  std::vector<TrackKey> keys;
  for (int n = 0; n < 200; ++n) {
    keys.push_back(
        {n * 0.02 + random_number(random, 0, 0.01),
         {random_point(random, 10), random_direction(random), random_number(random, -180, 180),
          random_number(random, 0, 30), random_number(random, 0, 1)}});
  }
  const TemporaryFolder folder;
  const InstrumentTrack track(keys);
  write_track(track, folder / "a.csv");
  const InstrumentTrack read = read_track(folder / "a.csv");
  write_track(read, folder / "b.csv");
  ASSERT_EQ(read.keys().size(), keys.size());
  EXPECT_EQ(text_of_file(folder / "a.csv"), text_of_file(folder / "b.csv"));
  for (std::size_t n = 0; n < keys.size(); ++n) {
    EXPECT_EQ(read.keys()[n].time_s, track.keys()[n].time_s);
    EXPECT_EQ(read.keys()[n].pose.tip_mm, track.keys()[n].pose.tip_mm);
    EXPECT_EQ(read.keys()[n].pose.axis, track.keys()[n].pose.axis);
    EXPECT_EQ(read.keys()[n].pose.active, track.keys()[n].pose.active);
  }
}

TEST(UnitTracks, BetweenKeysTheAxisGoesAlongTheGreatCircleAndOutsideItStands) {
  InstrumentPose a, b;
  a.axis = {0, 0, 1};
  b.axis = {1, 0, 0};
  b.tip_mm = {0, 4, 0};
  b.opening_degrees = 20;
  const InstrumentTrack track({{1, a}, {3, b}});
  const InstrumentPose third = track.at(1 + 2.0 / 3);
  EXPECT_NEAR(third.axis.x, 0.5, 1e-12);
  EXPECT_NEAR(third.axis.length(), 1, 1e-12);
  EXPECT_NEAR(track.at(2).tip_mm.y, 2, 1e-12);
  EXPECT_NEAR(track.at(2).opening_degrees, 10, 1e-12);
  EXPECT_EQ(track.at(0).axis, a.axis);
  EXPECT_EQ(track.at(9).tip_mm, b.tip_mm);
}

TEST(PropertyTracks, AShaftGoesThroughItsPivotAndItsTipStays) {
  std::mt19937 random(9);
  for (int n = 0; n < 500; ++n) {
    InstrumentPose pose;
    pose.tip_mm = random_point(random, 10);
    pose.axis = random_direction(random);
    const Vec3d pivot = random_point(random, 10);
    const InstrumentPose through = through_pivot(pose, pivot);
    EXPECT_EQ(through.tip_mm, pose.tip_mm);
    EXPECT_LT((pivot - pose.tip_mm).cross(through.axis).length(), 1e-12);
    EXPECT_GE(through.axis.dot(pose.axis), 0);
  }
  InstrumentPose at_pivot;
  at_pivot.axis = {0, 1, 0};
  EXPECT_EQ(through_pivot(at_pivot, at_pivot.tip_mm).axis, at_pivot.axis);
}

TEST(FaultTracks, ErrorsNameFileLineAndColumn) {
  const std::string head = "time_s,tip_x,tip_y,tip_z,axis_x,axis_y,axis_z\n";
  EXPECT_EQ(track_error(head + "0,1,2,3,0,0,1\n"), "");
  EXPECT_EQ(track_error("axis_z, time_s,tip_x,tip_y,tip_z,axis_x,axis_y\r\n1,0,1,2,3,0,0\r\n"), "");
  expect_parts(track_error("time_s,tip_x\n0,0\n"), {"hand.csv:1", "tip_y"});
  expect_parts(track_error("time_s,tipx\n"), {"hand.csv:1", "'tipx'", "tip_x"});
  expect_parts(track_error("time_s,time_s\n"), {"hand.csv:1", "time_s twice"});
  expect_parts(track_error(head + "0,1,2,3,0,0,1\n1,1,x,3,0,0,1\n"),
               {"hand.csv:3", "tip_y", "found x"});
  expect_parts(track_error(head + "0,1,2,3,0,0\n"), {"hand.csv:2", "6", "7"});
  expect_parts(track_error(head + "0,1,nan,3,0,0,1\n"), {"hand.csv:2", "tip_y"});
  expect_parts(track_error(head + "0,1,2,3,0,0,0\n"), {"hand.csv:2", "axis_x"});
  expect_parts(track_error(head + "1,1,2,3,0,0,1\n1,1,2,3,0,0,1\n"), {"hand.csv:3", "time_s"});
  expect_parts(track_error(head), {"hand.csv", "no key"});
  expect_parts(track_error(""), {"hand.csv"});
  EXPECT_NE(input_error([] { read_track("/nowhere/hand.csv"); }), "");
  EXPECT_NE(input_error([] { make_track({}); }), "");
}
