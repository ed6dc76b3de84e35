// A manual page and completions of shells, from the options that the commands declare.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace supple::tools {

/// supple(1) for man, in troff's macros (man-pages(7)).
std::string manual_page(const CLI::App& program);

// Scripts for shells: subcommands, options, the words that an option may take, and files.
std::string bash_completion(const CLI::App& program);
std::string zsh_completion(const CLI::App& program);
std::string fish_completion(const CLI::App& program);

}  // namespace supple::tools
