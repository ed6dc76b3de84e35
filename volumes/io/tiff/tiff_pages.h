// The pages of a TIFF or BigTIFF file, decoded one by one by libtiff: grey or several samples per
// pixel, 8 to 64-bit integers, 32 and 64-bit floats, strips or tiles, samples together or in
// planes, every compression that libtiff was built with. Source: TIFF 6.0. All pages must agree in
// size and type; reduced-resolution copies of pages (NewSubfileType 1) are passed over, as tifffile
// keeps them apart from the images of full size. Cost: every directory is read once when the file
// is opened, 8 bytes per page are kept; reading takes the decoded page (the caller's), one strip or
// tile, and one plane where samples lie in planes.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/format/volume_file.h"

struct tiff;

namespace supple {

/// Format of a page's pixels, by its tags.
struct TiffPage {
  std::int64_t width = 0;
  std::int64_t height = 0;
  ValueType type = ValueType::uint8;
  int samples = 1;         // values per pixel
  int photometric = 1;     // 0 MinIsWhite, 1 MinIsBlack, 2 RGB, 3 palette
  bool in_planes = false;  // each sample in a plane of its own
  int compression = 1;     // 1 none

  std::int64_t bytes() const;  // decoded
};

/// XResolution and YResolution, 0 where they are absent; unit 1 none, 2 inch, 3 cm.
struct TiffResolution {
  double x = 0;
  double y = 0;
  int unit = 2;
};

class TiffPages {
 public:
  /// Throws InputError: damaged, unsupported or differing pages, more pixels than the file can
  /// hold.
  explicit TiffPages(const std::string& path);
  ~TiffPages();

  std::size_t count() const { return m_offsets.size(); }
  /// The format that all pages share.
  const TiffPage& format() const { return m_format; }
  /// Description and resolution of the first page.
  const std::string& description() const { return m_description; }
  const TiffResolution& resolution() const { return m_resolution; }
  /// First byte of the first page's values if they are neither compressed nor scattered.
  std::optional<std::int64_t> first_byte() const { return m_first_byte; }
  const InputFile& file() const { return m_file; }

  /// Decodes a page into `out`: rows from the top, the samples of a pixel together, native byte
  /// order. Throws InputError for damaged data.
  void read(std::size_t page, void* out);

 private:
  struct Closer {
    void operator()(tiff* handle) const;
  };

  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const;
  [[noreturn]] void fail_library(const std::string& what) const;
  void select(std::uint64_t offset);
  int tag(std::uint32_t name, int fallback) const;
  bool is_reduced() const;
  TiffPage parse_page() const;
  void parse_first();
  void check_same(const TiffPage& page, std::size_t number) const;
  void check_length(std::size_t pages) const;
  bool read_strips(int plane, char* out);
  bool read_tiles(int plane, char* out);
  void read_planes(char* out);

  InputFile m_file;
  std::string m_message;
  std::unique_ptr<tiff, Closer> m_tiff;
  std::vector<std::uint64_t> m_offsets;  // of the directories of the pages
  std::uint64_t m_selected = 0;
  TiffPage m_format;
  std::string m_description;
  TiffResolution m_resolution;
  std::optional<std::int64_t> m_first_byte;
  std::vector<char> m_plane, m_tile;
};

}  // namespace supple
