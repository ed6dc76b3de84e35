#include "tools/scene/run/converted.h"

#include "volumes/io/load/convert.h"
#include "volumes/io/load/load.h"

namespace supple::tools {

namespace {

ConvertPlan plan_for(const VolumeOpener& open, const VolumeHeader& header,
                     const std::string& output, Progress& progress) {
  const bool is_scaled = header.slope != 1 || header.intercept != 0;
  if (header.components > 1 || !is_scaled || keeps_scaling(output)) {
    return plan_conversion(header, output, 0, 0);
  }
  const VolumeStatistics statistics = digest_volume(*open(), &progress).statistics;
  return plan_conversion(header, output, statistics.min, statistics.max);
}

}  // namespace

Fields fog_fields(WriteOptions& options) {
  return {
      Field("range", options.range, "OpenVDB: a fog for renderers, 0 to 1 from LO to HI")
          .shown_as("LO,HI"),
      Field("scale", options.scale, "OpenVDB: units of the scene per mm; 0.001 makes metres")
          .range(1e-6, 1e6),
      Field("half", options.half, "OpenVDB: floats of 16 bits"),
  };
}

void write_converted(const VolumeOpener& open, const std::string& output,
                     const WriteOptions& options, Progress& progress) {
  const std::unique_ptr<VolumeFile> file = open();
  const VolumeHeader& header = file->header();
  warn_of_all(header.path, header.warnings, &progress);
  const ConvertPlan plan = plan_for(open, header, output, progress);
  warn_of_all(output, convert(*file, plan, output, options, &progress), &progress);
}

}  // namespace supple::tools
