// The attributes of a DICOM file in front of its pixels (PS3.10, PS3.5), read without them. Source:
// DCMTK's parser over the file's first bytes. It recurses into nested sequences and trusts lengths,
// so its input is limited: kMaxHeaderBytes in all, kMaxDepth sequences deep.
// Cost: a few times the size of the header, which is some kB for a slice.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <dcmtk/config/osconfig.h>
// DCMTK wants osconfig.h first.
#include <dcmtk/dcmdata/dctk.h>

#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/text_header.h"

namespace supple {

constexpr std::size_t kMaxHeaderBytes = std::size_t(32) << 20;
constexpr int kMaxDepth = 64;

struct DicomFile {
  std::shared_ptr<const InputFile> file;
  std::string syntax_uid;
  E_TransferSyntax syntax = EXS_Unknown;
  std::int64_t data_offset = 0;         // of the dataset in the file
  std::unique_ptr<DcmDataset> dataset;  // everything in front of the pixels
  /// Offset behind the head of the element that follows, usually Pixel Data: from the file's start,
  /// or from the dataset's start after decompression where the dataset is deflated. The end without
  /// any.
  std::int64_t pixel_offset = 0;
};

/// Silences DCMTK's log and registers its decoders, once. Throws SystemError without dictionary.
void prepare_dcmtk();

/// Throws InputError for a file that is no DICOM file (dicom_start) or is damaged in front of the
/// pixels.
DicomFile read_attributes(const std::string& path);

/// Throws InputError for a transfer syntax whose pixels are not read.
void require_syntax(const DicomFile& file);

/// All values of an attribute, separated by backslashes; "" where it is absent.
std::string text_of(DcmItem& item, const DcmTagKey& tag);
/// The same as a field for strict parsing, named as the standard names it.
HeaderField field_of(const std::string& path, DcmItem& item, const DcmTagKey& tag);
/// Numbers of a field of text_of's form. Throws InputError unless there are `count` finite ones.
std::vector<double> numbers_of(const HeaderField& field, std::size_t count);
/// The attribute's keyword, as PS3.6 has it.
std::string name_of(const DcmTagKey& tag);

}  // namespace supple
