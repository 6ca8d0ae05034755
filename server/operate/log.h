// The program's log: one line for each event, as text for people or as JSON for machines.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <spdlog/formatter.h>

namespace brume {

// Formats lines of JSON: {"level":"info","message":"...","time":"2026-01-31T12:00:00.123Z"}. The message may hold any
// bytes: quotes and control characters are escaped, bytes that are not UTF-8 become U+FFFD. The time is UTC.
std::unique_ptr<spdlog::formatter> jsonLines();

// Makes the log of the process: to standard error, or appended to `file` unless that is empty. `level`: debug | info
// | warn | error; `format`: text | json. Throws spdlog::spdlog_ex when the file cannot be opened.
void startLog(const std::string& level, const std::string& format, const std::filesystem::path& file);

} // namespace brume
