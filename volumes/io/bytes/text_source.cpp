// Values as text: decimal numbers, or two hexadecimal digits per byte. Numbers are parsed strictly
// into the value type: what it cannot hold is an error that names the number's place. A whole
// number may be written as a decimal fraction, such as the 1e+06 of C++ streams.
// Source: http://teem.sourceforge.net/nrrd/format.html#encoding.
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <type_traits>

#include <locale.h>

#include "volumes/io/bytes/decoding_source.h"
#include "volumes/io/bytes/text_header.h"
#include "volumes/io/bytes/value_type.h"

namespace supple {

namespace {

/// strtod whatever the program's locale.
double number_of(const char* text) {
  static const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr);
  return ::strtod_l(text, nullptr, plain);
}

/// Zero for what is too small for the type, infinity for what is too large: from_chars leaves both
/// unsaid.
template <class Real>
bool parse_real(const char* begin, const char* end, Real& value) {
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || error == std::errc::invalid_argument) return false;
  if (error == std::errc::result_out_of_range) value = Real(number_of(begin));
  return true;
}

/// A whole number in whatever spelling; beyond 2^53 a fraction would not be exact.
template <class T>
bool parse_whole(const char* begin, const char* end, T& value) {
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop == end && error == std::errc()) return true;
  constexpr double kExactIntegers = 9007199254740992.0;
  double number = 0;
  if (!parse_real(begin, end, number) || number != std::floor(number)) return false;
  if (std::abs(number) > kExactIntegers || number < double(std::numeric_limits<T>::min()) ||
      number > double(std::numeric_limits<T>::max())) {
    return false;
  }
  value = T(number);
  return true;
}

/// False for what is no number and for what T cannot hold.
template <class T>
bool parse_value(const std::string& word, void* out) {
  const char* begin = word.c_str();
  const char* end = begin + word.size();
  if (*begin == '+' && word.size() > 1 && begin[1] != '-') ++begin;
  T value{};
  if constexpr (std::is_integral_v<T>) {
    if (!parse_whole(begin, end, value)) return false;
  } else {
    if (!parse_real(begin, end, value)) return false;
    const bool says_infinity = std::isalpha(static_cast<unsigned char>(end[-1])) != 0;
    if (std::isinf(value) && !says_infinity) return false;
  }
  std::memcpy(out, &value, sizeof value);
  return true;
}

using ParseValue = bool (*)(const std::string& word, void* out);

ParseValue parser_of(ValueType type) {
  switch (type) {
    case ValueType::int8:
      return parse_value<std::int8_t>;
    case ValueType::uint8:
      return parse_value<std::uint8_t>;
    case ValueType::int16:
      return parse_value<std::int16_t>;
    case ValueType::uint16:
      return parse_value<std::uint16_t>;
    case ValueType::int32:
      return parse_value<std::int32_t>;
    case ValueType::uint32:
      return parse_value<std::uint32_t>;
    case ValueType::int64:
      return parse_value<std::int64_t>;
    case ValueType::uint64:
      return parse_value<std::uint64_t>;
    case ValueType::float32:
      return parse_value<float>;
    case ValueType::float64:
      return parse_value<double>;
  }
  return parse_value<std::uint8_t>;
}

bool is_blank(unsigned char c) {
  return c == ' ' || (c >= '\t' && c <= '\r');
}

class TextSource : public DecodingSource {
 public:
  TextSource(std::shared_ptr<const InputFile> file, const ByteRange& range)
      : DecodingSource(std::move(file), range, "values as text"),
        m_type(range.text_type),
        m_width(std::size_t(bytes_of(range.text_type))),
        m_parse(parser_of(range.text_type)) {}

  std::size_t decode(void* out, std::size_t size) override {
    std::size_t done = 0;
    while (done + m_width <= size && next_word()) {
      ++m_values;
      if (!m_parse(m_word, static_cast<char*>(out) + done)) {
        fail(printable(m_word) + " as value " + std::to_string(m_values),
             std::string("decimal numbers of type ") + numpy_name(m_type));
      }
      done += m_width;
    }
    return done;
  }

 protected:
  std::string amount(std::int64_t bytes) const override {
    return std::to_string(bytes / std::int64_t(m_width)) + " values";
  }

 private:
  /// Longer words are no numbers.
  static constexpr std::size_t kMaxWord = 1000;

  static bool is_separator(unsigned char c) { return is_blank(c) || c == ','; }

  bool next_word() {
    m_word.clear();
    while (refill()) {
      const unsigned char c = *next();
      if (is_separator(c) && !m_word.empty()) break;
      use(1);
      if (!is_separator(c) && m_word.size() < kMaxWord) m_word.push_back(char(c));
    }
    return !m_word.empty();
  }

  ValueType m_type;
  std::size_t m_width;
  ParseValue m_parse;
  std::string m_word;
  std::int64_t m_values = 0;
};

class HexSource : public DecodingSource {
 public:
  HexSource(std::shared_ptr<const InputFile> file, const ByteRange& range)
      : DecodingSource(std::move(file), range, "values as hex") {}

  std::size_t decode(void* out, std::size_t size) override {
    auto* bytes = static_cast<unsigned char*>(out);
    std::size_t done = 0;
    int high = 0, low = 0;
    while (done < size && next_digit(high)) {
      if (!next_digit(low)) fail("half of " + place(), "two digits per byte");
      bytes[done++] = static_cast<unsigned char>(high * 16 + low);
    }
    return done;
  }

 private:
  bool next_digit(int& digit) {
    while (refill()) {
      const char c = char(*next());
      use(1);
      if (is_blank(static_cast<unsigned char>(c))) continue;
      if (std::from_chars(&c, &c + 1, digit, 16).ec != std::errc()) {
        fail(printable(std::string(1, c)) + " in " + place(), "hexadecimal digits");
      }
      ++m_digits;
      return true;
    }
    return false;
  }

  std::string place() const { return "byte " + std::to_string(m_digits / 2 + 1); }

  std::int64_t m_digits = 0;
};

}  // namespace

std::unique_ptr<DecodingSource> open_text(std::shared_ptr<const InputFile> file,
                                          const ByteRange& range) {
  return std::make_unique<TextSource>(std::move(file), range);
}

std::unique_ptr<DecodingSource> open_hex(std::shared_ptr<const InputFile> file,
                                         const ByteRange& range) {
  return std::make_unique<HexSource>(std::move(file), range);
}

}  // namespace supple
