#include "volumes/base/value.h"

#include <algorithm>
#include <stdexcept>

namespace supple {

namespace {

const Value kNull;

template <class T, class Data>
const T& held(const Data& data) {
  if (const T* value = std::get_if<T>(&data)) return *value;
  throw std::invalid_argument("a value of another kind");
}

}  // namespace

Value::Value(std::initializer_list<Value> values) {
  const bool are_entries = std::all_of(values.begin(), values.end(), [](const Value& value) {
    return value.is_list() && value.size() == 2 && value.front().is_text();
  });
  if (!are_entries) {
    m_data = List(values);
    return;
  }
  m_data = Entries();
  for (const Value& entry : values) (*this)[entry.front().text()] = entry.at(1);
}

bool Value::truth() const {
  return held<bool>(m_data);
}

std::int64_t Value::whole() const {
  return held<std::int64_t>(m_data);
}

double Value::number() const {
  return is_whole() ? double(whole()) : held<double>(m_data);
}

const std::string& Value::text() const {
  return is_moment() ? held<Moment>(m_data).text : held<std::string>(m_data);
}

const Value::List& Value::items() const& {
  static const List none;
  const List* list = std::get_if<List>(&m_data);
  return list != nullptr ? *list : none;
}

const Value::Entries& Value::entries() const& {
  static const Entries none;
  const Entries* entries = std::get_if<Entries>(&m_data);
  return entries != nullptr ? *entries : none;
}

std::size_t Value::size() const {
  return items().size() + entries().size();
}

const Value* Value::find(const std::string& key) const {
  for (const Entry& entry : entries()) {
    if (entry.key == key) return &entry.value;
  }
  return nullptr;
}

const Value& Value::operator[](const std::string& key) const {
  const Value* value = find(key);
  return value != nullptr ? *value : kNull;
}

const Value& Value::at(const std::string& key) const {
  const Value* value = find(key);
  if (value == nullptr) throw std::out_of_range("no key " + key);
  return *value;
}

Value& Value::operator[](const std::string& key) {
  if (is_null()) m_data = Entries();
  if (Value* value = const_cast<Value*>(find(key))) return *value;
  Entries* entries = std::get_if<Entries>(&m_data);
  if (entries == nullptr) throw std::invalid_argument("no table");
  entries->push_back({key, {}});
  return entries->back().value;
}

void Value::erase(const std::string& key) {
  if (auto* entries = std::get_if<Entries>(&m_data)) {
    const auto has_key = [&](const Entry& entry) { return entry.key == key; };
    entries->erase(std::remove_if(entries->begin(), entries->end(), has_key), entries->end());
  }
}

void Value::update(const Value& other) {
  for (const auto& [key, value] : other.entries()) (*this)[key] = value;
}

Value& Value::push_back(Value value) {
  if (is_null()) m_data = List();
  List* list = std::get_if<List>(&m_data);
  if (list == nullptr) throw std::invalid_argument("no list");
  list->push_back(std::move(value));
  return list->back();
}

void Value::erase(std::size_t index) {
  if (auto* list = std::get_if<List>(&m_data)) list->erase(list->begin() + std::ptrdiff_t(index));
}

std::vector<double> numbers_of(const Value& list) {
  if (!list.is_list()) throw std::invalid_argument("no list");
  std::vector<double> numbers;
  for (const Value& item : list.items()) numbers.push_back(item.number());
  return numbers;
}

Value sorted(Value value) {
  if (auto* list = std::get_if<Value::List>(&value.m_data)) {
    for (Value& item : *list) item = sorted(std::move(item));
  }
  if (auto* entries = std::get_if<Value::Entries>(&value.m_data)) {
    for (Value::Entry& entry : *entries) entry.value = sorted(std::move(entry.value));
    std::sort(entries->begin(), entries->end(),
              [](const Value::Entry& a, const Value::Entry& b) { return a.key < b.key; });
  }
  return value;
}

void for_each_text(Value& value, const std::string& key,
                   const std::function<void(const std::string& key, std::string& text)>& change) {
  if (auto* list = std::get_if<Value::List>(&value.m_data)) {
    for (Value& item : *list) for_each_text(item, key, change);
  }
  if (auto* entries = std::get_if<Value::Entries>(&value.m_data)) {
    for (Value::Entry& entry : *entries) for_each_text(entry.value, entry.key, change);
  }
  if (auto* text = std::get_if<std::string>(&value.m_data)) change(key, *text);
}

}  // namespace supple
