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
#include "server/net/tls.h"

namespace brume {

using namespace net;
using asio::ip::tcp;
namespace beast = boost::beast;

namespace {

constexpr int kMostUnsent = 32 << 10; // bytes

constexpr std::string_view kNoRoom = "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain\r\nRetry-After: 5\r\n"
                                     "Connection: close\r\n\r\ntoo many connections: try again later\n";

constexpr std::string_view kTooOften = "HTTP/1.1 429 Too Many Requests\r\nContent-Type: text/plain\r\nRetry-After: 1\r\n"
                                       "Connection: close\r\n\r\ntoo many connections a second: try again later\n";

Connections::Limits limitsOf(const NetOptions& options) {
    return {options.max_connections, options.max_connections_per_address, options.accept_rate, options.burst_s};
}

// What counts as one address: of IPv6 the 64 bits that one site has to itself, of IPv4 in IPv6 the IPv4.
std::string networkOf(const asio::ip::address& address) {
    if (address.is_v4()) return address.to_string();
    const auto v6 = address.to_v6();
    if (v6.is_v4_mapped()) return asio::ip::make_address_v4(asio::ip::v4_mapped, v6).to_string();
    auto bytes = v6.to_bytes();
    std::fill(bytes.begin() + 8, bytes.end(), static_cast<unsigned char>(0));
    return asio::ip::address_v6(bytes).to_string() + "/64";
}

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
        : house{audience, metrics, Pages{options.web_root}, Connections(limitsOf(options))} {
        add(std::move(options));
    }

    void add(NetOptions options) {
        std::shared_ptr<Tls> tls;
        if (!options.tls_key.empty()) tls = std::make_shared<Tls>(options.tls_certificate, options.tls_key);
        newest = &contexts.emplace_back(std::move(options), std::move(tls), house);
    }
    const NetOptions& options() const { return newest.load()->options; }

    asio::awaitable<void> accept();
    void welcome(tcp::socket socket) const;

    House house;
    std::deque<Context>
        contexts; // each stays where it is to the end, for connections that have it: a KB a reload, tens with a certificate
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

void NetServer::State::welcome(tcp::socket socket) const {
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
    auto refused = Connections::Refused::nothing;
    auto place = context.connections.take(remote.address().to_string(), networkOf(remote.address()), &refused);
    if (!place) {
        const bool room = refused == Connections::Refused::room;
        context.metrics.refused(room ? "connections" : "accept_rate");
        if (context.tls) return; // who expects TLS reads no plain words
        socket.non_blocking(true, error);
        socket.write_some(asio::buffer(room ? kNoRoom : kTooOften), error); // fits a fresh socket's buffer; nobody waits for it
        return;
    }
    beast::tcp_stream tcp(std::move(socket));
    serveHttp(context, context.tls ? ByteStream(std::move(tcp), context.tls->context) : ByteStream(std::move(tcp)),
              std::move(place));
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
    options.tls_certificate = old.tls_certificate;
    options.tls_key = old.tls_key;
    const Connections::Limits limits = limitsOf(options);
    s.add(std::move(options));
    s.house.connections.setLimits(limits);
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
