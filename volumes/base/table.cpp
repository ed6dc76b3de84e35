#include "volumes/base/table.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "volumes/base/error.h"
#include "volumes/base/text.h"
#include "volumes/base/toml.h"

namespace supple {

namespace {

double finite_number(const Table& table, const Value& value, const std::string& key,
                     const std::string& expected) {
  if (!value.is_number() || !std::isfinite(value.number())) {
    table.fail(key, shown_text(value), expected);
  }
  return value.number();
}

}  // namespace

bool is_integer(double value) {
  return std::abs(value) <= 2147483647.0 && value == std::floor(value);
}

Table Table::parse(const std::string& text, const std::string& source) {
  return Table(parse_toml(text, source), source);
}

Table Table::read(const std::string& path) {
  return Table(read_toml(path), path);
}

Table::Table(Value table, const std::string& source, std::map<std::string, std::string> options)
    : m_table(std::make_shared<const Value>(std::move(table))),
      m_file_data(std::make_shared<File>(File{source, std::move(options), {}, {}})) {}

Table::Table(std::shared_ptr<const Value> table, std::shared_ptr<File> file, std::string name)
    : m_table(std::move(table)), m_file_data(std::move(file)), m_name(std::move(name)) {}

Table Table::below(const Value& table, std::string name) const {
  return {std::shared_ptr<const Value>(m_table, &table), m_file_data, std::move(name)};
}

std::string Table::place(const std::string& key) const {
  const Value* value = key.empty() ? nullptr : m_table->find(key);
  const int line = value != nullptr ? value->line : m_table->line;
  return line == 0 || file().empty() ? file() : file() + ":" + std::to_string(line);
}

std::string Table::own_name(const std::string& key) const {
  if (key.empty()) return m_name;
  return m_name.empty() ? key : m_name + "." + key;
}

std::string Table::full_name(const std::string& key) const {
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

void Table::fail(const std::string& key, const std::string& found,
                 const std::string& expected) const {
  throw InputError({place(key), full_name(key), found, expected});
}

void Table::fail_missing(const std::string& key, const std::string& expected) const {
  finish();
  fail(key, "nothing", expected);
}

const Value* Table::find(const std::string& key) {
  m_known.insert(key);
  return m_table->find(key);
}

void Table::read(const Fields& fields) {
  for (const Field& field : fields) m_known.insert(field.name());
  for (const Field& field : fields) {
    std::string key = field.name();
    if (!field.traits().former.empty()) key = present_name(key, field.traits().former);
    if (has(key)) {
      read_field(field, key);
    } else if (field.traits().is_required) {
      fail_missing(key, field.traits().help);
    }
  }
}

std::string Table::present_name(const std::string& key, const std::string& former) {
  m_known.insert(key);
  if (!m_table->contains(former)) return key;
  if (m_table->contains(key)) fail(key, key + " and " + former, "one of both");
  m_file_data->warnings->push_back(
      to_line({place(former), full_name(former), "its former name", full_name(key)}));
  return former;
}

void Table::read_field(const Field& field, const std::string& key) {
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
    const bool says_little = allowed.empty() || allowed == field.traits().unit;
    return checked(
        finite_number(*this, *find(key), key, says_little ? "a finite number" : allowed));
  };
  const auto whole = [&] {
    const long long value = *get<long long>(key);
    checked(double(value));
    if (!is_integer(double(value))) fail(key, std::to_string(value), "an integer of 32 bits");
    return int(value);
  };
  const auto pair = [&] {
    const auto values = get<std::vector<double>>(key);
    if (values->size() != 2) fail(key, std::to_string(values->size()) + " numbers", "two numbers");
    return NumberPair(checked((*values)[0]), checked((*values)[1]));
  };
  const auto three = [&] {
    const Vec3d value = *get<Vec3d>(key);
    for (int c = 0; c < 3; ++c) checked(value[c]);
    return value;
  };
  const Field::Target& target = field.target();
  if (auto* flag = std::get_if<bool*>(&target)) **flag = *get<bool>(key);
  if (auto* value = std::get_if<int*>(&target)) **value = whole();
  if (auto* value = std::get_if<std::optional<int>*>(&target)) **value = whole();
  if (auto* value = std::get_if<double*>(&target)) **value = one();
  if (auto* value = std::get_if<std::optional<double>*>(&target)) **value = one();
  if (auto* value = std::get_if<Vec3d*>(&target)) **value = three();
  if (auto* value = std::get_if<std::optional<Vec3d>*>(&target)) **value = three();
  if (auto* value = std::get_if<NumberPair*>(&target)) **value = pair();
  if (auto* value = std::get_if<std::optional<NumberPair>*>(&target)) **value = pair();
  if (auto* value = std::get_if<std::string*>(&target)) {
    **value = field.names_file(*get<std::string>(key)) ? *path(key)
                                                       : field.name_for(*get<std::string>(key));
    named(**value);
  }
  if (auto* value = std::get_if<PixelSize*>(&target)) {
    const auto pixels = get<std::vector<double>>(key);
    if (pixels->size() != 2 || !is_integer((*pixels)[0]) || !is_integer((*pixels)[1])) {
      fail(key, shown_text((*m_table)[key]), "two integers [width, height]");
    }
    for (int a = 0; a < 2; ++a) (**value)[a] = int(checked((*pixels)[a]));
  }
  if (auto* value = std::get_if<Rgb*>(&target)) {
    const auto rgb = parse_colour(*get<std::string>(key));
    if (!rgb) fail(key, "\"" + *get<std::string>(key) + "\"", "\"#RRGGBB\", hexadecimal");
    **value = *rgb;
  }
  if (auto* values = std::get_if<std::vector<std::string>*>(&target)) {
    **values = *get<std::vector<std::string>>(key);
    for (const std::string& name : **values) named(name);
  }
  if (auto* choice = std::get_if<Field::Names>(&target))
    choice->set(int(named(*get<std::string>(key))));
}

std::optional<std::string> Table::path(const std::string& key) {
  const auto text = get<std::string>(key);
  return text ? std::optional<std::string>(input(key, *text)) : std::nullopt;
}

std::string Table::input(const std::string& key, const std::string& path) {
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

Value Table::written() const {
  Value keys = *m_table;
  for_each_text(keys, "", [&](const std::string& key, std::string& text) {
    const auto found = m_file_data->inputs.find({key, text});
    if (found != m_file_data->inputs.end()) text = found->second;
  });
  return keys;
}

Table Table::named_file(const std::string& key) {
  Table named = read(require(path(key), key, "the path of a file"));
  named.admit_inputs(admits());
  named.m_file_data->warnings = m_file_data->warnings;
  return named;
}

std::vector<std::string> Table::paths(const std::string& key) {
  if (!has(key)) return {};
  std::vector<std::string> paths;
  if (is_text(find(key))) {
    paths.push_back(*get<std::string>(key));
  } else {
    paths = *get<std::vector<std::string>>(key);
  }
  for (std::string& path : paths) path = input(key, path);
  return paths;
}

template <class T>
std::optional<T> Table::get(const std::string& key) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  const auto require = [&](bool is_right, const Value& found, const char* expected) {
    if (!is_right) fail(key, shown_text(found), expected);
  };
  if constexpr (std::is_same_v<T, bool>) {
    require(value->is_truth(), *value, "true or false");
    return value->truth();
  } else if constexpr (std::is_same_v<T, std::string>) {
    require(value->is_text(), *value, "a string");
    return value->text();
  } else if constexpr (std::is_same_v<T, double>) {
    return finite_number(*this, *value, key, "a finite number");
  } else if constexpr (std::is_same_v<T, long long>) {
    require(value->is_whole(), *value, "an integer");
    return value->whole();
  } else if constexpr (std::is_same_v<T, Vec3d>) {
    const auto numbers = *get<std::vector<double>>(key);
    require(numbers.size() == 3, *value, "three numbers");
    return Vec3d(numbers[0], numbers[1], numbers[2]);
  } else if constexpr (std::is_same_v<T, Vec3i>) {
    const auto numbers = *get<Vec3d>(key);
    Vec3i voxel;
    for (int axis = 0; axis < 3; ++axis) {
      voxel[axis] = int(std::clamp(numbers[axis], -2147483648.0, 2147483647.0));
    }
    require(Vec3d(voxel) == numbers, *value, "three integers, a voxel i, j, k");
    return voxel;
  } else if constexpr (std::is_same_v<T, std::vector<double>>) {
    require(value->is_list(), *value, "a list of numbers");
    std::vector<double> numbers;
    for (const Value& item : value->items()) {
      numbers.push_back(finite_number(*this, item, key, "a list of finite numbers"));
    }
    return numbers;
  } else {
    require(value->is_list(), *value, "a list of strings");
    std::vector<std::string> texts;
    for (const Value& item : value->items()) {
      require(item.is_text(), item, "a list of strings");
      texts.push_back(item.text());
    }
    return texts;
  }
}
template std::optional<bool> Table::get(const std::string& key);
template std::optional<std::string> Table::get(const std::string& key);
template std::optional<double> Table::get(const std::string& key);
template std::optional<long long> Table::get(const std::string& key);
template std::optional<Vec3d> Table::get(const std::string& key);
template std::optional<Vec3i> Table::get(const std::string& key);
template std::optional<std::vector<double>> Table::get(const std::string& key);
template std::optional<std::vector<std::string>> Table::get(const std::string& key);

std::optional<std::vector<std::vector<double>>> Table::rows(const std::string& key,
                                                            const std::set<std::size_t>& lengths,
                                                            const std::string& expected) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_list()) fail(key, shown_text(*value), expected);
  std::vector<std::vector<double>> rows;
  for (const Value& item : value->items()) {
    if (!item.is_list()) fail(key, shown_text(item), expected);
    std::vector<double> row;
    for (const Value& one : item.items()) row.push_back(finite_number(*this, one, key, expected));
    if (lengths.count(row.size()) == 0) fail(key, shown_text(item), expected);
    rows.push_back(std::move(row));
  }
  return rows;
}

std::optional<Table> Table::table(const std::string& key) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (!value->is_table()) fail(key, shown_text(*value), "a table");
  return below(*value, own_name(key));
}

std::vector<std::string> Table::keys() const {
  std::vector<std::string> names;
  for (const auto& [key, value] : m_table->entries()) names.push_back(key);
  std::sort(names.begin(), names.end());
  return names;
}

std::vector<Table> Table::tables(const std::string& key) {
  const Value* value = find(key);
  if (value == nullptr) return {};
  const Value::List& items = value->items();
  const auto is_table = [](const Value& item) { return item.is_table(); };
  if (!value->is_list() || !std::all_of(items.begin(), items.end(), is_table)) {
    fail(key, shown_text(*value), "tables, [[" + key + "]] or a list of { … }");
  }
  std::vector<Table> tables;
  for (const Value& item : value->items()) {
    const std::string number = "[" + std::to_string(tables.size() + 1) + "]";
    tables.push_back(below(item, own_name(key) + number));
  }
  return tables;
}

std::vector<Table> Table::table_or_tables(const std::string& key) {
  const Value* value = find(key);
  if (value == nullptr || !value->is_table()) return tables(key);
  return {below(*value, own_name(key))};
}

void Table::finish() const {
  for (const std::string& name : keys()) {
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
