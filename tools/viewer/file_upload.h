// The body of a request as the bytes of a file: what comes goes to its receiver piece by piece, so
// that memory does not grow with it.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>

#include "tools/viewer/page_session.h"

namespace supple::tools {

/// Called at the end, unless the connection has: the status of the answer and one line about a
/// failure, after which the rest of the body has not been read.
using UploadEnd = std::function<void(boost::beast::http::status status, const std::string& text)>;

/// Reads the body that follows a header of that length, each piece within ten seconds. Stream and
/// buffer live until `end` is destroyed.
void receive_upload(boost::beast::tcp_stream& stream, boost::beast::flat_buffer& buffer,
                    boost::beast::http::request_parser<boost::beast::http::empty_body>&& header,
                    std::unique_ptr<FileReceiver> receiver, UploadEnd end);

}  // namespace supple::tools
