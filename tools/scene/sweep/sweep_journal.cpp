#include "tools/scene/sweep/sweep_journal.h"

#include <algorithm>
#include <cerrno>
#include <filesystem>

#include <fcntl.h>
#include <unistd.h>

#include "tools/scene/sweep/scene_digests.h"
#include "volumes/base/atomic_file.h"
#include "volumes/base/error.h"
#include "volumes/base/files.h"
#include "volumes/base/json.h"
#include "volumes/base/toml.h"

namespace supple::tools {

namespace {

constexpr const char* kKind = "cases of supple sweep";

/// True for a file that ended within its first line, or before it, and so has no case.
bool is_torn_head(const std::string& text) {
  const std::string line = json_text(Value{{"file", kKind}});
  const std::string begin = line.substr(0, line.size() - 1) + ",";
  const std::size_t common = std::min(begin.size(), text.size());
  return text.find('\n') == std::string::npos && text.compare(0, common, begin, 0, common) == 0;
}

}  // namespace

SweepJournal::SweepJournal(const std::string& path, const std::string& scene_digest, bool anew)
    : m_path(path), m_scene_digest(scene_digest) {
  if (!std::filesystem::exists(path)) return;
  const std::string text = text_of_input(path);
  if (!is_torn_head(text)) read(text, anew);
}

SweepJournal::~SweepJournal() {
  if (m_file >= 0) ::close(m_file);
}

void SweepJournal::read(const std::string& text, bool anew) {
  int number = 0;
  std::size_t at = 0;
  const auto refuse = [&](const std::string& found, const std::string& expected) {
    throw InputError({m_path + ":" + std::to_string(number), "", found, expected});
  };
  for (std::size_t end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
    ++number;
    const Value line = json_or_null(std::string_view(text).substr(at, end - at));
    if (number > 1) {
      const Value &digest = line["case"], &report = line["report"];
      if (!digest.is_text() || !report.is_table()) {
        refuse("no case of a sweep", "one, or --anew to run all cases again");
      }
      m_reports[digest.text()] = report;
      continue;
    }
    if (line["file"] != Value(kKind)) {
      refuse("another file", "the cases of a sweep, or another name for the table");
    }
    if (anew) return;
    if (line["scene"] != Value(m_scene_digest)) {
      refuse("cases of another scene, or of files of it that have changed",
             "those of this one; --anew runs all cases again");
    }
    if (line["program"] != Value(program_of_results())) {
      refuse("cases run by " + shown_text(line["program"]),
             program_of_results() + "; --anew runs all cases again");
    }
  }
  m_whole_bytes = at;
  if (number > 0) return;
  number = 1;
  refuse("another file", "the cases of a sweep, or another name for the table");
}

const Value* SweepJournal::find(const std::string& case_digest) const {
  const auto found = m_reports.find(case_digest);
  return found == m_reports.end() ? nullptr : &found->second;
}

void SweepJournal::append(const Value& line) {
  const std::string text = json_text(line) + "\n";
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t written = ::write(m_file, text.data() + at, text.size() - at);
    if (written < 0 && errno != EINTR) throw_write_error(m_path, errno);
    if (written > 0) at += std::size_t(written);
  }
}

void SweepJournal::add(const std::string& case_digest, const Value& report) {
  if (m_file < 0) {
    check_output_place(m_path);
    m_file = ::open(m_path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    if (m_file < 0) throw_write_error(m_path, errno);
    if (::ftruncate(m_file, off_t(m_whole_bytes)) != 0) throw_write_error(m_path, errno);
    if (m_whole_bytes == 0) {
      append({{"file", kKind}, {"program", program_of_results()}, {"scene", m_scene_digest}});
    }
  }
  append({{"case", case_digest}, {"report", report}});
  if (::fsync(m_file) != 0) throw_write_error(m_path, errno);
  // The next process reads numbers as they were written: both make the same table.
  m_reports[case_digest] = json_or_null(json_text(report));
}

}  // namespace supple::tools
