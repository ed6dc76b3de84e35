#include "tests/lib/fem/tet/calculix_decks.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include <gtest/gtest.h>

#include "tests/support/program.h"

namespace supple::test {

std::string judged_text(const std::string& deck) {
  const TemporaryFolder folder;
  write_text(folder / "block.inp", deck);
  EXPECT_TRUE(runs("cd " + (folder / "") + " && ccx block"));
  return read_text(folder / "block.dat");
}

std::vector<double> calculix_displacements(const std::string& deck) {
  std::istringstream lines(judged_text(deck));
  std::vector<double> u;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    int node;
    double x, y, z;
    if (line.find(" for set ") != std::string::npos) u.clear();
    if (words >> node >> x >> y >> z) u.insert(u.end(), {x, y, z});
  }
  return u;
}

double difference(const std::vector<double>& ours, const std::vector<double>& theirs) {
  EXPECT_EQ(ours.size(), theirs.size());
  double most = 0, off = 0;
  for (std::size_t n = 0; n < std::min(ours.size(), theirs.size()); ++n) {
    most = std::max(most, std::abs(theirs[n]));
    off = std::max(off, std::abs(ours[n] - theirs[n]));
  }
  EXPECT_GT(most, 0);
  return off / most;
}

}  // namespace supple::test
