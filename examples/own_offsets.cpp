// An offset field of one's own in the renderer: own_offsets VOLUME IMAGE.png
//
// The volume is seen sheared, without a body or a solver.
#include <cstdio>

#include <supple/supple.h>

int main(int argc, char** argv) try {
  if (argc != 3) return std::fprintf(stderr, "usage: own_offsets VOLUME IMAGE.png\n"), 2;
  const supple::Volume volume = supple::load_volume(argv[1]);

  // [offsets]
  supple::OffsetField field;
  field.geometry = volume.geometry;
  field.o.topology = supple::dilate(volume.density.bricks(), 8);
  field.o.vectors.resize(field.o.topology.brick_count());
  for (std::size_t b = 0; b < field.o.topology.brick_count(); ++b) {
    for (int n = 0; n < supple::kBrickVoxels; ++n) {
      const supple::Vec3i x = field.o.topology.origin(b) + supple::brick_local(n);
      // What is now at x came from x + o(x).
      field.o.vectors.set(b * supple::kBrickVoxels + n, {0.2f * float(x.z), 0, 0});
    }
  }

  supple::Renderer renderer(volume.geometry, volume.density, 2);
  renderer.set_offsets(&field);
  // [offsets]

  supple::RenderSettings settings;
  settings.width = settings.height = 256;
  write_png(argv[2], renderer.render(supple::default_camera(volume.geometry, 1),
                                     supple::preset("MR-Default"), settings));
  std::printf("wrote %s\n", argv[2]);
  return 0;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "own_offsets: %s\n", error.what()), 1;
}
