// Helpers of tests that run whole programs: start them, read their files, check how they end.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "client/native/connection.h"
#include "tests/integration/process.h"

namespace brume::test {

std::unique_ptr<Process> startProgram(const std::string& program, const std::vector<std::string>& arguments,
                                      const std::vector<std::string>& environment = {});

size_t timesIn(const std::string& text, const std::string& words);

client::Bytes contentOf(const std::filesystem::path& file);

// Expects that the process ends by itself with an error status and exactly one line on standard error, which contains
// `words`.
void expectOneLine(Process& process, const std::string& words);

} // namespace brume::test
