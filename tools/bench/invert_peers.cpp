#include "tools/bench/invert_peers.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "volumes/base/error.h"

namespace supple::tools {

namespace {

/// Arguments: folder, threads, nx, ny, nz. Reads u.raw, writes o.raw (floats, three per voxel, i
/// fastest), prints the milliseconds of the inversion.
constexpr const char* kVtkScript = R"(
import sys, time
from vtkmodules.vtkFiltersHybrid import vtkGridTransform, vtkTransformToGrid
from vtkmodules.vtkIOImage import vtkImageReader2, vtkMetaImageWriter
folder, threads, nx, ny, nz = sys.argv[1], *map(int, sys.argv[2:6])
reader = vtkImageReader2()
reader.SetFileName(folder + '/u.raw')
reader.SetFileDimensionality(3)
reader.SetDataExtent(0, nx - 1, 0, ny - 1, 0, nz - 1)
reader.SetDataScalarTypeToFloat()
reader.SetNumberOfScalarComponents(3)
reader.SetDataByteOrderToLittleEndian()
reader.Update()
transform = vtkGridTransform()
transform.SetDisplacementGridData(reader.GetOutput())
transform.SetInterpolationModeToLinear()
transform.Update()
grid = vtkTransformToGrid()
grid.SetInput(transform.GetInverse())
grid.SetGridExtent(0, nx - 1, 0, ny - 1, 0, nz - 1)
grid.SetGridScalarTypeToFloat()
begin = time.perf_counter()
grid.Update()
print(1e3 * (time.perf_counter() - begin))
writer = vtkMetaImageWriter()
writer.SetInputData(grid.GetOutput())
writer.SetCompression(False)
writer.SetFileName(folder + '/o.mhd')
writer.SetRAWFileName(folder + '/o.raw')
writer.Write()
)";

/// A folder of its own that goes when this does.
class Scratch {
 public:
  Scratch() {
    std::string pattern = (std::filesystem::temp_directory_path() / "supple-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw SystemError(pattern + ": cannot create");
    m_path = pattern;
  }
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(m_path, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  const std::string& path() const { return m_path; }

 private:
  std::string m_path;
};

void write_dense(const Displacement& displacement, const std::string& path) {
  const Vec3i& dims = displacement.geometry.dims();
  std::ofstream stream(path, std::ios::binary);
  std::vector<Vec3f> row(std::size_t(dims.x));
  for (int k = 0; k < dims.z; ++k) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) displacement.u.at({i, j, k}, row[std::size_t(i)]);
      stream.write(reinterpret_cast<const char*>(row.data()),
                   std::streamsize(row.size() * sizeof(Vec3f)));
    }
  }
  stream.flush();
  if (!stream) throw SystemError(path + ": cannot write");
}

VectorBricks read_dense(const BrickTopology& voxels, const Vec3i& dims, const std::string& path) {
  std::vector<Vec3f> dense(std::size_t(dims.x) * dims.y * dims.z);
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(dense.data()), std::streamsize(dense.size() * sizeof(Vec3f)));
  if (!stream) throw Error(path + ": found fewer values than voxels");
  VectorBricks o{voxels, std::vector<Vec3f>(voxels.brick_count() * kBrickVoxels, Vec3f(0))};
  for (std::size_t b = 0; b < voxels.brick_count(); ++b) {
    for_each_active(voxels.mask(b), [&](int offset) {
      const Vec3i v = voxels.origin(b) + brick_local(offset);
      o.vectors[b * kBrickVoxels + std::size_t(offset)] =
          dense[(std::size_t(v.z) * dims.y + v.y) * dims.x + v.x];
    });
  }
  return o;
}

/// What the command prints; empty when it fails.
std::string output_of(const std::string& command) {
  std::string text;
  FILE* pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (pipe == nullptr) return text;
  char buffer[256];
  while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) text += buffer;
  return ::pclose(pipe) == 0 ? text : "";
}

/// The command up to its arguments; empty when the peer is not installed.
std::string command_of(const std::string& peer, const std::string& folder) {
  if (peer == "itk") {
    const auto program =
        std::filesystem::read_symlink("/proc/self/exe").parent_path() / "supple-itk-inverse";
    return std::filesystem::exists(program) ? program.string() : "";
  }
  constexpr const char* kPython = "/usr/bin/python3";
  const std::string test =
      std::string(kPython) + " -c 'import vtkmodules.vtkFiltersHybrid; print(1)'";
  if (output_of(test).empty()) return "";
  std::ofstream(folder + "/invert.py") << kVtkScript;
  return std::string(kPython) + " " + folder + "/invert.py";
}

}  // namespace

std::optional<PeerInverse> invert_by_peer(const std::string& peer, const Displacement& displacement,
                                          int threads) {
  const Scratch scratch;
  const std::string command = command_of(peer, scratch.path());
  if (command.empty()) return std::nullopt;
  const Vec3i& dims = displacement.geometry.dims();
  write_dense(displacement, scratch.path() + "/u.raw");
  const std::string printed = output_of(
      command + " " + scratch.path() + " " + std::to_string(threads) + " " +
      std::to_string(dims.x) + " " + std::to_string(dims.y) + " " + std::to_string(dims.z));
  if (printed.empty()) throw Error(peer + ": the inversion failed");
  PeerInverse inverse;
  inverse.ms = std::stod(printed);
  inverse.o = read_dense(displacement.u.topology, dims, scratch.path() + "/o.raw");
  return inverse;
}

}  // namespace supple::tools
