// The seal of OpenVDB files that supple writes: OpenVDB's own errors are not enough (truncated
// uncompressed files read as "ok", flipped bits crash the decoder), so a trailer after the last
// grid carries the length and the SHA-256 of everything before it, and both are verified before
// anything is decoded.
//
// OpenVDB writes a random UUID at byte 21. The digest takes it as zeros, and the digest's first 32
// digits then replace it, so that equal contents are equal files. Design section 7.
// Cost: one sequential read of the file.
#pragma once

#include <string>

#include "volumes/base/progress.h"

namespace supple {

/// The writer of a file, by its first and last bytes.
enum class VdbKind {
  none,     // no OpenVDB file
  foreign,  // another program's
  state,    // a deformed body (state.h)
  volume    // a dense volume or warp (dense_writer.h)
};
/// The kind of a file; `none` also for files that cannot be read.
VdbKind vdb_kind(const std::string& path);

/// Names of all our file-level metadata start with this; OpenVDB writes them sorted, so the first
/// one stands at a known place.
constexpr const char* kStateMetadataPrefix = "supple_";
constexpr const char* kVolumeMetadataPrefix = "supple-";

/// Replaces the UUID and appends the trailer to a complete OpenVDB stream of ours.
/// Throws SystemError when the file cannot be written, Cancelled.
void seal_vdb(const std::string& path, VdbKind kind, const Progress* progress = nullptr);

/// Throws InputError: missing, a folder, not OpenVDB, someone else's OpenVDB file, no trailer,
/// another length or digest than the trailer says.
void verify_vdb_seal(const std::string& path, VdbKind kind);

}  // namespace supple
