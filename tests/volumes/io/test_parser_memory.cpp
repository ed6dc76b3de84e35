// Files of a few kilobytes that make a third-party parser allocate without end: refused in one
// line. Sanitizers end the process where memory is refused, so that they leave these tests out.
#include <fstream>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include "tests/volumes/io/io_fixtures.h"
#include "volumes/base/memory_limit.h"

namespace supple::test {
namespace {

#if defined(__SANITIZE_ADDRESS__)
constexpr bool kIsSanitized = true;
#else
constexpr bool kIsSanitized = false;
#endif

TEST(UnitMemoryLimit, AllocationsBeyondItFailAndItEndsWithItsScope) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer bounds memory by itself";
  constexpr std::size_t kMany = std::size_t(1) << 30;
  {
    const MemoryLimit limit(std::int64_t(256) << 20);
    EXPECT_THROW(std::string(kMany, 'x'), std::bad_alloc);
  }
  EXPECT_EQ(std::string(kMany, 'x').size(), kMany);
}

TEST(FaultParserMemory, AStringOfGigabytesInASmallGridFile) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer bounds memory by itself";
  openvdb::initialize();
  const TemporaryFolder folder;
  auto fog = openvdb::FloatGrid::create();
  fog->tree().setValueOn({1, 2, 3}, 4);
  {
    std::ofstream out(folder.file("a.vdb"), std::ios::binary);
    openvdb::io::Stream(out).write(openvdb::GridCPtrVec{fog});
  }
  std::string bytes = bytes_of_file(folder.file("a.vdb"));
  patch(bytes, 57, std::uint32_t(1));           // metadata of the file
  patch(bytes, 61, std::uint32_t(0xF0000000));  // length of the first name
  const std::string line = failure_of(folder.write("b.vdb", bytes));
  EXPECT_NE(line.find("more memory than a file of " + std::to_string(bytes.size())),
            std::string::npos)
      << line;
}

TEST(FaultParserMemory, ACircleOfFreeBlocksInAHeap) {
  if (kIsSanitized) GTEST_SKIP() << "a sanitizer bounds memory by itself";
  const TemporaryFolder folder;
  const std::string path = folder.file("a.h5");
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(file);
  std::string bytes = bytes_of_file(path);
  const std::size_t heap = bytes.find("HEAP");
  ASSERT_NE(heap, std::string::npos);
  std::uint64_t data = 0;
  std::memcpy(&data, &bytes[heap + 24], sizeof data);
  patch(bytes, heap + 16, std::uint64_t(16));  // the first free block
  patch(bytes, data + 16, std::uint64_t(16));  // is its own successor,
  patch(bytes, data + 24, std::uint64_t(16));  // 16 bytes long
  const std::string line = failure_of(folder.write("b.h5", bytes));
  EXPECT_NE(line.find("b.h5"), std::string::npos) << line;
  EXPECT_TRUE(line.find("memory") != std::string::npos) << line;
}

}  // namespace
}  // namespace supple::test
