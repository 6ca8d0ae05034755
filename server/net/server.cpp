#include "server/net/server.h"

#include <mutex>
#include <stdexcept>
#include <thread>

#include <netinet/tcp.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/strand.hpp>
#include <boost/asio/use_future.hpp>
#include <boost/asio/write.hpp>
#include <fmt/format.h>

#include "server/net/address.h"
#include "server/net/agent.h"
#include "server/net/context.h"
#include "server/net/coroutine.h"
#include "server/net/http.h"
#include "server/net/proxy_greeting.h"
#include "server/net/tls.h"

namespace brume {

using namespace net;
using asio::ip::tcp;
namespace beast = boost::beast;

namespace {

constexpr int kMostUnsent = 32 << 10; // bytes of a connection that may wait in the kernel

// Connections beyond --max-connections (HttpConnection::answer() says for what), and those of them for one address.
constexpr uint32_t kReserve = 16, kReservePerAddress = 4;

Connections::Limits limitsOf(const NetOptions& options) {
    return {
        options.max_connections, options.max_connections_per_address, options.accept_rate, options.burst_s, kReserve,
        kReservePerAddress};
}

Address addressOf(const tcp::endpoint& remote) {
    // Without its scope, which a link-local address of IPv6 has.
    const std::string text = remote.address().to_string();
    return Address::read(text.substr(0, text.find('%'))).value_or(Address());
}

std::string hostAndPort(const std::string& listen, uint16_t port) {
    const bool v6 = listen.find(':') != std::string::npos;
    return fmt::format("{}{}{}:{}", v6 ? "[" : "", listen, v6 ? "]" : "", port);
}

// Says what to do about a listener that does not open. `option` sets its port.
std::runtime_error cannotListen(const std::string& listen, uint16_t port, const char* option, const error_code& error) {
    std::string advice = "choose another with --listen";
    if (error == asio::error::address_in_use) advice = fmt::format("choose another with {}", option);
    if (error == asio::error::access_denied) advice = fmt::format("choose a port above 1023 with {}", option);
    return std::runtime_error(
        fmt::format("cannot listen on {}: {}; {}", hostAndPort(listen, port), error.message(), advice));
}

void bindTo(tcp::acceptor& acceptor, const std::string& listen, uint16_t port, const char* option) {
    error_code error;
    const auto found =
        tcp::resolver(acceptor.get_executor()).resolve(listen, std::to_string(port), tcp::resolver::passive, error);
    if (error) throw cannotListen(listen, port, option, error);
    const tcp::endpoint endpoint = *found.begin();
    acceptor.open(endpoint.protocol(), error);
    if (!error) acceptor.set_option(asio::socket_base::reuse_address(true), error);
    // Of :: both kinds come in, whatever the system's default is.
    if (!error && endpoint.protocol() == tcp::v6()) acceptor.set_option(asio::ip::v6_only(false), error);
    if (!error) acceptor.bind(endpoint, error);
    if (error) throw cannotListen(listen, port, option, error);
}

void listenOn(tcp::acceptor& acceptor, const std::string& listen, uint16_t port, const char* option) {
    bindTo(acceptor, listen, port, option);
    error_code error;
    acceptor.listen(asio::socket_base::max_listen_connections, error);
    if (error) throw cannotListen(listen, port, option, error);
}

void refuse(const Context& context, tcp::socket& socket, Connections::Refused why) {
    const bool full = why == Connections::Refused::full;
    context.metrics.refused(full ? "connections" : "accept_rate");
    if (context.tls) return; // a peer that expects TLS cannot read plain text
    error_code error;
    socket.non_blocking(true, error);
    // The answer fits into the buffer of a new socket, so nothing has to wait for it.
    socket.write_some(asio::buffer(lastWords(full ? noRoom() : tooOften(), context.options)), error);
}

// Serves a connection that comes from this address.
void serveFrom(std::shared_ptr<const Context> context, beast::tcp_stream tcp, const Address& address) {
    auto refused = Connections::Refused::nothing;
    const bool proxy = isTrusted(address, context->options.trusted_proxies);
    auto slot = proxy ? context->connections.takeForOthers(address.text(), address.network())
                      : context->connections.take(address.text(), address.network(), &refused);
    if (!slot) return refuse(*context, tcp.socket(), proxy ? Connections::Refused::full : refused);
    ByteStream stream = context->tls ? ByteStream(std::move(tcp), context->tls->context) : ByteStream(std::move(tcp));
    serveHttp(std::move(context), std::move(stream), std::move(slot));
}

} // namespace

struct NetServer::State {
    State(NetOptions options, Audience& audience, Metrics& metrics)
        : shared{Rooms(std::make_shared<Room>("", audience, metrics)), metrics, Pages{options.web_root},
                 Connections(limitsOf(options))} {
        add(std::move(options));
    }

    void add(NetOptions options) {
        std::shared_ptr<Tls> tls;
        if (!options.tls_key.empty()) tls = std::make_shared<Tls>(options.tls_certificate, options.tls_key);
        auto context = std::make_shared<const Context>(std::move(options), std::move(tls), shared);
        const std::scoped_lock lock(mutex);
        newest = std::move(context);
    }
    std::shared_ptr<const Context> context() const {
        const std::scoped_lock lock(mutex);
        return newest;
    }

    using Serve = void (State::*)(tcp::socket) const;
    asio::awaitable<void> accept(tcp::acceptor& from, Serve serve_it);
    void serve(tcp::socket socket) const;
    void answerAgent(tcp::socket socket) const;

    ServerState shared;
    mutable std::mutex mutex;
    std::shared_ptr<const Context> newest; // guarded by mutex
    // Declared after `shared`, so that it is destroyed first: coroutines that never ended are destroyed with it, and
    // give their slots back to `shared`.
    asio::io_context io;
    tcp::acceptor acceptor{asio::make_strand(io)};
    tcp::acceptor agents{acceptor.get_executor()}; // of --agent-port
    std::vector<std::thread> threads;
};

asio::awaitable<void> NetServer::State::accept(tcp::acceptor& from, Serve serve_it) {
    asio::steady_timer pause(from.get_executor());
    for (;;) {
        auto [error, socket] = co_await from.async_accept(asio::make_strand(io), kToken);
        if (shared.stopping || error == asio::error::operation_aborted) co_return;
        if (error) { // most likely no descriptor is free: after a pause another connection may have ended
            shared.log.write(spdlog::level::warn, "all addresses",
                             fmt::format("cannot accept a connection: {}", error.message()));
            pause.expires_after(std::chrono::milliseconds(100));
            co_await pause.async_wait(kToken);
            continue;
        }
        (this->*serve_it)(std::move(socket));
    }
}

// One line, whatever is asked. It fits into the buffer of a new socket, so nothing has to wait for it.
void NetServer::State::answerAgent(tcp::socket socket) const {
    const Audience& audience = shared.rooms.home()->audience;
    const std::string line = agentLine({audience.ready, shared.draining, !audience.report()->standstill.empty(),
                                        audience.budget_used, audience.withPictures(), audience.places()});
    error_code ignored;
    socket.non_blocking(true, ignored);
    socket.write_some(asio::buffer(line), ignored);
    socket.shutdown(tcp::socket::shutdown_send, ignored);
}

void NetServer::State::serve(tcp::socket socket) const {
    const auto shared_context = this->context();
    const Context& context = *shared_context;
    error_code error;
    const auto remote = socket.remote_endpoint(error);
    if (error) return; // the peer has closed already
    socket.set_option(tcp::no_delay(true), error);
    // Few bytes wait in the kernel: a frame that waits here can still be replaced by a newer one, and control messages
    // can be sent before it.
    const int unsent = kMostUnsent;
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_NOTSENT_LOWAT, &unsent, sizeof unsent);
    // Ends the connection if the peer acknowledges no byte for so long: it vanished, or it keeps its window closed.
    const auto stall_ms = static_cast<unsigned>(context.options.write_stall.count());
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_USER_TIMEOUT, &stall_ms, sizeof stall_ms);
    const Address peer = addressOf(remote);
    if (!context.options.proxy_protocol) return serveFrom(shared_context, beast::tcp_stream(std::move(socket)), peer);
    auto slot = context.connections.takeOwing(peer.text(), peer.network());
    if (!slot) return refuse(context, socket, Connections::Refused::full);
    greetGateway(shared_context, beast::tcp_stream(std::move(socket)), std::move(slot), peer, serveFrom);
}

NetServer::NetServer(NetOptions options, Audience& audience, Metrics& metrics)
    : state_(std::make_unique<State>(std::move(options), audience, metrics)) {}

NetServer::~NetServer() { stop(std::chrono::milliseconds(0)); }

void checkNetwork(const net::NetOptions& options) {
    if (!options.tls_key.empty()) const Tls usable(options.tls_certificate, options.tls_key);
    asio::io_context io;
    tcp::acceptor viewers(io), agents(io);
    bindTo(viewers, options.listen, options.port, "--port");
    if (options.agent_port != 0) bindTo(agents, options.listen, options.agent_port, "--agent-port");
}

void NetServer::start() {
    State& s = *state_;
    const auto context = s.context();
    const NetOptions& options = context->options;
    listenOn(s.acceptor, options.listen, options.port, "--port");
    asio::co_spawn(s.acceptor.get_executor(), s.accept(s.acceptor, &State::serve), kLogFailure);
    if (options.agent_port != 0) {
        listenOn(s.agents, options.listen, options.agent_port, "--agent-port");
        asio::co_spawn(s.agents.get_executor(), s.accept(s.agents, &State::answerAgent), kLogFailure);
    }
    for (uint32_t i = 0; i < std::max(options.threads, 1u); ++i) s.threads.emplace_back([&s] { s.io.run(); });
}

uint16_t NetServer::port() const { return state_->acceptor.local_endpoint().port(); }

void NetServer::setOptions(NetOptions options) {
    State& s = *state_;
    const auto context = s.context();
    const NetOptions& old = context->options;
    options.listen = old.listen;
    options.port = old.port;
    options.agent_port = old.agent_port;
    options.proxy_protocol = old.proxy_protocol;
    options.web_root = old.web_root;
    options.threads = old.threads;
    options.tls_certificate = old.tls_certificate;
    options.tls_key = old.tls_key;
    const Connections::Limits limits = limitsOf(options);
    s.add(std::move(options));
    s.shared.connections.setLimits(limits);
}

uint32_t NetServer::contexts() const { return state_->shared.contexts; }

void NetServer::drain() { state_->shared.draining = true; }

net::Rooms& NetServer::rooms() { return state_->shared.rooms; }

void NetServer::setElsewhere(std::function<std::string()> elsewhere) {
    state_->shared.rooms.home()->elsewhere.set(std::move(elsewhere));
}

void NetServer::stop(std::chrono::milliseconds grace, std::string go_to) {
    State& s = *state_;
    if (s.threads.empty()) return;
    const auto deadline = std::chrono::steady_clock::now() + grace;
    s.shared.go_to = std::move(go_to);
    s.shared.stopping = true;
    // Waits until the listeners are closed, so that no client connects to a server that will not answer.
    asio::post(s.acceptor.get_executor(), asio::use_future([&s] {
                   s.acceptor.close();
                   s.agents.close();
               }))
        .wait();
    s.shared.connections.stopAll();
    if (!s.shared.connections.waitUntilEmpty(deadline)) {
        s.shared.connections.killAll();
        // Coroutines end at once when their socket is cut. One that does not is destroyed with the io_context.
        if (!s.shared.connections.waitUntilEmpty(std::chrono::steady_clock::now() + std::chrono::seconds(1)))
            spdlog::warn("stop: a connection did not end when it was cut");
    }
    s.io.stop();
    for (std::thread& thread : s.threads) thread.join();
    s.threads.clear();
}

} // namespace brume
