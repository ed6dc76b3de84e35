#include "volumes/io/mesh/vtk_numbers.h"

#include <algorithm>
#include <cstring>
#include <map>

#include "volumes/io/bytes/text_header.h"

namespace supple::vtk {

namespace {

const std::map<std::string, VtkType> kVtkTypes = {{"bit", {VtkKind::bit, 1}},
                                                  {"char", {VtkKind::integer, 1}},
                                                  {"signed_char", {VtkKind::integer, 1}},
                                                  {"unsigned_char", {VtkKind::integer, 1}},
                                                  {"short", {VtkKind::integer, 2}},
                                                  {"unsigned_short", {VtkKind::integer, 2}},
                                                  {"int", {VtkKind::integer, 4}},
                                                  {"unsigned_int", {VtkKind::integer, 4}},
                                                  {"long", {VtkKind::integer, 8}},
                                                  {"unsigned_long", {VtkKind::integer, 8}},
                                                  {"vtkidtype", {VtkKind::integer, 4}},
                                                  {"vtktypeint64", {VtkKind::integer, 8}},
                                                  {"vtktypeuint64", {VtkKind::integer, 8}},
                                                  {"float", {VtkKind::real, 4}},
                                                  {"double", {VtkKind::real, 8}},
                                                  {"string", {VtkKind::string, 1}}};

double decode(VtkType type, const char* bytes) {
  std::uint64_t bits = 0;
  for (std::size_t n = 0; n < type.bytes; ++n) bits = bits << 8 | std::uint8_t(bytes[n]);
  const std::uint32_t low = std::uint32_t(bits);
  if (type.kind != VtkKind::real) {
    return type.bytes == 4 ? double(std::int32_t(low)) : double(std::int64_t(bits));
  }
  double value;
  float single;
  std::memcpy(&value, &bits, sizeof value);
  std::memcpy(&single, &low, sizeof single);
  return type.bytes == 4 ? double(single) : value;
}

}  // namespace

VtkType VtkNumbers::read_type() {
  const std::string_view word = m_words.next_on_line();
  const auto found = kVtkTypes.find(lower_case(std::string(word)));
  if (found == kVtkTypes.end()) m_words.fail(word, "a type of VTK, such as float or int");
  return found->second;
}

void VtkNumbers::require(std::size_t count, VtkType type) {
  const std::size_t left = m_content.size() - std::min(m_content.size(), m_words.position());
  const std::size_t fit = m_is_binary ? left / type.bytes : (left + 1) / 2;
  if (count <= fit) return;
  m_words.fail(std::to_string(count) + " numbers in " + std::to_string(left) + " bytes",
               "as many as the file can hold");
}

double VtkNumbers::read_number(VtkType type, NumberSlot* slot) {
  const bool is_double = type.bytes == 8;
  if (!m_is_binary) {
    const std::string_view word = m_words.next();
    if (slot != nullptr) {
      *slot = m_words.slot_of(word, is_double ? NumberCode::text : NumberCode::text_float);
    }
    return m_words.number(word);
  }
  const std::size_t at = m_words.position();
  if (slot != nullptr) {
    *slot = {at, std::uint32_t(type.bytes),
             is_double ? NumberCode::float64_big : NumberCode::float32_big};
  }
  m_words.skip_bytes(type.bytes);
  return decode(type, m_content.data() + at);
}

Vec3d VtkNumbers::read_vector(VtkType type, VectorSlot& slot) {
  Vec3d v;
  for (int a = 0; a < 3; ++a) v[a] = read_number(type, &slot[std::size_t(a)]);
  return v;
}

void VtkNumbers::skip(std::size_t count, VtkType type) {
  if (type.kind == VtkKind::string) return skip_strings(count);
  if (!m_is_binary) {
    require(count, type);
    for (std::size_t n = 0; n < count; ++n) {
      if (m_words.next().empty()) m_words.fail("", std::to_string(count) + " numbers");
    }
    return;
  }
  if (type.kind == VtkKind::bit) count = count / 8 + (count % 8 != 0);
  require(count, type);
  m_words.skip_bytes(count * type.bytes);
}

/// Skips strings, one a line, or each behind its length: the two highest bits tell its bytes.
void VtkNumbers::skip_strings(std::size_t count) {
  require(count, kByte);
  for (std::size_t n = 0; n < count; ++n) {
    if (!m_is_binary) {
      m_words.skip_line();
      continue;
    }
    require(1, kByte);
    const std::size_t bytes = std::size_t(8) >> (std::uint8_t(m_content[m_words.position()]) >> 6);
    require(bytes, kByte);
    std::size_t length = 0;
    for (std::size_t b = 0; b < bytes; ++b) {
      length = length << 8 | std::uint8_t(m_content[m_words.position() + b]);
    }
    m_words.skip_bytes(bytes);
    length &= (std::size_t(1) << (8 * bytes - 2)) - 1;
    require(length, kByte);
    m_words.skip_bytes(length);
  }
}

}  // namespace supple::vtk
