#include "tools/console/read_options.h"

#include "tools/console/parse.h"
#include "volumes/io/open_volume.h"

namespace supple::tools {

void add_read_options(CLI::App& app, ReadOptions& options) {
  app.add_option("--raw", options.raw,
                 "Headerless raw: dims=X,Y,Z,type=int16,spacing=A,B,C[,endian=big][,offset=N]");
  app.add_option("--frame", options.frame, "One volume of a time series, from 0")->option_text("N");
  app.add_option("--channel", options.channel, "One of several values per voxel, from 0")
      ->option_text("N");
  app.add_option_function<std::string>(
         "--spacing",
         [&options](const std::string& text) {
           options.spacing_mm = parse_vector("--spacing", text);
         },
         "Voxel size in mm in place of the file's")
      ->option_text("A,B,C");
}

void add_write_options(CLI::App& app, WriteOptions& options) {
  app.add_flag("--compress", options.compress, "Deflate the values (NRRD, MetaImage, TIFF, HDF5)");
}

void add_warp_options(CLI::App& app, WriteOptions& options) {
  app.add_option_function<int>(
         "--intent", [&options](int intent) { options.ras_vectors = intent == 1006; },
         "NIfTI: 1007, vectors in LPS (default), or 1006, in RAS")
      ->check(CLI::IsMember({1006, 1007}))
      ->option_text("1006|1007");
}

}  // namespace supple::tools
