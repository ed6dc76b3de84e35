// JPEG 2000 for the DICOM fixtures, which DCMTK does not write: encoded by OpenJPEG.
#pragma once

#include <string>
#include <vector>

#include "tests/support/dicom_fixtures.h"

namespace supple::test {

/// A lossless codestream of values, i fastest, of so many bits.
std::string jpeg2000_stream(const std::vector<int>& values, int columns, int rows, int bits,
                            bool is_signed);

/// Puts compressed frames in place of the pixels of `data`; each frame takes as many fragments of
/// at most `fragment_bytes` (even) as it needs, 0: one.
void compress_jpeg2000(DcmDataset& data, E_TransferSyntax syntax, std::size_t fragment_bytes = 0);

}  // namespace supple::test
