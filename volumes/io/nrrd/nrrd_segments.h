// Segmentations of 3D Slicer (.seg.nrrd): a NRRD whose keys Segment0_Name, Segment0_LabelValue,
// Segment0_Layer and so on give its values their meaning. Segments that overlap lie in layers, the
// components of a voxel.
// Source: slicer.readthedocs.io, developer guide, "Segmentation labelmap file format".
#pragma once

#include <memory>

#include "volumes/io/format/volume_file.h"
#include "volumes/io/nrrd/nrrd_header.h"

namespace supple {

struct NrrdSegment {
  std::string name;
  std::int32_t value = 1;  // in its layer
  int layer = 0;
  std::int32_t label = 1;
};

/// The segments in the order of their numbers; none in a file that is no segmentation. Their labels
/// are their values, or 1, 2, … where segments of several layers share a value. Files of Slicer 4
/// give neither value nor layer: each segment is the ones of its own layer. Throws InputError for a
/// value that is no label and a layer of which there are fewer.
std::vector<NrrdSegment> nrrd_segments(const NrrdHeader& header, int layers);

/// The layers as one volume of labels, with a warning: where several segments hold a voxel the
/// last of them counts. A file of one layer stays as it is.
std::unique_ptr<VolumeFile> with_layers_merged(std::unique_ptr<VolumeFile> file,
                                               std::vector<NrrdSegment> segments);

}  // namespace supple
