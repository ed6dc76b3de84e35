// The messages of what an action throws.
#pragma once

#include <functional>
#include <string>

namespace supple::test {

/// Of the InputError; "" when it throws none.
std::string input_error(const std::function<void()>& action);
/// Of any Error; "" when it throws none.
std::string error_of(const std::function<void()>& action);

}  // namespace supple::test
