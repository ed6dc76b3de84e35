// Methods per class, by a parse that knows braces, parentheses and little else of C++. It agrees
// with ctags, but that ctags counts lambdas of initialisers and misses destructors that override.
#include <map>
#include <regex>

#include <gtest/gtest.h>

#include "tests/support/program.h"

using namespace supple::test;

namespace {

/// True for the declaration of a member that is a function: constructors, operators, templates,
/// deleted and defaulted ones count.
bool is_method(std::string text) {
  static const std::regex label("\\b(?:public|private|protected)\\s*:");
  static const std::regex sign("\\boperator\\s*(?:\\(\\)|[^\\s\\w(]+)"), angled("<[^<>]*>");
  static const std::regex type("\\b(?:alignas|decltype)\\([^()]*\\)");
  static const std::regex other("^\\s*(?:template\\s*)?(?:using|friend|typedef|static_assert)\\b");
  static const std::regex function("^[^=(]*[\\w~]\\s*\\((?!\\s*[*&])");
  for (const std::regex& dropped : {label, type}) text = std::regex_replace(text, dropped, "");
  text = std::regex_replace(text, sign, "operator_");
  while (std::regex_search(text, angled)) text = std::regex_replace(text, angled, "");
  return !std::regex_search(text, other) && std::regex_search(text, function);
}

/// Adds the methods of the classes of a file, by their names; classes within functions apart.
void count_methods(const std::string& file, std::map<std::string, int>& methods) {
  static const std::regex noise(
      "//[^\n]*|\"(?:[^\"\\\\\n]|\\\\.)*\"|'(?:[^'\\\\\n]|\\\\.)+'|\n#(?:[^\n\\\\]|\\\\[^])*");
  static const std::regex is_namespace("\\b(?:namespace|extern)\\b[^()]*$"), is_enum("\\benum\\b");
  static const std::regex is_class(
      "(?:^|[\\s>])(?:class|struct|union) (?:alignas\\([^()]*\\) )?([\\w:<>]+)(?: "
      "final)?\\s*(?::[^:][^()]*)?$");
  static const std::regex is_member_set("\\)[^():]*:[^:][^]*\\w$");  // before the body
  const std::string code = std::regex_replace("\n" + file, noise, " ");
  std::vector<std::string> open;  // classes, and "" for namespaces
  std::string text;
  int parentheses = 0, skipped = 0;  // the latter of braces
  for (const char c : code) {
    if (skipped > 0) {
      skipped += int(c == '{') - int(c == '}');
      continue;
    }
    parentheses += int(c == '(') - int(c == ')');
    if (parentheses > 0 || (c != ';' && c != '{' && c != '}')) {
      text += c;
      continue;
    }
    text.erase(text.find_last_not_of(" \n") + 1);
    std::smatch found;
    if (c == '}') {
      if (!open.empty()) open.pop_back();
    } else if (c == '{' && std::regex_search(text, is_namespace)) {
      open.emplace_back();
    } else if (c == '{' && !std::regex_search(text, is_enum) &&
               std::regex_search(text, found, is_class)) {
      methods[open.emplace_back((open.empty() ? "" : open.back() + "::") + found[1].str())];
    } else {
      skipped = c == '{';
      if (skipped > 0 && std::regex_search(text, is_member_set)) {
        text += "{}";
        continue;
      }
      if (!open.empty() && !open.back().empty()) methods[open.back()] += is_method(text);
    }
    text.clear();
  }
}

}  // namespace

TEST(UnitClassSize, ClassesHaveAtMostThirtyFiveMethods) {
  std::size_t classes = 0;
  for (const char* root : {"lib", "volumes", "raycast", "tools"}) {
    const std::filesystem::path path = std::filesystem::path(source_dir()) / root;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
      const std::string extension = entry.path().extension().string();
      if (extension != ".h" && extension != ".cpp") continue;
      std::map<std::string, int> methods;
      count_methods(read_text(entry.path().string()), methods);
      for (const auto& [name, count] : methods) {
        EXPECT_LE(count, 35) << name << " in " << entry.path();
      }
      classes += methods.size();
    }
  }
  EXPECT_GT(classes, 1000U);
}

TEST(UnitClassSize, EveryDeclarationOfAFunctionCounts) {
  std::map<std::string, int> methods;
  count_methods(
      "#define OTHER(x) struct x {\n"
      "namespace a {\n"
      "struct Point { double x{f(1)}, y = f(2); };\n"
      "template <class T, int n = (1)>\n"
      "class Whole final : public Base<T> {  // void no();\n"
      " public:\n"
      "  Whole() = default;\n"
      "  Whole(const Whole&) = delete;\n"
      "  explicit Whole(int x) : m_y(x), m_x{x, [](int y) { return y; }} { run(); }\n"
      "  ~Whole() override;\n"
      "  struct Part { int one() const { return 1; } std::function<void()> none; };\n"
      "  enum class Kind { a, b };\n"
      "  using Call = void (*)(int);\n"
      "  template <class U, std::enable_if_t<sizeof(U) == 1, int> = 0>\n"
      "  std::vector<std::pair<U, int>> of(const U& given = {}) const;\n"
      "  bool operator()(int) const;\n"
      "  bool operator==(const Whole& other) const { return this == &other; }\n"
      "  void set(const std::string& text = \"a(){};\");\n"
      "  friend void beside(Whole& whole);\n"
      " private:\n"
      "  int (*m_function)(int) = nullptr;\n"
      "  Call m_call = [](int x) { g(x); };\n"
      "};\n"
      "int free(int x) { struct Local { void no(); }; return x; }\n"
      "}\n",
      methods);
  const std::map<std::string, int> expected = {
      {"::Point", 0}, {"::Whole", 8}, {"::Whole::Part", 1}};
  EXPECT_EQ(methods, expected);
}
