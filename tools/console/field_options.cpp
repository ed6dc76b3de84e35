#include "tools/console/field_options.h"

#include <algorithm>
#include <cstdlib>

#include "lib/material/toml_string.h"
#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

/// Takes the value of an option as TOML.
using Sink = std::function<void(const Field&, const std::string& toml)>;

std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string help_of(const Field& field) {
  std::string help = field.help();
  if (field.holds<bool>()) return help;
  const std::string& unit = field.unit();
  if (unit.find_first_of(" /") != std::string::npos) help += ", in " + unit;
  const std::string otherwise = field.default_text();
  return otherwise.empty() ? help : help + " (default: " + otherwise + ")";
}

double to_number(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size()) {
    throw UsageError(to_line({"", option, "'" + text + "'", "a number"}));
  }
  return value;
}

std::string number_as_toml(double value) {
  // A whole number is an integer of TOML, which also stands for a float.
  return is_integer(value) ? std::to_string((long long)value) : exact_text(value);
}

/// The text of an option as the TOML of its field. Throws UsageError.
std::string toml_of(const Field& field, const std::string& option, const std::string& text) {
  if (field.holds<double>() || field.holds<int>()) return toml_number(option, text);
  if (field.holds<Vec3d>()) return toml_numbers(option, text);
  if (field.holds<NumberPair>()) return toml_numbers(option, text, 2);
  if (field.holds<PixelSize>()) {
    std::string pair = text;  // 4x3 as well as 4,3
    std::replace(pair.begin(), pair.end(), 'x', ',');
    return toml_numbers(option, pair, 2);
  }
  const bool is_list = field.holds<std::vector<std::string>>();
  std::string list;
  for (const std::string& word : is_list ? split(text, ',') : std::vector<std::string>{text}) {
    const std::vector<std::string>& names = field.names();
    const std::string part = field.name_for(word);
    if (!names.empty() && std::find(names.begin(), names.end(), part) == names.end()) {
      throw UsageError(to_line({"", option, "'" + word + "'", field.allowed()}));
    }
    list += (list.empty() ? "" : ", ") + toml_string(part);
  }
  return is_list ? "[" + list + "]" : list;
}

CLI::Option* add_option(CLI::App& app, const Field& field, const std::string& option,
                        const Sink& sink) {
  if (bool* const* flag = std::get_if<bool*>(&field.target())) {
    const std::string value = **flag ? "false" : "true";
    return app
        .add_flag_function(
            option, [=](std::int64_t) { sink(field, value); }, help_of(field))
        ->disable_flag_override();
  }
  CLI::Option* added = app.add_option_function<std::string>(
      option, [=](const std::string& text) { sink(field, toml_of(field, option, text)); },
      help_of(field));
  added->option_text(field.placeholder());
  if (field.holds<std::vector<std::string>>()) added->join(',');
  if (field.implied().empty()) return added;
  return added->expected(0, 1)
      ->default_str(field.implied())
      ->option_text("[" + field.placeholder() + "]");
}

void add_options(CLI::App& app, const Fields& fields, const std::string& prefix, const Sink& sink) {
  for (const Field& field : fields) {
    if (field.is_only_in_scenes()) continue;
    CLI::Option* present = add_option(app, field, option_name(field, prefix), sink);
    if (field.former().empty()) continue;
    const std::string former = "--" + prefix + dashed(field.former());
    app.add_option_function<std::string>(
           former, [=](const std::string& text) { sink(field, toml_of(field, former, text)); },
           "this option is called " + option_name(field, prefix) + " now")
        ->group("")
        ->excludes(present);
  }
}

/// "step.relax" as the tables of a file are named: "step[1].relax".
std::string full_table_name(const std::string& table) {
  const std::size_t dot = std::min(table.find('.'), table.size());
  const std::string first = table.substr(0, dot);
  const bool is_listed = first == "step" || first == "view";
  return (is_listed ? first + "[1]" : first) + table.substr(dot);
}

std::string heading(const std::string& table) {
  const bool is_listed = table == "step" || table == "view";
  return is_listed ? "[[" + table + "]]\n" : "[" + table + "]\n";
}

}  // namespace

std::string option_name(const Field& field, const std::string& prefix) {
  if (!field.option().empty()) return "--" + field.option();
  const bool* const* flag = std::get_if<bool*>(&field.target());
  const bool is_on = flag != nullptr && **flag;
  return "--" + prefix + (is_on ? "no-" : "") + dashed(field.name());
}

bool is_table(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  return first != std::string::npos && text[first] == '{';
}

std::string toml_table(const std::string& option, const std::string& text) {
  std::string found = "'" + text + "'";
  try {
    Table whole = Table::parse("x = " + text, option);
    if (whole.keys().size() == 1 && whole.table("x")) return text;
  } catch (const InputError& error) {
    found = error.problem().field;
  }
  throw UsageError(to_line({"", option, found, "one table { … } as in a scene"}));
}

std::string toml_number(const std::string& option, const std::string& text) {
  return number_as_toml(to_number(option, text));
}

std::string toml_numbers(const std::string& option, const std::string& text, std::size_t count) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != count) {
    throw UsageError(to_line(
        {"", option, "'" + text + "'", std::to_string(count) + " numbers, comma-separated"}));
  }
  std::string list;
  for (const std::string& part : parts) {
    list += (list.empty() ? "[" : ", ") + toml_number(option, part);
  }
  return list + "]";
}

namespace {

Table table_of_options(const std::string& text, std::map<std::string, std::string> options) {
  Value root = parse_toml(text, "");
  for_each_text(root, "",
                [](const std::string&, std::string& own) { own = bytes_of_toml_string(own); });
  return Table(std::move(root), "", std::move(options));
}

}  // namespace

void add_field_options(CLI::App& app, const Fields& fields) {
  add_options(app, fields, "", [](const Field& field, const std::string& toml) {
    const std::string& key = field.name();
    table_of_options(key + " = " + toml, {{key, option_name(field, "")}}).read({field});
  });
}

void SceneOptions::add(const std::string& table, const Fields& fields, const std::string& prefix) {
  if (std::find(m_tables.begin(), m_tables.end(), table) == m_tables.end()) {
    m_tables.push_back(table);
  }
  const std::string name = full_table_name(table) + ".";
  for (const Field& field : fields) {
    m_names[name + field.name()] = option_name(field, prefix);
  }
  add_options(m_app, fields, prefix, [this, table](const Field& field, const std::string& toml) {
    m_text[table] += field.name() + " = " + toml + "\n";
  });
}

void SceneOptions::set(const std::string& table, const std::string& key, const std::string& toml,
                       const std::string& option) {
  try {
    Table::parse(key + " = " + toml, option);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
  m_names[full_table_name(table) + "." + key] = option;
  m_text[table] += key + " = " + toml + "\n";
}

Table SceneOptions::scene() const {
  std::string text;
  for (const std::string& table : m_tables) {
    const auto holds = [&](const std::string& other) {
      return other == table || other.compare(0, table.size() + 1, table + ".") == 0;
    };
    const bool is_there = std::any_of(m_text.begin(), m_text.end(),
                                      [&](const auto& given) { return holds(given.first); });
    if (!is_there) continue;
    const auto own = m_text.find(table);
    text += heading(table) + (own == m_text.end() ? "" : own->second);
  }
  return table_of_options(text, m_names);
}

}  // namespace supple::tools
