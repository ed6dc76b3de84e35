// supple-examples: what the examples need beyond `supple` itself: generated volumes and membranes,
// and the figures of the original ChainMail and ECM on surfaces, which `supple` does not offer.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>

#include <CLI/CLI.hpp>
#include <png.h>

#include "tools/examples/drag_surface.h"
#include "tools/examples/original_figures.h"
#include "volumes/io/mesh/mesh_writer.h"
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

/// A patch of triangles, in LPS mm, whose edges are at most `spacing` long along its sides.
struct MembranePatch {
  std::string output;
  std::array<double, 3> corner, edge1, edge2;
  double spacing_mm = 5;
};

/// Writes the patch; diagonals alternate, so that it is alike along both of them.
void write_membrane(const MembranePatch& membrane) {
  const auto vector = [](const std::array<double, 3>& v) { return Vec3d(v[0], v[1], v[2]); };
  const Vec3d edge1 = vector(membrane.edge1), edge2 = vector(membrane.edge2);
  const auto cells = [&](const Vec3d& edge) {
    return std::max(1, int(std::ceil(edge.length() / membrane.spacing_mm - 1e-9)));
  };
  const int n = cells(edge1), m = cells(edge2);
  LineNetwork network;
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) {
      network.mesh.vertices_lps_mm.push_back(vector(membrane.corner) + edge1 * (double(i) / n) +
                                             edge2 * (double(j) / m));
    }
  }
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
      const bool is_even = (i + j) % 2 == 0;
      network.mesh.triangles.push_back({a, b, is_even ? d : c});
      network.mesh.triangles.push_back({is_even ? a : b, d, c});
    }
  }
  write_mesh(membrane.output, network);
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
  MembranePatch membrane;
  CLI::App* patch = program.add_subcommand("membrane", "Write a flat patch of triangles");
  patch->add_option("output", membrane.output, "STL, PLY, OBJ or VTK")->required();
  const auto add_vector = [&](const char* name, std::array<double, 3>& v, const char* help) {
    patch->add_option(name, v, help)->required()->delimiter(',');
  };
  add_vector("--corner", membrane.corner, "X,Y,Z (LPS mm)");
  add_vector("--edge1", membrane.edge1, "DX,DY,DZ from the corner (LPS mm)");
  add_vector("--edge2", membrane.edge2, "DX,DY,DZ from the corner (LPS mm)");
  patch->add_option("--spacing", membrane.spacing_mm, "Of its nodes along the edges, at most (mm)")
      ->check(CLI::PositiveNumber);
  CLI11_PARSE(program, argc, argv);
  try {
    if (surface->parsed()) {
      supple::examples::drag_surface(drag);
    } else if (patch->parsed()) {
      write_membrane(membrane);
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
