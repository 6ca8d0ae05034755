// A TCP connection with deadlines, with or without TLS. One type for both, so that code built on it is compiled once.
#pragma once

#include <array>
#include <memory>
#include <utility>
#include <variant>

#include <boost/asio/any_io_executor.hpp>
#include <boost/asio/associated_executor.hpp>
#include <boost/asio/buffer.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/detail/config.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace brume {

// A completion handler of any type, called where that one would be.
class AnyHandler {
public:
    using executor_type = boost::asio::any_io_executor;

    template <class Handler>
    AnyHandler(Handler handler, const executor_type& otherwise)
        : executor_(boost::asio::get_associated_executor(handler, otherwise)),
          held_(std::make_unique<Held<Handler>>(std::move(handler))) {}

    executor_type get_executor() const noexcept { return executor_; }
    void operator()(boost::system::error_code error, size_t bytes) {
        const std::unique_ptr<Base> held = std::move(held_);
        held->call(error, bytes);
    }

private:
    struct Base {
        virtual ~Base() = default;
        virtual void call(boost::system::error_code error, size_t bytes) = 0;
    };
    template <class Handler>
    struct Held final : Base {
        explicit Held(Handler&& held) : handler(std::move(held)) {}
        void call(boost::system::error_code error, size_t bytes) override {
            Handler last = std::move(handler);
            last(error, bytes);
        }
        Handler handler;
    };

    executor_type executor_;
    std::unique_ptr<Base> held_;
};

// An AsyncReadStream and AsyncWriteStream of Asio, and a lowest layer for Beast's WebSocket. What works on sockets is
// compiled once, for AnyHandler: Beast has dozens of handlers, for each of which TCP and TLS would take seconds.
class ByteStream {
public:
    using Tcp = boost::beast::tcp_stream;
    using Tls = boost::asio::ssl::stream<Tcp>;
    using executor_type = Tcp::executor_type;

    explicit ByteStream(Tcp tcp) : stream_(std::in_place_type<Tcp>, std::move(tcp)) {}
    // `context` outlives the stream.
    ByteStream(Tcp tcp, boost::asio::ssl::context& context)
        : stream_(std::in_place_type<Tls>, std::move(tcp), context) {}

    executor_type get_executor() { return tcp().get_executor(); }
    Tcp& tcp() { return tls() ? tls()->next_layer() : *std::get_if<Tcp>(&stream_); }
    Tls* tls() { return std::get_if<Tls>(&stream_); } // null without TLS
    uint64_t received() const { return *received_; }  // bytes that were read so far

    // Into the first buffer that is not empty.
    template <class Buffers, class Handler>
    BOOST_BEAST_ASYNC_RESULT2(Handler)
    async_read_some(const Buffers& buffers, Handler&& handler) {
        return boost::asio::async_initiate<Handler, Signature>(
            [this](auto done, const Buffers& from) {
                boost::asio::mutable_buffer first;
                for (auto i = boost::asio::buffer_sequence_begin(from); i != boost::asio::buffer_sequence_end(from);
                     ++i)
                    if (first.size() == 0) first = *i;
                readSome(first, {std::move(done), get_executor()});
            },
            handler, buffers);
    }
    // From the first buffers that are not empty.
    template <class Buffers, class Handler>
    BOOST_BEAST_ASYNC_RESULT2(Handler)
    async_write_some(const Buffers& buffers, Handler&& handler) {
        return boost::asio::async_initiate<Handler, Signature>(
            [this](auto done, const Buffers& from) {
                Gathered gathered;
                size_t count = 0;
                for (auto i = boost::asio::buffer_sequence_begin(from); i != boost::asio::buffer_sequence_end(from);
                     ++i) {
                    const boost::asio::const_buffer buffer(*i);
                    if (buffer.size() > 0 && count < gathered.size()) gathered[count++] = buffer;
                }
                writeSome(gathered, {std::move(done), get_executor()});
            },
            handler, buffers);
    }

private:
    using Signature = void(boost::system::error_code, size_t);
    using Gathered =
        std::array<boost::asio::const_buffer, 8>; // more than a head and a body take; the rest is written next

    void readSome(boost::asio::mutable_buffer buffer, AnyHandler done);
    void writeSome(const Gathered& buffers, AnyHandler done);

    std::variant<Tcp, Tls> stream_;
    std::shared_ptr<uint64_t> received_ = std::make_shared<uint64_t>(0); // shared with the read that is under way
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
