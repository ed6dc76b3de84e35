// Drags a voxel of a volume or state and writes the warp: drag_and_export VOLUME I J K DX DY DZ
// WARP
#include <cstdio>
#include <cstdlib>

#include <supple/supple.h>

int main(int argc, char** argv) try {
  if (argc != 9) return std::fprintf(stderr, "usage: see the first line of the source\n"), 2;
  const supple::Vec3i voxel(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
  const supple::Vec3d by_mm(std::atof(argv[5]), std::atof(argv[6]), std::atof(argv[7]));

  // [drag]
  supple::Session session(argv[1]);
  session.drag(voxel, by_mm);
  session.write_warp(argv[8]);
  // [drag]

  std::printf("moved %lld elements, residual of the inverse at most %g voxels\n",
              static_cast<long long>(session.records().back().report.moved),
              session.pose().offsets.certificate.residual_max);
  for (const std::string& line : session.messages()) std::printf("%s\n", line.c_str());
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "drag_and_export: %s\n", error.what()), 1;
}
