// Asio as we use it: coroutines on a strand per connection, errors as values.
#pragma once

#include <exception>

#include <boost/asio/as_tuple.hpp>
#include <boost/asio/awaitable.hpp>
#include <boost/asio/co_spawn.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/use_awaitable.hpp>
#include <spdlog/spdlog.h>

namespace brume::net {

namespace asio = boost::asio;
using boost::system::error_code;

inline constexpr auto kToken = asio::as_tuple(asio::use_awaitable);

// For co_spawn: expected errors are values, so whatever arrives here ends one connection and is worth a line.
inline constexpr auto kLogFailure =
    [](std::exception_ptr failure) { // NOLINT(performance-unnecessary-value-param): what Asio calls it with
        try {
            if (failure) std::rethrow_exception(failure);
        } catch (const std::exception& e) {
            spdlog::error("a connection ended: {}", e.what());
        }
    };

// Something to wait for that other threads may ring. A ring while nobody waits is not kept: look first, then wait.
class Bell : public std::enable_shared_from_this<Bell> {
public:
    explicit Bell(const asio::any_io_executor& executor) : timer_(executor) {}

    // On the executor only.
    void ring() { timer_.cancel(); }
    asio::awaitable<void> wait(std::chrono::steady_clock::time_point until = std::chrono::steady_clock::time_point::max()) {
        timer_.expires_at(until);
        co_await timer_.async_wait(kToken);
    }

    // A function that rings from any thread, and does nothing once the bell is gone.
    auto ringer() {
        return [executor = timer_.get_executor(), weak = weak_from_this()] {
            asio::post(executor, [weak] {
                if (const auto bell = weak.lock()) bell->ring();
            });
        };
    }

private:
    asio::steady_timer timer_;
};

} // namespace brume::net
