#include "tools/viewer/file_upload.h"

#include <array>

#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/read.hpp>

namespace supple::tools {

namespace {

namespace beast = boost::beast;
namespace http = beast::http;
using namespace std::chrono_literals;

constexpr auto kPieceTime = 10s;

class FileUpload final : public std::enable_shared_from_this<FileUpload> {
 public:
  FileUpload(beast::tcp_stream& stream, beast::flat_buffer& buffer,
             http::request_parser<http::empty_body>&& header,
             std::unique_ptr<FileReceiver> receiver, UploadEnd end)
      : m_stream(stream),
        m_buffer(buffer),
        m_parser(std::move(header)),
        m_receiver(std::move(receiver)),
        m_end(std::move(end)) {}

  void read() {
    m_parser.get().body().data = m_piece.data();
    m_parser.get().body().size = m_piece.size();
    m_stream.expires_after(kPieceTime);
    http::async_read_some(m_stream, m_buffer, m_parser,
                          [self = shared_from_this()](beast::error_code error, std::size_t) {
                            const bool is_full = error == http::error::need_buffer;
                            if (!error || is_full) self->take();
                          });
  }

 private:
  void take() {
    try {
      m_receiver->add(m_piece.data(), m_piece.size() - m_parser.get().body().size);
      if (!m_parser.is_done()) return read();
      m_receiver->finish();
    } catch (const std::exception& error) {
      m_receiver.reset();
      return m_end(http::status::insufficient_storage, error.what());
    }
    m_end(http::status::ok, "");
  }

  beast::tcp_stream& m_stream;
  beast::flat_buffer& m_buffer;
  http::request_parser<http::buffer_body> m_parser;
  std::unique_ptr<FileReceiver> m_receiver;
  UploadEnd m_end;
  std::array<char, 65536> m_piece{};
};

}  // namespace

void receive_upload(beast::tcp_stream& stream, beast::flat_buffer& buffer,
                    http::request_parser<http::empty_body>&& header,
                    std::unique_ptr<FileReceiver> receiver, UploadEnd end) {
  std::make_shared<FileUpload>(stream, buffer, std::move(header), std::move(receiver),
                               std::move(end))
      ->read();
}

}  // namespace supple::tools
