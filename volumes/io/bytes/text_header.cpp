#include "volumes/io/bytes/text_header.h"

#include <charconv>
#include <limits>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr const char* kBlanks = " \t\r\n\f\v";

template <class Number>
bool parse_whole(std::string text, Number& value) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.erase(0, 1);
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end;
}

}  // namespace

bool LineReader::next(std::string& line) {
  if (m_position >= m_text.size()) return false;
  const std::size_t newline = m_text.find('\n', m_position);
  const std::size_t end = newline == std::string::npos ? m_text.size() : newline;
  line = m_text.substr(m_position, end - m_position);
  if (!line.empty() && line.back() == '\r') line.pop_back();
  m_position = newline == std::string::npos ? end : end + 1;
  return true;
}

std::string printable(const std::string& text) {
  constexpr std::size_t kMaxShown = 60;
  std::string shown = text.substr(0, kMaxShown);
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return text.size() > kMaxShown ? shown + "..." : shown;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

std::string lower_case(std::string text) {
  for (char& c : text) {
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  }
  return text;
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words;
  std::size_t first = text.find_first_not_of(kBlanks);
  while (first != std::string::npos) {
    const std::size_t end = text.find_first_of(kBlanks, first);
    words.push_back(text.substr(first, end - first));
    first = text.find_first_not_of(kBlanks, end);
  }
  return words;
}

void HeaderField::fail(const std::string& expected) const {
  throw InputError({file, name, text.empty() ? "nothing" : printable(text), expected});
}

std::int64_t HeaderField::integer() const {
  std::int64_t value = 0;
  if (!parse_whole(trimmed(text), value)) fail("an integer");
  return value;
}

double HeaderField::number() const {
  double value = 0;
  if (!parse_whole(trimmed(text), value)) fail("a number");
  return value;
}

bool HeaderField::boolean() const {
  const std::string word = lower_case(trimmed(text));
  if (word == "true" || word == "1") return true;
  if (word != "false" && word != "0") fail("True or False");
  return false;
}

std::vector<std::int64_t> HeaderField::integers() const {
  std::vector<std::int64_t> values;
  for (const std::string& word : words_of(text)) {
    values.push_back(0);
    if (!parse_whole(word, values.back())) fail("integers below 2^63");
  }
  return values;
}

std::vector<double> HeaderField::numbers() const {
  std::vector<double> values;
  for (const std::string& word : words_of(text)) {
    values.push_back(0);
    if (!parse_whole(word, values.back())) fail("numbers");
  }
  return values;
}

Vec3i dims_from(const HeaderField& field, const std::vector<std::int64_t>& sizes) {
  if (sizes.size() < 2 || sizes.size() > 3) field.fail("2 or 3 sizes");
  Vec3i dims(1, 1, 1);
  for (std::size_t a = 0; a < sizes.size(); ++a) {
    if (sizes[a] < 1 || sizes[a] > std::numeric_limits<int>::max()) {
      field.fail("sizes from 1 to 2147483647");
    }
    dims[int(a)] = int(sizes[a]);
  }
  return dims;
}

Geometry make_geometry(const std::string& file, const Vec3i& dims, const Vec3d& origin_lps_mm,
                       const std::array<Vec3d, 3>& axes_mm) {
  try {
    return Geometry(dims, origin_lps_mm, axes_mm);
  } catch (const InputError& error) {
    Problem problem = error.problem();
    problem.file = file;
    throw InputError(problem);
  }
}

}  // namespace supple
