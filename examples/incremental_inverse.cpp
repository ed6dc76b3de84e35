// An inverse that follows a drag, solved again only where something moved: incremental_inverse
// VOLUME I J K
#include <cstdio>
#include <cstdlib>

#include <supple/supple.h>
#include <supple/volumes/field/inversion/invert.h>

int main(int argc, char** argv) try {
  if (argc != 5) return std::fprintf(stderr, "usage: incremental_inverse VOLUME I J K\n"), 2;
  const supple::Vec3i voxel(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
  supple::Session session(argv[1]);
  const supple::State rest = session.state();

  // [incremental]
  supple::LiveDisplacement live(rest.geometry, rest.elements, rest.density.bricks());
  supple::IncrementalInversion inverse(live.displacement());
  for (int step = 0; step < 3; ++step) {
    session.drag(voxel, {0.4, 0, 0});
    const auto changed = live.update(session.body().q);
    const auto solved = inverse.update(live.displacement(), changed);
    std::printf("%zu bricks moved, %zu bricks of offsets solved again\n", changed.size(),
                solved.size());
  }
  // [incremental]

  const supple::OffsetField anew = supple::invert(live.displacement());
  const bool is_same = inverse.field(live.displacement()).o.vectors == anew.o.vectors;
  std::printf("the same bits as an inversion anew: %s\n", is_same ? "yes" : "no");
  return is_same ? 0 : 1;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "incremental_inverse: %s\n", error.what()), 1;
}
