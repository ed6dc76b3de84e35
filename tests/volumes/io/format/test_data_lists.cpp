// Values in several files: lists, numbered names, headers of the files' own; and names that a
// header may not use.
#include <filesystem>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

const std::vector<std::int16_t> kListed = {-5, 0,  1,  2,  300, -300, 7,  8,  9,  10, 11, 12,
                                           13, 14, 15, 16, 17,  18,   19, 20, 21, 22, 23, 24};

/// 2 x 3 x 4.
std::string list_nrrd(const std::string& fields, const std::string& encoding = "raw") {
  return "NRRD0004\ntype: short\ndimension: 3\nsizes: 2 3 4\nendian: little\nencoding: " +
         encoding + "\n" + fields;
}

std::string list_metaimage(const std::string& data_file, const std::string& more = "") {
  return "NDims = 3\nDimSize = 2 3 4\nElementType = MET_SHORT\n" + more +
         "ElementDataFile = " + data_file + "\n";
}

std::string all() {
  return bytes_of_values(kListed);
}
std::string slice(int k) {
  return all().substr(std::size_t(k) * 12, 12);
}

/// s1.raw to s4.raw, a slice each, behind `before`.
void write_slices(const TemporaryFolder& folder, const std::string& before = "") {
  for (int k = 0; k < 4; ++k) {
    folder.write("s" + std::to_string(k + 1) + ".raw", before + slice(k));
  }
}

/// While it lives this process can have so many files open.
class DescriptorLimit {
 public:
  explicit DescriptorLimit(rlim_t count) {
    ::getrlimit(RLIMIT_NOFILE, &m_usual);
    const rlimit few{count, m_usual.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
  }
  ~DescriptorLimit() { ::setrlimit(RLIMIT_NOFILE, &m_usual); }
  DescriptorLimit(const DescriptorLimit&) = delete;
  DescriptorLimit& operator=(const DescriptorLimit&) = delete;

 private:
  rlimit m_usual{};
};

TEST(UnitDataFiles, AListGivesASlicePerFileInItsOrder) {
  const TemporaryFolder folder;
  write_slices(folder);
  const std::string names = "s1.raw\ns2.raw\ns3.raw\ns4.raw\n";
  EXPECT_EQ(read_all(folder.write("a.nhdr", list_nrrd("data file: LIST\n" + names))), all());
  EXPECT_EQ(read_all(folder.write("b.mhd", list_metaimage("LIST", "") + names)), all());
  EXPECT_EQ(read_all(folder.write("c.nhdr",
                                  list_nrrd("data file: LIST\ns4.raw\ns3.raw\ns2.raw\ns1.raw"))),
            slice(3) + slice(2) + slice(1) + slice(0));
}

TEST(UnitDataFiles, AListMayHoldSlabsOrSingleRows) {
  const TemporaryFolder folder;
  folder.write("a.raw", slice(0) + slice(1));
  folder.write("b.raw", slice(2) + slice(3));
  EXPECT_EQ(read_all(folder.write("slabs.nhdr", list_nrrd("data file: LIST 3\na.raw\nb.raw\n"))),
            all());
  std::string names;
  for (int row = 0; row < 12; ++row) {
    names += "r" + std::to_string(row) + "\n";
    folder.write("r" + std::to_string(row), all().substr(std::size_t(row) * 4, 4));
  }
  EXPECT_EQ(read_all(folder.write("rows.nhdr", list_nrrd("data file: LIST 1\n" + names))), all());
  EXPECT_EQ(read_all(folder.write("rows.mhd", list_metaimage("LIST 1") + names)), all());
}

TEST(UnitDataFiles, NumberedNamesCountUpOrDownWithZerosInFront) {
  const TemporaryFolder folder;
  write_slices(folder);
  for (int k = 0; k < 4; ++k) folder.write("p00" + std::to_string(2 * k) + ".raw", slice(k));
  EXPECT_EQ(read_all(folder.write("a.nhdr", list_nrrd("data file: s%d.raw 1 4 1\n"))), all());
  EXPECT_EQ(read_all(folder.write("b.nhdr", list_nrrd("data file: p%03d.raw 0 6 2 2\n"))), all());
  EXPECT_EQ(read_all(folder.write("c.nhdr", list_nrrd("data file: p%03d.raw 6 0 -2\n"))),
            slice(3) + slice(2) + slice(1) + slice(0));
  EXPECT_EQ(read_all(folder.write("a.mhd", list_metaimage("s%d.raw 1 4 1"))), all());
  EXPECT_EQ(read_all(folder.write("b.mhd", list_metaimage("p%03d.raw 0 6 2"))), all());
  EXPECT_EQ(read_all(folder.write("c.mhd", list_metaimage("s%d.raw"))), all());
}

TEST(UnitDataFiles, EveryFileSkipsItsOwnLinesAndBytes) {
  const TemporaryFolder folder;
  write_slices(folder, "made by\nsomeone\nxyz");
  EXPECT_EQ(read_all(folder.write(
                "a.nhdr", list_nrrd("line skip: 2\nbyte skip: 3\ndata file: s%d.raw 1 4 1\n"))),
            all());
  EXPECT_EQ(
      read_all(folder.write("b.nhdr", list_nrrd("byte skip: -1\ndata file: s%d.raw 1 4 1\n"))),
      all());
  EXPECT_EQ(read_all(folder.write("a.mhd", list_metaimage("s%d.raw", "HeaderSize = 19\n"))), all());
  EXPECT_EQ(read_all(folder.write("b.mhd", list_metaimage("s%d.raw", "HeaderSize = -1\n"))), all());
}

TEST(UnitDataFiles, ListedFilesAreDecodedOneByOne) {
  const TemporaryFolder folder;
  const std::string names = "data file: s%d.raw 1 4 1\n";
  for (int k = 0; k < 4; ++k) {
    const std::string name = "s" + std::to_string(k + 1) + ".raw";
    folder.write(name, "a line\n" + gzip("junk" + slice(k)));
    std::string numbers;
    for (int n = 0; n < 6; ++n) numbers += std::to_string(kListed[std::size_t(6 * k + n)]) + " ";
    folder.write("t" + name, numbers);
  }
  EXPECT_EQ(
      read_all(folder.write("a.nhdr", list_nrrd("line skip: 1\nbyte skip: 4\n" + names, "gzip"))),
      all());
  EXPECT_EQ(read_all(folder.write("b.nhdr", list_nrrd("data file: ts%d.raw 1 4 1\n", "ascii"))),
            all());
}

TEST(UnitDataFiles, FoldersBelowTheHeadersAreSearched) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "data/deep");
  folder.write("data/deep/a.raw", all());
  EXPECT_EQ(read_all(folder.write("a.nhdr", list_nrrd("data file: data/../data/deep/a.raw\n"))),
            all());
  EXPECT_EQ(read_all(folder.write("a.mhd", list_metaimage("./data/deep/a.raw"))), all());
}

TEST(PropertyDataFiles, MoreFilesThanDescriptorsAreRead) {
  const TemporaryFolder folder;
  constexpr int kFiles = 300, kDescriptors = 64;
  for (int n = 0; n < kFiles; ++n) folder.write("f" + std::to_string(n), std::string(1, char(n)));
  const std::string path =
      folder.write("a.nhdr",
                   "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 300\nencoding: raw\n"
                   "data file: f%d 0 299 1\n");
  std::string values;
  {
    const DescriptorLimit limit(kDescriptors);
    values = read_all(path);
  }
  for (int n = 0; n < kFiles; ++n) EXPECT_EQ(values[std::size_t(n)], char(n));
}

TEST(FaultDataFiles, NamesThatLeaveTheHeadersFolderAreRefused) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "sub");
  folder.write("a.raw", all());
  for (const std::string& name : {folder / "a.raw", std::string("../a.raw"),
                                  std::string("x/../../a.raw"), std::string("/etc/passwd")}) {
    const std::vector<std::string> parts = {"the header's folder or below it"};
    expect_failure(folder.write("sub/a.nhdr", list_nrrd("data file: " + name + "\n")), parts);
    expect_failure(folder.write("sub/b.mhd", list_metaimage(name)), parts);
    expect_failure(folder.write("sub/c.nhdr", list_nrrd("data file: LIST 3\n" + name + "\n")),
                   parts);
    expect_failure(folder.write("sub/d.mhd", list_metaimage("LIST 3") + name + "\n"), parts);
  }
  expect_failure(folder.write("sub/e.nhdr", list_nrrd("data file: ../s%d.raw 1 4 1\n")),
                 {"../s1.raw"});
}

TEST(FaultDataFiles, ListsThatContradictTheSizesAreRefusedWithBothNumbers) {
  const TemporaryFolder folder;
  write_slices(folder);
  const auto expect = [&](const std::string& data_file, const std::vector<std::string>& parts) {
    expect_failure(folder.write("a.nhdr", list_nrrd("data file: " + data_file + "\n")), parts);
  };
  expect("LIST\ns1.raw\ns2.raw", {"data file", "2 files", "expected 4"});
  expect("LIST 1\ns1.raw\ns2.raw", {"2 files", "expected 12"});
  expect("LIST 4\ns1.raw", {"1 to 3 dimensions"});
  expect("LIST 3\ns1.raw\ns2.raw\ns3.raw", {"3 files", "last size 4"});
  expect("LIST", {"0 files"});
  expect("LIST 2 2\ns1.raw", {"LIST [dimensions]"});
  expect("s%d.raw 1 3 1", {"3 files", "expected 4"});
  expect("s%d.raw 1 4 0", {"min max step"});
  expect("s%d.raw 4 1 1", {"min max step"});
  expect("s%d.raw 1 99999999999 1", {"min max step"});
  expect("s%d%d.raw 1 4 1", {"one number"});
  expect("s%s.raw 1 4 1", {"one number"});
  expect("s%*d.raw 1 4 1", {"one number"});
  expect("s%999999d.raw 1 4 1", {"one number"});
  expect("t%d.raw 1 4 1", {"t1.raw", "no such file"});
  expect_failure(folder.write("a.mhd", list_metaimage("LIST") + "s1.raw\n"),
                 {"1 files", "expected 4"});
  expect_failure(folder.write("a.mhd", list_metaimage("s%d.raw 1 3 1")), {"3 files", "expected 4"});
}

TEST(FaultDataFiles, AFileOfTheWrongLengthIsNamedBeforeAnyIsRead) {
  const TemporaryFolder folder;
  write_slices(folder);
  folder.write("s3.raw", slice(2) + "x");
  EXPECT_THROW(open_volume(folder.write("a.nhdr", list_nrrd("data file: s%d.raw 1 4 1\n"))),
               std::exception);
  expect_failure(folder / "a.nhdr", {"s3.raw", "13 bytes", "12 bytes"});
  folder.write("s3.raw", "short");
  expect_failure(folder.write("a.mhd", list_metaimage("s%d.raw 1 4 1")),
                 {"s3.raw", "5 bytes", "12 bytes"});
  expect_failure(folder.write("b.nhdr", list_nrrd("line skip: 3\ndata file: s%d.raw 1 4 1\n")),
                 {"line skip", "s1.raw"});
}

}  // namespace
}  // namespace supple::test
