#include "tools/console/field_options.h"

#include <algorithm>
#include <cstdlib>

#include "tools/console/command.h"
#include "tools/console/parse.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"
#include "volumes/base/value.h"

namespace supple::tools {

namespace {

using Sink = std::function<void(const Field&, Value value)>;

std::string dashed(std::string name) {
  std::replace(name.begin(), name.end(), '_', '-');
  return name;
}

std::string help_of(const Field& field) {
  std::string help = field.traits().help;
  if (field.holds<bool>()) return help;
  const std::string& unit = field.traits().unit;
  if (unit.find_first_of(" /") != std::string::npos) help += ", in " + unit;
  const std::string otherwise = field.default_text();
  return otherwise.empty() ? help : help + " (default: " + otherwise + ")";
}

double to_number(const std::string& option, const std::string& text) {
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || end != text.c_str() + text.size()) {
    refuse_option(option, text, "a number");
  }
  return value;
}

/// The text of an option as the value of its field. Throws UsageError.
Value value_of(const Field& field, const std::string& option, const std::string& text) {
  if (field.holds<double>() || field.holds<int>()) return number_value(option, text);
  if (field.holds<Vec3d>()) return numbers_value(option, text);
  if (field.holds<NumberPair>()) return numbers_value(option, text, 2);
  if (field.holds<PixelSize>()) {
    std::string pair = text;  // 4x3 as well as 4,3
    std::replace(pair.begin(), pair.end(), 'x', ',');
    return numbers_value(option, pair, 2);
  }
  const bool is_list = field.holds<std::vector<std::string>>();
  Value list = Value::List();
  for (const std::string& word : is_list ? split(text, ',') : std::vector<std::string>{text}) {
    const std::vector<std::string>& names = field.names();
    const std::string part = field.name_for(word);
    if (!names.empty() && std::find(names.begin(), names.end(), part) == names.end()) {
      refuse_option(option, word, field.allowed());
    }
    list.push_back(part);
  }
  return is_list ? list : list.front();
}

CLI::Option* add_option(CLI::App& app, const Field& field, const std::string& option,
                        const Sink& sink) {
  if (bool* const* flag = std::get_if<bool*>(&field.target())) {
    const bool value = !**flag;
    return app
        .add_flag_function(
            option, [=](std::int64_t) { sink(field, value); }, help_of(field))
        ->disable_flag_override();
  }
  CLI::Option* added = app.add_option_function<std::string>(
      option, [=](const std::string& text) { sink(field, value_of(field, option, text)); },
      help_of(field));
  added->option_text(field.placeholder());
  if (field.holds<std::vector<std::string>>()) added->join(',');
  if (field.traits().implied.empty()) return added;
  return added->expected(0, 1)
      ->default_str(field.traits().implied)
      ->option_text("[" + field.placeholder() + "]");
}

void add_options(CLI::App& app, const Fields& fields, const std::string& prefix, const Sink& sink) {
  for (const Field& field : fields) {
    if (field.traits().is_only_in_scenes) continue;
    CLI::Option* present = add_option(app, field, option_name(field, prefix), sink);
    if (field.traits().former.empty()) continue;
    const std::string former = "--" + prefix + dashed(field.traits().former);
    app.add_option_function<std::string>(
           former, [=](const std::string& text) { sink(field, value_of(field, former, text)); },
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

}  // namespace

std::string option_name(const Field& field, const std::string& prefix) {
  if (!field.traits().option.empty()) return "--" + field.traits().option;
  const bool* const* flag = std::get_if<bool*>(&field.target());
  const bool is_on = flag != nullptr && **flag;
  return "--" + prefix + (is_on ? "no-" : "") + dashed(field.name());
}

bool is_table(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\n");
  return first != std::string::npos && text[first] == '{';
}

Value table_value(const std::string& option, const std::string& text) {
  std::string found = "'" + text + "'";
  try {
    const Value whole = parse_toml("x = " + text, option);
    if (whole.size() == 1 && whole["x"].is_table()) return whole["x"];
  } catch (const InputError& error) {
    found = error.problem().field;
  }
  throw UsageError(to_line({"", option, found, "one table { … } as in a scene"}));
}

Value number_value(const std::string& option, const std::string& text) {
  // A whole number also stands for one that need not be.
  const double number = to_number(option, text);
  return is_integer(number) ? Value((long long)number) : Value(number);
}

Value numbers_value(const std::string& option, const std::string& text, std::size_t count) {
  const std::vector<std::string> parts = split(text, ',');
  if (parts.size() != count) {
    refuse_option(option, text, std::to_string(count) + " numbers, comma-separated");
  }
  Value list = Value::List();
  for (const std::string& part : parts) list.push_back(number_value(option, part));
  return list;
}

void add_field_options(CLI::App& app, const Fields& fields) {
  add_options(app, fields, "", [](const Field& field, Value value) {
    const std::string& key = field.name();
    Table({{key, std::move(value)}}, "", {{key, option_name(field, "")}}).read({field});
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
  add_options(m_app, fields, prefix, [this, table](const Field& field, Value value) {
    m_given[table][field.name()] = std::move(value);
  });
}

void SceneOptions::set(const std::string& table, const std::string& key, Value value,
                       const std::string& option) {
  m_names[full_table_name(table) + "." + key] = option;
  m_given[table][key] = std::move(value);
}

/// The table of that name in the root, which comes to be where it is not there.
Value& SceneOptions::made(Value& root, const std::string& name) const {
  const std::size_t dot = name.rfind('.');
  if (dot == std::string::npos) {
    Value& entry = root[name];
    if (name != "step" && name != "view") return entry;
    return entry.is_null() ? entry.push_back(Value::Entries()) : entry.back();
  }
  Value& inner = made(root, name.substr(0, dot))[name.substr(dot + 1)];
  if (inner.is_null() || inner.is_table()) return inner;
  throw InputError({"", m_names.at(full_table_name(name)), shown_text(inner) + " and a key of it",
                    "one of them"});
}

Table SceneOptions::scene() const {
  Value root = Value::Entries();
  for (const std::string& name : m_tables) {
    const auto given = m_given.find(name);
    if (given == m_given.end()) continue;
    Value& table = made(root, name);
    if (table.is_null()) table = Value::Entries();
    table.update(given->second);
  }
  return Table(std::move(root), "", m_names);
}

}  // namespace supple::tools
