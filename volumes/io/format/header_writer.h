// Writers of formats that are a text header and a run of values, attached or in a file beside it:
// NRRD, MetaImage and VTK's image data.
#pragma once

#include "volumes/io/format/dense_writer.h"

namespace supple {

/// Stands in a header for the length in bytes of the compressed stream, which is known at the end;
/// blanks fill the rest of the field.
constexpr const char* kStreamSize = "@@@@@@@@@@@@@@@@@@@@";

/// Writes `header`, then the slices as they come: little-endian, plain, or as one gzip stream. Both
/// files of a pair are complete before the first of them takes its name. `footer` comes last.
enum class StreamCoding { plain, gzip };
std::unique_ptr<DenseWriter> write_after_header(const std::string& path,
                                                const std::string& raw_path,
                                                const std::string& header, const DenseImage& image,
                                                StreamCoding coding,
                                                const std::string& footer = "");

}  // namespace supple
