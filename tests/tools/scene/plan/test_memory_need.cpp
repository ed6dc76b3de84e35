// Runs that do not fit into memory are refused before their volume is read; others are not.
#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "tests/support/program.h"
#include "tests/support/sanitized.h"

using namespace supple::test;

namespace {

constexpr int kRefused = 4;

/// A volume of zeros that takes no room on the disk.
void write_empty(const TemporaryFolder& folder, const std::string& type, int bytes, int across,
                 int slices) {
  const std::string sizes =
      std::to_string(across) + " " + std::to_string(across) + " " + std::to_string(slices);
  write_text(folder / "v.nhdr", "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes +
                                    "\nspacings: 0.01 0.01 0.01\nencoding: raw\nendian: little\n"
                                    "data file: v.raw\n");
  write_text(folder / "v.raw", "");
  std::filesystem::resize_file(folder / "v.raw",
                               std::uintmax_t(across) * across * slices * std::uintmax_t(bytes));
}

/// A box of tissue in the volume of bytes.
void write_tissue(const TemporaryFolder& folder, int across) {
  std::FILE* const file = std::fopen((folder / "v.raw").c_str(), "r+");
  ASSERT_NE(file, nullptr);
  const std::string row(16, char(200));
  for (long k = 100; k < 116; ++k) {
    for (long j = 100; j < 116; ++j) {
      std::fseek(file, (k * across + j) * across + 100, SEEK_SET);
      std::fwrite(row.data(), 1, row.size(), file);
    }
  }
  std::fclose(file);
}

/// A drag with so many kB of addresses.
Outcome deform_under(const TemporaryFolder& folder, long kb, const std::vector<std::string>& more) {
  std::vector<std::string> words = {"/bin/bash",
                                    "-c",
                                    "ulimit -v " + std::to_string(kb) + "; exec \"$0\" \"$@\"",
                                    std::getenv("SUPPLE_BINARY"),
                                    "deform",
                                    folder / "v.nhdr",
                                    "--by",
                                    "0,0.01,0",
                                    "--no-relax",
                                    "-o",
                                    folder / "out.vdb"};
  words.insert(words.end(), more.begin(), more.end());
  return run_program(words);
}

void write_material(const std::string& path, const std::string& active) {
  write_text(path, "domain = [0, 255]\nactive = " + active +
                       "\nmax_length = [[0, 1.3]]\nmin_length = [[0, 0.7]]\nshear = [[0, 0.3]]\n");
}

class UnitMemoryNeed : public ::testing::Test {
 protected:
  void SetUp() override {
    if (kSanitized) GTEST_SKIP() << "sanitizers reserve more addresses than any limit";
  }
  TemporaryFolder m_folder;
};

TEST_F(UnitMemoryNeed, SlicesThatDoNotFitAreRefusedByTheHeader) {
  write_empty(m_folder, "double", 8, 2048, 500);
  const Outcome outcome = deform_under(m_folder, 600000, {"--grab", "1024,1024,250"});
  EXPECT_EQ(outcome.exit_code, kRefused);
  for (const char* words : {"v.nhdr: the run needs at least", "are there", "supple crop"}) {
    EXPECT_NE(outcome.err.find(words), std::string::npos) << words << " in " << outcome.err;
  }
  EXPECT_EQ(m_folder.entries(), (std::vector<std::string>{"v.nhdr", "v.raw"}));
}

TEST_F(UnitMemoryNeed, AVolumeThatDoesNotFitIsNotPutOnAnotherGrid) {
  write_empty(m_folder, "uint8", 1, 640, 640);
  const Outcome outcome = run_program(
      {"/bin/bash", "-c", "ulimit -v 1000000; exec \"$0\" \"$@\"", std::getenv("SUPPLE_BINARY"),
       "resample", m_folder / "v.nhdr", "--margin", "0.02", "-o", m_folder / "out.nrrd"});
  EXPECT_EQ(outcome.exit_code, kRefused);
  EXPECT_NE(outcome.err.find("v.nhdr: another grid needs 2.1 GB of memory, and 0."),
            std::string::npos)
      << outcome.err;
  EXPECT_EQ(m_folder.entries(), (std::vector<std::string>{"v.nhdr", "v.raw"}));
}

TEST_F(UnitMemoryNeed, TissueCountsAndNotTheBoxAroundIt) {
  constexpr int kAcross = 640;
  constexpr long kLimit = 1000000;  // full of tissue the volume takes 1.5 GB
  write_empty(m_folder, "uint8", 1, kAcross, kAcross);
  write_tissue(m_folder, kAcross);
  const std::vector<std::string> drag = {"--grab", "108,108,108", "--material",
                                         m_folder / "m.toml"};
  write_material(m_folder / "m.toml", "[1, 255]");
  const Outcome fits = deform_under(m_folder, kLimit, drag);
  EXPECT_EQ(fits.exit_code, 0) << fits.err;
  std::filesystem::remove(m_folder / "out.vdb");
  write_material(m_folder / "m.toml", "[0, 255]");
  const Outcome full = deform_under(m_folder, kLimit, drag);
  EXPECT_EQ(full.exit_code, kRefused);
  EXPECT_NE(full.err.find("v.nhdr: the run needs about 1."), std::string::npos) << full.err;
  EXPECT_NE(full.err.find(" of its slices); with a state that refers to its volume (--refer"),
            std::string::npos)
      << full.err;
  EXPECT_FALSE(std::filesystem::exists(m_folder / "out.vdb"));
}

}  // namespace
