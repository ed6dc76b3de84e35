// `supple bench io`: how fast files become sparse grids and volumes become files, beside the time
// that the system needs for the bytes alone (design.md section 9).
#include <algorithm>
#include <filesystem>
#include <thread>

#include <fcntl.h>
#include <unistd.h>

#include "tools/console/command.h"
#include "tools/lab/bench/benches.h"
#include "tools/lab/bench/bodies/invert_fields.h"
#include "tools/lab/bench/report/memory.h"
#include "tools/lab/bench/report/report.h"
#include "tools/lab/bench/report/timing.h"
#include "tools/scene/peers/peer_process.h"
#include "volumes/base/parallel.h"
#include "volumes/base/units.h"
#include "volumes/field/dense/resample.h"
#include "volumes/field/inversion/invert.h"
#include "volumes/io/bytes/byte_source.h"
#include "volumes/io/bytes/output_file.h"
#include "volumes/io/load/load.h"
#include "volumes/io/volume_writer.h"
#include "volumes/phantom/phantom.h"

namespace supple::tools {

namespace {

/// One line of the table.
struct IoRow {
  std::string op;      // read, read-cold, write or export
  std::string format;  // extension
  int size;            // voxels per axis

  std::string name() const { return op + "/" + format + "/" + std::to_string(size); }
};

std::vector<IoRow> plan_io(const BenchOptions& options) {
  std::vector<IoRow> plan = {{"read", "nrrd", 512}, {"read-cold", "nrrd", 512}};
  const int size = options.quick ? 128 : 256;
  for (const char* format : {"nrrd", "mha", "nii", "nii.gz", "tif", "h5", "vdb"}) {
    plan.push_back({"read", format, size});
    plan.push_back({"write", format, size});
  }
  plan.push_back({"export", "nrrd", 256});
  const auto is_left_out = [&](const IoRow& row) {
    return !is_wanted_row(options.only, row.name());
  };
  plan.erase(std::remove_if(plan.begin(), plan.end(), is_left_out), plan.end());
  if (plan.empty()) {
    throw UsageError(to_line({"", "--only", "'" + options.only.front() + "', which no row matches",
                              "part of a row's name, such as read/nrrd/512"}));
  }
  return plan;
}

/// The head phantom as int16, one period of slices at a time, so that large ones are made quickly.
class HeadSlices {
 public:
  explicit HeadSlices(int size) : m_geometry(head_phantom(Vec3i(size)).geometry) {
    const Phantom head = head_phantom(Vec3i(kPeriod));
    const int repeat = size / kPeriod;
    m_slices.resize(std::size_t(kPeriod) * size * size);
    float* out = m_slices.data();
    for (int k = 0; k < kPeriod; ++k) {
      for (int j = 0; j < size; ++j) {
        for (int i = 0; i < size; ++i) *out++ = head.density(i / repeat, j / repeat, k);
      }
    }
  }
  const Geometry& geometry() const { return m_geometry; }
  void operator()(int k, float* out) const {
    const std::size_t slice = std::size_t(m_geometry.dims().x) * m_geometry.dims().y;
    const int repeat = m_geometry.dims().z / kPeriod;
    std::copy_n(m_slices.begin() + slice * (k / repeat), slice, out);
  }

 private:
  static constexpr int kPeriod = 128;
  Geometry m_geometry;
  std::vector<float> m_slices;
};

void write_head(const std::string& path, const HeadSlices& head) {
  write_volume(path, head.geometry(), ValueType::int16, [&](int k, float* out) { head(k, out); });
}

/// The file's bytes, as fast as read() gives them.
void read_bytes(const std::string& path) {
  const InputFile file(path);
  std::vector<char> block(std::size_t(4) << 20);
  for (std::int64_t at = 0; at < file.size(); at += std::int64_t(block.size())) {
    file.read_at(at, block.data(), block.size());
  }
}

void write_bytes(const std::string& path, std::int64_t count) {
  OutputFile file(path);
  const std::vector<char> block(std::size_t(4) << 20, 'x');
  for (std::int64_t left = count; left > 0; left -= std::int64_t(block.size())) {
    file.write(block.data(), std::size_t(std::min<std::int64_t>(left, std::int64_t(block.size()))));
  }
  file.close();
  file.commit();
}

/// Takes the file out of the page cache.
void make_cold(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::posix_fadvise(descriptor, 0, 0, POSIX_FADV_DONTNEED);
  ::close(descriptor);
}

TimedSide side_of(const std::function<void()>& prepare, const std::function<void()>& action) {
  TimedSide side;
  side.run = [=](Times& times) {
    prepare();
    times.ms.push_back(time_ms(action));
  };
  return side;
}

double rate(double bytes, const Times& times) {
  return bytes / kMegabyte / (times.median() / 1e3);
}

BenchRow describe(const IoRow& row, std::int64_t bytes) {
  return {{"case", row.op.substr(0, row.op.find('-'))},
          {"format", row.format},
          {"op", row.op},
          {"size", {row.size, row.size, row.size}},
          {"bytes", bytes}};
}

BenchRow measure_read(const IoRow& row, const ScratchFolder& folder, const RoundLimits& limits,
                      const std::function<void()>& before) {
  const std::string path = folder / ("head." + row.format);
  write_head(path, HeadSlices(row.size));
  const bool is_cold = row.op == "read-cold";
  const auto prepare = [=] {
    if (is_cold) make_cold(path);
  };
  std::vector<TimedSide> sides = {side_of(prepare, [=] { read_bytes(path); }),
                                  side_of(prepare, [=] { load_volume(path); })};
  take_turns(sides, limits, before);

  const PeakMemory peak;
  const Volume volume = load_volume(path);
  const auto growth = peak.growth();
  const double dense_bytes = double(volume.geometry.voxel_count()) * sizeof(std::int16_t);
  BenchRow result = describe(row, std::int64_t(std::filesystem::file_size(path)));
  result["mb_per_s"] = rate(dense_bytes, sides[1].times);
  result["raw_read_mb_per_s"] = rate(double(std::filesystem::file_size(path)), sides[0].times);
  result["sparse_mb"] = double(volume.density.bytes()) / kMegabyte;
  if (growth) result["peak_rss_mb"] = double(*growth) / kMegabyte;
  add_times(result, sides[1].times, 0);
  std::filesystem::remove(path);
  return result;
}

BenchRow measure_write(const IoRow& row, const ScratchFolder& folder, const RoundLimits& limits,
                       const std::function<void()>& before) {
  const HeadSlices head(row.size);
  const std::string path = folder / ("head." + row.format), plain = folder / "plain";
  const auto nothing = [] {};
  write_head(path, head);
  const std::int64_t bytes = std::int64_t(std::filesystem::file_size(path));
  std::vector<TimedSide> sides = {side_of(nothing, [&] { write_bytes(plain, bytes); }),
                                  side_of(nothing, [&] { write_head(path, head); })};
  take_turns(sides, limits, before);
  BenchRow result = describe(row, bytes);
  result["mb_per_s"] =
      rate(double(head.geometry().voxel_count()) * sizeof(std::int16_t), sides[1].times);
  result["raw_write_mb_per_s"] = rate(double(bytes), sides[0].times);
  add_times(result, sides[1].times, 0);
  return result;
}

/// Inverting and writing a dense warp, beside inverting and beside writing as many bytes.
BenchRow measure_export(const IoRow& row, const ScratchFolder& folder, const RoundLimits& limits,
                        const std::function<void()>& before) {
  const Displacement u = field_to_invert("smooth", row.size);
  const std::string path = folder / ("warp." + row.format), plain = folder / "plain";
  const std::int64_t bytes = u.geometry.voxel_count() * std::int64_t(sizeof(Vec3f));
  const auto nothing = [] {};
  const auto export_warp = [&] {
    const OffsetField offsets = invert(u);
    write_warp(path, {u.geometry, WarpDirection::resample},
               dense_offsets(offsets, u.u.topology, u.geometry, VoidMode::nearest));
  };
  std::vector<TimedSide> sides = {side_of(nothing, [&] { write_bytes(plain, bytes); }),
                                  side_of(nothing, [&] { invert(u); }),
                                  side_of(nothing, export_warp)};
  take_turns(sides, limits, before);
  BenchRow result = describe(row, bytes);
  result["mb_per_s"] = rate(double(bytes), sides[2].times);
  result["raw_write_ms"] = sides[0].times.median();
  result["invert_ms"] = sides[1].times.median();
  add_times(result, sides[2].times, 0);
  return result;
}

}  // namespace

std::vector<std::string> io_row_names(const BenchOptions& options, Console&) {
  std::vector<std::string> names;
  for (const IoRow& row : plan_io(options)) names.push_back(row.name());
  return names;
}

BenchReport bench_io(const BenchOptions& options, Console& console) {
  const std::vector<IoRow> plan = plan_io(options);
  int threads = options.threads;
  if (threads == 0) threads = std::min(2, int(std::thread::hardware_concurrency()));
  const ThreadLimit limit(threads);
  BenchReport report{"io", measure_machine(), {}};
  const RoundLimits limits = options.quick ? RoundLimits{3, 5, 1000} : RoundLimits{5, 15, 4000};
  const ScratchFolder folder;
  const auto before = [&] {
    if (console.cancelled()) throw Cancelled();
  };
  for (const IoRow& row : plan) {
    console.stage(row.name());
    const auto measure = row.op == "write"    ? measure_write
                         : row.op == "export" ? measure_export
                                              : measure_read;
    BenchRow result = measure(row, folder, limits, before);
    result["threads"] = threads;
    report.rows.push_back(std::move(result));
  }
  return report;
}

}  // namespace supple::tools
