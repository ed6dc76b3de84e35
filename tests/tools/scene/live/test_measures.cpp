// Measures of a live session: their values against motions that are known, their place in history
// and journals, and what is refused.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"
#include "tests/tools/scene/live/replay_fixture.h"
#include "volumes/base/csv.h"

using namespace supple;
using namespace supple::test;

namespace {

using Rows = std::vector<std::vector<std::string>>;

std::string measure(const std::string& points, const std::string& more = "") {
  return event("measure", "points = " + points + "\n" + more);
}

double number(const std::string& text) {
  return std::stod(text);
}

class UnitMeasures : public UnitReplay {
 protected:
  /// The table that a replay of these events writes, without its head.
  Rows rows_of(const std::string& events, const std::string& more = "") {
    const Outcome run =
        replay(journal(events), "--measures " + (m_folder / "measures.csv") + " " + more);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return rows_in(m_folder / "measures.csv");
  }
  static Rows rows_in(const std::string& path) {
    const std::string text = read_text(path);
    Rows rows;
    for (std::size_t at = 0; at < text.size();) rows.push_back(take_csv_line(text, at));
    EXPECT_EQ(rows.front().size(), 23u);
    rows.erase(rows.begin());
    return rows;
  }
};

/// LPS mm of the ball: voxels of 1 x 1 x 1.5 mm.
const std::string kDistance = measure("[[12, 12, 12], [15, 16, 24]]", "name = \"axis, long\"");
const std::string kAngle = measure("[[16, 12, 18], [12, 12, 18], [12, 17, 21]]");

}  // namespace

TEST_F(UnitMeasures, AGrownBallHasLongerDistancesAndTheSameAngles) {
  const std::string grown =
      event("step", "handles = [{ grab_box = [0, 0, 0, 23, 23, 23], scale = 1.15 }]");
  const Rows rows = rows_of(kDistance + kAngle + grown);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0][0], "axis, long");
  EXPECT_EQ(rows[0][1] + rows[0][2], "distancemm");
  EXPECT_NEAR(number(rows[0][3]), 13, 1e-9);
  EXPECT_NEAR(number(rows[0][4]), 1.15 * 13, 1e-3);
  EXPECT_EQ(rows[1][0], "2");
  EXPECT_EQ(rows[1][1] + rows[1][2], "angledegrees");
  const double angle = std::acos(0.) * 180 / std::acos(-1.);
  EXPECT_NEAR(number(rows[1][3]), angle, 1e-9);
  EXPECT_NEAR(number(rows[1][4]), angle, 1e-3);
}

TEST_F(UnitMeasures, AnAngleFollowsItsPointsAndThoseInTheAirStay) {
  // The voxel 12, 12, 16 lies at 12, 12, 24 mm and is led; 12, 12, 8 is held, the corner is air.
  const std::string events = event("anchor", "grab_box = [10, 10, 6, 14, 14, 9]") +
                             event("grab", "grab = [12, 12, 16]") +
                             event("drag", "to = [0.5, 1.5, 0.75]") + event("release") +
                             measure("[[12, 12, 24], [12, 12, 12], [0, 12, 12]]");
  const Rows rows = rows_of(events);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(number(rows[0][3]), 90, 1e-9);
  const double cosine = -0.5 / std::sqrt(0.5 * 0.5 + 1.5 * 1.5 + 12.75 * 12.75);
  EXPECT_NEAR(number(rows[0][4]), std::acos(cosine) * 180 / std::acos(-1.), 1e-3);
  for (int n = 0; n < 9; ++n) {
    const double led[] = {12.5, 13.5, 24.75, 12, 12, 12, 0, 12, 12};
    EXPECT_NEAR(number(rows[0][std::size_t(5 + n)]), led[n], 1e-4) << n;
  }
  EXPECT_EQ(rows[0][14], "12");
}

TEST_F(UnitMeasures, TheyStandInHistoryAndInWhatIsCarriedOut) {
  const std::string moved =
      event("grab", "grab = [12, 12, 16]") + event("drag", "to = [0, 1, 0]") + event("release");
  const std::string all = kDistance + moved + kAngle + kDistance + event("measure", "remove = 2");
  const std::string carried = "--journal " + (m_folder / "carried.toml");
  EXPECT_EQ(rows_of(all, carried).size(), 2u);
  const std::string table = read_text(m_folder / "measures.csv");
  EXPECT_EQ(replay(m_folder / "carried.toml", "--measures " + (m_folder / "again.csv")).exit_code,
            0);
  EXPECT_EQ(read_text(m_folder / "again.csv"), table);

  const std::string undo = event("undo", "looks = true"), redo = event("redo", "looks = true");
  EXPECT_EQ(rows_of(all + undo).size(), 3u);
  EXPECT_EQ(rows_of(all + undo)[1][1], "angle");
  EXPECT_EQ(rows_of(all + undo + undo + undo).size(), 1u);
  // The drag is taken back before the first measure, and is made again after it.
  const Rows still = rows_of(all + undo + undo + undo + undo);
  ASSERT_EQ(still.size(), 1u);
  EXPECT_EQ(still[0][3], still[0][4]);
  EXPECT_EQ(rows_of(all + undo + undo + undo + undo + undo).size(), 0u);
  rows_of(all + undo + undo + undo + undo + undo + redo + redo + redo + redo + redo);
  EXPECT_EQ(read_text(m_folder / "measures.csv"), table);
  EXPECT_EQ(rows_of(all + event("measure", "all = true")).size(), 0u);
  // The body does not know of them.
  EXPECT_EQ(hash(journal(all)), hash(journal(moved)));
}

TEST_F(UnitMeasures, WhatIsNoMeasureIsRefused) {
  const auto expect_refused = [&](const std::string& events, const std::string& words) {
    const Outcome run = replay(journal(events));
    EXPECT_EQ(run.exit_code, 3) << events;
    EXPECT_NE(run.err.find(words), std::string::npos) << run.err;
  };
  expect_refused(measure("[[1, 2, 3]]"), "points: found 1 places");
  expect_refused(measure("[[1, 2, 3], [1, 2, 3]]"), "one place twice in a row");
  expect_refused(measure("[[1, 2, 3], [1e9, 2, 3]]"), "a place far away");
  expect_refused(event("measure"), "nothing to measure");
  expect_refused(measure("[[1, 2, 3], [2, 2, 3]]", "remove = 1"), "beside what is taken away");
  expect_refused(kDistance + event("measure", "remove = 2"), "one of 1 measures that there are");
  std::string many;
  for (int n = 0; n < 101; ++n) many += kDistance;
  expect_refused(many, "one more than 100");
}
