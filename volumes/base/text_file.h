// Small files of text, whole.
#pragma once

#include <string>

namespace supple {

/// Reads a file; empty where it cannot be read.
std::string text_of_file(const std::string& path);
/// Replaces the file as a whole, or not at all. Throws SystemError, InputError as AtomicFile.
void replace_text_file(const std::string& path, const std::string& text);

}  // namespace supple
