#include "volumes/io/nrrd/nrrd_header.h"

#include <algorithm>

namespace supple {

namespace {

/// Spellings that the format allows for one field.
std::string canonical_name(const std::string& name) {
  static const std::map<std::string, std::string> aliases = {
      {"datafile", "data file"}, {"lineskip", "line skip"},      {"byteskip", "byte skip"},
      {"centerings", "centers"}, {"axismins", "axis mins"},      {"axis mins", "axis mins"},
      {"axismaxs", "axis maxs"}, {"blocksize", "block size"},    {"oldmin", "old min"},
      {"oldmax", "old max"},     {"sampleunits", "sample units"}};
  const std::string lower = lower_case(name);
  const auto found = aliases.find(lower);
  return found == aliases.end() ? lower : found->second;
}

bool is_known(const std::string& name) {
  static const char* const known[] = {"type",
                                      "dimension",
                                      "sizes",
                                      "spacings",
                                      "space",
                                      "space dimension",
                                      "space directions",
                                      "space origin",
                                      "space units",
                                      "kinds",
                                      "centers",
                                      "endian",
                                      "encoding",
                                      "data file",
                                      "line skip",
                                      "byte skip",
                                      "axis mins",
                                      "axis maxs",
                                      "thicknesses",
                                      "units",
                                      "labels",
                                      "content",
                                      "min",
                                      "max",
                                      "old min",
                                      "old max",
                                      "number",
                                      "measurement frame",
                                      "sample units",
                                      "block size"};
  return std::find(std::begin(known), std::end(known), name) != std::end(known);
}

bool is_list(const std::string& data_file) {
  const std::vector<std::string> words = words_of(data_file);
  return !words.empty() && words[0] == "LIST";
}

}  // namespace

NrrdHeader parse_nrrd_header(const InputFile& file) {
  NrrdHeader header;
  header.path = file.path();
  const std::string text = file.head(kMaxTextHeader);
  LineReader lines(text);
  std::string line;
  lines.next(line);
  if (line.size() != 8 || line.compare(0, 7, "NRRD000") != 0 || line[7] < '1' || line[7] > '5') {
    HeaderField{header.path, "magic", line}.fail("NRRD0001 to NRRD0005");
  }
  while (lines.next(line)) {
    if (line.empty()) {
      header.end = lines.position();
      return header;
    }
    if (line[0] == '#') continue;
    const std::size_t colon = line.find(':');
    if (colon == std::string::npos) {
      HeaderField{header.path, "header line", line}.fail("\"field: value\"");
    }
    if (colon + 1 < line.size() && line[colon + 1] == '=') {
      header.keys[line.substr(0, colon)] = trimmed(line.substr(colon + 2));
      continue;
    }
    const std::string name = canonical_name(trimmed(line.substr(0, colon)));
    if (!is_known(name)) HeaderField{header.path, "header field", name}.fail("a field of NRRD");
    if (!header.fields.emplace(name, trimmed(line.substr(colon + 1))).second) {
      HeaderField{header.path, name, "the field twice"}.fail("it once");
    }
    if (name == "data file" && is_list(header.fields[name])) {
      // The names fill the rest of the header.
      while (lines.next(line) && !trimmed(line).empty()) header.files.push_back(trimmed(line));
      return header;
    }
  }
  if (!header.has("data file")) {
    HeaderField{header.path, "header", "its end"}.fail("a blank line or a field \"data file\"");
  }
  return header;
}

HeaderField NrrdHeader::field(const std::string& name) const {
  const auto found = fields.find(name);
  return {path, name, found == fields.end() ? "" : found->second};
}

}  // namespace supple
