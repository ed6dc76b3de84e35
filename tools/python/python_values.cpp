#include "tools/python/python_values.h"

#include "volumes/base/table.h"

namespace py = pybind11;

namespace supple::python {

namespace {

[[noreturn]] void refuse(py::handle object, const std::string& key) {
  const std::string type = py::str(py::type::handle_of(object).attr("__name__"));
  throw py::type_error((key.empty() ? "" : key + ": ") + "found " + type +
                       ", expected None, bool, int, float, str, list, dict or a path");
}

Value table_of(const py::dict& dict) {
  Value::Entries entries;
  for (const auto& [name, value] : dict) {
    if (!py::isinstance<py::str>(name)) refuse(name, "a key");
    const std::string key = py::str(name);
    entries.push_back({key, to_value(value, key)});
  }
  return entries;
}

}  // namespace

Value to_value(py::handle object, const std::string& key) {
  if (object.is_none()) return {};
  if (py::isinstance<py::bool_>(object)) return object.cast<bool>();
  if (py::isinstance<py::int_>(object)) return object.cast<std::int64_t>();
  if (py::isinstance<py::float_>(object)) return object.cast<double>();
  if (py::isinstance<py::str>(object)) return object.cast<std::string>();
  if (py::isinstance<py::dict>(object)) return table_of(py::reinterpret_borrow<py::dict>(object));
  if (py::isinstance<py::list>(object) || py::isinstance<py::tuple>(object)) {
    Value::List items;
    for (const py::handle item : object) items.push_back(to_value(item, key));
    return items;
  }
  if (py::hasattr(object, "__fspath__")) return to_value(object.attr("__fspath__")(), key);
  if (py::hasattr(object, "tolist")) return to_value(object.attr("tolist")(), key);
  refuse(object, key);
}

py::object to_object(const Value& value) {
  if (value.is_truth()) return py::bool_(value.truth());
  if (value.is_whole()) return py::int_(value.whole());
  if (value.is_number()) return py::float_(value.number());
  if (value.is_text() || value.is_moment()) return py::str(value.text());
  if (value.is_table()) {
    py::dict dict;
    for (const auto& [name, entry] : value.entries()) dict[py::str(name)] = to_object(entry);
    return std::move(dict);
  }
  if (value.is_null()) return py::none();
  py::list list;
  for (const Value& item : value.items()) list.append(to_object(item));
  return std::move(list);
}

void read_keys(const Value& keys, const Fields& fields) {
  Table table(keys);
  table.read(fields);
  table.finish();
}

}  // namespace supple::python
