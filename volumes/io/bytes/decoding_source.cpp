#include "volumes/io/bytes/decoding_source.h"

#include <algorithm>

#include "volumes/base/error.h"

namespace supple {

namespace {

constexpr std::size_t kBufferBytes = 256 * 1024;
constexpr std::size_t kDroppedAtOnce = 64 * 1024;

}  // namespace

DecodingSource::DecodingSource(std::shared_ptr<const InputFile> file, const ByteRange& range,
                               std::string field)
    : m_file(std::move(file)),
      m_range(range),
      m_field(std::move(field)),
      m_offset(range.file_offset),
      m_buffer(kBufferBytes) {}

std::string DecodingSource::amount(std::int64_t bytes) const {
  return bytes_text(bytes);
}

void DecodingSource::fail(const std::string& found, const std::string& expected) const {
  throw InputError({m_file->path(), m_field, found, expected});
}

bool DecodingSource::refill() {
  if (available() > 0) return true;
  m_used = 0;
  m_filled = m_file->read_at(m_offset, m_buffer.data(), m_buffer.size());
  m_offset += std::int64_t(m_filled);
  return m_filled > 0;
}

std::int64_t DecodingSource::drop(std::int64_t count) {
  std::vector<char> dropped(std::size_t(std::min<std::int64_t>(count, kDroppedAtOnce)));
  std::int64_t done = 0;
  while (done < count) {
    const auto chunk = std::size_t(std::min<std::int64_t>(count - done, kDroppedAtOnce));
    const std::size_t got = decode(dropped.data(), chunk);
    done += std::int64_t(got);
    if (got < chunk) break;
  }
  return done;
}

void DecodingSource::drop_stream_offset() {
  if (m_at_values) return;
  m_at_values = true;
  if (drop(m_range.stream_offset) < m_range.stream_offset) {
    fail("its end before the first value", amount(m_range.size));
  }
}

void DecodingSource::read(void* out, std::size_t size) {
  drop_stream_offset();
  const std::size_t got = decode(out, size);
  m_delivered += std::int64_t(got);
  if (got < size) fail(amount(m_delivered), amount(m_range.size));
}

void DecodingSource::skip(std::int64_t size) {
  drop_stream_offset();
  const std::int64_t got = drop(size);
  m_delivered += got;
  if (got < size) fail(amount(m_delivered), amount(m_range.size));
}

void DecodingSource::finish() {
  // The rest of the claimed bytes is decoded too, so that checksums behind them are compared.
  skip(std::max<std::int64_t>(m_range.size - m_delivered, 0));
  std::vector<char> rest(kDroppedAtOnce);
  while (decode(rest.data(), rest.size()) > 0) {
    if (m_range.surplus == Surplus::error) {
      fail("more than " + amount(m_range.size), amount(m_range.size));
    }
  }
}

}  // namespace supple
