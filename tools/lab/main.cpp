// The `supple-lab` program: what measures supple itself. Users start it through `supple`.
#include "tools/console/program.h"
#include "tools/lab/commands/lab_commands.h"

int main(int argc, char** argv) {
  using namespace supple::tools;
  return run_program(argc, argv,
                     {"The laboratory of Supple, whose commands supple has, too.",
                      "Exit codes are those of supple.",
                      {bench_command, stress_command, tradeoff_command}});
}
