#include "volumes/io/vtu/vtk_xml.h"

#include "volumes/base/error.h"
#include "volumes/io/bytes/input_file.h"

namespace supple {

void open_vtk_xml(const std::string& path, VtkXml& content) {
  const InputFile file(path);
  content.bytes.resize(std::size_t(file.size()));
  file.read_at(0, &content.bytes[0], content.bytes.size());
  VtuEncoding& encoding = content.encoding;
  encoding.path = path;
  const std::size_t appended = content.bytes.find("<AppendedData");
  std::string head = content.bytes.substr(0, appended);
  if (appended != std::string::npos) {
    head += "</VTKFile>";
    const std::size_t end = content.bytes.find('>', appended);
    const std::size_t mark = content.bytes.find('_', std::min(end, content.bytes.size()));
    if (mark == std::string::npos) {
      throw InputError({path, "AppendedData", "no '_' before the data", "a whole file"});
    }
    const std::string tag = content.bytes.substr(appended, end - appended);
    encoding.is_appended_raw = tag.find("base64") == std::string::npos;
    encoding.appended = std::string_view(content.bytes).substr(mark + 1);
  }
  const pugi::xml_parse_result parsed = content.xml.load_buffer(head.data(), head.size());
  if (!parsed) {
    throw InputError(
        {path, "XML",
         std::string(parsed.description()) + " at byte " + std::to_string(parsed.offset),
         "a VTK file of XML"});
  }
  const pugi::xml_node root = content.xml.child("VTKFile");
  const std::string compressor = root.attribute("compressor").value();
  encoding.is_compressed = !compressor.empty();
  encoding.is_big_endian = std::string(root.attribute("byte_order").value()) == "BigEndian";
  encoding.is_header_64 = std::string(root.attribute("header_type").value()) == "UInt64";
  if (encoding.is_compressed && compressor != "vtkZLibDataCompressor") {
    throw InputError({path, "compressor", compressor, "vtkZLibDataCompressor, or none"});
  }
}

VtuArray array_of(const pugi::xml_node& node) {
  VtuArray array;
  array.name = node.attribute("Name").value();
  array.type = node.attribute("type").value();
  array.format = node.attribute("format").value();
  array.text = node.text().get();
  array.offset = node.attribute("offset").as_llong(-1);
  return array;
}

}  // namespace supple
