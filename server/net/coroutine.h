// Asio as the server uses it: coroutines, one strand per connection, errors as values.
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

// The completion token of every asynchronous operation: co_await gives a tuple whose first element is the error.
inline constexpr auto kToken = asio::as_tuple(asio::use_awaitable);

// For co_spawn. Expected errors are values, so an exception is a fault of this program: it ends one connection and is
// logged.
inline constexpr auto kLogFailure =
    [](std::exception_ptr failure) { // NOLINT(performance-unnecessary-value-param): what Asio calls it with
        try {
            if (failure) std::rethrow_exception(failure);
        } catch (const std::exception& e) {
            spdlog::error("a connection ended: {}", e.what());
        }
    };

// Wakes a coroutine. A notification is not kept while no coroutine waits, so check the condition first, then wait.
class Event : public std::enable_shared_from_this<Event> {
public:
    explicit Event(const asio::any_io_executor& executor) : timer_(executor) {}

    // On the executor only.
    void notify() { timer_.cancel(); }
    asio::awaitable<void>
    wait(std::chrono::steady_clock::time_point until = std::chrono::steady_clock::time_point::max()) {
        timer_.expires_at(until);
        co_await timer_.async_wait(kToken);
    }

    // A function that notifies from any thread. It does nothing once the event is destroyed.
    auto notifier() {
        return [executor = timer_.get_executor(), weak = weak_from_this()] {
            asio::post(executor, [weak] {
                if (const auto event = weak.lock()) event->notify();
            });
        };
    }

private:
    asio::steady_timer timer_;
};

} // namespace brume::net
