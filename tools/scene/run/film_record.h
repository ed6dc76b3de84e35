// Files of a film before its frames are made: their names, those that are there already, and the
// record beside them by which a resumed run knows its own frames.
#pragma once

#include <string>
#include <vector>

#include "tools/scene/file/scene.h"
#include "tools/scene/run/output_plan.h"

namespace supple::tools {

/// Adds the files of all frames that are to be made, and the videos.
void plan_film(const Scene& scene, const std::string& folder, OutputPlan& plan);

/// The frames of "A:B", "N", or all where it is empty. Throws UsageError.
std::vector<int> frames_of(const std::string& text, const Film& film);

/// Leaves out the frames whose files are all there. Throws InputError where there are some and the
/// record does not say that the same scene made them.
void leave_out_made(Scene& scene, const std::string& folder);

/// The file of the record: SCENE.film.json in the folder.
std::string film_record_path(const Scene& scene, const std::string& folder);
/// Says which scene the frames beside it belong to.
void write_film_record(const Scene& scene, const std::string& folder);

}  // namespace supple::tools
