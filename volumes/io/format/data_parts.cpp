#include "volumes/io/format/data_parts.h"

#include <algorithm>

namespace supple {

namespace {

class PartsSource : public ByteSource {
 public:
  explicit PartsSource(std::shared_ptr<const DataParts> parts) : m_parts(std::move(parts)) {}

  void read(void* out, std::size_t size) override {
    auto* bytes = static_cast<char*>(out);
    while (size > 0) {
      open_next();
      const auto chunk = std::size_t(std::min<std::int64_t>(std::int64_t(size), m_left));
      m_source->read(bytes, chunk);
      consume(std::int64_t(chunk));
      bytes += chunk;
      size -= chunk;
    }
  }

  /// Parts that are left out entirely are not even opened.
  void skip(std::int64_t size) override {
    while (size > 0) {
      if (m_source == nullptr && size >= m_parts->at(m_next).range.size) {
        size -= (*m_parts)[m_next++].range.size;
        continue;
      }
      open_next();
      const std::int64_t chunk = std::min(size, m_left);
      m_source->skip(chunk);
      consume(chunk);
      size -= chunk;
    }
  }

  void finish() override {
    if (m_source != nullptr) m_source->finish();
    m_source.reset();
  }

 private:
  void open_next() {
    if (m_source != nullptr) return;
    const DataPart& part = m_parts->at(m_next++);
    m_source = open_checked(std::make_shared<InputFile>(part.path), part.range);
    m_left = part.range.size;
  }

  void consume(std::int64_t size) {
    m_left -= size;
    if (m_left == 0) finish();
  }

  std::shared_ptr<const DataParts> m_parts;
  std::size_t m_next = 0;                // the first part that was not opened yet
  std::unique_ptr<ByteSource> m_source;  // of the part before it, while bytes are left in it
  std::int64_t m_left = 0;
};

}  // namespace

std::unique_ptr<ByteSource> open_parts(std::shared_ptr<const DataParts> parts) {
  return std::make_unique<PartsSource>(std::move(parts));
}

}  // namespace supple
