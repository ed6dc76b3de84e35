// supple crop, smooth and threshold: a volume made fit for a scene, slice by slice.
#include <functional>
#include <tuple>

#include "tools/console/command.h"
#include "tools/console/field_options.h"
#include "tools/console/parse.h"
#include "tools/scene/run/converted.h"
#include "tools/scene/run/output_plan.h"
#include "volumes/io/filter/filters.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/volume_file.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

namespace {

/// Options that every filter has.
struct FilterOptions {
  std::string input, output;
  ReadOptions read;
  WriteOptions write;
};

using Filter = std::function<std::unique_ptr<VolumeFile>(std::unique_ptr<VolumeFile>)>;

struct CropOptions : FilterOptions {
  std::string box;
  std::optional<NumberPair> range;
  double margin_mm = 0;
};

Fields fields(CropOptions& options) {
  return {
      Field("box", options.box, "Voxels to keep, both corners included").shown_as("I,J,K:I,J,K"),
      Field("range", options.range, "Keep the box around these densities").shown_as("LO,HI"),
      Field("margin", options.margin_mm, "With a range: more on every side")
          .unit("mm")
          .range(0, 1e6),
  };
}

struct SmoothOptions : FilterOptions {
  double sigma_mm = 1;
};

Fields fields(SmoothOptions& options) {
  return {
      Field("sigma", options.sigma_mm, "Standard deviation of the Gaussian").unit("mm").positive()};
}

struct ThresholdOptions : FilterOptions {
  NumberPair keep;
  Threshold threshold;
};

Fields fields(ThresholdOptions& options) {
  return {
      Field("keep", options.keep, "Densities that stay").shown_as("LO,HI").required(),
      Field("outside", options.threshold.outside, "Density in place of all others")
          .otherwise("the smallest of the volume"),
      Field("mask", options.threshold.is_mask, "Write 1 for what stays and 0 for all else"),
  };
}

int run_filter(const FilterOptions& options, const GlobalOptions& global, Console& console,
               const Filter& filter) {
  OutputPlan plan(global.force);
  plan.protect(options.input, options.read);
  plan.add_dense(options.output);
  console.claim(plan.files());
  write_converted([&] { return filter(open_volume(options.input, options.read)); }, options.output,
                  options.write, console);
  return kOk;
}

int run_crop(const CropOptions& options, const GlobalOptions& global, Console& console) {
  if (options.box.empty() == !options.range) {
    throw UsageError(std::string("crop: found ") +
                     (options.range ? "--box and --range" : "neither --box nor --range") +
                     ", expected one of them");
  }
  if (!options.range && options.margin_mm > 0) {
    throw UsageError("crop: found --margin beside --box, expected it beside --range");
  }
  const IndexBox box = options.range ? box_of_densities(*open_volume(options.input, options.read),
                                                        options.range->first, options.range->second,
                                                        options.margin_mm, &console)
                                     : parse_box("--box", options.box);
  return run_filter(options, global, console,
                    [&](std::unique_ptr<VolumeFile> file) { return crop(std::move(file), box); });
}

int run_threshold(const ThresholdOptions& options, const GlobalOptions& global, Console& console) {
  Threshold threshold_range = options.threshold;
  std::tie(threshold_range.lo, threshold_range.hi) = options.keep;
  double minimum = 0;
  if (!threshold_range.is_mask && !threshold_range.outside) {
    minimum = digest_volume(*open_volume(options.input, options.read), &console).statistics.min;
  }
  return run_filter(options, global, console, [&](std::unique_ptr<VolumeFile> file) {
    return threshold(std::move(file), threshold_range, minimum);
  });
}

template <class Options>
CLI::App* add_filter(CLI::App& program, const char* name, const char* description,
                     const char* examples, Options& options) {
  CLI::App* app = add_subcommand(program, name, description, examples);
  app->add_option("input", options.input, "A volume or a folder of slices")
      ->required()
      ->option_text("IN");
  app->add_option("-o,--output", options.output,
                  "Volume to write; its extension chooses the format")
      ->required()
      ->option_text("OUT");
  add_field_options(*app, fields(options));
  add_field_options(*app, fields(options.read));
  add_field_options(*app, fields(options.write));
  return app;
}

}  // namespace

Command add_crop(CLI::App& program) {
  auto options = std::make_shared<CropOptions>();
  CLI::App* app = add_filter(program, "crop", "Write a box of a volume",
                             "  supple crop head.nii.gz --box 20,20,0:235,220,107 -o small.nrrd\n"
                             "  supple crop head.nii.gz --range 300,3100 --margin 20 -o skull.nrrd",
                             *options);
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_crop(*options, global, console);
          }};
}

Command add_smooth(CLI::App& program) {
  auto options = std::make_shared<SmoothOptions>();
  CLI::App* app = add_filter(program, "smooth", "Write a volume smoothed by a Gaussian",
                             "  supple smooth head.nii.gz --sigma 1.5 -o smooth.nrrd", *options);
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_filter(*options, global, console, [&](std::unique_ptr<VolumeFile> file) {
              return smooth(std::move(file), options->sigma_mm);
            });
          }};
}

Command add_threshold(CLI::App& program) {
  auto options = std::make_shared<ThresholdOptions>();
  CLI::App* app =
      add_filter(program, "threshold", "Write the densities of a range, or where they are",
                 "  supple threshold head.nii.gz --keep 300,3100 -o bone.vdb\n"
                 "  supple threshold head.nii.gz --keep 300,3100 --mask -o bone_mask.nii.gz",
                 *options);
  return {app, [options](const GlobalOptions& global, Console& console) {
            return run_threshold(*options, global, console);
          }};
}

}  // namespace supple::tools
