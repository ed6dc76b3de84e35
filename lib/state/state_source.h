// The volume that a state refers to in place of holding its densities: where it lies, how it is
// read, and the digest by which it is known again. Such a state holds bricks of its own
// (own_bricks.h) and takes all others from the volume.
#pragma once

#include <memory>
#include <string>

#include "lib/state/state.h"
#include "volumes/base/progress.h"
#include "volumes/io/format/volume_file.h"

namespace supple {

struct StateSource {
  std::string path;  // of a file, a folder or a pattern
  ReadOptions read;
  double lo = 0, hi = 0;  // densities that are elements, as load_elements() takes them
  int components = 0;     // likewise
  std::string sha256;     // digest_of() densities and elements
  /// Densities and elements as the volume gives them; empty while it is not open.
  DensityGrid density;
  BrickTopology elements;
};

/// SHA-256 of densities and elements as a state holds them, whatever the format of the volume and
/// the number of threads. Cost: 2.2 kB hashed per brick, 1.5 µs on a core with instructions for it.
std::string digest_of(const DensityGrid& density, const BrickTopology& elements);

/// The source of a state whose volume has just been loaded. A file stands for the folder of a DICOM
/// series, so that the same series is found again beside others.
std::shared_ptr<const StateSource> make_source(const VolumeHeader& header, const ReadOptions& read,
                                               double lo, double hi, int components,
                                               const DensityGrid& density,
                                               const BrickTopology& elements);

/// The metadata of a state file with this name; its path is relative to the folder of that file.
std::string source_to_json(const StateSource& source, const std::string& state_path);
/// A source that is not open. Throws InputError naming the state file.
StateSource source_from_json(const std::string& text, const std::string& state_path);

/// Loads densities and elements. Throws InputError naming state and source where the volume is
/// missing, of another geometry, or gives others than the digest says.
void open_source(StateSource& source, const Geometry& geometry, const std::string& state_path,
                 Progress* progress = nullptr);

/// True if a state was read without the volume that it refers to (read_reachable_state).
inline bool lacks_source(const State& state) {
  return state.source && state.source->elements.empty();
}

/// The source of a state file that refers to one, not open; null for any other file, also for a
/// damaged one. Reads the metadata alone.
std::shared_ptr<const StateSource> source_of_state_file(const std::string& path);

}  // namespace supple
