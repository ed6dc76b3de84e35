#include "tools/lab/bench/peers/invert_peers.h"

#include <fstream>

#include "tools/lab/bench/peers/vtk_inverse.h"
#include "tools/scene/peers/peer_process.h"
#include "volumes/base/error.h"
#include "volumes/base/process.h"

namespace supple::tools {

namespace {

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
  VectorBricks o{voxels, BrickVectors(voxels.brick_count())};
  for (std::size_t b = 0; b < voxels.brick_count(); ++b) {
    for_each_active(voxels.mask(b), [&](int offset) {
      const Vec3i v = voxels.origin(b) + brick_local(offset);
      o.vectors.touch(b)[offset] = dense[(std::size_t(v.z) * dims.y + v.y) * dims.x + v.x];
    });
  }
  return o;
}

/// The command up to its arguments; empty when the peer is not installed.
std::vector<std::string> command_of(const std::string& peer, const std::string& folder) {
  if (peer == "itk") {
    const std::string program = program_beside("supple-itk-inverse");
    if (program.empty()) return {};
    return {program};
  }
  if (!has_python_with_vtk({"vtkFiltersHybrid", "vtkIOImage"})) return {};
  const std::string script = folder + "/invert.py";
  std::ofstream(script) << kVtkInverse;
  return {kPythonWithVtk, script};
}

}  // namespace

std::optional<PeerInverse> invert_by_peer(const std::string& peer, const Displacement& displacement,
                                          int threads) {
  const ScratchFolder scratch;
  std::vector<std::string> command = command_of(peer, scratch.path());
  if (command.empty()) return std::nullopt;
  const Vec3i& dims = displacement.geometry.dims();
  write_dense(displacement, scratch / "u.raw");
  command.push_back(scratch.path());
  for (const int number : {threads, dims.x, dims.y, dims.z}) {
    command.push_back(std::to_string(number));
  }
  PeerProcess process(command);
  PeerInverse inverse;
  inverse.ms = std::stod(process.read_line());
  process.finish();
  inverse.o = read_dense(displacement.u.topology, dims, scratch / "o.raw");
  return inverse;
}

}  // namespace supple::tools
