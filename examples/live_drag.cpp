// A drag in small steps with a picture after each, and back again: live_drag VOLUME I J K
//
// ForwardOffsets let each sample solve for itself, so that a step needs no inverse.
#include <cstdio>
#include <cstdlib>

#include <supple/supple.h>
#include <supple/volumes/field/inversion/forward_offsets.h>

int main(int argc, char** argv) try {
  if (argc != 5) return std::fprintf(stderr, "usage: live_drag VOLUME I J K\n"), 2;
  const supple::Vec3i voxel(std::atoi(argv[2]), std::atoi(argv[3]), std::atoi(argv[4]));
  supple::SessionOptions options;
  options.keeps_undo = true;
  supple::Session session(argv[1], options);
  const supple::State rest = session.state();

  // [live]
  supple::Renderer renderer(rest.geometry, rest.density);
  const supple::Camera camera = supple::default_camera(rest.geometry, 1);
  supple::RenderSettings settings;
  settings.width = settings.height = 256;
  supple::LiveDisplacement live(rest.geometry, rest.elements, rest.density.bricks());
  const auto offsets =
      std::make_shared<supple::ForwardOffsets>(live.displacement(), &rest.elements);
  for (int step = 0; step < 5; ++step) {
    session.drag(voxel, {0, 0.5, 0});
    offsets->update(live.update(session.body().q));
    renderer.set_pointwise_offsets(offsets);
    const supple::Image picture = renderer.render(camera, supple::preset("MR-Default"), settings);
    write_png("live_" + std::to_string(step) + ".png", picture);
  }
  while (session.undo()) {
  }
  // [live]

  const bool is_at_rest = session.state().q == rest.q;
  std::printf("five pictures; all steps taken back: %s\n", is_at_rest ? "at rest" : "still moved");
  return is_at_rest ? 0 : 1;
} catch (const supple::Error& error) {
  return std::fprintf(stderr, "live_drag: %s\n", error.what()), 1;
}
