// States that refer to their volume: whatever its format, all that is made of them is made of the
// same bytes as from states that hold everything.
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "lib/state/state_source.h"
#include "tests/support/io_fixtures.h"
#include "tests/support/program.h"

using namespace supple;
using namespace supple::test;

namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string>;

constexpr int kAcross = 40, kSlices = 32;

/// A ball with a hollow, of densities that differ from voxel to voxel.
int value_at(int i, int j, int k) {
  const double x = i - 19.5, y = j - 18.5, z = 1.2 * (k - 15.5), r2 = x * x + y * y + z * z;
  if (r2 > 17 * 17 || (x * x + (y - 6) * (y - 6) + z * z < 16)) return 0;
  return 60 + (7 * i + 13 * j + 29 * k + i * j) % 190;
}

/// Slices k0 to k1, i fastest.
template <class T>
std::string values_of_slices(int k0, int k1, int shift = 0) {
  std::vector<T> values;
  for (int k = k0; k < k1; ++k) {
    for (int j = 0; j < kAcross; ++j) {
      for (int i = 0; i < kAcross; ++i) values.push_back(T(value_at(i, j, k) + shift));
    }
  }
  return bytes_of_values(values);
}

/// An explicit element of a DICOM data set in little-endian order.
std::string dicom_element(int group, int number, const std::string& kind, std::string value) {
  if (value.size() % 2 != 0) value += kind == "UI" ? '\0' : ' ';
  const std::string head =
      bytes_of_value(std::uint16_t(group)) + bytes_of_value(std::uint16_t(number)) + kind;
  if (kind == "OW") {
    return head + std::string(2, '\0') + bytes_of_value(std::uint32_t(value.size())) + value;
  }
  return head + bytes_of_value(std::uint16_t(value.size())) + value;
}

/// One slice as CT would store it: 16 bits, slope 1 and intercept -1024.
std::string dicom_slice(int k, const std::string& series) {
  const auto number = [](int value) { return bytes_of_value(std::uint16_t(value)); };
  const std::string place = "0\\0\\" + std::to_string(2 * k);
  const std::string syntax = dicom_element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  return std::string(128, '\0') + "DICM" +
         dicom_element(2, 0, "UL", bytes_of_value(std::uint32_t(syntax.size()))) + syntax +
         dicom_element(0x08, 0x16, "UI", "1.2.840.10008.5.1.4.1.1.2") +
         dicom_element(0x08, 0x18, "UI", series + ".1." + std::to_string(k + 1)) +
         dicom_element(0x08, 0x60, "CS", "CT") + dicom_element(0x20, 0x0E, "UI", series) +
         dicom_element(0x20, 0x13, "IS", std::to_string(k + 1)) +
         dicom_element(0x20, 0x32, "DS", place) +
         dicom_element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0") +
         dicom_element(0x28, 0x02, "US", number(1)) +
         dicom_element(0x28, 0x04, "CS", "MONOCHROME2") +
         dicom_element(0x28, 0x10, "US", number(kAcross)) +
         dicom_element(0x28, 0x11, "US", number(kAcross)) +
         dicom_element(0x28, 0x30, "DS", "1\\1") + dicom_element(0x28, 0x100, "US", number(16)) +
         dicom_element(0x28, 0x101, "US", number(16)) +
         dicom_element(0x28, 0x102, "US", number(15)) +
         dicom_element(0x28, 0x103, "US", number(0)) + dicom_element(0x28, 0x1052, "DS", "-1024") +
         dicom_element(0x28, 0x1053, "DS", "1") +
         dicom_element(0x7FE0, 0x10, "OW", values_of_slices<std::uint16_t>(k, k + 1, 1024));
}

class Refer : public testing::Test {
 protected:
  void SetUp() override {
    write_soft_material(m_folder / "soft.toml");
    for (const char* name : {"whole", "refer"}) fs::create_directory(m_folder / name);
  }

  void write_nrrd() {
    m_folder.write("v.nrrd",
                   "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 40 32\n"
                   "space: LPS\nspace directions: (0.7,0,0) (0,0.7,0.1) (0,0,1.25)\n"
                   "space origin: (3,-4,5.5)\nencoding: gzip\n\n" +
                       gzip(values_of_slices<std::uint8_t>(0, kSlices)));
  }
  /// Two frames, of which the second is the ball.
  void write_frames() {
    const std::string ball = values_of_slices<std::int16_t>(0, kSlices);
    m_folder.write("frames.nrrd",
                   "NRRD0004\ntype: int16\ndimension: 4\nsizes: 40 40 32 2\n"
                   "endian: little\nencoding: raw\nspace: LPS\n"
                   "kinds: domain domain domain time\n"
                   "space directions: (1,0,0) (0,1,0) (0,0,1) none\n\n" +
                       std::string(ball.size(), '\0') + ball);
  }
  void write_nifti() {
    std::string head = nifti_header({kAcross, kAcross, kSlices});
    m_folder.write("v.nii.gz", gzip(head + values_of_slices<std::int16_t>(0, kSlices)));
  }
  void write_series(const std::string& folder, const std::string& series) {
    fs::create_directories(m_folder / folder);
    for (int k = 0; k < kSlices; ++k) {
      m_folder.write(folder + "/" + series + "." + std::to_string(k), dicom_slice(k, series));
    }
  }
  void write_pages() {
    fs::create_directory(m_folder / "pages");
    for (int k = 0; k < kSlices; ++k) {
      const std::string name = "pages/p" + std::to_string(100 + k) + ".tif";
      write_tiff(m_folder / name, kAcross, kAcross, {}, values_of_slices<std::uint8_t>(k, k + 1));
    }
  }

  /// Runs the program in one of the two folders, beside which the sources lie.
  Outcome run(const std::string& folder, const Words& words) {
    RunOptions options;
    options.directory = m_folder / folder;
    return run_supple(words, options);
  }
  /// A drag of what `read` names, as a state that refers in `refer`, and as one that does not in
  /// `whole`.
  void deform_both(const Words& read, const Words& more = {}) {
    for (const char* folder : {"whole", "refer"}) {
      Words words = {"deform"};
      words.insert(words.end(), read.begin(), read.end());
      const Words drag = {"--material", "../soft.toml", "--grab",     "8,19,15", "--by",
                          "-1.5,0,0",   "--force",      "--no-relax", "-o",      "d.vdb"};
      words.insert(words.end(), drag.begin(), drag.end());
      words.insert(words.end(), more.begin(), more.end());
      if (std::string(folder) == "refer") words.push_back("--refer");
      const Outcome outcome = run(folder, words);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
  }
  /// The same command in both folders, and the file that it makes.
  void expect_alike(const Words& words, const std::string& made) {
    for (const char* folder : {"whole", "refer"}) {
      const Outcome outcome = run(folder, words);
      ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    }
    EXPECT_TRUE(read_text(m_folder / ("whole/" + made)) == read_text(m_folder / ("refer/" + made)))
        << made;
  }
  void expect_all_alike() {
    expect_alike({"render", "d.vdb", "--size", "90x80", "--force", "-o", "d.png"}, "d.png");
    expect_alike({"slice", "d.vdb", "--force", "-o", "s.png"}, "s.png");
    expect_alike({"export", "d.vdb", "--force", "-o", "w.nrrd"}, "w.nrrd");
    expect_alike({"export", "d.vdb", "--direction", "material", "--force", "-o", "u.nrrd"},
                 "u.nrrd");
    expect_alike({"resample", "d.vdb", "--force", "-o", "v.nrrd"}, "v.nrrd");
    expect_alike({"metrics", "d.vdb", "--jacobian", "j.nrrd", "--force"}, "j.nrrd");
    expect_alike({"deform", "d.vdb", "--grab", "30,19,15", "--by", "0,1,0", "--no-relax", "--force",
                  "-o", "more.vdb"},
                 "more.vdb");
    expect_alike({"convert", "d.vdb", "e.vdb", "--force"}, "e.vdb");
    EXPECT_TRUE(read_text(m_folder / "refer/e.vdb") == read_text(m_folder / "whole/d.vdb"));
    EXPECT_EQ(source_of_state_file(m_folder / "refer/e.vdb"), nullptr);
    ASSERT_NE(source_of_state_file(m_folder / "refer/d.vdb"), nullptr);
  }

  TemporaryFolder m_folder;
};

using PropertyRefer = Refer;
using UnitRefer = Refer;

TEST_F(PropertyRefer, AStateOfANrrdIsLikeOneThatHoldsIt) {
  write_nrrd();
  deform_both({"../v.nrrd"});
  expect_all_alike();
}

TEST_F(PropertyRefer, AStateOfNiftiIsLikeOneThatHoldsIt) {
  write_nifti();
  deform_both({m_folder / "v.nii.gz", "--spacing", "0.5,0.5,0.6"});
  expect_all_alike();
}

TEST_F(PropertyRefer, AStateOfAFrameIsLikeOneThatHoldsIt) {
  write_frames();
  deform_both({"../frames.nrrd", "--frame", "1"});
  expect_all_alike();
}

TEST_F(PropertyRefer, AStateOfADicomSeriesIsLikeOneThatHoldsItAlsoBesideAnother) {
  write_series("series", "1.2.3");
  deform_both({"../series"});
  write_series("series", "1.2.4");
  EXPECT_NE(run("whole", {"info", "../series"}).exit_code, 0);
  expect_all_alike();
}

TEST_F(PropertyRefer, AStateOfAFolderOfPagesIsLikeOneThatHoldsThem) {
  write_pages();
  deform_both({"../pages/", "--spacing", "1,1,1"});
  expect_all_alike();
}

TEST_F(PropertyRefer, AStateOfRawValuesIsLikeOneThatHoldsThem) {
  m_folder.write("v.raw", std::string(6, 'x') + values_of_slices<std::int16_t>(0, kSlices));
  deform_both({"../v.raw", "--raw", "dims=40,40,32,type=int16,spacing=0.5,0.5,0.75,offset=6"});
  expect_all_alike();
}

TEST_F(PropertyRefer, WhatWasRemovedAndCutIsKept) {
  write_nrrd();
  deform_both({"../v.nrrd"},
              {"--remove", "ball:20,30,16:4", "--cut",
               "{ plane = { corner = [16, -30, 24], edge1 = [0, 90, 0], edge2 = [0, 0, 90] } }"});
  expect_all_alike();
}

TEST_F(PropertyRefer, LabelsAndRigidPiecesAreKept) {
  write_nrrd();
  std::string labels = values_of_slices<std::uint8_t>(0, kSlices);
  for (std::size_t n = 0; n < labels.size(); ++n) labels[n] = char(n % kAcross / 14);
  m_folder.write("l.nrrd",
                 "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 40 40 32\nspace: LPS\n"
                 "space directions: (0.7,0,0) (0,0.7,0.1) (0,0,1.25)\n"
                 "space origin: (3,-4,5.5)\nencoding: raw\n\n" +
                     labels);
  deform_both({"../v.nrrd"}, {"--labels", "../l.nrrd", "--fix", "label:1"});
  expect_all_alike();
}

TEST_F(PropertyRefer, TheFileDoesNotDependOnThreads) {
  write_nrrd();
  deform_both({"../v.nrrd"}, {"--threads", "1"});
  const std::string one = read_text(m_folder / "refer/d.vdb");
  deform_both({"../v.nrrd"}, {"--threads", "4"});
  EXPECT_TRUE(read_text(m_folder / "refer/d.vdb") == one);
}

TEST_F(UnitRefer, AContinuedStateRefersToTheVolumeWhereItIsAskedTo) {
  write_nrrd();
  deform_both({"../v.nrrd"});
  const Words more = {"deform", "d.vdb", "--grab", "30,19,15", "--by", "0,1,0", "--no-relax"};
  const auto made = [&](const std::string& folder, const std::string& name, bool refers) {
    Words words = more;
    words.insert(words.end(), {"-o", name});
    if (refers) words.push_back("--refer");
    return run(folder, words);
  };
  ASSERT_EQ(made("refer", "more.vdb", true).exit_code, 0);
  ASSERT_EQ(made("whole", "more.vdb", false).exit_code, 0);
  const auto source = source_of_state_file(m_folder / "refer/more.vdb");
  ASSERT_NE(source, nullptr);
  EXPECT_EQ(source->path, m_folder / "v.nrrd");
  fs::remove(m_folder / "refer/d.vdb");
  expect_alike({"convert", "more.vdb", "e.vdb"}, "e.vdb");
  const Outcome refused = made("whole", "no.vdb", true);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("d.vdb: refer: found a state that holds its densities"),
            std::string::npos)
      << refused.err;
}

TEST_F(UnitRefer, AStateMovesWithItsVolume) {
  write_nrrd();
  fs::create_directories(m_folder / "a/b");
  fs::rename(m_folder / "v.nrrd", m_folder / "a/v.nrrd");
  deform_both({m_folder / "a/v.nrrd"});
  ASSERT_EQ(run("refer", {"convert", "d.vdb", "../a/b/d.vdb", "--refer"}).exit_code, 0);
  fs::rename(m_folder / "a", m_folder / "elsewhere");
  ASSERT_EQ(run("refer", {"convert", "../elsewhere/b/d.vdb", "e.vdb"}).exit_code, 0);
  EXPECT_TRUE(read_text(m_folder / "refer/e.vdb") == read_text(m_folder / "whole/d.vdb"));
  EXPECT_EQ(run("refer", {"info", "d.vdb", "--json"}).exit_code, 0);
  EXPECT_EQ(run("refer", {"render", "d.vdb", "-o", "x.png"}).exit_code, 3);
}

TEST_F(UnitRefer, ASceneAsksForIt) {
  write_nrrd();
  deform_both({"../v.nrrd"});
  write_text(m_folder / "refer/s.toml",
             "[volume]\npath = \"d.vdb\"\n[[step]]\n"
             "handles = [{ grab = [30, 19, 15], by = [0, 1, 0] }]\n"
             "[output]\nstate = \"made.vdb\"\nrefer = true\n");
  ASSERT_EQ(run("refer", {"run", "s.toml", "-o", "."}).exit_code, 0);
  EXPECT_NE(source_of_state_file(m_folder / "refer/made.vdb"), nullptr);
  write_text(m_folder / "refer/n.toml", "[volume]\npath = \"d.vdb\"\n[output]\nrefer = true\n");
  const Outcome outcome = run("refer", {"run", "n.toml", "-o", "."});
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_NE(outcome.err.find("refer: found no state"), std::string::npos) << outcome.err;
}

TEST_F(UnitRefer, TheVolumeIsNotOverwritten) {
  write_nrrd();
  ASSERT_EQ(run("refer", {"convert", "../v.nrrd", "v.vdb"}).exit_code, 0);
  deform_both({"../refer/v.vdb"});
  const std::string before = read_text(m_folder / "refer/v.vdb");
  const Words more = {"deform", "d.vdb", "--grab", "30,19,15", "--by",
                      "0,1,0",  "-o",    "v.vdb",  "--force",  "--refer"};
  EXPECT_EQ(run("refer", more).exit_code, 3);
  EXPECT_EQ(run("refer", {"resample", "d.vdb", "-o", "v.vdb", "--force"}).exit_code, 3);
  EXPECT_TRUE(read_text(m_folder / "refer/v.vdb") == before);
}

}  // namespace
