#include "server/net/server.h"

#include <deque>
#include <stdexcept>
#include <thread>

#include <netinet/tcp.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "server/net/context.h"
#include "server/net/coroutine.h"
#include "server/net/http.h"

namespace brume {

using namespace net;
using asio::ip::tcp;

namespace {

constexpr int kMostUnsent = 32 << 10; // bytes

constexpr std::string_view kNoRoom = "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nRetry-After: 5\r\n"
                                     "Connection: close\r\n\r\ntoo many connections: try again later\n";

std::string hostAndPort(const NetOptions& options) {
    const bool v6 = options.listen.find(':') != std::string::npos;
    return fmt::format("{}{}{}:{}", v6 ? "[" : "", options.listen, v6 ? "]" : "", options.port);
}

// Says what to do about a listener that does not open.
std::runtime_error cannotListen(const NetOptions& options, const error_code& error) {
    const char* advice = "; choose another with --listen";
    if (error == asio::error::address_in_use) advice = "; choose another with --port";
    if (error == asio::error::access_denied) advice = "; choose a port above 1023 with --port";
    return std::runtime_error(fmt::format("cannot listen on {}: {}{}", hostAndPort(options), error.message(), advice));
}

} // namespace

struct NetServer::State {
    State(NetOptions options, Audience& audience, Metrics& metrics)
        : house{audience, metrics, Pages{options.web_root}, {options.max_connections, options.max_connections_per_address}} {
        add(std::move(options));
    }

    void add(NetOptions options) { newest = &contexts.emplace_back(std::move(options), house); }
    const NetOptions& options() const { return newest.load()->options; }

    asio::awaitable<void> accept();
    void welcome(tcp::socket socket);

    House house;
    std::deque<Context> contexts; // each stays where it is to the end, for connections that have it: some 300 bytes a reload
    std::atomic<Context*> newest;
    // Dies before the contexts: coroutines that never ended are destroyed with it and give their places back.
    asio::io_context io;
    tcp::acceptor acceptor{asio::make_strand(io)};
    std::vector<std::thread> threads;
};

asio::awaitable<void> NetServer::State::accept() {
    asio::steady_timer pause(acceptor.get_executor());
    for (;;) {
        auto [error, socket] = co_await acceptor.async_accept(asio::make_strand(io), kToken);
        if (house.stopping || error == asio::error::operation_aborted) co_return;
        if (error) { // out of descriptors, most likely: what is open may end
            spdlog::warn("cannot accept a connection: {}", error.message());
            pause.expires_after(std::chrono::milliseconds(100));
            co_await pause.async_wait(kToken);
            continue;
        }
        welcome(std::move(socket));
    }
}

void NetServer::State::welcome(tcp::socket socket) {
    Context& context = *newest.load();
    error_code error;
    const auto remote = socket.remote_endpoint(error);
    if (error) return; // gone already
    socket.set_option(tcp::no_delay(true), error);
    // Few bytes wait in the kernel, so that a newer frame can still take the place of an older one, and control messages pass
    // both.
    const int unsent = kMostUnsent;
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
    // What the kernel has taken from us but the peer does not: a peer that vanished, or shut its window for good.
    const auto stall_ms = static_cast<unsigned>(context.options.write_stall.count());
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &stall_ms, sizeof stall_ms);
    auto place = context.connections.take(remote.address().to_string());
    if (!place) {
        context.metrics.refused("connections");
        socket.non_blocking(true, error);
        socket.write_some(asio::buffer(kNoRoom), error); // fits a fresh socket's buffer; nobody waits for it
        return;
    }
    serveHttp(context, std::move(socket), std::move(place));
}

NetServer::NetServer(NetOptions options, Audience& audience, Metrics& metrics)
    : state_(std::make_unique<State>(std::move(options), audience, metrics)) {}

NetServer::~NetServer() { stop(std::chrono::milliseconds(0)); }

void NetServer::start() {
    State& s = *state_;
    const NetOptions& options = s.options();
    error_code error;
    const auto found = tcp::resolver(s.io).resolve(options.listen, std::to_string(options.port), tcp::resolver::passive, error);
    if (error) throw cannotListen(options, error);
    const tcp::endpoint endpoint = *found.begin();
    s.acceptor.open(endpoint.protocol(), error);
    if (!error) s.acceptor.set_option(asio::socket_base::reuse_address(true), error);
    if (!error) s.acceptor.bind(endpoint, error);
    if (!error) s.acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error) throw cannotListen(options, error);

    asio::co_spawn(s.acceptor.get_executor(), s.accept(), kLogFailure);
    for (uint32_t i = 0; i < std::max(options.threads, 1u); ++i) s.threads.emplace_back([&s] { s.io.run(); });
}

uint16_t NetServer::port() const { return state_->acceptor.local_endpoint().port(); }

void NetServer::setOptions(NetOptions options) {
    State& s = *state_;
    const NetOptions& old = s.options();
    options.listen = old.listen;
    options.port = old.port;
    options.web_root = old.web_root;
    options.threads = old.threads;
    s.house.connections.setLimits(options.max_connections, options.max_connections_per_address);
    s.add(std::move(options));
}

void NetServer::drain() { state_->house.draining = true; }

void NetServer::stop(std::chrono::milliseconds grace, std::string go_to) {
    State& s = *state_;
    if (s.threads.empty()) return;
    const auto deadline = std::chrono::steady_clock::now() + grace;
    s.house.go_to = std::move(go_to);
    s.house.stopping = true;
    asio::post(s.acceptor.get_executor(), [&s] { s.acceptor.close(); });
    s.house.connections.stopAll();
    if (!s.house.connections.waitUntilEmpty(deadline)) {
        s.house.connections.killAll();
        // Cut sockets end their coroutines at once; what does not is destroyed with the io_context.
        s.house.connections.waitUntilEmpty(std::chrono::steady_clock::now() + std::chrono::seconds(1));
    }
    s.io.stop();
    for (std::thread& thread : s.threads) thread.join();
    s.threads.clear();
}

} // namespace brume
