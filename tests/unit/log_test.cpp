// Lines of JSON, whatever a message holds.
#include "server/operate/log.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

namespace brume {
namespace {

using nlohmann::json;

std::string logged(const std::string& message, spdlog::level::level_enum level = spdlog::level::info) {
    std::ostringstream out;
    spdlog::logger logger("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(out));
    logger.set_formatter(jsonLines());
    logger.log(level, "{}", message);
    return out.str();
}

TEST(JsonLog, EveryMessageIsOneLineThatReadsBackAsItWas) {
    for (const std::string message :
         {"plain", "", "with \"quotes\", a \\ and a\ttab", "two\nlines\r\n",
          "{\"level\":\"fake\"}\n{\"level\":\"fake\"}", "\x01\x1f\x7f", "cloud \xe2\x98\x81"}) {
        const std::string line = logged(message);
        ASSERT_FALSE(line.empty());
        EXPECT_EQ(line.find('\n'), line.size() - 1) << line;
        EXPECT_EQ(json::parse(line).at("message"), message);
    }
    EXPECT_EQ(json::parse(logged(std::string("a\0b", 3))).at("message"), std::string("a\0b", 3));
}

TEST(JsonLog, BytesThatAreNotUtf8AreReplaced) {
    const std::string line = logged("a\xff\xc3(b");
    EXPECT_EQ(line.find('\n'), line.size() - 1);
    EXPECT_EQ(json::parse(line).at("message"), "a\xef\xbf\xbd\xef\xbf\xbd(b");
}

TEST(JsonLog, LevelAndTimeAreFields) {
    const json line = json::parse(logged("x", spdlog::level::warn));
    EXPECT_EQ(line.size(), 3u);
    EXPECT_EQ(line.at("level"), "warning");
    const std::string time = line.at("time");
    ASSERT_EQ(time.size(), 24u) << time; // 2026-01-31T12:00:00.123Z
    for (size_t i = 0; i < time.size(); ++i) {
        const char pattern = "dddd-dd-ddTdd:dd:dd.dddZ"[i];
        EXPECT_TRUE(pattern == 'd' ? time[i] >= '0' && time[i] <= '9' : time[i] == pattern) << time;
    }
}

} // namespace
} // namespace brume
