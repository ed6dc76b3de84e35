// Help, and hints for command lines that do not parse, from the options that the commands declare.
#pragma once

#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace supple::tools {

/// The group of the options that every subcommand takes.
constexpr const char* kEverywhere = "Everywhere";

/// Columns of a terminal that help and manual are wrapped to.
constexpr std::size_t kHelpColumns = 100;

/// Descriptions wrapped behind the names; the help of a subcommand ends on the options that it
/// takes beside its own.
class WrappingFormatter final : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* subcommand) const override;
  std::string make_usage(const CLI::App* app, std::string name) const override;
  std::string make_footer(const CLI::App* app) const override;
};

/// The text in lines of at most kHelpColumns, broken at blanks; all but the first begin with
/// `indent` blanks.
std::string wrapped(const std::string& text, std::size_t indent);

/// The command of this name; null where there is none.
const CLI::App* find_command(const CLI::App& program, const std::string& name);

/// The options of a command and of the program that are shown in help, in their order.
std::vector<const CLI::Option*> shown_options(const CLI::App& app);

/// "a b c" for an option that takes one of the words a|b|c; empty for other values.
std::string value_words(const CLI::Option& option);

/// "found 'infoo', expected info: did you mean 'info'?" and the like.
std::string unknown_subcommand(const CLI::App& program, const std::string& name);

/// A hint where an option has its numbers apart ("--grab 128 211 12") or is unknown to the command;
/// empty where neither is so.
std::string hint_for(const CLI::App& program, const std::vector<std::string>& arguments);

}  // namespace supple::tools
