#pragma once
// What every page of results has: its head, and where it goes.
#include <filesystem>
#include <string>

#include "tools/bench/commands.h"

namespace brume::bench {

// First line of what a command prints; empty when it fails.
std::string said(const char* command);
// This machine's CPU by name, and how many threads of it are ours.
std::string cpu();
// As YYYY-MM-DD, UTC.
std::string today();

// The title, the command, the day, CPU, device, and where the costs are from that the page was planned with.
std::string headed(const std::string& title, const Context& context, const gpu::Device& device,
                   const CostModel* costs = nullptr);

// To standard output where `file` is empty. Throws std::runtime_error, one line.
void writeText(const std::filesystem::path& file, const std::string& text);

} // namespace brume::bench
