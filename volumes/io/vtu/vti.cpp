// VTK's XML image data (.vti), read and written: one array of values or vectors at the points of a
// grid, which are the voxels' centres; of foreign files also at its cells. Coordinates are LPS mm.
// The writer puts values raw behind the XML, so that slices go to the disk as they come; all VTK
// readers and meshio read that.
// Format: VTK File Formats, vtk.org, "XML File Formats"; Direction since VTK 9.
#include <array>
#include <sstream>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"
#include "volumes/io/format/formats.h"
#include "volumes/io/format/header_writer.h"
#include "volumes/io/vtu/vtk_xml.h"

namespace supple {

namespace {

// In the order of ValueType.
constexpr std::array<const char*, 10> kVtkTypes = {
    "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Float32", "Float64"};
constexpr int kMostComponents = 16;
constexpr const char* kCertificateMark = "<!-- supple certificate ";
/// The end of the file, behind its raw values.
constexpr const char* kFooter = "\n</AppendedData>\n</VTKFile>\n";

/// So many numbers of an attribute, or the default where it is missing.
std::vector<double> numbers_of(const pugi::xml_node& node, const char* name,
                               const std::vector<double>& otherwise, const std::string& path) {
  const pugi::xml_attribute attribute = node.attribute(name);
  if (!attribute) return otherwise;
  std::istringstream text(attribute.value());
  std::vector<double> numbers;
  for (double number; text >> number;) numbers.push_back(number);
  if (numbers.size() != otherwise.size()) {
    throw InputError({path, name, std::string("'") + attribute.value() + "'",
                      std::to_string(otherwise.size()) + " numbers"});
  }
  return numbers;
}

struct ImageArray {
  pugi::xml_node node;
  bool is_of_cells = false;
};

/// The only array, or the one that the file calls its scalars or vectors.
ImageArray choose_array(const pugi::xml_node& piece, const std::string& path) {
  std::vector<ImageArray> arrays, active;
  std::string names;
  for (const bool is_of_cells : {false, true}) {
    const pugi::xml_node data = piece.child(is_of_cells ? "CellData" : "PointData");
    for (const pugi::xml_node& node : data.children("DataArray")) {
      const std::string name = node.attribute("Name").value();
      names += (names.empty() ? "" : ", ") + name;
      arrays.push_back({node, is_of_cells});
      for (const char* role : {"Scalars", "Vectors"}) {
        if (data.attribute(role) && name == data.attribute(role).value()) {
          active.push_back(arrays.back());
        }
      }
    }
  }
  if (arrays.size() == 1) return arrays.front();
  if (active.size() == 1) return active.front();
  throw InputError({path, "arrays", names.empty() ? "none" : names,
                    "one, or one that PointData or CellData name as Scalars or Vectors"});
}

ValueType type_of(const VtuArray& array, const std::string& path) {
  for (std::size_t n = 0; n < kVtkTypes.size(); ++n) {
    if (array.type == kVtkTypes[n]) return ValueType(n);
  }
  throw InputError({path, "DataArray " + array.name, "type " + array.type, "Int8 to Float64"});
}

class ImageDataFile : public VolumeFile {
 public:
  explicit ImageDataFile(const std::string& path) {
    VtkXml content;
    open_vtk_xml(path, content);
    m_header.path = path;
    m_header.format = "vti";
    const pugi::xml_node image = content.xml.child("VTKFile").child("ImageData");
    const pugi::xml_node piece = image.child("Piece");
    if (!piece || piece.next_sibling("Piece")) {
      throw InputError({path, "Piece", piece ? "several" : "none", "one"});
    }
    const ImageArray chosen = choose_array(piece, path);
    read_geometry(image, piece, chosen.is_of_cells);
    const VtuArray array = array_of(chosen.node);
    m_header.type = type_of(array, path);
    m_header.components = chosen.node.attribute("NumberOfComponents").as_int(1);
    if (m_header.components < 1 || m_header.components > kMostComponents) {
      throw InputError({path, "NumberOfComponents", std::to_string(m_header.components),
                        "1 to " + std::to_string(kMostComponents)});
    }
    if (array.name == "offset") m_header.warp_direction = "resample";
    if (array.name == "displacement") m_header.warp_direction = "material";
    read_certificate(content.bytes);
    m_values = supple::numbers_of(array, content.encoding);
    const std::int64_t expected = m_header.geometry.voxel_count() * m_header.components;
    if (std::int64_t(m_values.size()) != expected) {
      throw InputError({path, "DataArray " + array.name,
                        std::to_string(m_values.size()) + " values", std::to_string(expected)});
    }
  }

  void read_slice(void* out) override {
    const Vec3i& dims = m_header.geometry.dims();
    const std::size_t count = std::size_t(dims.x) * dims.y * m_header.components;
    store_values(m_header.type, &m_values[count * m_slices_read++], count, static_cast<char*>(out));
  }

 private:
  void read_geometry(const pugi::xml_node& image, const pugi::xml_node& piece, bool is_of_cells) {
    const std::string& path = m_header.path;
    const auto extent = numbers_of(piece, "Extent", std::vector<double>(6, 0), path);
    const auto origin = numbers_of(image, "Origin", {0, 0, 0}, path);
    const auto spacing = numbers_of(image, "Spacing", {1, 1, 1}, path);
    const auto direction = numbers_of(image, "Direction", {1, 0, 0, 0, 1, 0, 0, 0, 1}, path);
    std::array<Vec3d, 3> axes;
    Vec3d first(origin[0], origin[1], origin[2]);
    Vec3i dims;
    for (std::size_t a = 0; a < 3; ++a) {
      axes[a] = Vec3d(direction[a], direction[3 + a], direction[6 + a]) * spacing[a];
      const double points = extent[2 * a + 1] - extent[2 * a] + 1;
      if (!(points >= 1 && points <= 2147483647)) {
        throw InputError({path, "Extent", piece.attribute("Extent").value(), "ascending numbers"});
      }
      const bool has_cells = is_of_cells && points > 1;
      dims[int(a)] = int(points) - has_cells;
      first += axes[a] * (extent[2 * a] + (has_cells ? 0.5 : 0));
    }
    m_header.geometry = make_geometry(path, dims, first, axes);
  }

  void read_certificate(const std::string& bytes) {
    const std::string head = bytes.substr(0, bytes.find("<AppendedData"));
    const std::size_t mark = head.find(kCertificateMark);
    if (mark == std::string::npos) return;
    const std::size_t begin = mark + std::string(kCertificateMark).size();
    m_header.certificate = head.substr(begin, head.find(" -->", begin) - begin);
  }

  std::vector<double> m_values;
  std::size_t m_slices_read = 0;
};

std::string header_of(const DenseImage& image) {
  const Vec3i& dims = image.geometry.dims();
  const auto direction = image.geometry.direction();
  const Vec3d spacing = image.geometry.spacing_mm(), origin = image.geometry.origin_lps_mm();
  const auto triple = [](const Vec3d& v) {
    return exact_text(v.x) + " " + exact_text(v.y) + " " + exact_text(v.z);
  };
  std::string extent, matrix;
  for (int a = 0; a < 3; ++a) {
    extent += (a == 0 ? "0 " : " 0 ") + std::to_string(dims[a] - 1);
    matrix +=
        (a == 0 ? "" : " ") + triple(Vec3d(direction[0][a], direction[1][a], direction[2][a]));
  }
  const bool is_warp = image.components > 1;
  const std::string name = is_warp ? image.direction == "material" ? "displacement" : "offset"
                           : image.label_names.empty() ? "density"
                                                       : "label";
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n";
  if (!image.certificate.empty()) text += kCertificateMark + image.certificate + " -->\n";
  text += "<ImageData WholeExtent=\"" + extent + "\" Origin=\"" + triple(origin) + "\" Spacing=\"" +
          triple(spacing) + "\" Direction=\"" + matrix + "\">\n<Piece Extent=\"" + extent +
          "\">\n<PointData " + (is_warp ? "Vectors" : "Scalars") + "=\"" + name +
          "\">\n<DataArray type=\"" + kVtkTypes[std::size_t(image.type)] + "\" Name=\"" + name +
          "\" NumberOfComponents=\"" + std::to_string(image.components) +
          "\" format=\"appended\" offset=\"0\"/>\n</PointData>\n<CellData/>\n</Piece>\n"
          "</ImageData>\n<AppendedData encoding=\"raw\">\n_";
  const std::uint64_t bytes =
      std::uint64_t(image.geometry.voxel_count()) * image.components * bytes_of(image.type);
  text.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
  return text;
}

}  // namespace

std::unique_ptr<VolumeFile> open_vti(const std::string& path) {
  return std::make_unique<ImageDataFile>(path);
}

std::unique_ptr<DenseWriter> create_vti(const std::string& path, const std::string& raw_path,
                                        const DenseImage& image, const WriteOptions&) {
  require_perpendicular(image, path, "VTK's image data");
  return write_after_header(path, raw_path, header_of(image), image, StreamCoding::plain, kFooter);
}

}  // namespace supple
