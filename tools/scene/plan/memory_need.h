// Runs that will need more memory than there is end with numbers: before their volume is read, by
// its header and a few of its slices, and exactly once it is open.
#pragma once

#include "tools/scene/run/scene_run.h"

namespace supple::tools {

/// Ends a run of a scene before its volume is read, where even the least that it may need is more
/// than there is: sizes and type of the header, and bricks in up to 8 slabs, with half as many in
/// those between. Reads slabs only where a volume that is full of tissue would not fit. The header
/// alone counts for states, and for materials that choose densities by the whole volume. Throws
/// SystemError with the needs and the ways out; as open_volume().
void require_memory_to_run(const Scene& scene, Progress* progress);

/// The same for a scene of which only the body is opened.
void require_memory_to_open(const Scene& scene, Progress* progress);

/// Ends a run that has opened its volume and will need more memory than there is, before it solves
/// anything. Plans only where what is open takes a hundredth of that. Throws SystemError, which
/// says what the run needs most of it for, and what it would need with a state
/// that refers to its volume, and without any.
void require_memory(const Scene& scene, const SceneRun& run);

/// Ends work on a file that takes so many bytes at once where there are fewer. Throws SystemError,
/// which names the work and the ways out.
void require_memory(const std::string& path, std::int64_t bytes, const std::string& work,
                    const std::string& ways_out);

}  // namespace supple::tools
