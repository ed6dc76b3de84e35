// supple-examples: what the examples need beyond `supple` itself: the generated volumes, and the
// figures of the original ChainMail and ECM on surfaces, which `supple` does not offer.
#include <cstdio>
#include <filesystem>
#include <map>

#include <CLI/CLI.hpp>
#include <png.h>

#include "tools/examples/drag_surface.h"
#include "tools/examples/original_figures.h"
#include "volumes/io/volume_writer.h"
#include "volumes/phantom/phantom.h"

namespace {

using namespace supple;

constexpr int kSliceSize = 50;
constexpr int kExtrusion = 10;

Phantom make_phantom(const std::string& kind) {
  if (kind == "head") return head_phantom({256, 256, 108});
  if (kind == "large-head") return head_phantom({512, 512, 256});
  if (kind == "small-head") return head_phantom({96, 96, 54});
  if (kind == "gradient") return gradient_phantom(kSliceSize);
  if (kind == "t-shape") return t_shape_phantom(kSliceSize);
  if (kind == "irregular") return irregular_phantom(kSliceSize);
  if (kind == "lips") return lips_phantom();
  if (kind == "extruded") return extrude(t_shape_phantom(kSliceSize), kExtrusion);
  return constant_phantom({16, 16, 16}, 200);
}

/// A one-slice phantom as an 8-bit grey PNG.
void write_grey_png(const std::string& path, const Phantom& phantom) {
  const Vec3i dims = phantom.geometry.dims();
  std::vector<png_byte> grey(std::size_t(dims.x) * dims.y);
  for (int j = 0; j < dims.y; ++j) {
    for (int i = 0; i < dims.x; ++i) {
      grey[std::size_t(j) * dims.x + i] = png_byte(phantom.density(i, j, 0));
    }
  }
  png_image image = {};
  image.version = PNG_IMAGE_VERSION;
  image.width = png_uint_32(dims.x);
  image.height = png_uint_32(dims.y);
  image.format = PNG_FORMAT_GRAY;
  if (png_image_write_to_file(&image, path.c_str(), 0, grey.data(), 0, nullptr) == 0) {
    throw SystemError(path + ": " + image.message);
  }
}

void write_phantom(const std::string& kind, const std::string& path) {
  const Phantom phantom = make_phantom(kind);
  if (std::filesystem::path(path).extension() == ".png") return write_grey_png(path, phantom);
  const Vec3i dims = phantom.geometry.dims();
  const auto slice = [&](int k, float* out) {
    for (int j = 0; j < dims.y; ++j) {
      for (int i = 0; i < dims.x; ++i) *out++ = phantom.density(i, j, k);
    }
  };
  write_volume(path, phantom.geometry, ValueType::int16, slice);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Generates the inputs of Supple's examples.", "supple-examples");
  program.require_subcommand(1);
  std::string kind, output;
  CLI::App* phantom = program.add_subcommand("phantom", "Write a generated volume or grey image");
  phantom->add_option("kind", kind, "Which one")
      ->required()
      ->check(CLI::IsMember({"head", "large-head", "small-head", "gradient", "t-shape", "irregular",
                             "extruded", "lips", "cube"}));
  phantom->add_option("output", output, "A .png (one slice) or .nhdr file")->required();
  CLI::App* figure = program.add_subcommand("figure-4-5", "Original ChainMail against ECM");
  figure->add_option("folder", output, "Where the pictures go")->required();
  CLI::App* u_shape = program.add_subcommand("u-shape", "The same for a U of one material");
  u_shape->add_option("folder", output, "Where the pictures go")->required();
  supple::examples::SurfaceDrag drag;
  CLI::App* surface = program.add_subcommand("drag-surface", "Pull a surface at a point (ECM)");
  surface->add_option("input", drag.input, "STL, PLY, OBJ or VTK")->required();
  surface->add_option("output", drag.output, "The same with moved vertices")->required();
  surface->add_option("--grab", drag.grab, "X,Y,Z: the vertex nearest to it (LPS mm)")
      ->required()
      ->delimiter(',')
      ->expected(3);
  surface->add_option("--by", drag.by, "DX,DY,DZ (LPS mm)")
      ->required()
      ->delimiter(',')
      ->expected(3);
  surface->add_option("--fix-beyond", drag.fix_beyond, "Vertices further away stay (mm)");
  surface->add_option("--max-length", drag.max_length, "Of links, times their rest length");
  surface->add_option("--min-length", drag.min_length, "Of links, times their rest length");
  surface->add_option("--shear", drag.shear, "Of links, times their rest length");
  CLI11_PARSE(program, argc, argv);
  try {
    if (surface->parsed()) {
      supple::examples::drag_surface(drag);
    } else if (figure->parsed()) {
      supple::examples::draw_figure_4_5(t_shape_phantom(kSliceSize), output);
    } else if (u_shape->parsed()) {
      supple::examples::draw_u_shape(output);
    } else {
      write_phantom(kind, output);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "supple-examples: error: %s\n", error.what());
    return 1;
  }
  return 0;
}
