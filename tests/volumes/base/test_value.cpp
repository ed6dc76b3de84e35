// The tree of values: what JSON and TOML say, where, and how it is written again.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "volumes/base/error.h"
#include "volumes/base/json.h"
#include "volumes/base/table.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

using namespace supple;

namespace {

std::string again(const std::string& json) {
  return json_text(parse_json(json));
}

/// True if one can loop over what is in a value of this type.
template <class Given, class = void>
constexpr bool can_loop = false;
template <class Given>
constexpr bool can_loop<Given, std::void_t<decltype(std::declval<Given>().items()),
                                           decltype(std::declval<Given>().entries())>> = true;

/// The line of the error that reading a table ends with.
template <class Read>
std::string complaint(const Read& read) {
  try {
    read();
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

}  // namespace

TEST(UnitValue, JsonIsWrittenAgainByteForByte) {
  for (const char* text :
       {"null", "true", "[]", "{}", "5", "5.0", "-0.0", "-9223372036854775808", "1e+20", "1e-07",
        "0.1", "2.2250738585072014e-308", "5e-324", "1.7976931348623157e+308", "100000.0",
        "\"a\\\"b\\\\c\\n\\t\\u0001\x7F /\"", "\"\u00e9\u4e2d\U0001F642\"",
        "{\"z\":1,\"a\":{\"k\":[1,[2.5,\"x\"],{}]},\"m\":[]}"}) {
    EXPECT_EQ(again(text), text);
  }
  EXPECT_EQ(
      json_text({{"a", {1, 2}}, {"b", Value::List()}, {"c", {{"d", nullptr}}}}, 2),
      "{\n  \"a\": [\n    1,\n    2\n  ],\n  \"b\": [],\n  \"c\": {\n    \"d\": null\n  }\n}");
}

TEST(UnitValue, WholeNumbersStayWholeAndOthersKeepTheirPoint) {
  EXPECT_TRUE(parse_json("7").is_whole());
  EXPECT_FALSE(parse_json("7.0").is_whole());
  EXPECT_EQ(json_text(Value(7.0)), "7.0");
  EXPECT_EQ(json_text(Value(std::size_t(7))), "7");
  EXPECT_EQ(Value(7), Value(7.0)) << "as numbers they are the same";
  EXPECT_DOUBLE_EQ(parse_json("18446744073709551615").number(), 18446744073709551615.0);
  EXPECT_EQ(json_text(Value(std::nan(""))), "null");
  EXPECT_EQ(json_text(Value(-std::numeric_limits<double>::infinity())), "null");
}

TEST(UnitValue, BytesThatAreNoUtf8AreReplacedInJsonAndRefusedInToml) {
  EXPECT_EQ(json_text(Value("a\xFF"
                            "b")),
            "\"a\xEF\xBF\xBD"
            "b\"");
  EXPECT_EQ(complaint([] {
              toml_document({{"volume", {{"path", "a\xFF"}}}});
            }),
            "found \"a\xFF\", expected text in UTF-8");
}

TEST(UnitValue, TextThatIsNoJsonAndListsWithinListsAreRefused) {
  for (const char* text : {"", "{", "[1,]", "{\"a\":1} x", "nan", "1e400", "'a'", "{\"a\" 1}"}) {
    EXPECT_THROW(parse_json(text), JsonError) << text;
    EXPECT_TRUE(json_or_null(text).is_null()) << text;
  }
  const auto is_too_deep = [](int lists) {
    try {
      parse_json(std::string(std::size_t(lists), '[') + std::string(std::size_t(lists), ']'), 3);
    } catch (const JsonError& error) {
      return error.is_too_deep;
    }
    return false;
  };
  EXPECT_FALSE(is_too_deep(4));
  EXPECT_TRUE(is_too_deep(5));
  EXPECT_TRUE(is_too_deep(100000));
  EXPECT_EQ(json_text(parse_json("{\"a\":1,\"b\":2,\"a\":3}")), "{\"a\":3,\"b\":2}");
}

TEST(UnitValue, LoopsOverATemporaryDoNotCompile) {
  EXPECT_TRUE(can_loop<Value&>);
  EXPECT_TRUE(can_loop<const Value&>);
  EXPECT_FALSE(can_loop<Value>);
  EXPECT_FALSE(can_loop<const Value>);
}

TEST(UnitValue, EveryKindOfNumberTextAndListMakesOne) {
  const Value made = {nullptr,
                      true,
                      short(1),
                      2.5f,
                      "text",
                      std::string("string"),
                      std::string_view("view"),
                      Vec3i(1, 2, 3),
                      Vec3d(0.5, 1, 2),
                      IndexBox{{1, 2, 3}, {4, 5, 6}},
                      std::array<int, 2>{7, 8},
                      std::vector<bool>{true, false},
                      std::vector<std::string>{"a"},
                      Value::List{1, "b"},
                      Value::List(),
                      Value::Entries{{"key", 1}},
                      Value::Entries()};
  EXPECT_EQ(json_text(made),
            "[null,true,1,2.5,\"text\",\"string\",\"view\",[1,2,3],[0.5,1.0,2.0],[1,2,3,4,5,6],"
            "[7,8],[true,false],[\"a\"],[1,\"b\"],[],{\"key\":1},{}]");
}

TEST(UnitValue, KnowsTheLineThatItCameFrom) {
  const Value json = parse_json("{\"a\": 1,\n\"b\": [\n2,\n3\n],\n\n\"c\": {\"d\":\n\"text\"}\n}");
  EXPECT_EQ(json.line, 1);
  EXPECT_EQ(json["a"].line, 1);
  EXPECT_EQ(json["b"].line, 2);
  EXPECT_EQ(json["b"].at(0).line, 3);
  EXPECT_EQ(json["b"].at(1).line, 4) << "a number ends where its line does";
  EXPECT_EQ(json["c"].line, 7);
  EXPECT_EQ(json["c"]["d"].line, 8);
  const Value toml = parse_toml("b = 2\n\na = [1,\n 2]\n[t]\nx = \"y\"\n", "f.toml");
  EXPECT_EQ(toml["b"].line, 1);
  EXPECT_EQ(toml["a"].at(1).line, 4);
  EXPECT_EQ(toml["t"]["x"].line, 6);
  EXPECT_EQ(json_text(toml), "{\"a\":[1,2],\"b\":2,\"t\":{\"x\":\"y\"}}") << "keys ascend";
}

TEST(UnitValue, TablesKeepTheirOrderUntilTheyAreSorted) {
  Value value = {{"z", 1}, {"a", {{"y", 2}, {"b", 3}}}};
  value["m"].push_back({{"q", 1}, {"c", 2}});
  value.update({{"z", 4}});
  EXPECT_EQ(json_text(value), "{\"z\":4,\"a\":{\"y\":2,\"b\":3},\"m\":[{\"q\":1,\"c\":2}]}");
  EXPECT_EQ(json_text(sorted(value)),
            "{\"a\":{\"b\":3,\"y\":2},\"m\":[{\"c\":2,\"q\":1}],\"z\":4}");
  value.erase("a");
  EXPECT_FALSE(value.contains("a"));
  EXPECT_TRUE(std::as_const(value)["a"]["no key"].is_null());
  EXPECT_THROW(value.at("a"), std::out_of_range);
  EXPECT_THROW(value["m"].text(), std::invalid_argument);
}

TEST(UnitValue, ListsAndTablesAreToldApartByTheirFirstTexts) {
  EXPECT_TRUE((Value{{"a", 1}, {"b", 2}}).is_table());
  EXPECT_TRUE((Value{{1, 2}, {3, 4}}).is_list());
  EXPECT_TRUE((Value{"a", 1}).is_list());
  EXPECT_EQ(json_text({{"box", IndexBox{{1, 2, 3}, {4, 5, 6}}}, {"by", Vec3d(0, 0.5, 1)}}),
            "{\"box\":[1,2,3,4,5,6],\"by\":[0.0,0.5,1.0]}");
}

TEST(UnitValue, EveryTextIsVisitedWithTheKeyAboveIt) {
  Value value = {{"path", "a"}, {"step", Value::List{{{"points", {"b", "c"}}, {"n", 1}}}}};
  std::string seen;
  for_each_text(value, "", [&](const std::string& key, std::string& text) {
    seen += key + "=" + text + " ";
    text += "!";
  });
  EXPECT_EQ(seen, "path=a points=b points=c ");
  EXPECT_EQ(json_text(value), "{\"path\":\"a!\",\"step\":[{\"points\":[\"b!\",\"c!\"],\"n\":1}]}");
}

TEST(UnitValue, ADocumentOfTomlReadsAsWhatItSays) {
  const Value root = {{"volume", {{"path", "a \"b\"\n.nrrd"}, {"two words", 1}}},
                      {"step",
                       {{{"handles", Value::List{{{"grab", {1, 2, 3}}, {"by", {0.5, 1e-7, 2.0}}}}},
                         {"relax", Value::Entries()}},
                        {{"release", true}}}}};
  const std::string text = toml_document(root);
  EXPECT_EQ(
      text,
      "[volume]\npath = \"a \\\"b\\\"\\u000a.nrrd\"\n\"two words\" = 1\n\n[[step]]\nhandles = "
      "[{ grab = [1, 2, 3], by = [0.5, 1e-07, 2.0] }]\nrelax = {  }\n\n[[step]]\nrelease = "
      "true\n");
  EXPECT_EQ(parse_toml(text, "f"), sorted(root));
}

TEST(UnitValue, MessagesShowValuesInOneShortLine) {
  const Value value = parse_toml(
      "a = [1, 2.50, 1e300, inf, \"x\", { k = true, d = 1979-05-27 }, {}]\n"
      "b = \"01234567890123456789012345678901234567890123456789012345678901234567\"\n",
      "f");
  EXPECT_EQ(shown_text(value["a"]), "[1, 2.5, 1e+300, inf, 'x', { d = 1979-05-27, k = true }, {}]");
  EXPECT_EQ(shown_text(value["b"]), "'01234567890123456789012345678901234567890123456789012345...");
}

TEST(UnitTable, ReadsJsonAndOptionsAsStrictlyAsToml) {
  const std::string json = "{\"size\": 3,\n\"colour\": [1, null],\n\"colours\": 1}";
  Table table(parse_json(json), "f.json");
  EXPECT_EQ(table.get<long long>("size"), 3);
  EXPECT_EQ(complaint([&] { table.get<std::vector<double>>("colour"); }),
            "f.json:2: colour: found null, expected a list of finite numbers");
  EXPECT_EQ(complaint([&] { table.finish(); }),
            "f.json:3: colours: found an unknown key, expected a known one: did you mean "
            "'colour'?");
  Table options({{"step", Value::List{{{"soft", "x"}}}}}, "", {{"step[1].soft", "--soft"}});
  EXPECT_EQ(complaint([&] { options.tables("step").front().get<double>("soft"); }),
            "--soft: found 'x', expected a finite number");
}

TEST(UnitText, BytesAreWrittenInBase64AsRfc4648SaysSo) {
  EXPECT_EQ(base64_of(""), "");
  EXPECT_EQ(base64_of("f"), "Zg==");
  EXPECT_EQ(base64_of("fo"), "Zm8=");
  EXPECT_EQ(base64_of("foo"), "Zm9v");
  EXPECT_EQ(base64_of("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64_of("\xff\xfe\xfd"), "//79");
}
