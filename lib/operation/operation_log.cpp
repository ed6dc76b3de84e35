#include "lib/operation/operation_log.h"

#include <cerrno>
#include <cmath>

#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/text.h"

namespace supple {

namespace {

constexpr int kLogVersion = 1;
constexpr std::size_t kLongestLine = std::size_t(1) << 22;

double finite(double number) {
  require(std::isfinite(number), "operation log", number, "a finite number");
  return number;
}

Value to_value(const Vec3d& v) {
  return Value::List{finite(v.x), finite(v.y), finite(v.z)};
}

Value to_value(const InstrumentPose& pose) {
  std::vector<double> numbers;
  for (const Vec3d& v : {pose.tip_mm, pose.axis}) {
    for (int c = 0; c < 3; ++c) numbers.push_back(finite(v[c]));
  }
  for (double one : {pose.roll_degrees, pose.opening_degrees, pose.active}) {
    numbers.push_back(finite(one));
  }
  return numbers;
}

Value event_row(const OperationEvent& event) {
  Value row;
  row["t"] = finite(event.time_s);
  row["event"] = event.kind;
  row["by"] = event.instrument;
  row["at"] = event.at;
  row["place"] = to_value(event.place_mm);
  row["value"] = finite(event.value);
  return row;
}

Value step_row(const OperationSample& sample) {
  Value row;
  row["t"] = finite(sample.time_s);
  row["tools"] = Value::List();
  for (const InstrumentSample& tool : sample.instruments) {
    Value one;
    one["asked"] = to_value(tool.asked);
    one["pose"] = to_value(tool.pose);
    one["force"] = finite(tool.force_n);
    row["tools"].push_back(std::move(one));
  }
  row["turn"] = to_value(sample.turn_degrees);
  row["focus"] = to_value(sample.focus_mm);
  row["zoom"] = finite(sample.zoom);
  row["clinging"] = finite(sample.clinging_mm2);
  row["vitreous"] = finite(sample.vitreous_left);
  row["membranes"] = Value::Entries();
  for (const MembraneSample& membrane : sample.membranes) {
    row["membranes"][membrane.body] = finite(membrane.clinging_mm2);
    if (membrane.inverted > 0) row["inverted"][membrane.body] = membrane.inverted;
  }
  return row;
}

/// Errors name the line of the file, not that of the row's text.
void clear_lines(Value& value) {
  value.line = 0;
  for (const Value::Entry& entry : value.entries()) clear_lines(value[entry.key]);
  if (!value.is_list()) return;
  for (std::size_t n = 0; n < value.size(); ++n) clear_lines(value[n]);
}

template <class T>
T required(Table& table, const std::string& key, const std::string& expected) {
  return table.require(table.get<T>(key), key, expected);
}

double number_of(Table& table, const std::string& key) {
  return required<double>(table, key, "a finite number");
}

Vec3d vector_of(Table& table, const std::string& key) {
  return required<Vec3d>(table, key, "three numbers");
}

InstrumentPose pose_of(Table& table, const std::string& key) {
  const char* expected = "nine numbers: tip, axis, roll, opening, activity";
  const auto n = required<std::vector<double>>(table, key, expected);
  if (n.size() != 9) table.fail(key, std::to_string(n.size()) + " numbers", expected);
  return {{n[0], n[1], n[2]}, {n[3], n[4], n[5]}, n[6], n[7], n[8]};
}

}  // namespace

OperationLog::OperationLog(const std::string& path, const OperationPlan& plan)
    : m_file(path), m_out(m_file.path(), std::ios::binary | std::ios::trunc) {
  Value head;
  head["operation_log"] = kLogVersion;
  head["plan"] = supple::to_value(plan);
  write(head);
}

void OperationLog::write(const Value& row) {
  m_out << json_text(row) << '\n';
  if (!m_out) throw_write_error(m_file.final_path(), errno);
}

void OperationLog::add(const OperationSample& sample) {
  for (const OperationEvent& event : sample.events) write(event_row(event));
  write(step_row(sample));
  ++m_steps;
}

void OperationLog::end() {
  Value row;
  row["steps"] = m_steps;
  write(row);
  m_out.close();
  if (!m_out) throw_write_error(m_file.final_path(), errno);
  m_is_ended = true;
}

void OperationLog::finish() {
  if (!m_is_ended) end();
  m_file.commit();
}

OperationLogReader::OperationLogReader(const std::string& path) : m_path(path) {
  require_regular_file(path);
  m_in.open(path, std::ios::binary);
  if (!m_in) throw_open_error(path, errno);
  m_text.resize(kLongestLine);
  Table head = next_row();
  const char* expected = "the first row of a log of an operation, version 1";
  const auto version = required<long long>(head, "operation_log", expected);
  if (version != kLogVersion) head.fail("operation_log", std::to_string(version), expected);
  Table plan = head.require(head.table("plan"), "plan", "a table");
  m_plan = read_plan(plan);
  head.finish();
}

Table OperationLogReader::next_row() {
  ++m_line;
  const std::string place = m_path + ":" + std::to_string(m_line);
  m_in.getline(m_text.data(), std::streamsize(m_text.size()));
  if (m_in.bad()) throw_open_error(m_path, EIO);
  const auto read = std::size_t(m_in.gcount());
  if (read == 0) throw InputError({place, "", "the end of the file", "a row of a log"});
  if (m_in.fail()) throw InputError({place, "", "a line above 4 MiB", "a row of a log"});
  // A last line without its end has been cut off.
  if (m_in.eof()) throw InputError({place, "", "a line without an end", "a row of a log"});
  Value row = json_or_null({m_text.data(), read - 1});
  if (!row.is_table()) throw InputError({place, "", "no table of JSON", "a row of a log"});
  clear_lines(row);
  return Table(std::move(row), place);
}

OperationEvent OperationLogReader::read_event(Table& row) {
  OperationEvent event;
  row.know({"t", "event", "by", "at", "place", "value"});
  event.time_s = number_of(row, "t");
  event.kind = required<std::string>(row, "event", "a kind of event");
  event.instrument = required<std::string>(row, "by", "the name of an instrument");
  event.at = required<std::string>(row, "at", "a name");
  event.place_mm = vector_of(row, "place");
  event.value = number_of(row, "value");
  row.finish();
  return event;
}

OperationSample OperationLogReader::read_step(Table& row) {
  OperationSample sample;
  row.know(
      {"t", "tools", "turn", "focus", "zoom", "clinging", "vitreous", "membranes", "inverted"});
  sample.time_s = number_of(row, "t");
  if (m_before_s && sample.time_s < *m_before_s) {
    row.fail("t", exact_text(sample.time_s), "no time before " + exact_text(*m_before_s));
  }
  m_before_s = sample.time_s;
  for (Table& tool : row.tables("tools")) {
    InstrumentSample one;
    one.asked = pose_of(tool, "asked");
    one.pose = pose_of(tool, "pose");
    one.force_n = number_of(tool, "force");
    tool.finish();
    sample.instruments.push_back(one);
  }
  if (sample.instruments.size() != m_plan.instruments.size()) {
    row.fail("tools", with_count(std::int64_t(sample.instruments.size()), "instrument"),
             with_count(std::int64_t(m_plan.instruments.size()), "instrument"));
  }
  sample.turn_degrees = vector_of(row, "turn");
  sample.focus_mm = vector_of(row, "focus");
  sample.zoom = number_of(row, "zoom");
  sample.clinging_mm2 = number_of(row, "clinging");
  sample.vitreous_left = number_of(row, "vitreous");
  Table membranes = row.require(row.table("membranes"), "membranes", "a table of areas");
  for (const Value::Entry& entry : membranes.value().entries()) {
    sample.membranes.push_back({entry.key, number_of(membranes, entry.key)});
  }
  if (auto inverted = row.table("inverted")) {
    for (MembraneSample& membrane : sample.membranes) {
      if (!inverted->has(membrane.body)) continue;
      membrane.inverted =
          int(required<long long>(*inverted, membrane.body, "a count of triangles"));
    }
    inverted->finish();
  }
  row.finish();
  return sample;
}

void OperationLogReader::read_end(Table& row) {
  const auto steps = required<long long>(row, "steps", "the number of steps");
  if (steps != m_steps) {
    row.fail("steps", std::to_string(steps), std::to_string(m_steps) + ", as many as there are");
  }
  row.finish();
  m_is_over = true;
  if (m_in.peek() != std::ifstream::traits_type::eof()) {
    throw InputError({m_path + ":" + std::to_string(m_line + 1), "", "rows after the last one",
                      "the end of the file"});
  }
}

std::optional<OperationSample> OperationLogReader::next() {
  if (m_is_over) return std::nullopt;
  std::vector<OperationEvent> events;
  for (;;) {
    Table row = next_row();
    if (row.has("event")) {
      events.push_back(read_event(row));
    } else if (row.has("steps") && events.empty()) {
      read_end(row);
      return std::nullopt;
    } else {
      OperationSample sample = read_step(row);
      sample.events = std::move(events);
      ++m_steps;
      return sample;
    }
  }
}

OperationScore score_of_log(const std::string& path) {
  OperationLogReader log(path);
  ScoreKeeper keeper(log.plan());
  while (const auto sample = log.next()) keeper.take(*sample);
  return keeper.score();
}

}  // namespace supple
