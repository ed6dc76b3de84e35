// Files that make a third-party parser allocate without end or write past its memory: refused in
// one line.
#include <fstream>

#include <gtest/gtest.h>
#include <hdf5.h>
#include <openvdb/io/Stream.h>

#include "tests/support/io_fixtures.h"
#include "volumes/grid/density_grid_vdb.h"

namespace supple::test {
namespace {

/// A sanitizer ends the child where memory is refused.
bool is_refused(const std::string& line) {
  return line.find("of memory to parse") != std::string::npos ||
         line.find("memory allocation failed") != std::string::npos ||
         line.find("does not survive") != std::string::npos;
}

/// Bytes that a program other than ours writes of one voxel.
std::string foreign_grid_bytes(const TemporaryFolder& folder) {
  auto fog = make_grid<openvdb::FloatGrid>(0);
  fog->tree().setValueOn({1, 2, 3}, 4);
  {
    std::ofstream out(folder / "a.vdb", std::ios::binary);
    openvdb::io::Stream stream(out);
    stream.setCompression(openvdb::io::COMPRESS_ZIP);
    stream.write(openvdb::GridCPtrVec{fog});
  }
  return read_text(folder / "a.vdb");
}

TEST(FaultParserMemory, AStringOfGigabytesInASmallGridFile) {
  const TemporaryFolder folder;
  std::string bytes = foreign_grid_bytes(folder);
  patch(bytes, 57, std::uint32_t(1));           // metadata of the file
  patch(bytes, 61, std::uint32_t(0xF0000000));  // length of the first name
  const std::string line = failure_of(folder.write("b.vdb", bytes));
  EXPECT_NE(line.find("b.vdb: grids"), std::string::npos) << line;
  EXPECT_TRUE(is_refused(line)) << line;
}

TEST(FaultParserMemory, ALeafLongerThanItsBuffer) {
  const TemporaryFolder folder;
  std::string bytes = foreign_grid_bytes(folder);
  // Zipped values come behind their length; a negative one says that they are not compressed.
  const std::size_t zipped = bytes.rfind("\x78\x9c");
  ASSERT_NE(zipped, std::string::npos);
  bytes.resize(zipped);
  patch(bytes, zipped - 8, std::int64_t(-100000000));
  bytes += std::string(100000000, 'x');
  const std::string line = failure_of(folder.write("b.vdb", bytes));
  EXPECT_NE(line.find("b.vdb: "), std::string::npos) << line;
}

TEST(FaultParserMemory, ACircleOfFreeBlocksInAHeap) {
  const TemporaryFolder folder;
  const std::string path = folder / "a.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "g", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  H5Gclose(group);
  H5Fclose(file);
  std::string bytes = read_text(path);
  const std::size_t heap = bytes.find("HEAP");
  ASSERT_NE(heap, std::string::npos);
  std::uint64_t data = 0;
  std::memcpy(&data, &bytes[heap + 24], sizeof data);
  patch(bytes, heap + 16, std::uint64_t(16));  // the first free block
  patch(bytes, data + 16, std::uint64_t(16));  // is its own successor,
  patch(bytes, data + 24, std::uint64_t(16));  // 16 bytes long
  const std::string line = failure_of(folder.write("b.h5", bytes));
  EXPECT_NE(line.find("b.h5"), std::string::npos) << line;
  EXPECT_TRUE(is_refused(line)) << line;
}

}  // namespace
}  // namespace supple::test
