// Work without the GIL, while the thread that asked for it waits: it looks for signals, so that
// Ctrl-C ends the work within 20 ms of where it next polls, and tells a callback of Python how far
// it is. Costs a thread, 30 µs.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include <pybind11/pybind11.h>

#include "volumes/base/progress.h"

namespace supple::python {

/// `callback(stage, fraction)` is called every 20 ms at most, where something is new; None: nobody.
/// The work ends where it returns False or throws. Warnings become those of Python afterwards,
/// notes go to the logger "supple". Throws what the work throws; KeyboardInterrupt and errors of
/// the callback go first. To be called with the GIL, which `work` may not need.
void attend(const pybind11::object& callback, const std::function<void(Progress&)>& work);

/// The same for work with a result, which is no object of Python.
template <class Work>
auto attended(const pybind11::object& callback, const Work& work) {
  std::optional<decltype(work(std::declval<Progress&>()))> result;
  attend(callback, [&](Progress& progress) { result.emplace(work(progress)); });
  return std::move(*result);
}

}  // namespace supple::python
