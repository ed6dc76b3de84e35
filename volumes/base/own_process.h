// This process: where its program lies, the memory that it holds and has held, its processor time.
#pragma once

#include <string>
#include <vector>

namespace supple {

/// The file of the program that is running.
std::string own_program();
/// The program of that name in its folder; empty where there is none.
std::string program_beside(const std::string& name);
/// Returns that program; throws SystemError where there is none.
std::string require_program_beside(const std::string& name);
/// Starts the program in place of this one, as the same process, with arguments that begin with
/// its name. Throws SystemError where it cannot be started.
[[noreturn]] void become_program(const std::string& program,
                                 const std::vector<std::string>& arguments);

/// The resident size of the process, in millions of bytes.
double rss_mb();

/// The largest resident size of the process so far, in millions of bytes. That of the program which
/// started it does not count.
double peak_rss_mb();

/// The largest resident size of the programs which it has run, up to the present.
double peak_rss_of_children_mb();

/// The memory that the process may still take, in millions of bytes: what is free on the machine,
/// in its control group and under `ulimit -v`.
double memory_left_mb();

/// Processor time of all threads of the process so far.
double processor_seconds();

/// Processor time for loading the program and its libraries, before main().
double loading_seconds();

}  // namespace supple
