#include "server/operate/log.h"

#include <ctime>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

namespace brume {
namespace {

class JsonLines final : public spdlog::formatter {
public:
    void format(const spdlog::details::log_msg& message, spdlog::memory_buf_t& out) override {
        using namespace std::chrono;
        const auto since = message.time.time_since_epoch();
        const std::time_t second = duration_cast<seconds>(since).count();
        std::tm utc{};
        ::gmtime_r(&second, &utc);
        char time[32];
        const size_t length = std::strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%S", &utc);
        const auto text = [](const auto& view) { return std::string(view.data(), view.size()); };
        const nlohmann::json line{{"time", fmt::format("{}.{:03}Z", std::string_view(time, length),
                                                       duration_cast<milliseconds>(since).count() % 1000)},
                                  {"level", text(spdlog::level::to_string_view(message.level))},
                                  {"message", text(message.payload)}};
        const std::string written = line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
        out.append(written.data(), written.data() + written.size());
    }
    std::unique_ptr<spdlog::formatter> clone() const override { return std::make_unique<JsonLines>(); }
};

} // namespace

std::unique_ptr<spdlog::formatter> jsonLines() { return std::make_unique<JsonLines>(); }

void startLog(const std::string& level, const std::string& format, const std::filesystem::path& file) {
    spdlog::sink_ptr sink;
    if (file.empty())
        sink = std::make_shared<spdlog::sinks::stderr_sink_mt>();
    else if (std::error_code error; std::filesystem::is_fifo(file, error)) // to open it waits for a reader
        throw std::runtime_error(fmt::format("--log-file {}: is a pipe; allowed: a file", file.string()));
    else
        sink = std::make_shared<spdlog::sinks::basic_file_sink_mt>(file.string());
    auto logger = std::make_shared<spdlog::logger>("brume", sink);
    if (format == "json") logger->set_formatter(jsonLines());
    spdlog::set_default_logger(std::move(logger));
    spdlog::set_level(spdlog::level::from_str(level));
    spdlog::flush_on(spdlog::level::info);
}

} // namespace brume
