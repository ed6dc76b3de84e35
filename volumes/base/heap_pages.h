// The heap of the process: in large pages, and what is free given back.
#pragma once

namespace supple {

/// Puts small allocations into pages of 2 MiB from now on, where the system has them, up to 256 MiB
/// of it: the first touch of small pages else takes a third of a run. Not under a limit of
/// addresses, which the heap would use up ahead of its need: threads share one heap then, since
/// each takes 64 MiB or more for its own, and whether that leaves enough is a matter of luck. For
/// programs, not for libraries within them.
void keep_heap_in_large_pages();

/// Pages of memory that is free go back to the system; those that follow are large where a program
/// has kept them so. What lives long, between large arrays that do not, else keeps more and more.
void return_free_memory();

}  // namespace supple
