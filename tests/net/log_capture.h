// LogCapture: keeps the log lines written during its lifetime. Create it before a server, destroy it after.
#pragma once

#include <memory>
#include <string>

#include <spdlog/sinks/ringbuffer_sink.h>
#include <spdlog/spdlog.h>

namespace brume::test {

class LogCapture {
public:
    LogCapture() { spdlog::set_default_logger(std::make_shared<spdlog::logger>("captured", sink_)); }
    ~LogCapture() { spdlog::set_default_logger(before_); }
    LogCapture(const LogCapture&) = delete;
    LogCapture& operator=(const LogCapture&) = delete;

    // The captured lines of this level and above.
    std::string atLeast(spdlog::level::level_enum level) const {
        std::string text;
        for (const auto& line : sink_->last_raw())
            if (line.level >= level) text += std::string(line.payload.data(), line.payload.size()) + "\n";
        return text;
    }

private:
    const std::shared_ptr<spdlog::sinks::ringbuffer_sink_mt> sink_ =
        std::make_shared<spdlog::sinks::ringbuffer_sink_mt>(1000);
    const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
};

} // namespace brume::test
