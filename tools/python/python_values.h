// Values of the project as objects of Python and the other way, wherever a function has one:
// None, bool, int, float, str, list and dict. Tuples, arrays and numbers of numpy become lists and
// numbers, and whatever has a path (os.fspath) becomes its text.
#pragma once

#include <pybind11/pybind11.h>

#include "volumes/base/fields.h"

namespace supple::python {

/// Throws pybind11::type_error, naming the key, for what no file could hold.
Value to_value(pybind11::handle object, const std::string& key = "");
pybind11::object to_object(const Value& value);
/// Sets fields by name. Throws InputError for what they do not have or allow.
void read_keys(const Value& keys, const Fields& fields);

}  // namespace supple::python

namespace pybind11::detail {

template <>
struct type_caster<supple::Value> {
  PYBIND11_TYPE_CASTER(supple::Value, const_name("object"));
  bool load(handle source, bool) {
    value = supple::python::to_value(source);
    return true;
  }
  static handle cast(const supple::Value& value, return_value_policy, handle) {
    return supple::python::to_object(value).release();
  }
};

}  // namespace pybind11::detail
