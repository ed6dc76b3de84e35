// OME-XML in the ImageDescription of a TIFF file. The first Image counts; a warning tells of
// others. Files whose planes lie in several files are refused. pugixml neither loads external
// entities nor expands those of a document type, so that text cannot grow.
#include <algorithm>
#include <map>
#include <set>

#include <pugixml.hpp>

#include "volumes/base/error.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/format/length_units.h"
#include "volumes/io/tiff/tiff_metadata.h"

namespace supple {

namespace {

constexpr std::size_t kMaxXml = std::size_t(64) << 20;

std::string local_name(const pugi::xml_node& node) {
  const std::string name = node.name();
  return name.substr(name.find(':') + 1);
}

std::vector<pugi::xml_node> children(const pugi::xml_node& parent, const std::string& name) {
  std::vector<pugi::xml_node> found;
  for (const pugi::xml_node& child : parent.children()) {
    if (local_name(child) == name) found.push_back(child);
  }
  return found;
}

class OmeReader {
 public:
  explicit OmeReader(const TiffPages& pages) : m_pages(pages) { load(); }

  TiffLayout layout() {
    TiffLayout layout;
    read_sizes(layout);
    check_one_file();
    read_planes(layout);
    for (int a = 0; a < 3; ++a) layout.spacing_mm[a] = spacing_of("XYZ"[a], layout);
    const std::size_t images = children(m_root, "Image").size();
    if (images > 1) {
      layout.warnings.push_back("the first of " + std::to_string(images) +
                                " images of the OME description is read");
    }
    return layout;
  }

 private:
  [[noreturn]] void fail(const std::string& field, const std::string& found,
                         const std::string& expected) const {
    throw InputError({m_pages.file().path(), "OME " + field, printable(found), expected});
  }

  void load() {
    const std::string& text = m_pages.description();
    if (text.size() > kMaxXml)
      fail("XML", std::to_string(text.size()) + " bytes", "64 MiB at most");
    const pugi::xml_parse_result result = m_document.load_buffer(text.data(), text.size());
    if (!result) {
      fail("XML", std::string(result.description()) + " at byte " + std::to_string(result.offset),
           "well-formed XML");
    }
    m_root = m_document.document_element();
    if (local_name(m_root) != "OME") fail("XML", local_name(m_root), "an OME element");
    if (!children(m_root, "BinaryOnly").empty()) {
      fail("XML", "BinaryOnly: the metadata lie in another file", "metadata in the file itself");
    }
    const auto images = children(m_root, "Image");
    if (images.empty()) fail("Image", "none", "one");
    const auto pixels = children(images[0], "Pixels");
    if (pixels.empty()) fail("Pixels", "none", "one");
    m_pixels = pixels[0];
  }

  std::int64_t whole(const pugi::xml_node& node, const char* name, std::int64_t lowest) const {
    const HeaderField field{m_pages.file().path(), std::string("OME ") + name,
                            node.attribute(name).value()};
    const std::int64_t value = field.integer();
    if (value < lowest || value > 0x7fffffff) {
      field.fail(std::to_string(lowest) + " to 2147483647");
    }
    return value;
  }
  std::int64_t whole_or(const pugi::xml_node& node, const char* name, std::int64_t fallback) const {
    return node.attribute(name) ? whole(node, name, 0) : fallback;
  }

  void read_sizes(TiffLayout& layout) const {
    const TiffPage& page = m_pages.format();
    const std::int64_t x = whole(m_pixels, "SizeX", 1), y = whole(m_pixels, "SizeY", 1);
    if (x != page.width || y != page.height) {
      fail("SizeX and SizeY", std::to_string(x) + " x " + std::to_string(y),
           std::to_string(page.width) + " x " + std::to_string(page.height) + " as the pages are");
    }
    const std::int64_t channels = whole(m_pixels, "SizeC", 1);
    if (channels % page.samples != 0) {
      fail("SizeC", std::to_string(channels),
           "a multiple of the " + std::to_string(page.samples) + " samples per pixel");
    }
    layout.channels = channels / page.samples;
    layout.slices = whole(m_pixels, "SizeZ", 1);
    layout.frames = whole(m_pixels, "SizeT", 1);
    const double planes = double(layout.channels) * double(layout.slices) * double(layout.frames);
    if (planes > double(m_pages.count())) {
      fail("planes", number_text(planes) + " (SizeZ x SizeC x SizeT)",
           std::to_string(m_pages.count()) + " at most, as there are pages");
    }
  }

  /// Throws unless there is one UUID at most, that of this file.
  void check_one_file() const {
    const std::string own = m_root.attribute("UUID").value();
    std::set<std::string> others;
    if (!own.empty()) others.insert(own);
    for (const pugi::xml_node& data : children(m_pixels, "TiffData")) {
      for (const pugi::xml_node& uuid : children(data, "UUID")) {
        others.insert(trimmed(uuid.child_value()));
      }
    }
    if (others.size() > 1) {
      fail("TiffData", "planes in several files", "one file that holds all planes");
    }
  }

  /// Strides in the order of the planes; then which page holds each.
  void read_planes(TiffLayout& layout) const {
    const std::string order = m_pixels.attribute("DimensionOrder").value();
    std::string sorted = order.size() == 5 ? order.substr(2) : "";
    std::sort(sorted.begin(), sorted.end());
    if (order.compare(0, 2, "XY") != 0 || sorted != "CTZ") {
      fail("DimensionOrder", order, "XY, then Z, C and T in some order");
    }
    std::int64_t stride = 1;
    for (const char letter : order.substr(2)) {
      (letter == 'Z'   ? layout.slice_stride
       : letter == 'C' ? layout.channel_stride
                       : layout.frame_stride) = stride;
      stride *= letter == 'Z' ? layout.slices : letter == 'C' ? layout.channels : layout.frames;
    }
    const auto planes = std::size_t(stride);
    layout.pages.assign(planes, m_pages.count());
    const auto blocks = children(m_pixels, "TiffData");
    for (const pugi::xml_node& block : blocks) place(block, layout);
    if (blocks.empty()) {
      for (std::size_t n = 0; n < planes; ++n) layout.pages[n] = n;
    }
    for (std::size_t n = 0; n < planes; ++n) {
      if (layout.pages[n] < m_pages.count()) continue;
      fail("TiffData", "no page for plane " + std::to_string(n), "one for every plane");
    }
  }

  void place(const pugi::xml_node& block, TiffLayout& layout) const {
    const std::int64_t z = whole_or(block, "FirstZ", 0), t = whole_or(block, "FirstT", 0);
    const std::int64_t c = whole_or(block, "FirstC", 0) / m_pages.format().samples;
    if (z >= layout.slices || c >= layout.channels || t >= layout.frames) {
      fail("TiffData", "a first plane beyond SizeZ, SizeC or SizeT", "one of the planes");
    }
    const auto planes = std::int64_t(layout.pages.size()), pages = std::int64_t(m_pages.count());
    const std::int64_t first =
        z * layout.slice_stride + c * layout.channel_stride + t * layout.frame_stride;
    const std::int64_t ifd = whole_or(block, "IFD", 0);
    const std::int64_t all = std::min(planes - first, pages - std::min(ifd, pages));
    const std::int64_t count = whole_or(block, "PlaneCount", block.attribute("IFD") ? 1 : all);
    if (count > planes - first || count > pages - ifd) {
      fail("TiffData", "IFD " + std::to_string(ifd) + " with PlaneCount " + std::to_string(count),
           "up to " + std::to_string(planes) + " planes on " + std::to_string(pages) + " pages");
    }
    for (std::int64_t n = 0; n < count; ++n) {
      layout.pages[std::size_t(first + n)] = std::size_t(ifd + n);
    }
  }

  /// Spacing in mm; micrometres where no unit is named, 1 mm where there is no size.
  double spacing_of(char axis, TiffLayout& layout) const {
    const std::string name = std::string("PhysicalSize") + axis;
    const HeaderField field{m_pages.file().path(), "OME " + name,
                            m_pixels.attribute(name.c_str()).value()};
    if (field.text.empty()) {
      if (axis == 'Z' && layout.slices > 1 && m_pixels.attribute("PhysicalSizeX")) {
        layout.warnings.push_back(
            "the distance of slices is not recorded; it counts as 1 mm "
            "(spacing can be given)");
      }
      return 1;
    }
    const double size = field.number();
    if (!(size > 0)) field.fail("a positive length");
    const pugi::xml_attribute named = m_pixels.attribute((name + "Unit").c_str());
    const std::string unit = named ? named.value() : "um";
    const std::optional<double> factor = mm_per_unit(unit);
    if (!factor) {
      layout.warnings.push_back("unit \"" + printable(unit) + "\" of " + name +
                                " is no length that is known; it counts as mm");
    }
    return size * factor.value_or(1);
  }

  const TiffPages& m_pages;
  pugi::xml_document m_document;
  pugi::xml_node m_root, m_pixels;
};

}  // namespace

TiffLayout ome_layout(const TiffPages& pages) {
  return OmeReader(pages).layout();
}

}  // namespace supple
