#include "server/net/proxy_greeting.h"

#include <vector>

#include <boost/beast/core/error.hpp>
#include <fmt/format.h>

#include "server/net/coroutine.h"
#include "server/net/proxy_header.h"

namespace brume::net {
namespace {

class ProxyGreeting final : public Connection, public std::enable_shared_from_this<ProxyGreeting> {
public:
    ProxyGreeting(std::shared_ptr<const Context> context, ByteStream::Tcp tcp, std::unique_ptr<ConnectionSlot> slot,
                  Address own, ServeFrom serve)
        : context_(std::move(context)), slot_(std::move(slot)), stream_(std::move(tcp)), own_(own), serve_(serve) {}

    void start() {
        slot_->assign(shared_from_this());
        asio::co_spawn(
            stream_.get_executor(), [self = shared_from_this()] { return self->run(); }, kLogFailure);
    }
    void stop() override {
        asio::post(stream_.get_executor(), [self = shared_from_this()] { self->stream_.tcp().close(); });
    }
    void kill() override { stop(); }

private:
    asio::awaitable<void> run();
    void refuse(const char* line) const;

    const std::shared_ptr<const Context> context_;
    std::unique_ptr<ConnectionSlot> slot_;
    ByteStream stream_; // without TLS, which begins behind the header
    const Address own_;
    const ServeFrom serve_;
};

asio::awaitable<void> ProxyGreeting::run() {
    stream_.tcp().expires_after(context_->options.handshake); // for all of it
    std::vector<uint8_t> begun;
    auto read = readProxyHeader(begun);
    while (const auto* more = std::get_if<ProxyMore>(&read)) {
        const size_t had = begun.size();
        begun.resize(had + more->bytes);
        const auto [error, size] = co_await stream_.async_read_some(asio::buffer(begun) + had, kToken);
        begun.resize(had + size);
        if (error) {
            // Who comes and goes without a word looks if the port is open.
            if (!begun.empty())
                refuse("half of a PROXY protocol header: the gateway must send all of it within --handshake");
            else if (error == boost::beast::error::timeout)
                refuse(kNoProxyHeader);
            co_return;
        }
        read = readProxyHeader(begun);
    }
    if (const auto* fault = std::get_if<ProxyFault>(&read)) co_return refuse(fault->line);
    const std::string& address = std::get<ProxySource>(read).address;
    // The next slot is taken before this one is given back, so that a stop waits for the connection all the time.
    serve_(context_, std::move(stream_.tcp()), address.empty() ? own_ : Address::read(address).value_or(own_));
}

void ProxyGreeting::refuse(const char* line) const {
    if (context_->stopping) return;
    context_->metrics.refused("proxy_header");
    context_->log.write(spdlog::level::warn, slot_->network(), fmt::format("{}: {}", slot_->address(), line));
}

} // namespace

void greetGateway(std::shared_ptr<const Context> context, ByteStream::Tcp tcp, std::unique_ptr<ConnectionSlot> slot,
                  const Address& own, ServeFrom serve) {
    std::make_shared<ProxyGreeting>(std::move(context), std::move(tcp), std::move(slot), own, serve)->start();
}

} // namespace brume::net
