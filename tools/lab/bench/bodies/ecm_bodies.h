// Bodies that the ECM benchmark drags: full blocks of generated material classes, a generated head
// and the head CT. The same voxels whatever the number of threads.
#pragma once

#include <string>

#include "lib/body/body.h"
#include "tools/console/console.h"

namespace supple::tools {

/// A full block at rest under design.md section 2's example table (class 255 stretches by 1.5,
/// shrinks by 0.6 and shears by 0.7; class 0 is rigid), spacing 1 mm. Fields:
///   noise   classes 1 to 255, hashed from the voxel;
///   ct      rigid ellipsoidal shells (class 0), 3 voxels thick, 13 apart, in soft noise of
///           classes 200 to 255;
///   smooth  waves of 60 to 120 voxels, classes 28 to 228.
/// No density grid is built: 1 byte per voxel, 100 per brick. Some 3 ns per voxel and core.
Body block_body(const std::string& field, const Vec3i& size);

/// The head phantom of volumes/phantom with the demo's CT material and without its headrest;
/// sampled at half the resolution and trilinear between.
Body head_phantom_body(const Vec3i& size);

/// A ball that just fits into that many voxels of 1 mm, of one kind: class 255, whose links may get
/// three times as long and a fifth as long, and shear by twice their length; 1 kPa.
Body ball_body(int diameter);

/// The same ball of soft tissue: links get 1.5 times as long and 0.6 times, and shear by a quarter
/// of their length, which excludes folds; 1 kPa.
Body tissue_ball_body(int diameter);

/// A bar of that tissue, a third as many voxels along j and k as along i.
Body tissue_bar_body(int length);

/// A full block of voxels of 1 mm, of one kind: class 255 of the material.
Body even_block_body(const Vec3i& size, const MaterialTable& material);

/// A head CT under the material of docs/scenes/ct_head_material.toml.
Body ct_head_body(const std::string& path);
/// The path given, or the head CT that tools/fetch_ct_head.sh fetches; empty where there is
/// neither, with a note when `notes_absence`.
std::string head_file(const std::string& given, bool notes_absence, Console& console);

/// The size of a volume file.
Vec3i volume_dims(const std::string& path);

}  // namespace supple::tools
