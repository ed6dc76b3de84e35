// The messages of what an action throws.
#pragma once

#include <functional>
#include <string>

namespace supple::test {

/// Text of the InputError that the action throws; "" when it throws none.
std::string input_error(const std::function<void()>& action);
/// Text of any Error that the action throws; "" when it throws none.
std::string error_of(const std::function<void()>& action);

}  // namespace supple::test
