#include "tools/console/manual.h"

#include "tools/console/help.h"
#include "volumes/base/version.h"

namespace supple::tools {

namespace {

/// Text that troff prints as it stands.
std::string troff(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    const bool begins_line = escaped.empty() || escaped.back() == '\n';
    if (begins_line && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string usage_of(const CLI::Option& option) {
  const bool is_positional = option.get_positional();
  const std::string name = option.get_name(is_positional, !is_positional);
  const std::string value = option.get_option_text();
  return "\\fB" + troff(name) + "\\fR" + (value.empty() ? "" : " \\fI" + troff(value) + "\\fR");
}

std::string options_of(const std::vector<const CLI::Option*>& options) {
  std::string text;
  for (const CLI::Option* option : options) {
    text += ".TP\n" + usage_of(*option) + "\n" + troff(option->get_description()) + "\n";
  }
  return text;
}

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<const CLI::Option*> own_options(const CLI::App& app) {
  return app.get_options([&](const CLI::Option* option) {
    return !option->get_group().empty() && option != app.get_help_ptr();
  });
}

/// Text within single quotes, in which `escapes` stand behind a backslash.
std::string quoted(const std::string& text, const std::string& escapes, const char* quote) {
  std::string inside;
  for (const char c : text) {
    if (c == '\'') {
      inside += quote;
      continue;
    }
    if (escapes.find(c) != std::string::npos) inside += '\\';
    inside += c;
  }
  return "'" + inside + "'";
}

std::string for_zsh(const std::string& text) {
  return quoted(text, "", "'\\''");
}

std::string for_fish(const std::string& text) {
  return quoted(text, "\\", "\\'");
}

std::string dashed_names(const std::vector<const CLI::Option*>& options) {
  std::string names;
  for (const CLI::Option* option : options) {
    for (const std::string& name : option->get_snames()) names += " -" + name;
    for (const std::string& name : option->get_lnames()) names += " --" + name;
  }
  return names.empty() ? names : names.substr(1);
}

}  // namespace

std::string manual_page(const CLI::App& program) {
  std::string text = std::string(".TH SUPPLE 1 \"\" \"supple ") + kVersion + "\"\n.SH NAME\n" +
                     "supple \\- " + troff(program.get_description()) +
                     "\n.SH SYNOPSIS\n.B supple\n.I command\n[options]\n.SH OPTIONS\n" +
                     options_of(own_options(program)) + ".SH COMMANDS\n";
  for (const CLI::App* command : commands_of(program)) {
    text += ".SS " + troff(command->get_name()) + "\n" + troff(command->get_description()) + "\n" +
            options_of(own_options(*command)) + ".PP\n.nf\n" + troff(command->get_footer()) +
            "\n.fi\n";
  }
  return text + ".SH NOTES\n.nf\n" + troff(program.get_footer()) + "\n.fi\n";
}

std::string bash_completion(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* command : commands_of(program)) {
    names += (names.empty() ? "" : " ") + command->get_name();
    const std::vector<const CLI::Option*> options = shown_options(*command);
    cases += "    " + command->get_name() + ")\n      options=\"" + dashed_names(options) + "\"\n";
    std::string values;
    for (const CLI::Option* option : options) {
      const std::string words = value_words(*option);
      if (words.empty()) continue;
      for (const std::string& name : option->get_lnames()) {
        values += "        --" + name + ") words=\"" + words + "\" ;;\n";
      }
    }
    if (!values.empty()) cases += "      case \"$previous\" in\n" + values + "      esac\n";
    cases += "      ;;\n";
  }
  return "# bash completion of supple, made by `supple help --completion`.\n"
         "_supple() {\n"
         "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\"\n"
         "  local options=\"" +
         dashed_names(shown_options(program)) +
         "\" words=\"\"\n"
         "  if [[ $COMP_CWORD -eq 1 && $current != -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"" +
         names +
         "\" -- \"$current\"))\n    return\n  fi\n"
         "  case \"${COMP_WORDS[1]}\" in\n" +
         cases +
         "  esac\n"
         "  if [[ -n $words ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  elif [[ $current == -* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  else\n"
         "    COMPREPLY=($(compgen -f -- \"$current\"))\n"
         "  fi\n"
         "}\n"
         "complete -o filenames -F _supple supple\n";
}

std::string zsh_completion(const CLI::App& program) {
  const auto described = [](const std::string& name, const std::string& text) {
    return "    " + for_zsh(name + ":" + text) + "\n";
  };
  const auto list_of = [&](const std::vector<const CLI::Option*>& options) {
    std::string list;
    for (const CLI::Option* option : options) {
      for (const std::string& name : option->get_snames())
        list += described("-" + name, option->get_description());
      for (const std::string& name : option->get_lnames())
        list += described("--" + name, option->get_description());
    }
    return list;
  };
  std::string commands, cases;
  for (const CLI::App* command : commands_of(program)) {
    commands += described(command->get_name(), command->get_description());
    const std::vector<const CLI::Option*> options = shown_options(*command);
    cases += "  " + command->get_name() + ")\n    options=(\n" + list_of(options) + "    )\n";
    std::string values;
    for (const CLI::Option* option : options) {
      const std::string words = value_words(*option);
      if (words.empty()) continue;
      for (const std::string& name : option->get_lnames()) {
        values += "      --" + name + ") values=(" + words + ") ;;\n";
      }
    }
    if (!values.empty()) cases += "    case $previous in\n" + values + "    esac\n";
    cases += "    ;;\n";
  }
  return "#compdef supple\n"
         "# zsh completion of supple, made by `supple help --completion zsh`.\n"
         "local current=$words[CURRENT] previous=$words[CURRENT-1]\n"
         "local -a commands options values\n"
         "commands=(\n" +
         commands + ")\noptions=(\n" + list_of(shown_options(program)) +
         ")\n"
         "if (( CURRENT == 2 )) && [[ $current != -* ]]; then\n"
         "  _describe command commands\n"
         "  return\n"
         "fi\n"
         "case $words[2] in\n" +
         cases +
         "esac\n"
         "if (( $#values )); then\n"
         "  compadd -- $values\n"
         "elif [[ $current == -* ]]; then\n"
         "  _describe -o option options\n"
         "else\n"
         "  _files\n"
         "fi\n";
}

std::string fish_completion(const CLI::App& program) {
  const auto line_of = [](const std::string& condition, const CLI::Option& option) {
    std::string line = "complete -c supple -n " + for_fish(condition);
    for (const std::string& name : option.get_snames()) line += " -s " + name;
    for (const std::string& name : option.get_lnames()) line += " -l " + name;
    const std::string words = value_words(option);
    if (!words.empty()) {
      line += " -x -a " + for_fish(words);
    } else if (option.get_items_expected_max() > 0) {
      line += " -r";
    }
    return line + " -d " + for_fish(option.get_description()) + "\n";
  };
  std::string text = "# fish completion of supple, made by `supple help --completion fish`.\n";
  for (const CLI::Option* option : shown_options(program)) {
    text += line_of("__fish_use_subcommand", *option);
  }
  for (const CLI::App* command : commands_of(program)) {
    text += "complete -c supple -f -n __fish_use_subcommand -a " + command->get_name() + " -d " +
            for_fish(command->get_description()) + "\n";
    for (const CLI::Option* option : shown_options(*command)) {
      if (option->get_positional()) continue;
      text += line_of("__fish_seen_subcommand_from " + command->get_name(), *option);
    }
  }
  return text;
}

}  // namespace supple::tools
