#define TOML_IMPLEMENTATION  // the library itself, which other files only see declared
#include "lib/material/toml_table.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

#include <toml++/toml.h>

#include "lib/material/toml_string.h"
#include "volumes/base/error.h"
#include "volumes/base/regular_file.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr std::size_t kLongestText = 60;

/// Adds the node to the line until the line is too long to be shown. Lists and tables are written
/// here because the library's way to find whether they fit on a line is undefined for numbers
/// below 1 and for infinite ones (`toml_formatter_count_inline_columns`).
void add_text(std::string& line, const toml::node& node) {
  if (line.size() > kLongestText) return;
  if (const toml::array* list = node.as_array()) {
    line += '[';
    for (std::size_t i = 0; i < list->size() && line.size() <= kLongestText; ++i) {
      if (i > 0) line += ", ";
      add_text(line, (*list)[i]);
    }
    line += ']';
  } else if (const toml::table* table = node.as_table()) {
    line += '{';
    for (const auto& [key, value] : *table) {
      if (line.size() > kLongestText) break;
      line += line.back() == '{' ? " " : ", ";
      line += toml_key(std::string(key.str())) + " = ";
      add_text(line, value);
    }
    line += line.back() == '{' ? "}" : " }";
  } else if (const toml::value<double>* number = node.as_floating_point()) {
    char shortest[32];  // that reads as the same number
    line.append(shortest, std::to_chars(std::begin(shortest), std::end(shortest), **number).ptr);
  } else {
    std::ostringstream text;
    node.visit([&text](const auto& value) { text << value; });
    line += text.str();
  }
}

std::string text_of(const toml::node& node) {
  std::string line;
  add_text(line, node);
  std::replace(line.begin(), line.end(), '\n', ' ');
  if (line.size() > kLongestText) line = line.substr(0, kLongestText - 3) + "...";
  return line;
}

}  // namespace

bool is_integer(double value) {
  return std::abs(value) <= 2147483647.0 && value == std::floor(value);
}

TomlTable TomlTable::parse(const std::string& text, const std::string& source) {
  try {
    return {std::make_shared<const toml::table>(toml::parse(text, source)),
            std::make_shared<File>(File{source, {}, {}, {}, {}}), ""};
  } catch (const toml::parse_error& error) {
    throw InputError({source + ":" + std::to_string(error.source().begin.line),
                      "not TOML: " + std::string(error.description()), "", ""});
  }
}

TomlTable TomlTable::of_options(const std::string& text,
                                std::map<std::string, std::string> options) {
  TomlTable table = parse(text, "");
  table.m_file_data->options = std::move(options);
  return table;
}

TomlTable TomlTable::read(const std::string& path) {
  require_regular_file(path);
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw_open_error(path, errno);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  if (text.empty()) throw InputError({path, "", "an empty file", "TOML"});
  return parse(text, path);
}

TomlTable::TomlTable(std::shared_ptr<const toml::table> table, std::shared_ptr<File> file,
                     std::string name)
    : m_table(std::move(table)), m_file_data(std::move(file)), m_name(std::move(name)) {}

TomlTable TomlTable::below(const toml::node& node, std::string name) const {
  return {std::shared_ptr<const toml::table>(m_table, node.as_table()), m_file_data,
          std::move(name)};
}

void TomlTable::take_warnings(const TomlTable& other) {
  std::vector<std::string>& all = m_file_data->warnings;
  all.insert(all.end(), other.warnings().begin(), other.warnings().end());
}

std::string TomlTable::place(const std::string& key) const {
  const toml::node* node = key.empty() ? m_table.get() : m_table->get(key);
  if (node == nullptr) node = m_table.get();
  const auto line = node->source().begin.line;
  return line == 0 || file().empty() ? file() : file() + ":" + std::to_string(line);
}

std::string TomlTable::own_name(const std::string& key) const {
  if (key.empty()) return m_name;
  return m_name.empty() ? key : m_name + "." + key;
}

std::string TomlTable::full_name(const std::string& key) const {
  const std::string name = own_name(key);
  // The option of the key, or of the table that holds it.
  const auto& options = m_file_data->options;
  for (std::size_t end = name.size(); !options.empty() && end != std::string::npos && end > 0;
       end = name.find_last_of(".[", end - 1)) {
    const auto option = options.find(name.substr(0, end));
    if (option != options.end()) return option->second + name.substr(end);
  }
  return name;
}

void TomlTable::fail(const std::string& key, const std::string& found,
                     const std::string& expected) const {
  throw InputError({place(key), full_name(key), found, expected});
}

void TomlTable::fail_missing(const std::string& key, const std::string& expected) const {
  finish();
  fail(key, "nothing", expected);
}

const toml::node* TomlTable::find(const std::string& key) {
  m_known.insert(key);
  return m_table->get(key);
}

double TomlTable::number_of(const toml::node& node, const std::string& key,
                            const std::string& expected) {
  const auto value = node.value<double>();
  if (!value || node.is_boolean() || !std::isfinite(*value)) fail(key, text_of(node), expected);
  return *value;
}

void TomlTable::read(const Fields& fields) {
  for (const Field& field : fields) m_known.insert(field.name());
  for (const Field& field : fields) {
    std::string key = field.name();
    if (!field.former().empty()) key = present_name(key, field.former());
    if (has(key)) {
      read_field(field, key);
    } else if (field.is_required()) {
      fail_missing(key, field.help());
    }
  }
}

std::string TomlTable::present_name(const std::string& key, const std::string& former) {
  m_known.insert(key);
  if (!m_table->contains(former)) return key;
  if (m_table->contains(key)) fail(key, key + " and " + former, "one of both");
  m_file_data->warnings.push_back(
      to_line({place(former), full_name(former), "its former name", full_name(key)}));
  return former;
}

void TomlTable::read_field(const Field& field, const std::string& key) {
  const auto checked = [&](double value) {
    if (!field.allows(value)) {
      fail(key, is_integer(value) ? exact_text(value) : number_text(value), field.allowed());
    }
    return value;
  };
  const auto named = [&](const std::string& name) {
    const std::vector<std::string>& names = field.names();
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end() && !names.empty()) fail(key, "\"" + name + "\"", field.allowed());
    return found - names.begin();
  };
  const auto one = [&] {
    const std::string allowed = field.allowed();
    const bool says_little = allowed.empty() || allowed == field.unit();
    return checked(number_of(*find(key), key, says_little ? "a finite number" : allowed));
  };
  const auto whole = [&] {
    const long long value = *integer(key);
    checked(double(value));
    if (!is_integer(double(value))) fail(key, std::to_string(value), "an integer of 32 bits");
    return int(value);
  };
  const auto pair = [&] {
    const auto values = numbers(key);
    if (values->size() != 2) fail(key, std::to_string(values->size()) + " numbers", "two numbers");
    return NumberPair(checked((*values)[0]), checked((*values)[1]));
  };
  const auto three = [&] {
    const Vec3d value = *vector(key);
    for (int c = 0; c < 3; ++c) checked(value[c]);
    return value;
  };
  const Field::Target& target = field.target();
  if (auto* flag = std::get_if<bool*>(&target)) **flag = *boolean(key);
  if (auto* value = std::get_if<int*>(&target)) **value = whole();
  if (auto* value = std::get_if<std::optional<int>*>(&target)) **value = whole();
  if (auto* value = std::get_if<double*>(&target)) **value = one();
  if (auto* value = std::get_if<std::optional<double>*>(&target)) **value = one();
  if (auto* value = std::get_if<Vec3d*>(&target)) **value = three();
  if (auto* value = std::get_if<std::optional<Vec3d>*>(&target)) **value = three();
  if (auto* value = std::get_if<NumberPair*>(&target)) **value = pair();
  if (auto* value = std::get_if<std::optional<NumberPair>*>(&target)) **value = pair();
  if (auto* value = std::get_if<std::string*>(&target)) {
    **value =
        field.is_path() && !field.is_word(*string(key)) ? *path(key) : field.name_for(*string(key));
    named(**value);
  }
  if (auto* value = std::get_if<PixelSize*>(&target)) {
    const auto pixels = numbers(key);
    if (pixels->size() != 2 || !is_integer((*pixels)[0]) || !is_integer((*pixels)[1])) {
      fail(key, text_of(*m_table->get(key)), "two integers [width, height]");
    }
    for (int a = 0; a < 2; ++a) (**value)[a] = int(checked((*pixels)[a]));
  }
  if (auto* value = std::get_if<Rgb*>(&target)) {
    const auto rgb = parse_colour(*string(key));
    if (!rgb) fail(key, "\"" + *string(key) + "\"", "\"#RRGGBB\", hexadecimal");
    **value = *rgb;
  }
  if (auto* values = std::get_if<std::vector<std::string>*>(&target)) {
    **values = *strings(key);
    for (const std::string& name : **values) named(name);
  }
  if (auto* choice = std::get_if<Field::Names>(&target)) choice->set(int(named(*string(key))));
}

std::optional<std::string> TomlTable::string(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_string()) fail(key, text_of(*node), "a string");
  const std::string text = *node->value<std::string>();
  return m_file_data->options.empty() ? text : bytes_of_toml_string(text);
}

std::optional<std::string> TomlTable::path(const std::string& key) {
  const auto text = string(key);
  return text ? std::optional<std::string>(input(key, *text)) : std::nullopt;
}

bool TomlTable::is_string(const std::string& key) {
  const toml::node* node = find(key);
  return node != nullptr && node->is_string();
}

bool TomlTable::is_list_of_strings(const std::string& key) {
  const toml::node* node = find(key);
  const toml::array* list = node == nullptr ? nullptr : node->as_array();
  return list != nullptr && !list->empty() && list->front().is_string();
}

std::string TomlTable::input(const std::string& key, const std::string& path) {
  namespace fs = std::filesystem;
  const bool is_absolute = fs::path(path).is_absolute();
  std::string found = is_absolute ? path : (fs::path(file()).parent_path() / path).string();
  if (m_file_data->admits) m_file_data->admits(found);
  std::error_code error;
  if (fs::exists(found, error)) {
    m_file_data->inputs[{key, path}] = fs::absolute(found).lexically_normal().string();
  }
  return found;
}

TomlTable TomlTable::named_file(const std::string& key) {
  TomlTable named = read(require(path(key), key, "the path of a file"));
  named.admit_inputs(admits());
  return named;
}

std::vector<std::string> TomlTable::paths(const std::string& key) {
  if (!has(key)) return {};
  std::vector<std::string> paths;
  if (is_string(key)) {
    paths.push_back(*string(key));
  } else {
    paths = *strings(key);
  }
  for (std::string& path : paths) path = input(key, path);
  return paths;
}

std::optional<bool> TomlTable::boolean(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_boolean()) fail(key, text_of(*node), "true or false");
  return node->value<bool>();
}

std::optional<double> TomlTable::number(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  return number_of(*node, key, "a finite number");
}

std::optional<long long> TomlTable::integer(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_integer()) fail(key, text_of(*node), "an integer");
  return node->value<long long>();
}

std::optional<std::vector<double>> TomlTable::numbers(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_array()) fail(key, text_of(*node), "a list of numbers");
  std::vector<double> values;
  for (const toml::node& item : *node->as_array()) {
    values.push_back(number_of(item, key, "a list of finite numbers"));
  }
  return values;
}

std::optional<Vec3d> TomlTable::vector(const std::string& key) {
  const auto values = numbers(key);
  if (!values) return std::nullopt;
  if (values->size() != 3) fail(key, text_of(*m_table->get(key)), "three numbers");
  return Vec3d((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<Vec3i> TomlTable::voxel(const std::string& key) {
  const auto values = vector(key);
  if (!values) return std::nullopt;
  Vec3i voxel;
  for (int axis = 0; axis < 3; ++axis) {
    voxel[axis] = int(std::clamp((*values)[axis], -2147483648.0, 2147483647.0));
    if (voxel[axis] != (*values)[axis]) {
      fail(key, text_of(*m_table->get(key)), "three integers, a voxel i, j, k");
    }
  }
  return voxel;
}

std::optional<std::vector<std::string>> TomlTable::strings(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_array()) fail(key, text_of(*node), "a list of strings");
  std::vector<std::string> values;
  for (const toml::node& item : *node->as_array()) {
    if (!item.is_string()) fail(key, text_of(item), "a list of strings");
    const std::string text = *item.value<std::string>();
    values.push_back(m_file_data->options.empty() ? text : bytes_of_toml_string(text));
  }
  return values;
}

std::optional<std::vector<std::vector<double>>> TomlTable::rows(
    const std::string& key, const std::set<std::size_t>& lengths, const std::string& expected) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_array()) fail(key, text_of(*node), expected);
  std::vector<std::vector<double>> rows;
  for (const toml::node& item : *node->as_array()) {
    if (!item.is_array()) fail(key, text_of(item), expected);
    std::vector<double> row;
    for (const toml::node& value : *item.as_array()) {
      row.push_back(number_of(value, key, expected));
    }
    if (lengths.count(row.size()) == 0) fail(key, text_of(item), expected);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<TomlTable> TomlTable::table(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (!node->is_table()) fail(key, text_of(*node), "a table");
  return below(*node, own_name(key));
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, node] : *m_table) names.emplace_back(key.str());
  return names;
}

std::vector<TomlTable> TomlTable::tables(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr) return {};
  const bool is_empty = node->is_array() && node->as_array()->empty();
  if (!is_empty && !node->is_array_of_tables()) {
    fail(key, text_of(*node), "tables, [[" + key + "]] or a list of { … }");
  }
  std::vector<TomlTable> tables;
  for (const toml::node& item : *node->as_array()) {
    const std::string number = "[" + std::to_string(tables.size() + 1) + "]";
    tables.push_back(below(item, own_name(key) + number));
  }
  return tables;
}

std::vector<TomlTable> TomlTable::table_or_tables(const std::string& key) {
  const toml::node* node = find(key);
  if (node == nullptr || !node->is_table()) return tables(key);
  return {below(*node, own_name(key))};
}

std::string TomlTable::json() const {
  std::ostringstream text;
  text << toml::json_formatter(*m_table);
  std::string line = text.str();
  line.erase(std::remove(line.begin(), line.end(), '\n'), line.end());
  return line;
}

void TomlTable::finish() const {
  for (const auto& [key, node] : *m_table) {
    const std::string name(key.str());
    if (m_known.count(name) != 0) continue;
    const std::string nearest = nearest_name(name, {m_known.begin(), m_known.end()});
    std::string expected = "did you mean '" + nearest + "'?";
    if (nearest.empty()) {
      expected = "one of";
      for (const std::string& known : m_known) expected += " " + known;
    }
    throw InputError({place(name), full_name(name), "an unknown key",
                      nearest.empty() ? expected : "a known one: " + expected});
  }
}

}  // namespace supple
