// Bytes of the fuzzer as a file, since every reader starts from a path.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

namespace supple::fuzz {

/// Puts the bytes under `name` into a folder of this process in memory and calls `read` with the
/// path. Errors that the library documents are what readers may throw; anything else ends the run.
void with_file(const std::string& name, const std::uint8_t* data, std::size_t size,
               const std::function<void(const std::string& path)>& read);

}  // namespace supple::fuzz
