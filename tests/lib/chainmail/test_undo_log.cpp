#include <algorithm>

#include <gtest/gtest.h>

#include "lib/chainmail/undo_log.h"

using namespace supple;

TEST(UnitUndoLog, RollingBackRestoresStoredBricksAndReleasesTheOthers) {
  BrickValues values(5000);
  values.set(3 * kBrickVoxels + 7, 42);
  const BrickValues before = values;
  UndoLog undo;
  // Twice, since a log that rolled back starts over.
  for (int n = 0; n < 2; ++n) {
    for (const std::size_t brick : {std::size_t(3), std::size_t(4999), std::size_t(0)}) {
      undo.before_change(brick, values);
      std::fill_n(values.touch(brick), kBrickVoxels, 5);
      undo.before_change(brick, values);
    }
    EXPECT_EQ(undo.bricks(), (std::vector<std::size_t>{3, 4999, 0}));
    EXPECT_EQ(undo.saved_of(3)[7], 42);
    EXPECT_EQ(undo.saved_of(4999)[7], 0);
    EXPECT_EQ(undo.saved(0)[8], 0);
    EXPECT_EQ(undo.saved_of(1), nullptr);
    EXPECT_EQ(undo.saved_of(4000), nullptr);
    undo.roll_back(values);
    EXPECT_EQ(values, before);
    EXPECT_EQ(values.stored_bricks(), 1u);
    EXPECT_TRUE(undo.bricks().empty());
    EXPECT_EQ(undo.saved_of(3), nullptr);
  }
}

TEST(UnitUndoLog, AClearedLogKeepsWhatComesNext) {
  BrickValues values(2);
  UndoLog undo;
  undo.before_change(1, values);
  values.set(kBrickVoxels, 1);
  undo.clear();
  undo.before_change(1, values);
  values.set(kBrickVoxels, 2);
  undo.roll_back(values);
  EXPECT_EQ(values.at(kBrickVoxels), 1);
}
