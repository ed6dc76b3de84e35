// Checks for readers that open files by themselves, through streams or libraries.
#pragma once

#include <string>

namespace supple {

/// Throws InputError for a folder, a pipe, a socket or a device: opening a pipe would wait for its
/// writer, and a device may never end. A missing file passes, since opening it says so.
void require_regular_file(const std::string& path);

}  // namespace supple
