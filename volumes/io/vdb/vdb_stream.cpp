// Debian's OpenVDB logs through log4cplus; its header only knows with this.
#define OPENVDB_USE_LOG4CPLUS

#include "volumes/io/vdb/vdb_stream.h"

#include <cerrno>
#include <cstring>
#include <fstream>

#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/util/logging.h>

#include "volumes/base/error.h"
#include "volumes/base/memory.h"
#include "volumes/io/bytes/input_file.h"
#include "volumes/io/vdb/leaf_ranges.h"

namespace supple {

namespace {

constexpr std::size_t kMaxMessage = 1000;
// Memory for OpenVDB, c-blosc and TBB beside the grids themselves.
constexpr std::int64_t kWorkingBytes = std::int64_t(64) << 20;

/// The steps of io::Stream, grid by grid.
class GridArchive : public openvdb::io::Archive {
 public:
  GridArchive(const InputFile& file, VdbTrust trust) : m_file(file), m_trust(trust) {}

  openvdb::MetaMap read_metadata() {
    FileBuffer buffer(m_file);
    std::istream in(&buffer);
    VdbContent content;
    read_head(in, content);
    return content.metadata;
  }

  VdbContent read(const std::function<bool(const std::string&)>& stops) {
    FileBuffer buffer(m_file);
    std::istream in(&buffer);
    VdbContent content;
    auto about = read_head(in, content);
    const int count = readGridCount(in);
    for (int n = 0; n < count; ++n) {
      openvdb::io::GridDescriptor descriptor;
      const openvdb::GridBase::Ptr grid = descriptor.read(in);
      if (stops(descriptor.gridName())) break;
      if (m_trust == VdbTrust::sealed) {
        read_in_ranges(*grid, in, about);
      } else {
        readGrid(grid, descriptor, in);
      }
      content.grids.push_back(grid);
    }
    return content;
  }

 private:
  openvdb::io::StreamMetadata::Ptr read_head(std::istream& in, VdbContent& content) {
    in.exceptions(std::ios::failbit | std::ios::badbit | std::ios::eofbit);
    readHeader(in);
    auto about = std::make_shared<openvdb::io::StreamMetadata>();
    openvdb::io::setStreamMetadataPtr(in, about, /*transfer=*/false);
    openvdb::io::setVersion(in, libraryVersion(), fileVersion());
    openvdb::io::setDataCompression(in, compression());
    content.metadata.readMeta(in);
    return about;
  }

  /// What readGrid() does with a grid as Supple writes it, but for the leaves.
  void read_in_ranges(openvdb::GridBase& grid, std::istream& in,
                      openvdb::io::StreamMetadata::Ptr& of_file) {
    readGridCompression(in);
    auto of_grid = std::make_shared<openvdb::io::StreamMetadata>(*of_file);
    of_grid->setHalfFloat(grid.saveFloatAsHalf());
    openvdb::io::setStreamMetadataPtr(in, of_grid, /*transfer=*/false);
    grid.readMeta(in);
    openvdb::io::setGridClass(in, grid.getGridClass());
    grid.readTransform(in);
    grid.readTopology(in);
    if (!read_leaf_ranges(grid, in, m_file)) grid.readBuffers(in);
    openvdb::io::setStreamMetadataPtr(in, of_file, /*transfer=*/false);
  }

  const InputFile& m_file;
  VdbTrust m_trust;
};

/// The steps of io::Stream, grid by grid.
class GridWriter : public openvdb::io::Archive {
 public:
  GridWriter() {
    setCompression(
        openvdb::io::COMPRESS_ACTIVE_MASK |
        (hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_NONE));
    setGridStatsMetadataEnabled(false);
  }

  void write_all(std::ostream& out, const std::vector<OutgoingGrid>& grids,
                 const openvdb::MetaMap& metadata) const {
    writeHeader(out, /*seekable=*/false);
    metadata.writeMeta(out);
    const auto count = std::int32_t(grids.size());
    out.write(reinterpret_cast<const char*>(&count), sizeof count);
    for (const OutgoingGrid& outgoing : grids) write_grid(out, outgoing);
  }

 private:
  /// Writes a grid as writeGrid() does, but for the leaves where they are given.
  void write_grid(std::ostream& out, const OutgoingGrid& outgoing) const {
    const openvdb::GridBase& grid = *outgoing.grid;
    openvdb::io::GridDescriptor descriptor(grid.getName(), grid.type(), grid.saveFloatAsHalf());
    if (!outgoing.write_leaves) return writeGrid(descriptor, outgoing.grid, out, false);
    descriptor.writeHeader(out);
    descriptor.writeStreamPos(out);
    setGridCompression(out, grid);
    grid.writeMeta(out);
    grid.writeTransform(out);
    grid.writeTopology(out);
    outgoing.write_leaves(out);
  }
};

/// The result of `read`, with errors as read_vdb_grids() throws them.
template <class Read>
auto read_archive(const std::string& path, VdbTrust trust, const Read& read) {
  const InputFile file(path);
  try {
    GridArchive archive(file, trust);
    return read(archive, file);
  } catch (const std::bad_alloc&) {
    throw SystemError(path + ": not enough memory");
  } catch (const std::exception& error) {
    throw InputError({path, "", std::string(error.what()).substr(0, kMaxMessage), "OpenVDB grids"});
  }
}

/// A file that is written until the user asks to stop: a write throws Cancelled then, which a
/// stream with exceptions hands on.
class PolledFile : public std::filebuf {
 public:
  explicit PolledFile(const Progress* progress) : m_progress(progress) {}

 protected:
  std::streamsize xsputn(const char* bytes, std::streamsize count) override {
    constexpr std::streamsize kBetweenPolls = std::streamsize(1) << 20;
    m_unpolled += count;
    if (m_unpolled >= kBetweenPolls) {
      m_unpolled = 0;
      poll(m_progress);
    }
    return std::filebuf::xsputn(bytes, count);
  }

 private:
  const Progress* m_progress;
  std::streamsize m_unpolled = 0;
};

void write_throwing(const std::string& path, const std::vector<OutgoingGrid>& grids,
                    const openvdb::MetaMap& metadata, const Progress* progress) {
  require_memory(kWorkingBytes);
  PolledFile file(progress);
  std::ostream out(&file);
  out.exceptions(std::ios::failbit | std::ios::badbit);
  const auto require = [&](const void* done) {
    if (done == nullptr) out.setstate(std::ios::failbit);
  };
  require(file.open(path, std::ios::out | std::ios::binary | std::ios::trunc));
  GridWriter().write_all(out, grids, metadata);
  require(file.close());
}

}  // namespace

void write_vdb_stream(const AtomicFile& file, const std::vector<OutgoingGrid>& grids,
                      const openvdb::MetaMap& metadata, const Progress* progress) {
  errno = 0;
  try {
    write_throwing(file.path(), grids, metadata, progress);
  } catch (const Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw SystemError(file.final_path() + ": not enough memory");
  } catch (const std::exception&) {
    throw SystemError(file.final_path() +
                      ": cannot write: " + std::strerror(errno != 0 ? errno : EIO));
  }
}

VdbContent read_vdb_grids(const std::string& path, VdbTrust trust,
                          const std::function<bool(const std::string& name)>& stops) {
  return read_archive(path, trust, [&](GridArchive& archive, const InputFile& file) {
    require_memory(kWorkingBytes + 4 * file.size());
    return archive.read(stops);
  });
}

openvdb::MetaMap read_vdb_metadata(const std::string& path) {
  return read_archive(path, VdbTrust::sealed, [](GridArchive& archive, const InputFile&) {
    require_memory(kWorkingBytes);
    return archive.read_metadata();
  });
}

void attach_affine(openvdb::GridBase& grid, const Geometry& geometry) {
  const auto& a = geometry.axes_mm();
  const Vec3d& o = geometry.origin_lps_mm();
  try {
    openvdb::Mat4R matrix = openvdb::Mat4R::identity();
    for (int row = 0; row < 3; ++row) {
      matrix.setRow(row, openvdb::Vec4d(a[row].x, a[row].y, a[row].z, 0));
    }
    matrix.setRow(3, openvdb::Vec4d(o.x, o.y, o.z, 1));
    grid.setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  } catch (const openvdb::ArithmeticError&) {
    grid.insertMeta("affine", openvdb::StringMetadata("beyond OpenVDB's limits"));
  }
}

}  // namespace supple
