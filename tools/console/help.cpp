#include "tools/console/help.h"

#include <cstdlib>

#include "volumes/base/error.h"
#include "volumes/base/fields.h"
#include "volumes/base/text.h"

namespace supple::tools {

namespace {

constexpr std::size_t kNameColumns = 34;

/// Number of characters, of which UTF-8 takes several bytes.
std::size_t columns_of(const std::string& text) {
  std::size_t count = 0;
  for (const char c : text) count += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  return count;
}

/// A name and what it means behind it, or below it where the name is long.
std::string entry(const std::string& name, const std::string& meaning) {
  std::string line = "  " + name;
  if (meaning.empty()) return line + "\n";
  if (columns_of(line) + 2 > kNameColumns) {
    line += "\n";
    line.append(kNameColumns, ' ');
  } else {
    line.append(kNameColumns - columns_of(line), ' ');
  }
  return line + wrapped(meaning, kNameColumns) + "\n";
}

bool is_number(const std::string& text) {
  char* end = nullptr;
  std::strtod(text.c_str(), &end);
  return !text.empty() && end == text.c_str() + text.size();
}

std::vector<std::string> subcommand_names(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* app : program.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(app->get_name());
  }
  return names;
}

const CLI::App* command_of(const CLI::App& program, const std::vector<std::string>& arguments) {
  for (const std::string& argument : arguments) {
    if (const CLI::App* app = find_command(program, argument)) return app;
  }
  return &program;
}

/// "--grab: found 128 211 12, expected 128,211,12"; empty where at most one number follows.
std::string numbers_apart(const std::vector<std::string>& arguments, std::size_t option) {
  std::string found, expected;
  std::size_t count = 0;
  for (std::size_t n = option + 1; n < arguments.size() && is_number(arguments[n]); ++n, ++count) {
    found += (found.empty() ? "" : " ") + arguments[n];
    expected += (expected.empty() ? "" : ",") + arguments[n];
  }
  if (count < 2) return "";
  return to_line({"", arguments[option], found, expected + ", with commas and without blanks"});
}

std::string unknown_option(const CLI::App& app, const std::string& name) {
  std::vector<std::string> known;
  for (const CLI::Option* option : shown_options(app)) {
    for (const std::string& word : option->get_lnames()) known.push_back("--" + word);
  }
  const std::string nearest = nearest_name(name, known);
  const std::string command = app.get_parent() == nullptr ? "" : " " + app.get_name();
  return to_line({"", name, "an unknown option",
                  nearest.empty() ? "one that supple" + command + " --help lists"
                                  : "a known one: did you mean '" + nearest + "'?"});
}

}  // namespace

std::string value_words(const CLI::Option& option) {
  const std::string value = option.get_option_text();
  const bool is_list = value.find('|') != std::string::npos &&
                       value.find_first_of("[],:. ") == std::string::npos &&
                       value.find_first_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ") == std::string::npos;
  std::string words = is_list ? value : "";
  for (char& c : words) c = c == '|' ? ' ' : c;
  return words;
}

std::string wrapped(const std::string& text, std::size_t indent) {
  std::string lines, word;
  std::size_t column = indent;
  const auto put = [&] {
    if (word.empty()) return;
    const std::size_t width = columns_of(word);
    const bool is_first = column == indent;
    if (!is_first && column + 1 + width > kHelpColumns) {
      lines += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!is_first) {
      lines += " ";
      ++column;
    }
    lines += word;
    column += width;
    word.clear();
  };
  for (const char c : text) {
    if (c == ' ') {
      put();
    } else {
      word += c;
    }
  }
  put();
  return lines;
}

const CLI::App* find_command(const CLI::App& program, const std::string& name) {
  const auto found =
      program.get_subcommands([&](const CLI::App* app) { return app->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

std::vector<const CLI::Option*> shown_options(const CLI::App& app) {
  const auto is_shown = [](const CLI::Option* option) { return !option->get_group().empty(); };
  std::vector<const CLI::Option*> options = app.get_options(is_shown);
  if (const CLI::App* parent = app.get_parent()) {
    for (const CLI::Option* option : parent->get_options(is_shown)) {
      if (option->get_group() == kEverywhere) options.push_back(option);
    }
  }
  return options;
}

std::string WrappingFormatter::make_option(const CLI::Option* option, bool is_positional) const {
  return entry(make_option_name(option, is_positional) + make_option_opts(option),
               make_option_desc(option));
}

std::string WrappingFormatter::make_option_opts(const CLI::Option* option) const {
  return option->get_option_text().empty() ? "" : " " + option->get_option_text();
}

std::string WrappingFormatter::make_subcommand(const CLI::App* subcommand) const {
  return entry(subcommand->get_name(), subcommand->get_description());
}

std::string WrappingFormatter::make_usage(const CLI::App* app, std::string name) const {
  std::string usage = CLI::Formatter::make_usage(app, std::move(name));
  while (!usage.empty() && usage.back() == '\n') usage.pop_back();
  return wrapped(usage, 2) + "\n";
}

std::string WrappingFormatter::make_footer(const CLI::App* app) const {
  std::string everywhere;
  for (const CLI::Option* option : shown_options(*app)) {
    if (app->get_parent() == nullptr || option->get_group() != kEverywhere) continue;
    everywhere += (everywhere.empty() ? "" : ", ") + make_option_name(option, false) +
                  make_option_opts(option);
  }
  if (!everywhere.empty()) {
    everywhere = wrapped("Everywhere, see supple --help: " + everywhere, 2) + "\n\n";
  }
  return everywhere + CLI::Formatter::make_footer(app);
}

std::string unknown_subcommand(const CLI::App& program, const std::string& name) {
  const std::vector<std::string> names = subcommand_names(program);
  const std::string nearest = nearest_name(name, names);
  return to_line(
      {"", "subcommand", "'" + name + "'",
       nearest.empty() ? listed(names, "or") : "a known one: did you mean '" + nearest + "'?"});
}

std::string hint_for(const CLI::App& program, const std::vector<std::string>& arguments) {
  const CLI::App* app = command_of(program, arguments);
  for (std::size_t n = 0; n < arguments.size() && arguments[n] != "--"; ++n) {
    if (arguments[n].compare(0, 2, "--") != 0) continue;
    const std::string name = arguments[n].substr(0, arguments[n].find('='));
    const bool is_known =
        app->get_option_no_throw(name) != nullptr || program.get_option_no_throw(name) != nullptr;
    const std::string hint = is_known ? numbers_apart(arguments, n) : unknown_option(*app, name);
    if (!hint.empty()) return hint;
  }
  return "";
}

}  // namespace supple::tools
