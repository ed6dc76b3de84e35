// The functions of the module, by subject; the package in `supple/` makes classes of them.
#pragma once

#include <pybind11/pybind11.h>

namespace supple::python {

void bind_volumes(pybind11::module_& module);
void bind_warps(pybind11::module_& module);
void bind_blocks(pybind11::module_& module);
void bind_session(pybind11::module_& module);
void bind_scenes(pybind11::module_& module);

}  // namespace supple::python
