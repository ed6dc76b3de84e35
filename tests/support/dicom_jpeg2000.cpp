#include "tests/support/dicom_jpeg2000.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include <dcmtk/dcmdata/dcpixel.h>
#include <dcmtk/dcmdata/dcpixseq.h>
#include <dcmtk/dcmdata/dcpxitem.h>
#include <openjpeg.h>

namespace supple::test {

namespace {

void require(bool done) {
  if (!done) throw std::runtime_error("JPEG 2000 could not be written");
}

/// The bytes that OpenJPEG writes; it goes back to fill in lengths.
struct Sink {
  std::string bytes;
  std::size_t at = 0;

  void write(const void* from, std::size_t count) {
    bytes.resize(std::max(bytes.size(), at + count));
    if (from != nullptr) std::memcpy(&bytes[at], from, count);
    at += count;
  }
};

opj_stream_t* stream_to(Sink& sink) {
  opj_stream_t* stream = opj_stream_create(65536, OPJ_FALSE);
  opj_stream_set_user_data(stream, &sink, nullptr);
  opj_stream_set_write_function(stream, [](void* from, OPJ_SIZE_T count, void* user) {
    static_cast<Sink*>(user)->write(from, count);
    return count;
  });
  opj_stream_set_skip_function(stream, [](OPJ_OFF_T count, void* user) {
    static_cast<Sink*>(user)->write(nullptr, std::size_t(count));
    return count;
  });
  opj_stream_set_seek_function(stream, [](OPJ_OFF_T to, void* user) {
    static_cast<Sink*>(user)->at = std::size_t(to);
    return OPJ_BOOL(OPJ_TRUE);
  });
  return stream;
}

int number_of(DcmDataset& data, const DcmTagKey& tag) {
  Uint16 number = 0;
  require(data.findAndGetUint16(tag, number).good());
  return number;
}

/// Stored values of all frames.
std::vector<int> stored_values(DcmDataset& data, std::size_t count, bool is_signed) {
  std::vector<int> values(count);
  if (number_of(data, DCM_BitsAllocated) == 8) {
    const Uint8* bytes = nullptr;
    require(data.findAndGetUint8Array(DCM_PixelData, bytes).good());
    for (std::size_t n = 0; n < count; ++n) values[n] = is_signed ? Sint8(bytes[n]) : bytes[n];
  } else {
    const Uint16* words = nullptr;
    require(data.findAndGetUint16Array(DCM_PixelData, words).good());
    for (std::size_t n = 0; n < count; ++n) values[n] = is_signed ? Sint16(words[n]) : words[n];
  }
  return values;
}

}  // namespace

std::string jpeg2000_stream(const std::vector<int>& values, int columns, int rows, int bits,
                            bool is_signed) {
  opj_cparameters_t parameters;
  opj_set_default_encoder_parameters(&parameters);
  parameters.numresolution = 1;  // pictures of a few pixels
  opj_image_cmptparm_t component{};
  component.dx = component.dy = 1;
  component.w = OPJ_UINT32(columns);
  component.h = OPJ_UINT32(rows);
  component.prec = OPJ_UINT32(bits);
  component.sgnd = OPJ_UINT32(is_signed);
  opj_image_t* image = opj_image_create(1, &component, OPJ_CLRSPC_GRAY);
  image->x1 = component.w;
  image->y1 = component.h;
  std::copy(values.begin(), values.end(), image->comps[0].data);
  Sink sink;
  opj_stream_t* stream = stream_to(sink);
  opj_codec_t* codec = opj_create_compress(OPJ_CODEC_J2K);
  require(opj_setup_encoder(codec, &parameters, image) != 0 &&
          opj_start_compress(codec, image, stream) != 0 && opj_encode(codec, stream) != 0 &&
          opj_end_compress(codec, stream) != 0);
  opj_destroy_codec(codec);
  opj_stream_destroy(stream);
  opj_image_destroy(image);
  return sink.bytes;
}

void compress_jpeg2000(DcmDataset& data, E_TransferSyntax syntax, std::size_t fragment_bytes) {
  const int columns = number_of(data, DCM_Columns), rows = number_of(data, DCM_Rows);
  const bool is_signed = number_of(data, DCM_PixelRepresentation) == 1;
  OFString text;
  if (data.findAndGetOFString(DCM_NumberOfFrames, text).bad()) text = "1";
  const std::size_t frame = std::size_t(columns) * std::size_t(rows);
  const std::vector<int> values = stored_values(data, frame * std::stoul(text.c_str()), is_signed);
  auto* sequence = new DcmPixelSequence(DCM_PixelSequenceTag);
  sequence->insert(new DcmPixelItem(DCM_PixelItemTag));
  for (auto begin = values.begin(); begin != values.end(); begin += std::ptrdiff_t(frame)) {
    std::string stream = jpeg2000_stream({begin, begin + std::ptrdiff_t(frame)}, columns, rows,
                                         number_of(data, DCM_BitsStored), is_signed);
    stream.resize((stream.size() + 1) / 2 * 2);
    const std::size_t step = fragment_bytes == 0 ? stream.size() : fragment_bytes;
    for (std::size_t at = 0; at < stream.size(); at += step) {
      auto* item = new DcmPixelItem(DCM_PixelItemTag);
      const std::size_t count = std::min(step, stream.size() - at);
      require(
          item->putUint8Array(reinterpret_cast<const Uint8*>(stream.data()) + at, count).good());
      sequence->insert(item);
    }
  }
  auto* pixels = new DcmPixelData(DCM_PixelData);
  pixels->putOriginalRepresentation(syntax, nullptr, sequence);
  require(data.insert(pixels, true).good());
}

}  // namespace supple::test
