// What tests of whole programs share: start, read their files, judge their end.
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

client::Bytes contentOf(const std::filesystem::path& file);

// It ends by itself, not with success, and with a single line on standard error that has these words.
void expectOneLine(Process& process, const std::string& words);

} // namespace brume::test
