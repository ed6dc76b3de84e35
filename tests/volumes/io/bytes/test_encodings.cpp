// bzip2, decimal text and hexadecimal digits: the same values as plain bytes, and nothing else.
#include <limits>

#include <bzlib.h>
#include <gtest/gtest.h>

#include "tests/support/io_fixtures.h"
#include "volumes/io/format/volume_file.h"

namespace supple::test {
namespace {

std::string encoded_nrrd(const std::string& type, const std::string& encoding,
                         const std::string& sizes = "2 3 2", const std::string& more = "") {
  return "NRRD0004\ntype: " + type + "\ndimension: 3\nsizes: " + sizes + "\nencoding: " + encoding +
         "\n" + more + "\n";
}

std::string bzip2(std::string bytes) {
  std::string out(bytes.size() + bytes.size() / 50 + 1000, '\0');
  unsigned size = unsigned(out.size());
  const int result =
      BZ2_bzBuffToBuffCompress(out.data(), &size, bytes.data(), unsigned(bytes.size()), 9, 0, 0);
  if (result != BZ_OK) throw std::runtime_error("BZ2_bzBuffToBuffCompress");
  out.resize(size);
  return out;
}

std::string hex(const std::string& bytes) {
  std::string text;
  for (const char c : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof digits, "%02x", unsigned(static_cast<unsigned char>(c)));
    text += digits;
  }
  return text;
}

TEST(UnitEncodings, Bzip2StreamsInARowReadAsOne) {
  const TemporaryFolder folder;
  const std::string all = bytes_of_values(kShorts, true);
  const std::string head = encoded_nrrd("short", "bzip2", "2 3 2", "endian: big\n");
  EXPECT_EQ(read_all(folder.write("a.nrrd", head + bzip2(all))), bytes_of_values(kShorts));
  EXPECT_EQ(read_all(folder.write("b.nrrd", head + bzip2(all.substr(0, 7)) + bzip2(all.substr(7)))),
            bytes_of_values(kShorts));
}

TEST(UnitEncodings, TextIsSeparatedByBlanksLineEndsAndCommas) {
  const TemporaryFolder folder;
  const std::string text = "-5 0\t1,2\r\n+300 , -300\n\n7 8 9 1e1,11.0 12\n";
  for (const char* name : {"ascii", "text", "txt"}) {
    EXPECT_EQ(read_all(folder.write("a.nrrd", encoded_nrrd("short", name) + text)),
              bytes_of_values(kShorts));
  }
  EXPECT_EQ(
      read_all(folder.write("a.mha",
                            "NDims = 3\nDimSize = 2 3 2\nElementType = MET_SHORT\nBinaryData = "
                            "False\nBinaryDataByteOrderMSB = True\nElementDataFile = LOCAL\n" +
                                text)),
      bytes_of_values(kShorts));
}

TEST(UnitEncodings, TextKeepsEveryTypesLimitsExactly) {
  const TemporaryFolder folder;
  const auto values_of = [&](const std::string& type, const std::string& text) {
    return read_all(folder.write("a.nrrd", encoded_nrrd(type, "ascii", "2 1 1") + text));
  };
  EXPECT_EQ(values_of("int64", "-9223372036854775808 9223372036854775807"),
            bytes_of_values<std::int64_t>({INT64_MIN, INT64_MAX}));
  EXPECT_EQ(values_of("uint64", "18446744073709551615 9007199254740993"),
            bytes_of_values<std::uint64_t>({UINT64_MAX, 9007199254740993u}));
  EXPECT_EQ(values_of("uint8", "0 255"), bytes_of_values<std::uint8_t>({0, 255}));
  EXPECT_EQ(values_of("int32", "1.23457e+06 -2147483648"),
            bytes_of_values<std::int32_t>({1234570, INT32_MIN}));
  EXPECT_EQ(values_of("float", "0.1 -1e-45"),
            bytes_of_values<float>({0.1f, -std::numeric_limits<float>::denorm_min()}));
  EXPECT_EQ(values_of("float", "1e-400 -inf"),
            bytes_of_values<float>({0.0f, -std::numeric_limits<float>::infinity()}));
  EXPECT_EQ(values_of("double", "0.1 1.7976931348623157e308"),
            bytes_of_values<double>({0.1, std::numeric_limits<double>::max()}));
}

TEST(UnitEncodings, HexIsTwoDigitsPerByteInEitherByteOrder) {
  const TemporaryFolder folder;
  std::string digits = hex(bytes_of_values(kShorts, true));
  digits.insert(13, "\n ");
  EXPECT_EQ(read_all(folder.write("a.nrrd",
                                  encoded_nrrd("short", "hex", "2 3 2", "endian: big\n") + digits)),
            bytes_of_values(kShorts));
}

TEST(FaultEncodings, TextThatTheTypeCannotHoldIsNamedWithItsPlace) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& type, const std::string& text,
                          const std::vector<std::string>& parts) {
    expect_failure(folder.write("a.nrrd", encoded_nrrd(type, "ascii", "3 1 1") + text), parts);
  };
  expect("uint8", "1 256 3", {"a.nrrd", "256 as value 2", "uint8"});
  expect("uint8", "1 2 -1", {"-1 as value 3", "uint8"});
  expect("int16", "1.5 2 3", {"1.5 as value 1", "int16"});
  expect("int8", "1 2x 3", {"2x as value 2"});
  expect("int8", "1 0x2 3", {"0x2 as value 2"});
  expect("int8", "1 \x1b[2J 3", {"?[2J as value 2"});
  expect("uint64", "18446744073709551616 2 3", {"as value 1", "uint64"});
  expect("int32", "nan 2 3", {"nan as value 1", "int32"});
  expect("float", "1 2 1e39", {"1e39 as value 3", "float32"});
  expect("double", "1 1e400 3", {"1e400 as value 2", "float64"});
  expect("float", "1 2\n   \n", {"found 2 values", "expected 3 values"});
  expect("float", "1 2 3 4", {"more than 3 values", "expected 3 values"});
  expect("float", std::string(5000, '1') + " 2 3", {"as value 1"});
}

TEST(FaultEncodings, HexThatIsNoneOrOfAnotherLengthIsRefused) {
  const TemporaryFolder folder;
  const auto expect = [&](const std::string& digits, const std::vector<std::string>& parts) {
    expect_failure(folder.write("a.nrrd", encoded_nrrd("uint8", "hex", "3 1 1") + digits), parts);
  };
  expect("01g203", {"g in byte 2", "hexadecimal digits"});
  expect("0102 \n \n", {"2 bytes", "3 bytes"});
  expect("01020304", {"more than 3 bytes"});
  expect("0102035", {"half of byte 4"});
}

TEST(FaultEncodings, DamagedOrShortBzip2IsRefused) {
  const TemporaryFolder folder;
  const std::string head = encoded_nrrd("short", "bz2", "2 3 2", "endian: little\n");
  const std::string data = bytes_of_values(kShorts), packed = bzip2(data);
  expect_failure(folder.write("a.nrrd", head + packed.substr(0, packed.size() / 2)),
                 {"compressed data", "end of the file"});
  expect_failure(folder.write("b.nrrd", head + bzip2(data.substr(3))), {"21", "24 bytes"});
  expect_failure(folder.write("c.nrrd", head + bzip2(data + "y")), {"more than 24 bytes"});
  for (const std::size_t at : {std::size_t(12), packed.size() - 3}) {
    std::string damaged = packed;
    damaged[at] = char(damaged[at] ^ 4);
    expect_failure(folder.write("d.nrrd", head + damaged), {"compressed data", "bzip2"});
  }
}

TEST(FaultEncodings, SizesThatAnEncodingCannotHoldAreRefusedBeforeAllocation) {
  const TemporaryFolder folder;
  const std::string sizes = "100000 100000 9", data(24, '1');
  const auto expect = [&](const std::string& encoding, const std::string& stored,
                          const std::vector<std::string>& parts) {
    expect_failure(folder.write("a.nrrd", encoded_nrrd("uint8", encoding, sizes) + stored), parts);
  };
  expect("ascii", data, {"24 bytes of text", "90000000000 bytes"});
  expect("hex", data, {"24 bytes of hex digits", "90000000000 bytes"});
  expect("bzip2", bzip2(data), {"compressed data", "90000000000 bytes"});
  // A stream that might hold as much, but does not, is found out by decoding.
  const std::string zeros = bzip2(std::string(10'000'000, '\0'));
  expect_failure(folder.write("b.nrrd", encoded_nrrd("uint8", "bzip2", "5000 5000 1") + zeros),
                 {"10000000 bytes after decompression", "25000000 bytes"});
  EXPECT_EQ(
      failure_of(folder.write("c.nrrd", encoded_nrrd("uint8", "bzip2", "2500 4000 1") + zeros)),
      "");
}

}  // namespace
}  // namespace supple::test
