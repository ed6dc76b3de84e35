// The module `supple._supple`. Errors of the libraries become those of supple/_errors.py.
#include "tools/python/bindings.h"
#include "volumes/base/error.h"
#include "volumes/base/version.h"

namespace py = pybind11;

namespace {

template <class... Arguments>
void raise(const char* name, const Arguments&... arguments) {
  const py::object type = py::module_::import("supple._errors").attr(name);
  PyErr_SetObject(type.ptr(), type(arguments...).ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    std::rethrow_exception(thrown);
  } catch (const supple::InputError& error) {
    const supple::Problem& problem = error.problem();
    raise("InputError", error.what(), problem.file, problem.field, problem.found, problem.expected);
  } catch (const supple::UsageError& error) {
    raise("UsageError", error.what());
  } catch (const supple::SystemError& error) {
    raise("SystemError", error.what());
  } catch (const supple::Cancelled& error) {
    raise("Cancelled", error.what());
  } catch (const supple::Error& error) {
    raise("Error", error.what());
  }
}

}  // namespace

PYBIND11_MODULE(_supple, module) {
  py::register_exception_translator(translate);
  module.attr("version") = supple::kVersion;
  supple::python::bind_volumes(module);
  supple::python::bind_warps(module);
  supple::python::bind_blocks(module);
  supple::python::bind_session(module);
  supple::python::bind_scenes(module);
}
