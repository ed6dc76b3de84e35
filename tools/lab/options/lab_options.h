// Command lines of bench, stress and tradeoff, which two programs declare: supple, and supple-lab,
// which runs them.
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace supple::tools {

struct BenchOptions {
  std::string name;
  bool quick = false;
  int threads = 0;  // of rows with several; 0: two, one on a single core
  std::vector<std::string> only;
  std::string ct_head;  // a volume; empty: build/data/ct_head.nhdr where that exists
};

struct BenchCommand {
  BenchOptions bench;
  std::string output;
  bool list = false, markdown = false;
};

/// The subcommand, whose options set those of `command`, and the option of the benchmark's name.
struct BenchApp {
  CLI::App* app;
  CLI::Option* name;
};
BenchApp add_bench_options(CLI::App& program, BenchCommand& command);

/// Rows of the matrix, by names of extremes, models or rows (empty: all), without long ones unless
/// they are named or asked for; `quick`: of each extreme one, models taking turns.
struct StressChoice {
  std::vector<std::string> only;
  bool quick = false;
  bool with_long = false;
};

struct StressOptions {
  StressChoice choice;
  std::string folder;   // that inputs and results of rows are kept in; empty: none are
  double patience = 1;  // limits of time and memory are multiplied by it
  int threads = 0;
};

struct StressCommand {
  StressOptions options;
  std::vector<std::string> outputs;
  bool lists = false;
  std::string markdown, row;
};

/// The subcommand, whose options set those of `given`.
CLI::App* add_stress_options(CLI::App& program, StressCommand& given);

/// How a row is measured.
struct MeasureOptions {
  std::string folder;
  int runs = 5;
  double limit_s = 600;  // of one run
  double row_s = 60;     // no further run of a row begins after so long
  int threads = 0;
};

struct TradeCommand {
  std::vector<std::string> scenes;
  std::string held_out;                        // one more, which nothing is chosen by; empty: none
  std::vector<std::string> methods, drawings;  // empty: all
  bool has_drawings = true;
  MeasureOptions measure;
};

/// The subcommand, whose options set those of `given`.
CLI::App* add_tradeoff_options(CLI::App& program, TradeCommand& given);

}  // namespace supple::tools
