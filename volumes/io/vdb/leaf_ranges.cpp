#include "volumes/io/vdb/leaf_ranges.h"

#include <algorithm>
#include <exception>

#include <openvdb/io/Compression.h>

#include "volumes/base/parallel.h"

namespace supple {

namespace {

constexpr std::size_t kBufferBytes = 1 << 16;
constexpr std::size_t kLeavesPerRange = 64;

/// Passes over the leaves and returns where every range of them begins.
template <class Leaf>
std::vector<std::int64_t> range_places(std::size_t leaf_count, std::istream& in, bool is_half) {
  const auto about = openvdb::io::getStreamMetadataPtr(in);
  about->setSeekable(true);
  std::vector<std::int64_t> places;
  for (std::size_t n = 0; n < leaf_count; ++n) {
    if (n % kLeavesPerRange == 0) places.push_back(in.tellg());
    typename Leaf::NodeMaskType mask;
    mask.load(in);
    openvdb::io::readCompressedValues<typename Leaf::ValueType>(in, nullptr, Leaf::SIZE, mask,
                                                                is_half);
  }
  about->setSeekable(false);
  return places;
}

template <class Grid>
void read_leaves(Grid& grid, std::istream& in, const InputFile& file) {
  using Leaf = typename Grid::TreeType::LeafNodeType;
  const bool is_half = grid.saveFloatAsHalf();
  std::vector<Leaf*> leaves;
  grid.tree().getNodes(leaves);
  const std::vector<std::int64_t> places = range_places<Leaf>(leaves.size(), in, is_half);
  std::vector<std::exception_ptr> errors(places.size());
  parallel_for(places.size(), [&](std::size_t range) {
    FileBuffer buffer(file, places[range]);
    std::istream own(&buffer);
    own.copyfmt(in);
    auto about =
        std::make_shared<openvdb::io::StreamMetadata>(*openvdb::io::getStreamMetadataPtr(in));
    openvdb::io::setStreamMetadataPtr(own, about, /*transfer=*/false);
    const std::size_t end = std::min(leaves.size(), (range + 1) * kLeavesPerRange);
    try {
      for (std::size_t n = range * kLeavesPerRange; n < end; ++n) {
        leaves[n]->readBuffers(own, is_half);
      }
    } catch (...) {
      errors[range] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error != nullptr) std::rethrow_exception(error);
  }
}

template <class Grid>
bool read_if(openvdb::GridBase& grid, std::istream& in, const InputFile& file) {
  if (!grid.isType<Grid>()) return false;
  read_leaves(static_cast<Grid&>(grid), in, file);
  return true;
}

}  // namespace

FileBuffer::FileBuffer(const InputFile& file, std::int64_t place)
    : m_file(file), m_end(place), m_bytes(kBufferBytes) {
  setg(m_bytes.data(), m_bytes.data(), m_bytes.data());
}

FileBuffer::int_type FileBuffer::underflow() {
  const std::size_t count = m_file.read_at(m_end, m_bytes.data(), m_bytes.size());
  m_end += std::int64_t(count);
  setg(m_bytes.data(), m_bytes.data(), m_bytes.data() + count);
  return count == 0 ? traits_type::eof() : traits_type::to_int_type(m_bytes[0]);
}

FileBuffer::pos_type FileBuffer::seekoff(off_type offset, std::ios::seekdir from,
                                         std::ios::openmode which) {
  if (from == std::ios::cur) offset += off_type(m_end - (egptr() - gptr()));
  if (from == std::ios::end) offset += off_type(m_file.size());
  return seekpos(offset, which);
}

FileBuffer::pos_type FileBuffer::seekpos(pos_type place, std::ios::openmode) {
  const std::int64_t wanted = off_type(place);
  if (wanted < 0) return pos_type(off_type(-1));
  const std::int64_t begin = m_end - (egptr() - eback());
  if (wanted >= begin && wanted <= m_end) {
    setg(eback(), eback() + (wanted - begin), egptr());
  } else {
    m_end = wanted;
    setg(m_bytes.data(), m_bytes.data(), m_bytes.data());
  }
  return place;
}

bool read_leaf_ranges(openvdb::GridBase& grid, std::istream& in, const InputFile& file) {
  return read_if<openvdb::FloatGrid>(grid, in, file) ||
         read_if<openvdb::Vec3IGrid>(grid, in, file) || read_if<openvdb::Vec3SGrid>(grid, in, file);
}

}  // namespace supple
