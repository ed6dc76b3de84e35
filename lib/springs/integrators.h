// The integrators of a spring system by name.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lib/springs/integrator.h"
#include "lib/springs/spring_report.h"

namespace supple {

/// Makes one with its default parameters. Throws InputError as validate(system), and Cancelled.
std::unique_ptr<SpringIntegrator> make_integrator(SpringMethod method, SpringSystem& system,
                                                  const Progress* progress = nullptr);

}  // namespace supple
