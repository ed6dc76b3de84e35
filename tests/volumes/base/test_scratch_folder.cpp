#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

using namespace supple;
using namespace supple::test;

namespace {

namespace fs = std::filesystem;

/// The system's folder of temporary files, for as long as this lives.
class TemporaryPath {
 public:
  explicit TemporaryPath(const std::string& path) {
    if (const char* known = std::getenv("TMPDIR")) m_known = known;
    ::setenv("TMPDIR", path.c_str(), 1);
  }
  ~TemporaryPath() {
    m_known.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", m_known.c_str(), 1);
  }

 private:
  std::string m_known;
};

void make_old(const fs::path& folder) {
  fs::last_write_time(folder, fs::file_time_type::clock::now() - std::chrono::hours(1));
}

fs::path make_old_folder(const fs::path& folder) {
  fs::create_directory(folder);
  std::ofstream(folder / "deck.inp") << "*NODE\n";
  make_old(folder);
  return folder;
}

}  // namespace

TEST(UnitScratchFolder, GoesWithItsOwner) {
  fs::path path;
  {
    const ScratchFolder folder;
    path = folder.path();
    std::ofstream(folder / "deck.inp") << "*NODE\n";
    EXPECT_TRUE(fs::is_directory(path));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(UnitScratchFolder, OfAKilledProcessGoesWithTheNextAndNothingElseDoes) {
  const TemporaryFolder folder;
  const fs::path temporary = folder / "";
  const TemporaryPath path(folder / "");
  const ScratchFolder in_use;
  make_old(in_use.path());
  const fs::path abandoned = make_old_folder(temporary / "supple-scratch-a1B2c3");
  const fs::path others[] = {make_old_folder(temporary / "supple-scratch-results"),
                             make_old_folder(temporary / "supple-a1B2c3"),
                             make_old_folder(temporary / "scratch")};
  const fs::path young = temporary / "supple-scratch-d4E5f6";
  fs::create_directory(young);
  const fs::path link = temporary / "supple-scratch-g7H8i9";
  fs::create_directory_symlink(others[2], link);
  const ScratchFolder next;
  EXPECT_FALSE(fs::exists(abandoned));
  EXPECT_TRUE(fs::exists(in_use.path()));
  EXPECT_TRUE(fs::exists(young));
  EXPECT_TRUE(fs::exists(link));
  for (const fs::path& other : others) EXPECT_TRUE(fs::exists(other / "deck.inp")) << other;
}
