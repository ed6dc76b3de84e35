// This process: where its program lies, the memory that it holds and has held, its processor time.
#pragma once

#include <string>

namespace supple::tools {

/// The file of the program that is running.
std::string own_program();

/// The resident size of the process, in millions of bytes.
double rss_mb();

/// The largest resident size of the process so far, in millions of bytes. That of the program which
/// started it does not count.
double peak_rss_mb();

/// That of the programs which it has run, up to the present.
double peak_rss_of_children_mb();

/// What is allocated in small pieces lies in pages of 2 MiB from now on, where the system has them,
/// up to 256 MiB of it: the first touch of small pages else takes a third of a run. Not under a
/// limit of addresses, which the heap would use up ahead of its need.
void keep_heap_in_large_pages();

/// Pages of memory that is free go back to the system. What lives long, between large arrays that
/// do not, else keeps more and more of them.
void return_free_memory();

/// Processor time of all threads of the process so far.
double processor_seconds();

/// That which went into loading the program and its libraries, before main().
double loading_seconds();

}  // namespace supple::tools
