// A TCP connection with deadlines, with or without TLS. One type for both, so that code built on it is compiled once.
#pragma once

#include <utility>
#include <variant>

#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/detail/config.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace brume {

// An AsyncReadStream and AsyncWriteStream of Asio, and a lowest layer for Beast's WebSocket.
class ByteStream {
public:
    using Tcp = boost::beast::tcp_stream;
    using Tls = boost::asio::ssl::stream<Tcp>;
    using executor_type = Tcp::executor_type;

    explicit ByteStream(Tcp tcp) : stream_(std::in_place_type<Tcp>, std::move(tcp)) {}
    // `context` outlives the stream.
    ByteStream(Tcp tcp, boost::asio::ssl::context& context) : stream_(std::in_place_type<Tls>, std::move(tcp), context) {}

    executor_type get_executor() { return tcp().get_executor(); }
    Tcp& tcp() { return tls() ? tls()->next_layer() : *std::get_if<Tcp>(&stream_); }
    Tls* tls() { return std::get_if<Tls>(&stream_); } // null without TLS

    template <class Buffers, class Handler>
    BOOST_BEAST_ASYNC_RESULT2(Handler)
    async_read_some(const Buffers& buffers, Handler&& handler) {
        return start(handler, [this, buffers](auto done) {
            tls() ? tls()->async_read_some(buffers, std::move(done)) : tcp().async_read_some(buffers, std::move(done));
        });
    }
    template <class Buffers, class Handler>
    BOOST_BEAST_ASYNC_RESULT2(Handler)
    async_write_some(const Buffers& buffers, Handler&& handler) {
        return start(handler, [this, buffers](auto done) {
            tls() ? tls()->async_write_some(buffers, std::move(done)) : tcp().async_write_some(buffers, std::move(done));
        });
    }

private:
    template <class Handler, class Operation>
    static BOOST_BEAST_ASYNC_RESULT2(Handler) start(Handler& handler, Operation&& operation) {
        return boost::asio::async_initiate<Handler, void(boost::system::error_code, size_t)>(std::forward<Operation>(operation),
                                                                                             handler);
    }

    std::variant<Tcp, Tls> stream_;
};

// How Beast's WebSocket closes the stream: with TLS and TCP shutdown, or at once.
inline void beast_close_socket(ByteStream& stream) { stream.tcp().close(); }

inline void teardown(boost::beast::role_type role, ByteStream& stream, boost::system::error_code& error) {
    boost::beast::websocket::teardown(role, stream.tcp().socket(), error);
}

template <class Handler>
void async_teardown(boost::beast::role_type role, ByteStream& stream, Handler&& handler) {
    if (ByteStream::Tls* tls = stream.tls())
        tls->async_shutdown(std::forward<Handler>(handler));
    else
        boost::beast::websocket::async_teardown(role, stream.tcp().socket(), std::forward<Handler>(handler));
}

} // namespace brume
