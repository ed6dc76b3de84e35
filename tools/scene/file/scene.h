// A scene file: one volume, its labels, one material, steps that deform it, views and outputs
// (design.md section 8). Input paths are relative to the scene file; output paths to the -o folder.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lib/fem/voxel/fem_results.h"
#include "lib/material/material.h"
#include "lib/session/cut_surface.h"
#include "lib/session/deformable_mesh.h"
#include "lib/session/file/step_keys.h"
#include "lib/session/session.h"
#include "tools/scene/file/film.h"
#include "tools/scene/file/view.h"
#include "volumes/base/table.h"
#include "volumes/base/vec.h"
#include "volumes/io/load/label_file.h"

namespace supple::tools {

// The mesh bodies of a scene: [[body]].

struct SceneBody {
  MeshSetup setup = {};
  std::string output;  // mesh to write after the last step; empty: none
};
/// Keys of a [[body]].
Fields fields(SceneBody& body);

/// All tables [[body]] of a scene. Throws InputError as Table, for a name that two bodies have and
/// for an output of no mesh format.
std::vector<SceneBody> read_bodies(Table& root);

/// Puts them into a session. Throws InputError as Session::add().
void add_bodies(const std::vector<SceneBody>& bodies, Session& session);

// The files that a scene writes beside its pictures: [output].

/// A volume of what a step of finite elements says of its elements.
struct ElementOutput {
  FemQuantity quantity;
  std::string path;
  std::string table;  // in which it stands, as errors call it
};

struct SceneOutput {
  std::string state;
  bool refers = false;  // the state to its volume, in place of holding what did not move
  std::vector<std::string> offsets;        // resample-direction warps
  std::vector<std::string> displacements;  // material-direction warps
  std::vector<std::string> volumes;        // resampled volumes
  std::vector<ElementOutput> elements;     // of the last step of finite elements
  std::string forces;                      // a table (.csv) of forces on handles and shapes by step
  std::string motion;                      // a table (.csv) of the last step with a motion in time

  std::vector<std::string> all() const;
};

/// Throws InputError as Table.
SceneOutput read_output(Table& table);

struct Scene {
  std::string file;
  std::string volume_path;  // resolved
  ReadOptions read;
  std::string warp_path;    // resolved; the volume is seen through it; empty: as it is
  std::string labels_path;  // resolved; empty without labels
  LabelNames label_names;   // of its segments
  std::optional<MaterialTable> material;
  std::string material_path;      // resolved; empty for an inline table
  std::vector<SceneBody> bodies;  // beside the voxels
  std::vector<Step> steps;
  std::vector<SceneView> views;
  std::vector<OffsetFunction> path;  // of all deformed views and outputs but the state
  SceneOutput output;
  std::optional<Film> film;
  std::string described;  // the file and those that it names, for records beside results
  std::vector<std::string> warnings;  // keys by their former names
  bool has_events = false;            // of a live session, which read_event reads

  /// Every output path, relative as written; of a film, those of its frames to be made.
  std::vector<std::string> outputs() const;
  /// The files of one frame of a film. An output without a number is of the last one.
  std::vector<std::string> outputs_of(int frame) const;
  /// All outputs but pictures.
  std::vector<std::string> written() const;
  /// True if the frames of a film are those of the motion in time of its last step.
  bool films_motion() const;
  /// Steps before the first whose handles follow a path: the same in all frames.
  std::size_t still_steps() const;
};

/// Throws InputError: unknown key (line and suggestion), wrong type or value, missing key.
Scene read_scene(const std::string& path);
/// The root of a file, or the options of a command as one.
Scene read_scene(Table root);
/// Reads what is seen and how it gets there: volume, labels, material, steps and views. Throws as
/// read_scene().
void read_subject(Table& root, Scene& scene);

}  // namespace supple::tools
