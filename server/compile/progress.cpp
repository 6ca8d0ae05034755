#include "server/compile/progress.h"

#include <spdlog/spdlog.h>

namespace brume {
namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kLong = std::chrono::seconds(1), kTellAgain = std::chrono::seconds(5);

} // namespace

Progress::Progress()
    : thread_([this](const std::stop_token& over) {
          const Clock::time_point begun = Clock::now();
          const auto isOverAfter = [&](Clock::duration time) {
              std::unique_lock lock(mutex_);
              return woken_.wait_for(lock, over, time, [&] { return over.stop_requested(); });
          };
          if (isOverAfter(kLong)) return;
          spdlog::info("compiling shaders, which takes half a minute: a driver does so once, and then has them in "
                       "its cache");
          while (!isOverAfter(kTellAgain))
              spdlog::info("still compiling shaders, for {:.0f} s",
                           std::chrono::duration<double>(Clock::now() - begun).count());
      }) {}

} // namespace brume
